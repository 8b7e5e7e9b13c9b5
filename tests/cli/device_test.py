# SPDX-License-Identifier: Apache-2.0
"""Proves that a picture's device is chosen as asked, and that a machine without OpenGL says so."""
import json
import os

from program import ProgramTest, main, write_scene

SMALL = ["--width", "32", "--height", "24"]
# No driver: the loader of OpenGL's vendors finds none.
NO_OPENGL = {**os.environ, "__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent"}


class DeviceTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")

    def device_of(self, name):
        return json.loads(self.done("info", name, "--json").stdout)["provenance"]["options"]["device"]

    def test_opengl_renders_and_says_on_what(self):
        result = self.done("render", "scene.gltf", "-o", "gl.exr", "--device", "gl", *SMALL)
        self.assertIn("32 x 24 px on ", result.stderr)
        self.assertNotIn(" px on CPU", result.stderr)
        self.assertEqual(self.device_of("gl.exr"), "gl")

    def test_without_tone_mapping_there_is_no_png(self):
        self.done("render", "scene.gltf", "-o", "bare.exr", "--effect", "tone-mapping=off", *SMALL)
        self.assertIn("bare.exr", self.files())
        self.assertNotIn("bare.png", self.files())

    def test_cpu_is_the_default(self):
        result = self.done("render", "scene.gltf", "-o", "cpu.exr", *SMALL)
        self.assertIn(" px on CPU", result.stderr)
        self.assertEqual(self.device_of("cpu.exr"), "cpu")

    def test_auto_takes_opengl_where_there_is_a_context(self):
        result = self.done("render", "scene.gltf", "-o", "auto.exr", "--device", "auto", "--explain", *SMALL)
        self.assertIn("there is an OpenGL 4.5 context", result.stdout)
        self.assertIn("there is an OpenGL 4.5 context", result.stderr)
        self.assertEqual(self.device_of("auto.exr"), "gl")

    def test_without_opengl_gl_is_refused_and_auto_falls_back_aloud(self):
        line = self.refused(1, "render", "scene.gltf", "-o", "gl.exr", "--device", "gl", *SMALL, env=NO_OPENGL)
        self.assertIn("no OpenGL 4.5 context", line)
        self.assertIn("libegl1", line)
        self.assertNotIn("gl.exr", self.files())
        result = self.done("render", "scene.gltf", "-o", "auto.exr", "--device", "auto", *SMALL, env=NO_OPENGL)
        self.assertIn("no OpenGL 4.5 context", result.stderr)
        self.assertEqual(self.device_of("auto.exr"), "cpu")


if __name__ == "__main__":
    main()
