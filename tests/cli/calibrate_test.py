# SPDX-License-Identifier: Apache-2.0
"""Calibrations of virtual benches by the program alone: as near to the truth as their sigmas say, or refused with what to do."""
import json
import pathlib
import unittest

from program import ProgramTest, main, run

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CHESSBOARD = SOURCE.parent / "shared/data/capture/chessboard"


def small_capture(name, bench_changes=None, **plan_changes):
    """The near bench with few pixels, targets and positions; the capture's folder is made anew."""
    bench = json.loads((SOURCE / "sample_data/bench_near.json").read_text())
    bench["camera"]["size_px"] = [128, 128]
    for key in ("fx_px", "fy_px", "cx_px", "cy_px"):
        bench["camera"][key] *= 0.25
    bench["filter"]["grid"] = [3, 2]
    bench["accuracy"]["screen_step_px"] = 4
    bench.update(bench_changes or {})
    pathlib.Path("small_bench.json").write_text(json.dumps(bench))
    plan = json.loads((SOURCE / "sample_data/plan_near.json").read_text())
    plan["camera"]["device"] = "bench:small_bench.json"
    plan["filter"].update(columns=3, rows=2)
    plan["exposures_us"] = [2000, 8000]
    plan["filter_views"]["positions"] = [[0, 0], [2, 1]]
    del plan["drift"]
    plan.update(plan_changes)
    pathlib.Path("small_plan.json").write_text(json.dumps({k: v for k, v in plan.items() if v is not None}))
    done = run("capture", "small_plan.json", "-o", name)
    assert done.returncode == 0, done.stderr
    return name


class Refusals(ProgramTest):
    def refusal(self, *arguments):
        return self.refused(1, "calibrate", *arguments)

    def test_a_folder_that_is_no_capture(self):
        self.assertIn("capture.json", self.refusal("nowhere", "-o", "rig.json"))

    def test_boards_that_are_not_found_are_named(self):
        # A board of another size than the plan says is not found anywhere.
        plan = json.loads((SOURCE / "sample_data/plan_near.json").read_text())
        board = dict(plan["targets"]["board"], dictionary="6x6_50")
        folder = small_capture("other_board", targets=dict(plan["targets"], board=board))
        text = self.refusal(folder, "-o", "rig.json")
        self.assertIn("target_v000", text)
        self.assertIn("at least 3", text)
        self.assertFalse(pathlib.Path("rig.json").exists())

    def test_missing_darks(self):
        folder = small_capture("no_darks", darks_per_exposure=0, darks_after_per_exposure=0, exposure_ratio_limit_rel=1)
        self.assertIn("dark", self.refusal(folder, "-o", "rig.json"))

    def test_missing_flats(self):
        folder = small_capture("no_flats", flats=None)
        self.assertIn("flats", self.refusal(folder, "-o", "rig.json"))

    def test_a_board_that_the_plan_does_not_describe(self):
        plan = json.loads((SOURCE / "sample_data/plan_near.json").read_text())
        folder = small_capture("no_board", photometer=None,
                               targets={k: v for k, v in plan["targets"].items() if k != "board"})
        self.assertIn("targets.board", self.refusal(folder, "-o", "rig.json"))


@unittest.skipUnless(CHESSBOARD.is_dir(), f"{CHESSBOARD} is absent")
class Photographs(ProgramTest):
    def test_thirteen_of_thirteen_chessboards(self):
        self.done("capture", "--import", CHESSBOARD, "-o", "boards", "--board", "chessboard:10x7:0.025")
        done = self.done("calibrate", "boards", "-o", "lens.json", "--report", "lens.html")
        self.assertIn("13 views", done.stderr)
        rig = json.loads(pathlib.Path("lens.json").read_text())
        figures = {figure["name"]: figure["value"] for figure in rig["provenance"]["figures"]}
        self.assertLess(figures["rms_px"], 0.20)
        self.assertNotIn("planes", rig)
        self.assertNotIn("radiometry", rig)
        self.assertIn("<html", pathlib.Path("lens.html").read_text())


if __name__ == "__main__":
    main()
