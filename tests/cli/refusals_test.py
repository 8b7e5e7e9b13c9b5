# SPDX-License-Identifier: Apache-2.0
"""Proves that what is wrong is refused in one line that says what was expected and got: exit code 2 for the
command line, 1 for the world, 3 for a result that is not good enough; and that nothing is written then."""
import pathlib
import resource
import struct
import subprocess

from program import POINTS_HEADER, PROGRAM, ProgramTest, main, run, write_scene

RENDER = ["render", "scene.gltf", "-o", "picture.exr"]
SIMULATE = ["simulate", "headlight", "-o", "x.exr"]
PROBE = ["probe", "lamp.exr", "--points", "p.csv"]
CONVERT = ["convert", "led.tm25ray", "-o", "x.exr"]

# A command line, and what its refusal must say.
USAGE = [
    (["bogus"], ["'bogus'", "simulate", "render"]),
    (["rendr"], ["did you mean render?"]),
    (["help", "bogus"], ["'bogus'", "simulate"]),
    (["pack"], ["lightfield is required"]),
    (["pack", "a", "-o", "b", "--len"], ["'--len'", "did you mean --lean?"]),
    ([*RENDER, "--width", "0"], ["--width", "1 ... 16384", "'0'"]),
    ([*RENDER, "--width", "20000"], ["--width", "1 ... 16384", "'20000'"]),
    ([*RENDER, "--height", "-1"], ["--height", "0 ... 16384", "'-1'"]),
    ([*RENDER, "--threads", "-1"], ["--threads", "0 ... 4096", "'-1'"]),
    ([*RENDER, "--seed", "-1"], ["--seed", "0 ... 4294967295", "'-1'"]),
    ([*RENDER, "--seed", "abc"], ["--seed", "'abc'"]),
    ([*RENDER, "--exposure-ev", "nan"], ["--exposure-ev", "-100 ... 100", "'nan'"]),
    ([*RENDER, "--samples-per-pixel", "3"], ["samples per pixel", "square", "3"]),
    ([*RENDER, "--samples", "1"], ["samples", "2 or more", "1"]),
    ([*RENDER, "--samples", "-1"], ["--samples", "'-1'"]),
    ([*RENDER, "--sampler", "both"], ["--sampler", "sum, systematic", "'both'"]),
    ([*RENDER, "--sampler", "cells", "--q", "8"], ["q", "but sum", "8"]),
    ([*RENDER, "--shift", "x"], ["--shift", "blue-noise", "'x'"]),
    ([*RENDER, "--sequence", "x"], ["--sequence", "halton", "'x'"]),
    ([*RENDER, "--error", "1"], ["--error", "'1'"]),
    ([*RENDER, "--time-ms", "-1"], ["--time-ms", "'-1'"]),
    ([*RENDER, "--tonemap", "0"], ["--tonemap", "filmic, papers", "'0'"]),
    ([*RENDER, "--device", "gl", "--sigma-measured"], ["sigma measured", "device cpu", "gl"]),
    ([*RENDER, "--device", "gpu"], ["--device", "cpu", "'gpu'"]),
    ([*RENDER, "--effect", "shadow=off"], ["--effect", "color, shadows, gloss, tone-mapping", "'shadow=off'"]),
    ([*RENDER, "--effect", "tone-mapping=off", "--png", "x.png"], ["--png", "tone-mapping=off"]),
    (["render", "scene.gltf", "-o", "picture.png"], ["NAME.exr", "'picture.png'"]),
    ([*PROBE, "--sampler", "both"], ["--sampler", "aperture", "'both'"]),
    ([*PROBE, "--sampler", "cells", "--q", "8"], ["--q", "but sum", "8"]),
    ([*PROBE, "--samples", "0"], ["--samples", "2 ... 1073741824", "'0'"]),
    ([*PROBE, "--seed", "99999999999"], ["--seed", "0 ... 4294967295", "'99999999999'"]),
    ([*SIMULATE, "--grid", "3"], ["--grid", "13x11", "'3'"]),
    ([*SIMULATE, "--grid", "0x3"], ["--grid", "'0x3'"]),
    ([*SIMULATE, "--texels", "70000x1"], ["--texels", "'70000x1'"]),
    ([*SIMULATE, "--grid", "9999x9999", "--texels", "9999x9999"], ["--grid, --texels", "1073741824"]),
    ([*SIMULATE, "--delta-m", "0"], ["--delta-m", "0.05 ... 100", "'0'"]),
    ([*SIMULATE, "--channels", "2"], ["--channels", "3, 1", "'2'"]),
    ([*SIMULATE, "--weighting", "x"], ["--weighting", "irradiance, radiance", "'x'"]),
    ([*SIMULATE, "--basis", "x"], ["--basis", "bspline", "'x'"]),
    (["simulate", "moon", "-o", "x.exr"], ["headlight, reference", "'moon'"]),
    ([*CONVERT, "--slabs", "2"], ["--slabs", "1, 5, 6", "'2'"]),
    ([*CONVERT, "--grid", "1x1"], ["--grid", "3x3", "1x1"]),
    ([*CONVERT, "--grid", "4x4", "--texels", "9999x9999"],
     ["--grid, --texels", "268 million", "1600 million", "11.9 GiB"]),
    ([*CONVERT, "--texels", "9999x9999"], ["--grid, --texels", "268 million", "3x3 images"]),
    ([*CONVERT, "--flux-lm", "0"], ["--flux-lm", "'0'"]),
    ([*CONVERT, "--u-plane-mm", "inf"], ["--u-plane-mm", "'inf'"]),
    ([*CONVERT, "--seed", "-1"], ["--seed", "'-1'"]),
]


class Usage(ProgramTest):
    def test_says_which_option_what_was_expected_and_got(self):
        for arguments, texts in USAGE:
            line = self.refused(2, *arguments)
            for text in texts:
                self.assertIn(text, line, arguments)
        self.assertEqual(self.files(), [])

    def test_hints_at_the_commands_help(self):
        self.assertIn("Try: nearfield help render", run("render", "x", "-o", "y.exr", "--width", "0").stderr)


class World(ProgramTest):
    def test_missing_files_and_folders_as_files(self):
        pathlib.Path("folder").mkdir()
        pathlib.Path("p.csv").write_text(f"{POINTS_HEADER}\n0,0,1,0,0,-1\n")
        for name in ("missing", "folder"):
            for command in (["info", name], ["pack", name, "-o", "x.exr"], ["convert", name, "-o", "x.exr"],
                            ["render", name, "-o", "x.exr"], ["probe", name, "--points", "p.csv"]):
                self.assertIn(name, self.refused(1, *command), command)
        self.assertEqual(self.files(), ["folder", "p.csv"])

    def test_files_of_another_kind(self):
        pathlib.Path("text").write_text("not what was expected\n")
        for command in (["info", "text"], ["pack", "text", "-o", "x.exr"], ["convert", "text", "-o", "x.exr"],
                        ["render", "text", "-o", "x.exr"]):
            self.assertIn("text", self.refused(1, *command), command)

    def test_points_are_refused_with_line_and_column(self):
        self.make_lamp()
        for text, place in (("x_m,y_m\n", "line 1"), (f"{POINTS_HEADER}\n0,0,oops,0,0,1\n", "line 2, column z_m"),
                            (f"{POINTS_HEADER}\n0,0,1,0,0,0\n", "line 2")):
            pathlib.Path("p.csv").write_text(text)
            line = self.refused(1, "probe", "lamp.luminaire.exr", "--points", "p.csv")
            self.assertIn(place, line)
            self.assertIn("expected", line)
        self.assertIn("folder", self.refused(1, "probe", "lamp.luminaire.exr", "--points", self.make_folder()))

    def make_folder(self):
        pathlib.Path("folder").mkdir()
        return "folder"

    def test_a_scene_whose_lamp_or_camera_is_missing(self):
        write_scene("scene.gltf", "absent.luminaire.exr")
        self.assertIn("absent.luminaire.exr", self.refused(1, *RENDER))
        self.make_lamp("absent")
        self.assertIn("'nobody'", self.refused(1, *RENDER, "--camera", "nobody"))

    def test_a_picture_larger_than_memory(self):
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")

        def with_4_gib():
            resource.setrlimit(resource.RLIMIT_AS, (1 << 32, 1 << 32))

        line = self.refused(1, *RENDER, "--width", "16384", "--height", "16384", preexec_fn=with_4_gib)
        self.assertIn("larger than the memory", line)
        self.assertIn("GiB", line)
        self.assertNotIn("picture.exr", self.files())

    def test_outputs_are_refused_before_the_work(self):
        self.make_lamp()
        before = self.files()
        pathlib.Path("folder").mkdir()
        for output in ("folder", "absent/x.exr", "/dev/full", "x" * 300 + ".exr"):
            for command in (["pack", "lamp.lightfield.exr"], ["simulate", "headlight"]):
                line = self.refused(1, *command, "-o", output)
                self.assertIn(output, line)
        self.assertEqual(self.files(), sorted([*before, "folder"]))

    def test_an_output_never_replaces_an_input(self):
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")
        pathlib.Path("link.exr").symlink_to("lamp.lightfield.exr")
        pathlib.Path("p.csv").write_text(f"{POINTS_HEADER}\n0,0,1,0,0,-1\n")
        before = {name: pathlib.Path(name).read_bytes() for name in self.files()}
        for command in (["pack", "lamp.lightfield.exr", "-o", "./lamp.lightfield.exr"],
                        ["pack", "lamp.lightfield.exr", "-o", "link.exr"],
                        ["render", "scene.gltf", "-o", "lamp.luminaire.exr"],
                        ["probe", "lamp.luminaire.exr", "--points", "p.csv", "-o", "p.csv"]):
            self.assertIn("would replace an input", self.refused(1, *command))
        self.assertIn("two outputs", self.refused(1, *RENDER, "--png", "./picture.exr"))
        self.assertEqual(before, {name: pathlib.Path(name).read_bytes() for name in self.files()})

    def test_values_that_are_no_light_are_refused_unless_repaired(self):
        self.make_lamp()
        lamp = bytearray(pathlib.Path("lamp.luminaire.exr").read_bytes())
        # The first image of slab0.coeffs, uncompressed: 32 x 24 texels of 3 channels.
        first = lamp.index(struct.pack("<6i", 0, 0, 0, 0, 0, 32 * 24 * 3 * 4)) + 24
        struct.pack_into("<4f", lamp, first, float("nan"), -1.0, float("inf"), -0.5)
        pathlib.Path("broken.luminaire.exr").write_bytes(lamp)
        line = self.refused(1, "pack", "broken.luminaire.exr", "-o", "x.luminaire.exr")
        for text in ("broken.luminaire.exr", "image", "texel (0, 23)", "finite and >= 0", "nan"):
            self.assertIn(text, line)
        said = self.done("pack", "broken.luminaire.exr", "-o", "x.luminaire.exr", "--repair").stderr
        self.assertIn("4 values repaired: 2 negative and 1 NaN now 0, 1 infinite", said)
        self.done("info", "x.luminaire.exr", "--verify")

    def test_a_result_that_cannot_be_printed_is_an_error(self):
        self.make_lamp()
        with open("/dev/full", "w") as full:
            for command in (["info", "lamp.luminaire.exr"], ["help"]):
                result = subprocess.run([PROGRAM, *command], stdout=full, stderr=subprocess.PIPE, text=True)
                self.assertEqual(result.returncode, 1)
                self.assertIn("standard output: cannot write file", result.stderr)


class Verify(ProgramTest):
    def test_finds_one_wrong_value_in_any_table(self):
        self.make_lamp()
        good = pathlib.Path("lamp.luminaire.exr").read_bytes()
        places = largest_values(good)
        self.assertGreater(len(places), 6)
        for name, offset in places.items():
            if name.endswith("coeffs"):
                continue
            bad = bytearray(good)
            bad[offset + 2] ^= 0x80  # the exponent's last bit: twice or half the value
            pathlib.Path("bad.exr").write_bytes(bad)
            result = run("info", "bad.exr", "--verify")
            self.assertEqual(result.returncode, 3, f"{name}: {result.stdout}{result.stderr}")
            self.assertIn("1 of", result.stderr)


def largest_values(data):
    """The place of the largest float of every part of an uncompressed tiled EXR file."""
    def text(at):
        end = data.index(b"\0", at)
        return data[at:end].decode(), end + 1

    at, parts = 8, []
    while data[at] != 0:
        part = {}
        while data[at] != 0:
            name, at = text(at)
            _, at = text(at)
            size = struct.unpack_from("<i", data, at)[0]
            part[name] = data[at + 4:at + 4 + size]
            at += 4 + size
        parts.append(part)
        at += 1
    at += 1
    places = {}
    for part in parts:
        count = struct.unpack("<i", part["chunkCount"])[0]
        best = (0.0, 0)
        for chunk in struct.unpack_from(f"<{count}Q", data, at):
            size = struct.unpack_from("<i", data, chunk + 20)[0]  # after part, tile x, y and levels
            values = struct.unpack_from(f"<{size // 4}f", data, chunk + 24)
            k = max(range(len(values)), key=values.__getitem__)
            best = max(best, (values[k], chunk + 24 + 4 * k))
        at += 8 * count
        places[part["name"].decode()] = best[1]
    return places


if __name__ == "__main__":
    main()
