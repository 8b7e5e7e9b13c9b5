#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts a scene under a night sky by formula: stars, a low moon, and the glow of a town behind what the camera looks at.

    python3 make_night_scene.py SCENE.gltf NIGHT.gltf     (writes NIGHT.hdr beside it; keep all in the scene's folder)
"""
import json
import math
import pathlib
import random
import struct
import sys

WIDTH, HEIGHT = 1024, 512
MOON = (-0.62, 0.42, 0.66)  # towards it, world; y is up
MOON_RADIUS = 0.012         # radians: larger than the true one, so that a pixel of 6 mrad shows a disk
GLOW = (0.15, 1.0)          # of the town, x and z


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def direction(column, row):
    """The conventions of the project's environments: the first row +y, the middle column -z, +x right of it."""
    azimuth, polar = ((column + 0.5) / WIDTH - 0.5) * 2 * math.pi, (row + 0.5) / HEIGHT * math.pi
    return [math.sin(polar) * math.sin(azimuth), math.cos(polar), -math.sin(polar) * math.cos(azimuth)]


def radiance(d, moon, glow):
    """cd/m^2. Late dusk: the sky lights the road with about 1 lx, the moon with 0.3; headlights with 10 and more."""
    if d[1] < 0.0:
        return [0.03, 0.03, 0.03]
    above = d[1]
    rgb = [a + b * (1 - above) for a, b in zip((0.10, 0.16, 0.34), (0.12, 0.14, 0.16))]
    towards = max(d[0] * glow[0] + d[2] * glow[1], 0.0) / max(math.hypot(d[0], d[2]), 1e-9)
    town = 5.0 * math.exp(-7.0 * above) * towards ** 6
    rgb = [a + town * b for a, b in zip(rgb, (1.0, 0.62, 0.3))]
    cosine = sum(a * b for a, b in zip(d, moon))
    if cosine > math.cos(MOON_RADIUS):
        return [600.0, 590.0, 560.0]
    halo = 1.5 * math.exp(-18.0 * math.acos(min(cosine, 1.0)))
    return [a + halo * b for a, b in zip(rgb, (0.9, 0.95, 1.0))]


def rgbe(rgb):
    most = max(rgb)
    if most < 1e-32:
        return b"\0\0\0\0"
    mantissa, exponent = math.frexp(most)
    return bytes(min(int(x * mantissa * 256 / most), 255) for x in rgb) + struct.pack("B", exponent + 128)


def write_sky(path):
    moon, glow = unit(MOON), unit(GLOW)
    stars = random.Random(7)
    pixels = [radiance(direction(x, y), moon, glow) for y in range(HEIGHT) for x in range(WIDTH)]
    for _ in range(900):
        up = stars.random()  # evenly over the half sphere
        row, column = int(math.acos(up) / math.pi * HEIGHT), stars.randrange(WIDTH)
        bright = 0.2 / (1e-3 + stars.random()) ** 0.7
        k = row * WIDTH + column
        pixels[k] = [a + min(bright, 8.0) * b for a, b in zip(pixels[k], (1.0, 0.95, 0.9))]
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n".encode()
    path.write_bytes(header + b"".join(map(rgbe, pixels)))


def main(scene, night):
    night = pathlib.Path(night)
    document = json.loads(pathlib.Path(scene).read_text())
    sky = night.with_suffix(".hdr")
    write_sky(sky)
    shown = document["scenes"][document.get("scene", 0)]
    shown.setdefault("extensions", {})["NEARFIELD_environment"] = {"uri": sky.name}
    document["extensionsUsed"] = sorted({*document.get("extensionsUsed", []), "NEARFIELD_environment"})
    night.write_text(json.dumps(document))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
