# SPDX-License-Identifier: Apache-2.0
"""Proves that a picture says how far it is from another, by devices and by kinds of shadow."""
import re

from program import ProgramTest, main, write_scene

SMALL = ["--width", "48", "--height", "32"]


class CompareTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")
        self.render("cpu.exr", "--effect", "shadows=off")

    def render(self, name, *options):
        return self.done("render", "scene.gltf", "-o", name, *SMALL, *options)

    def errors(self, name, *options):
        """Relative RMS in percent, and the line."""
        result = self.render(name, "--compare", "cpu.exr", *options)
        line = next(line for line in result.stderr.splitlines() if "against cpu.exr" in line)
        return float(re.search(r"relative RMS of luminance ([\d.e+-]+) %", line)[1]), line

    def test_a_picture_is_itself(self):
        error, line = self.errors("again.exr", "--effect", "shadows=off")
        self.assertEqual(error, 0.0)
        self.assertIn("Lab difference 0", line)

    def test_devices_agree_and_noise_is_found(self):
        self.assertLess(self.errors("gl.exr", "--device", "gl", "--effect", "shadows=off")[0], 0.1)
        self.assertGreater(self.errors("noisy.exr", "--effect", "shadows=off", "--sampler", "uniform",
                                       "--samples", "4")[0], 1.0)
        layers = self.done("info", "gl.exr").stdout
        self.assertIn("error", layers)

    def test_weights_of_shadow_maps_are_in_the_provenance(self):
        self.render("pdis.exr", "--device", "gl", "--shadow-weights", "pdis")
        self.assertRegex(self.done("info", "pdis.exr", "--json").stdout, r'"shadow-weights":\s*"pdis"')

    def test_refuses_what_cannot_be_compared(self):
        line = self.refused(1, "render", "scene.gltf", "-o", "small.exr", "--width", "24", "--height", "16",
                            "--compare", "cpu.exr")
        self.assertIn("24 x 16 px", line)
        self.assertIn("48 x 32 px", line)
        self.assertNotIn("small.exr", self.files())
        line = self.refused(2, "render", "scene.gltf", "-o", "x.exr", "--shadow-weights", "pdis",
                            "--sampler", "cells")
        self.assertIn("shadow weights", line)


if __name__ == "__main__":
    main()
