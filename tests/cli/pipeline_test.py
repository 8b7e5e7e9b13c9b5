# SPDX-License-Identifier: Apache-2.0
"""Proves that the commands of the README work one after the other, that what they print is the contract
of docs/formats.md, and that equal input and seed give equal bytes, whatever the number of threads."""
import csv
import io
import json
import os
import pathlib

from program import POINTS_HEADER, SMALL_LAMP, ProgramTest, disk_rays, main, run, write_rays, write_scene

RESULTS = ["e_r", "e_g", "e_b", "e_y", "sigma_sampling_y", "sigma_measured_y"]
# Of an estimate that agrees, 1 in 16,000 lies further away; seeds are fixed.
MOST_SIGMA = 4.0


def rows_of(text):
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(io.StringIO(text))]


def on_one_core():
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


class Pipeline(ProgramTest):
    def setUp(self):
        super().setUp()
        self.make_lamp()
        pathlib.Path("points.csv").write_text(
            f"name,{POINTS_HEADER}\na,0,-0.2,10,0,0,-1\nb,0,-0.2,10,0,0,-1\nc,1.5,-0.3,10,0.5,0,-1\nd,0,0,-5,0,0,1\n")

    def probe(self, *options):
        return self.done("probe", "lamp.luminaire.exr", "--points", "points.csv", *options).stdout

    def test_info_json_holds_what_the_contract_names(self):
        for name, kind in (("lamp.lightfield.exr", "lightfield"), ("lamp.luminaire.exr", "luminaire")):
            info = json.loads(self.done("info", name, "--json").stdout)
            self.assertEqual(info["kind"], kind)
            self.assertEqual(info["format_version"], 1)
            self.assertEqual(len(info["slabs"]), 1)
            slab = info["slabs"][0]
            self.assertEqual(slab["grid"], [5, 4])
            self.assertEqual(slab["texels"], [32, 24])
            self.assertEqual((slab["basis"], slab["weighting"], slab["delta_m"]), ("bspline", "irradiance", 2.4))
            self.assertEqual(info["flux"]["unit"], "lm")
            self.assertGreater(info["flux"]["value"], 0.0)
            self.assertEqual(info["flux"]["sigma"], 0.0)
        self.assertIn("flux", self.done("info", "lamp.luminaire.exr").stdout)

    def test_info_verify_finds_every_table_right(self):
        tables = json.loads(self.done("info", "lamp.luminaire.exr", "--verify", "--json").stdout)["tables"]
        self.assertGreater(tables["values"], 1000)
        self.assertEqual(tables["different"], 0)
        self.done("pack", "lamp.lightfield.exr", "-o", "lean.exr", "--lean")
        for name in ("lean.exr", "lamp.lightfield.exr"):
            self.assertIn("nothing to verify", self.done("info", name, "--verify").stderr)

    def test_probe_writes_the_points_columns_and_the_results(self):
        text = self.probe()
        header = text.splitlines()[0].split(",")
        self.assertEqual(header, POINTS_HEADER.split(",") + [name + "_lx" for name in RESULTS])
        rows = rows_of(text)
        self.assertEqual(len(rows), 4)
        self.assertTrue(text.splitlines()[3].startswith("1.5,-0.3,10,0.5,0,-1,"))
        first = rows[0]
        self.assertGreater(first["e_y_lx"], 1.0)
        luminance = 0.2126 * first["e_r_lx"] + 0.7152 * first["e_g_lx"] + 0.0722 * first["e_b_lx"]
        self.assertAlmostEqual(first["e_y_lx"], luminance, delta=1e-9 * luminance)  # twelve digits are printed
        self.assertEqual(first["sigma_sampling_y_lx"], 0.0)
        self.assertEqual(rows[3]["e_y_lx"], 0.0)  # behind the lamp

    def test_probe_gives_the_same_as_json_and_in_a_file_and_from_stdin(self):
        rows = rows_of(self.probe())
        points = json.loads(self.probe("--json"))["points"]
        self.assertEqual([list(point) for point in points], [list(row) for row in rows])
        for point, row in zip(points, rows):
            for name in ["x_m", "y_m", "z_m"] + list(row)[6:]:  # normals are of unit length in JSON
                value = row[name]
                self.assertAlmostEqual(point[name], value, delta=1e-9 * abs(value))
        self.assertEqual(self.probe("-o", "lux.csv"), "")
        self.assertEqual(pathlib.Path("lux.csv").read_text(), self.probe())
        piped = self.done("probe", "lamp.luminaire.exr", "--points", "-", input=pathlib.Path("points.csv").read_text())
        self.assertEqual(piped.stdout, self.probe())

    def test_probe_of_the_light_field_and_of_the_luminaire_agree(self):
        from_lightfield = self.done("probe", "lamp.lightfield.exr", "--points", "points.csv").stdout
        self.assertEqual(from_lightfield, self.probe())

    def test_probe_by_sampling_agrees_with_the_sum_and_depends_on_the_seed_alone(self):
        options = ["--sampler", "aperture", "--samples", "4096"]
        sampled = self.probe(*options, "--seed", "7")
        self.assertEqual(sampled, self.probe(*options, "--seed", "7"))
        self.assertNotEqual(sampled, self.probe(*options, "--seed", "8"))
        rows, exact = rows_of(sampled), rows_of(self.probe())
        self.assertNotEqual(rows[0]["e_y_lx"], rows[1]["e_y_lx"])  # one point, twice
        for estimate, truth in zip(rows[:3], exact[:3]):
            sigma = estimate["sigma_sampling_y_lx"]
            self.assertGreater(sigma, 0.0)
            self.assertLess(abs(estimate["e_y_lx"] - truth["e_y_lx"]), MOST_SIGMA * sigma)

    def test_probe_by_every_sampler_agrees_with_the_sum_or_is_known_to_be_biased(self):
        exact = rows_of(self.probe())
        for sampler in ("systematic", "cells", "uniform"):
            rows = rows_of(self.probe("--sampler", sampler))
            for estimate, truth in zip(rows[:3], exact[:3]):
                sigma = estimate["sigma_sampling_y_lx"]
                self.assertGreater(sigma, 0.0)
                self.assertLess(abs(estimate["e_y_lx"] - truth["e_y_lx"]), MOST_SIGMA * sigma, sampler)
            self.assertEqual(rows[3]["e_y_lx"], 0.0)
        for sampler in ("pdis", "precomputed"):
            self.assertEqual(self.probe("--sampler", sampler), self.probe("--sampler", sampler))

    def test_probe_of_a_coarser_sum_states_a_bound_of_its_bias(self):
        text = self.probe("--q", "1")
        self.assertEqual(text.splitlines()[0].split(",")[-1], "bias_bound_y_lx")
        rows, exact = rows_of(text), rows_of(self.probe())
        self.assertGreater(rows[0]["bias_bound_y_lx"], 0.0)
        self.assertNotEqual(rows[0]["e_y_lx"], exact[0]["e_y_lx"])
        self.assertEqual(rows[0]["sigma_sampling_y_lx"], 0.0)

    def test_render_writes_a_picture_with_layers_and_a_png(self):
        write_scene("scene.gltf", "lamp.luminaire.exr")
        self.done("render", "scene.gltf", "-o", "picture.exr", "--width", "48", "--samples", "8")
        info = json.loads(self.done("info", "picture.exr", "--json").stdout)
        self.assertEqual((info["kind"], info["size_px"]), ("picture", [48, 32]))
        layers = {layer["name"] for layer in info["layers"]}
        self.assertLessEqual({"radiance", "irradiance", "depth", "normal", "sigma", "lamp.lamp"}, layers)
        self.assertEqual({entry["name"] for entry in info["provenance"]["inputs"]},
                         {"scene.gltf", "lamp.luminaire.exr"})
        png = pathlib.Path("picture.png").read_bytes()
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(len(set(png)), 50)  # not one color

    def test_render_says_whether_an_error_was_reached_and_what_a_time_bought(self):
        write_scene("scene.gltf", "lamp.luminaire.exr")
        render = ["render", "scene.gltf", "-o", "picture.exr", "--width", "48"]
        self.assertIn("of the wanted 20 %, reached", self.done(*render, "--error", "0.2").stderr)
        result = run(*render, "--error", "0.0001", "--samples", "32")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("not reached", result.stderr)
        self.assertIn("bought an error of", self.done(*render, "--time-ms", "300").stderr)
        options = json.loads(self.done("info", "picture.exr", "--json").stdout)["provenance"]["options"]
        self.assertIn("depend on the clock", str(options))

    def test_render_by_every_sampler(self):
        write_scene("scene.gltf", "lamp.luminaire.exr")
        for sampler in ("sum", "systematic", "cells", "pdis", "precomputed", "uniform"):
            text = self.done("render", "scene.gltf", "-o", "picture.exr", "--width", "24", "--sampler", sampler).stderr
            self.assertIn(f"{sampler} sampler, 1 pass of 64 samples", text)
        self.done("render", "scene.gltf", "-o", "picture.exr", "--width", "24", "--q", "4")
        layers = json.loads(self.done("info", "picture.exr", "--json").stdout)["layers"]
        self.assertIn("bias_bound", {layer["name"] for layer in layers})

    def test_reproducible_files_do_not_depend_on_the_run_or_the_number_of_threads(self):
        write_scene("scene.gltf", "lamp.luminaire.exr")
        write_rays("disk.tm25ray", disk_rays(5000), luminous_flux_lm=100.0)
        render = ["render", "scene.gltf", "--width", "48", "--samples", "8"]
        commands = [["simulate", "headlight", *SMALL_LAMP], ["pack", "lamp.lightfield.exr"],
                    ["convert", "disk.tm25ray"], render]
        for command in commands:
            first = self.output_bytes("first.exr", command)
            self.assertEqual(first, self.output_bytes("second.exr", command), command)
            self.assertEqual(first, self.output_bytes("third.exr", command, preexec_fn=on_one_core), command)
            self.done(*command, "-o", "dated.exr")
            self.assertIn(b"date_utc", pathlib.Path("dated.exr").read_bytes())
            self.assertNotIn(b"date_utc", first)
        picture = self.output_bytes("first.exr", render)
        for threads in ("1", "3"):
            self.assertEqual(picture, self.output_bytes("second.exr", [*render, "--threads", threads]))
        self.assertEqual(pathlib.Path("first.png").read_bytes(), pathlib.Path("second.png").read_bytes())

    def output_bytes(self, name, command, **options):
        self.done(*command, "-o", name, "--reproducible", **options)
        return pathlib.Path(name).read_bytes()


class Convert(ProgramTest):
    def test_a_ray_file_becomes_a_light_field_of_its_flux(self):
        write_rays("disk.tm25ray", disk_rays(5000), luminous_flux_lm=100.0)
        self.done("convert", "disk.tm25ray", "-o", "disk.lightfield.exr", "--slabs", "5")
        info = json.loads(self.done("info", "disk.lightfield.exr", "--json").stdout)
        self.assertEqual(len(info["slabs"]), 5)
        self.assertAlmostEqual(info["flux"]["value"], 100.0, delta=2.0)  # convert drops 2 % at most
        self.assertGreater(info["flux"]["sigma"], 0.0)
        self.assertEqual(info["provenance"]["inputs"][0]["name"], "disk.tm25ray")

    def test_radiant_flux_is_probed_in_watts(self):
        write_rays("watts.tm25ray", disk_rays(5000, 0.5), radiant_flux_w=100.0)
        self.done("convert", "watts.tm25ray", "-o", "watts.lightfield.exr", "--grid", "7x7", "--texels", "8x8")
        flux = json.loads(self.done("info", "watts.lightfield.exr", "--json").stdout)["flux"]
        self.assertEqual(flux["unit"], "W")
        text = self.done("probe", "watts.lightfield.exr", "--points", "-",
                         input=f"{POINTS_HEADER}\n0,0,0.5,0,0,-1\n").stdout
        self.assertEqual(text.splitlines()[0].split(",")[6:], [name + "_w_m2" for name in RESULTS])
        row = rows_of(text)[0]
        self.assertGreater(row["e_y_w_m2"], 0.0)
        self.assertGreater(row["sigma_measured_y_w_m2"], 0.0)

    def test_a_lamp_that_loses_light_is_written_only_where_that_is_allowed(self):
        # A quarter of the rays goes back, which one slab cannot hold.
        rays = [ray[:5] + (-ray[5] if k % 4 == 0 else ray[5], ray[6]) for k, ray in enumerate(disk_rays(4000, 0.5))]
        write_rays("back.tm25ray", rays, luminous_flux_lm=100.0)
        command = ["convert", "back.tm25ray", "-o", "back.lightfield.exr", "--slabs", "1", "--grid", "5x5"]
        result = run(*command)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("--allow-drop", result.stderr)
        self.assertEqual(self.files(), ["back.tm25ray"])
        self.assertIn("dropped 25", self.done(*command, "--allow-drop").stderr)
        self.assertEqual(self.files(), ["back.lightfield.exr", "back.tm25ray"])


class Export(ProgramTest):
    def test_a_lamp_goes_through_every_format_and_back_with_its_flux(self):
        self.make_lamp()
        truth = json.loads(self.done("info", "lamp.luminaire.exr", "--json").stdout)["flux"]["value"]
        for name, options in (("lamp.tm25ray", []), ("lamp.dat", []), ("lamp.ray", []), ("text.ray", ["--format", "lighttools-text"])):
            said = self.done("export", "lamp.luminaire.exr", "-o", name, "--rays", "20000", "--seed", "2", *options).stderr
            self.assertIn(f"{name}: 20000 rays", said)
            self.done("convert", name, "-o", "back.lightfield.exr", "--no-color", "--slabs", "1", "--grid", "5x5", "--texels", "16x16")
            back = json.loads(self.done("info", "back.lightfield.exr", "--json").stdout)
            figures = back["provenance"]["figures"]
            self.assertAlmostEqual(back["flux"]["value"] + figures["flux_dropped_lm"], truth, delta=1e-3 * truth)
            self.assertLess(figures["flux_dropped_lm"], 0.02 * truth)

    def test_the_same_seed_gives_the_same_bytes_on_any_number_of_threads(self):
        self.make_lamp()
        command = ["export", "lamp.luminaire.exr", "--rays", "70000"]
        self.done(*command, "-o", "one.tm25ray")
        self.done(*command, "-o", "two.tm25ray", preexec_fn=on_one_core)
        self.assertEqual(pathlib.Path("one.tm25ray").read_bytes(), pathlib.Path("two.tm25ray").read_bytes())

    def test_what_cannot_be_is_refused(self):
        self.make_lamp()
        for options, words in ((["-o", "x.rays"], ".tm25ray"), (["-o", "x.ray", "--rays", "0"], "--rays"),
                               (["-o", "x.ray", "--axis", "up"], "--axis"), (["-o", "x.ray", "--origin-mm", "1", "2"], "--origin-mm")):
            self.assertIn(words, self.refused(2, "export", "lamp.luminaire.exr", *options))
        self.assertIn("sphere", self.refused(1, "export", "lamp.luminaire.exr", "-o", "x.ray", "--sphere-mm", "1"))
        self.assertFalse(pathlib.Path("x.ray").exists())


if __name__ == "__main__":
    main()
