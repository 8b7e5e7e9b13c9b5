# SPDX-License-Identifier: Apache-2.0
"""Fits by the program: a small virtual bench becomes a light field, and what does not fit together is refused."""
import json
import os
import pathlib
import re
import shutil
import unittest

from program import ProgramTest, main, run

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ADDRESS = f"127.{64 + (os.getpid() >> 8) % 64}.{os.getpid() % 256}.9"


def small_bench(bench_path, plan_path, device):
    """The near bench with a quarter of its pixels and a coarse filter that still covers the lens with a margin."""
    bench = json.loads((SOURCE / "sample_data/bench_near.json").read_text())
    bench["camera"]["size_px"] = [256, 256]
    for key in ("fx_px", "fy_px", "cx_px", "cy_px"):
        bench["camera"][key] *= 0.5
    grid, pitch_m = [7, 6], [0.036, 0.036]
    bench["filter"].update(grid=grid, pitch_m=pitch_m)
    bench["accuracy"].update(screen_step_px=3, lens_step=2)
    pathlib.Path(bench_path).write_text(json.dumps(bench))
    plan = json.loads((SOURCE / "sample_data/plan_near.json").read_text())
    plan["camera"]["device"] = device
    plan["filter"].update(columns=grid[0], rows=grid[1], pitch_m=pitch_m)
    plan["exposures_us"] = [500, 4000, 32000, 256000]
    plan["filter_views"]["positions"] = [[0, 0], [6, 0], [3, 3], [0, 5], [6, 5]]
    plan["drift"]["every"] = 7
    pathlib.Path(plan_path).write_text(json.dumps(plan))


class Fit(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = pathlib.Path("fit_test_made").absolute()
        shutil.rmtree(cls.made, ignore_errors=True)
        cls.made.mkdir()
        small_bench(cls.made / "bench.json", cls.made / "plan.json", "bench:bench.json")
        for command in (("capture", "plan.json", "-o", "capture"), ("calibrate", "capture", "-o", "rig.json")):
            done = run(*command, cwd=cls.made)
            assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.made)

    def fit(self, *options, capture=None, rig=None):
        return ("fit", capture or self.made / "capture", "--rig", rig or self.made / "rig.json", "--texels", "48x30",
                "-o", "lamp.lightfield.exr", *options)

    def changed_rig(self, change):
        rig = json.loads((self.made / "rig.json").read_text())
        change(rig)
        shutil.copy(self.made / "rig.maps.exr", "rig.maps.exr")
        pathlib.Path("rig.json").write_text(json.dumps(rig))
        return "rig.json"

    def test_a_capture_becomes_a_light_field(self):
        done = self.done(*self.fit("--report", "fit.html"))
        self.assertIn("42 positions, 48 x 30 texels", done.stderr)
        self.assertIn("light beside the filter, taken off", done.stderr)
        self.assertIn("<html", pathlib.Path("fit.html").read_text())
        told = self.done("info", "lamp.lightfield.exr").stdout
        self.assertIn("7 x 6 images of 48 x 30 texels", told)
        # The bench's lamp has 1000 lm, up to 4 % more while it warms up.
        flux_lm = float(re.search(r"flux ([0-9.]+) lm", done.stderr).group(1))
        self.assertGreater(flux_lm, 980)
        self.assertLess(flux_lm, 1060)

    def test_a_flux_that_was_measured_otherwise_must_agree(self):
        done = self.done(*self.fit("--flux-lm", 1020, "--flux-limit-rel", 0.1))
        self.assertIn("% off the 1020 lm", done.stderr)
        pathlib.Path("lamp.lightfield.exr").unlink()
        done = run(*self.fit("--flux-lm", 1500, "--report", "fit.html"))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("not written", done.stderr)
        self.assertEqual(self.files(), ["fit.html"])

    def test_a_rig_of_another_capture(self):
        rig = self.changed_rig(lambda rig: rig["radiometry"].update(bits=10))
        self.assertIn("rig is not this capture's", self.refused(1, *self.fit(rig=rig)))
        self.assertFalse(pathlib.Path("lamp.lightfield.exr").exists())

    def test_a_rig_without_the_filters_profile(self):
        rig = self.changed_rig(lambda rig: rig["radiometry"]["filter_profile"].update(cells=[]))
        self.assertIn("filter", self.refused(1, *self.fit(rig=rig)))

    def test_positions_without_frames(self):
        shutil.copytree(self.made / "capture", "capture")
        log = pathlib.Path("capture/log.jsonl")
        lines = log.read_text().splitlines(keepends=True)

        def keep(is_kept):
            records = [(line, json.loads(line).get("shot", {})) for line in lines]
            log.write_text("".join(line for line, shot in records
                                   if shot.get("kind") != "light" or is_kept(shot["position"])))

        keep(lambda position: position != [2, 3])
        self.assertIn("41 positions", self.done(*self.fit(capture="capture")).stderr)
        keep(lambda position: position in ([2, 3], [3, 3]))
        self.assertIn("too few positions", self.refused(1, *self.fit(capture="capture")))


class Lab(ProgramTest):
    def test_the_whole_way_on_a_small_bench(self):
        small_bench("bench.json", "plan.json", "")
        self.done("demo", "--lab", "--quick", "--bench", "bench.json", "--plan", "plan.json", "--address", ADDRESS,
                  "-o", "out")
        report = json.loads(pathlib.Path("out/report.json").read_text())
        closure = report["closure"]
        for key in ("irradiance_rms", "irradiance_rms_truth", "flux_rel", "delta_rel", "coverage_3sigma"):
            self.assertTrue(-1 < closure[key] < 10, f"{key}: {closure[key]}")
        # A coarse bench: an order of magnitude away from nonsense, not the sample benches' closeness.
        self.assertLess(abs(closure["flux_rel"]), 0.03)
        self.assertLess(closure["irradiance_rms"], 0.2)
        self.assertEqual(report["error_budget"][0]["source"], "all")
        for name in ("report.html", "calibration.html", "fit.html", "lamp.lightfield.exr", "picture.png"):
            self.assertTrue(pathlib.Path("out", name).exists(), name)


if __name__ == "__main__":
    main()
