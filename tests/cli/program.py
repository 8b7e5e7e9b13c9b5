# SPDX-License-Identifier: Apache-2.0
"""What the tests of the program share: running it, and inputs that they write themselves."""
import base64
import json
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.environ["NEARFIELD_PROGRAM"]
POINTS_HEADER = "x_m,y_m,z_m,nx,ny,nz"
# A lamp that takes a tenth of a second.
SMALL_LAMP = ["--grid", "5x4", "--texels", "32x24", "--delta-m", "2.4"]


def run(*arguments, **options):
    """Runs the program; standard output and error as text."""
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120, **options)


class ProgramTest(unittest.TestCase):
    """Each test works in an empty folder of its own."""

    maxDiff = 2000

    def setUp(self):
        self.before = os.getcwd()
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.before))
        os.chdir(self.folder)

    def tearDown(self):
        os.chdir(self.before)
        shutil.rmtree(self.folder)

    def done(self, *arguments, **options):
        """Runs the program and expects success."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def refused(self, code, *arguments, **options):
        """Runs the program, expects the exit code and one line that starts as errors do; returns it."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, code, f"{arguments}: {result.stdout}{result.stderr}")
        lines = result.stderr.splitlines()
        self.assertTrue(lines and lines[0].startswith("nearfield: error: "), f"{arguments}: {result.stderr}")
        self.assertLessEqual(len(lines), 2 if code == 2 else 1, result.stderr)
        return lines[0]

    def files(self):
        return sorted(path.name for path in pathlib.Path().iterdir())

    def make_lamp(self, name="lamp"):
        self.done("simulate", "headlight", *SMALL_LAMP, "-o", f"{name}.lightfield.exr")
        self.done("pack", f"{name}.lightfield.exr", "-o", f"{name}.luminaire.exr")


def write_rays(path, rays, luminous_flux_lm=-1.0, radiant_flux_w=-1.0):
    """Writes a TM-25 ray file; rays are (x, y, z in mm, direction, flux)."""
    header = bytearray(36288)
    struct.pack_into("<4siiffQ", header, 0, b"TM25", 2013, 0, luminous_flux_lm, radiant_flux_w, len(rays))
    if luminous_flux_lm >= 0:
        flags = (1, 1, 0, 0, 1, 0, 0, 0)
    else:
        flags = (1, 1, 1, 0, 0, 0, 0, 0)
    struct.pack_into("<8i", header, 256, *flags)
    with open(path, "wb") as file:
        file.write(header)
        for ray in rays:
            file.write(struct.pack("<7f", *ray))


def disk_rays(count, most_sine_squared=1.0, seed=1):
    """Rays of a Lambertian disk of 2 mm radius at z = 0, 100 lm or W in all."""
    generator = random.Random(seed)
    rays = []
    for _ in range(count):
        radius, angle = 2.0 * math.sqrt(generator.random()), 2.0 * math.pi * generator.random()
        sine, azimuth = math.sqrt(most_sine_squared * generator.random()), 2.0 * math.pi * generator.random()
        rays.append((radius * math.cos(angle), radius * math.sin(angle), 0.0, sine * math.cos(azimuth),
                     sine * math.sin(azimuth), math.sqrt(1.0 - sine * sine), 100.0 / count))
    return rays


def write_scene(path, lamp):
    """A floor 20 m ahead of the lamp and across its beam, a post in the beam, a camera beside the lamp."""
    quad = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]
    data = b"".join(struct.pack("<3f", *p) for p in quad) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    toward_lamp = [0.0, 1.0, 0.0, 0.0]  # half a turn about y: faces -z
    scene = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["NEARFIELD_luminaire"],
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2, 3]}],
        "nodes": [
            {"name": "wall", "mesh": 0, "translation": [0, 0, 10], "rotation": toward_lamp, "scale": [6, 3, 1]},
            {"name": "post", "mesh": 0, "translation": [0.5, -0.2, 5], "rotation": toward_lamp, "scale": [0.1, 1, 1]},
            {"name": "eye", "camera": 0, "translation": [0, 0.5, -1], "rotation": toward_lamp},
            {"name": "lamp", "extensions": {"NEARFIELD_luminaire": {"uri": lamp}}},
        ],
        "cameras": [{"type": "perspective",
                     "perspective": {"yfov": 0.6, "znear": 0.1, "aspectRatio": 1.5}}],
        "meshes": [{"name": "quad", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }
    pathlib.Path(path).write_text(json.dumps(scene))


def main():
    """Runs the tests of the calling file; a name on the command line selects one."""
    unittest.main(module=sys.modules["__main__"], verbosity=1)
