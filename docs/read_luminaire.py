#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Reads a light field or luminaire by docs/formats.md alone; needs numpy and OpenImageIO.

    python3 read_luminaire.py FILE [SLAB UX UY SX SY]    prints slabs and flux (irradiance weighting), and
    L(u -> s) where asked, as JSON
"""
import json
import sys

import numpy
import OpenImageIO


def read(path):
    """The metadata; each slab with its coeffs[channel, row, column, j, i], rows and j upwards."""
    file = OpenImageIO.ImageInput.open(path)
    if not file:
        sys.exit(OpenImageIO.geterror())
    lamp = json.loads(file.spec().get_string_attribute("nearfield.luminaire"))
    if lamp["format_version"] > 1:
        sys.exit("file is newer than this reader")
    part = 0
    while file.seek_subimage(part, 0):
        spec = file.spec()
        slab_name, table = spec.get_string_attribute("oiio:subimagename").split(".")
        slab = lamp["slabs"][int(slab_name[len("slab"):])]
        if table == "coeffs":
            (W, H), (w, h) = slab["grid"], slab["texels"]
            pixels = file.read_image(part, 0, 0, spec.nchannels, "float").reshape(H * h, W * w, -1)
            order = [spec.channelnames.index(name) for name in slab["channels"]]
            pixels = pixels[::-1, :, order].astype(float)  # the file's first row is the topmost
            slab["coeffs"] = pixels.reshape(H, h, W, w, -1).transpose(4, 0, 2, 1, 3)
        part += 1
    return lamp


def basis(slab, axis, u):
    """phi of every basis function along an axis at u."""
    count = slab["grid"][axis]
    centers = slab["u_center_m"][axis] + (numpy.arange(count) - (count - 1) / 2) * slab["pitch_m"][axis]
    x = (u - centers) / slab["pitch_m"][axis]
    n = len(slab["profile_cells"])
    cell = numpy.floor(x + n / 2).astype(int)
    a = numpy.array(slab["profile_cells"])[cell.clip(0, n - 1)]
    return numpy.where((cell >= 0) & (cell < n), a[:, 0] + x * (a[:, 1] + x * a[:, 2]), 0)


def radiance(slab, u, s):
    """L(u -> s) for each channel; u on U, s on S, in the slab's frame."""
    low, high = numpy.array(slab["s_min_m"]), numpy.array(slab["s_max_m"])
    i, j = numpy.floor((numpy.array(s) - low) / (high - low) * slab["texels"]).astype(int)
    if not (0 <= i < slab["texels"][0] and 0 <= j < slab["texels"][1]):
        return numpy.zeros(len(slab["channels"]))
    phi = numpy.outer(basis(slab, 1, u[1]), basis(slab, 0, u[0]))
    cos2 = slab["delta_m"]**2 / (slab["delta_m"]**2 + sum((numpy.array(s) - u)**2))
    weight = slab["delta_m"]**2 / cos2**2 if slab["weighting"] == "irradiance" else 1.0
    return weight * (slab["coeffs"][..., j, i] * phi).sum(axis=(1, 2))


def flux(slab):
    """Integral of L cos^4(theta) / delta^2 over U and S, for irradiance weighting: a plain sum."""
    texel_area = numpy.prod((numpy.array(slab["s_max_m"]) - slab["s_min_m"]) / slab["texels"])
    n = len(slab["profile_cells"])
    integral = sum(a[0] + a[1] * x + a[2] * (x * x + 1 / 12)  # each cell's, x its center
                   for a, x in zip(slab["profile_cells"], numpy.arange(n) + 0.5 - n / 2))
    return slab["coeffs"].sum(axis=(1, 2, 3, 4)) * texel_area * numpy.prod(slab["pitch_m"]) * integral**2


if __name__ == "__main__":
    lamp = read(sys.argv[1])
    answer = {key: lamp[key] for key in ("kind", "format_version", "quantity")}
    answer["flux"] = [flux(slab).tolist() if slab["weighting"] == "irradiance" else None
                      for slab in lamp["slabs"]]
    if len(sys.argv) > 2:
        numbers = [float(text) for text in sys.argv[3:7]]
        answer["radiance"] = radiance(lamp["slabs"][int(sys.argv[2])], numbers[:2], numbers[2:]).tolist()
    answer["slabs"] = [{k: v for k, v in slab.items() if k != "coeffs"} for slab in lamp["slabs"]]
    print(json.dumps(answer, indent=1))
