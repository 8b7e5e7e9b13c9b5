# SPDX-License-Identifier: Apache-2.0
"""Proves that lamps go to and from the files that labs and other programs exchange, with their flux, and that lamps
are compared: what is equal is found equal, what is turned is found turned."""
import json
import math
import pathlib
import re
import xml.etree.ElementTree

from program import ProgramTest, disk_rays, main, run, write_rays

PLANES, ANGLES = range(0, 361, 15), range(0, 181, 5)


def skew_cd(plane_deg, angle_deg):
    """Intensity without symmetry, 400 pi lm all around: the table's C counts from +x to -y."""
    c, g = math.radians(plane_deg), math.radians(angle_deg)
    east, north, up = math.sin(g) * math.cos(c), math.sin(g) * math.sin(c), -math.cos(g)
    return 100 * (1 + 0.3 * east + 0.2 * north - 0.4 * up + 0.25 * east * north)


def write_ies(path, opening="0.2 0.3 0", planes=PLANES, angles=ANGLES, intensity=skew_cd):
    rows = [" ".join(f"{intensity(c, g):.9g}" for g in angles) for c in planes]
    pathlib.Path(path).write_text("\n".join([
        "IESNA:LM-63-2002", "[MANUFAC] nobody", "TILT=NONE",
        f"1 -1 1 {len(angles)} {len(planes)} 1 2 {opening}", "1 1 10",
        " ".join(map(str, angles)), " ".join(map(str, planes)), *rows, ""]))


class Photometry(ProgramTest):
    def info(self, name):
        return json.loads(self.done("info", name, "--json").stdout)

    def test_a_photometric_file_becomes_a_luminaire_and_comes_back_with_its_flux(self):
        write_ies("lamp.ies")
        flux = self.info("lamp.ies")["flux_lm"]
        self.assertAlmostEqual(flux, 400 * math.pi, delta=2)
        said = self.done("convert", "lamp.ies", "-o", "lamp.lightfield.exr", "--texels", "64x64").stderr
        self.assertIn("6 slabs", said)
        self.assertIn("nothing lies outside", said)
        self.assertIn("300 x 200 mm", said)
        back = self.info("lamp.lightfield.exr")
        self.assertAlmostEqual(back["flux"]["value"], flux, delta=1e-3 * flux)
        for name in ("back.ies", "back.ldt", "back.xml"):
            self.done("export", "lamp.lightfield.exr", "-o", name)
            self.assertAlmostEqual(self.info(name)["flux_lm"], flux, delta=1e-3 * flux, msg=name)
        xml.etree.ElementTree.parse("back.xml")
        compared = json.loads(self.done("compare", "lamp.ies", "back.xml", "--json").stdout)
        self.assertLess(compared["intensity"]["p95_rel"], 0.02)

    def test_formats_become_each_other(self):
        write_ies("lamp.ies")
        self.done("export", "lamp.ies", "-o", "lamp.ldt")
        self.done("export", "lamp.ldt", "-o", "lamp.xml")
        self.assertEqual(self.info("lamp.xml")["peak"], self.info("lamp.ldt")["peak"])
        self.assertIn("EULUMDAT", self.done("info", "lamp.ldt").stdout)

    def test_what_is_lost_is_told_and_not_written_unless_allowed(self):
        write_ies("lamp.ies")
        command = ["convert", "lamp.ies", "-o", "lamp.lightfield.exr", "--slabs", "1", "--texels", "32x32"]
        line = self.done(*command, "--allow-drop").stderr
        self.assertRegex(line, r"light \d+ ... 180 deg from \+z lies outside")
        pathlib.Path("lamp.lightfield.exr").unlink()
        result = run(*command)
        self.assertEqual(result.returncode, 3)
        self.assertEqual(self.files(), ["lamp.ies"])

    def test_points_and_options_of_others_are_refused(self):
        write_ies("point.ies", opening="0 0 0")
        self.assertIn("--opening-mm", self.refused(1, "convert", "point.ies", "-o", "x.exr"))
        self.done("convert", "point.ies", "-o", "x.exr", "--opening-mm", "100", "50", "--texels", "16x16")
        self.assertIn("--basis", self.refused(2, "convert", "point.ies", "-o", "y.exr", "--basis", "box"))
        write_rays("disk.tm25ray", disk_rays(100))
        self.assertIn("--opening-mm", self.refused(2, "convert", "disk.tm25ray", "-o", "y.exr", "--opening-mm", "1", "1"))
        self.assertIn("line 6", self.refused_ies("0 5 10", "0 5 1O"))

    def refused_ies(self, old, new):
        write_ies("bad.ies")
        text = pathlib.Path("bad.ies").read_text()
        pathlib.Path("bad.ies").write_text(text.replace(old, new, 1))
        return self.refused(1, "info", "bad.ies")


class Rays(ProgramTest):
    def test_info_tells_flux_starts_and_focus(self):
        write_rays("disk.tm25ray", disk_rays(2000), luminous_flux_lm=100.0)
        told = json.loads(self.done("info", "disk.tm25ray", "--json").stdout)
        self.assertEqual(told["rays"], 2000)
        self.assertAlmostEqual(told["flux"]["of_rays"], 100, delta=1e-3)
        self.assertEqual(told["backward_rays"], 0)
        for axis in range(3):
            self.assertLess(abs(told["focus_mm"][axis]), 0.2)
        self.assertIn("nearest to all rays", self.done("info", "disk.tm25ray").stdout)


class Compare(ProgramTest):
    def test_a_lamp_is_itself_and_its_far_field(self):
        self.make_lamp()
        text = self.done("compare", "lamp.luminaire.exr", "lamp.lightfield.exr", "--directions", "50").stdout
        self.assertIn("+0.000 %", text)
        self.assertEqual(len(re.findall(r"RMS 0.00 %", text)), 5)
        self.done("export", "lamp.luminaire.exr", "-o", "lamp.ies")
        told = json.loads(self.done("compare", "lamp.luminaire.exr", "lamp.ies", "--json", "--directions", "50").stdout)
        self.assertEqual(told["near_field"], [])
        self.assertLess(told["intensity"]["median_rel"], 0.02)

    def test_a_turned_lamp_is_found(self):
        write_ies("lamp.ies")
        write_ies("turned.ies", intensity=lambda c, g: skew_cd(c + 90, g))
        apart = json.loads(self.done("compare", "lamp.ies", "turned.ies", "--json").stdout)
        told = json.loads(self.done("compare", "lamp.ies", "turned.ies", "--json", "--align").stdout)
        self.assertGreater(apart["intensity"]["median_rel"], 0.1)
        self.assertLess(told["intensity"]["p95_rel"], 0.01)
        self.assertAlmostEqual(told["a_from_b"]["turn_deg"], 90, delta=0.5)


class OtherRenderers(ProgramTest):
    def test_farfield_maps_where_a_lamp_is_a_point(self):
        self.make_lamp()
        text = self.done("farfield", "lamp.luminaire.exr", "--size", "5", "--report", "map.html", "--csv", "map.csv",
                         "--png", "map.png").stdout
        self.assertEqual(len(re.findall(r"a point errs by less than +\d+ % beyond", text)), 3)
        rows = pathlib.Path("map.csv").read_text().splitlines()
        self.assertEqual(len(rows), 26)
        self.assertTrue(pathlib.Path("map.png").read_bytes().startswith(b"\x89PNG"))
        self.assertIn("<img", pathlib.Path("map.html").read_text())

    def test_far_field_proxies_name_the_near_field(self):
        self.make_lamp()
        self.done("export", "lamp.luminaire.exr", "-o", "lamp.gltf")
        scene = json.loads(pathlib.Path("lamp.gltf").read_text())
        self.assertEqual(scene["nodes"][0]["extensions"]["NEARFIELD_luminaire"]["uri"], "lamp.luminaire.exr")
        self.assertEqual(scene["extensions"]["EXT_lights_ies"]["lights"][0]["uri"], "lamp.ies")
        self.assertIn("LM-63-2002", self.done("info", "lamp.ies").stdout)
        self.done("export", "lamp.luminaire.exr", "-o", "lamp.usda")
        self.assertIn("@lamp.luminaire.exr@", pathlib.Path("lamp.usda").read_text())

    def test_projectors_are_written_with_their_errors(self):
        self.make_lamp()
        said = self.done("export", "lamp.luminaire.exr", "-o", "lamp.xml", "--format", "mitsuba", "--report", "e.html")
        self.assertIn("the array errs by less than  2 %", said.stdout)
        scene = xml.etree.ElementTree.parse("lamp.xml").getroot()
        pictures = [node.get("value") for node in scene.iter("string") if node.get("name") == "filename"]
        self.assertEqual(len(pictures), len(list(pathlib.Path("lamp_projectors").iterdir())))
        self.assertTrue(all(pathlib.Path(name).is_file() for name in pictures))
        self.done("export", "lamp.luminaire.exr", "-o", "lamp.pbrt")
        self.assertEqual(pathlib.Path("lamp.pbrt").read_text().count("LightSource"), len(pictures))


if __name__ == "__main__":
    main()
