#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Reads a light field or luminaire by docs/formats.md alone; needs numpy and OpenImageIO.

    python3 read_luminaire.py FILE [SLAB UX UY SX SY]    prints slabs and flux, and L(u -> s) where asked, as JSON
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
    """phi of every basis function along an axis at u (an array): [function, point]."""
    count = slab["grid"][axis]
    centers = slab["u_center_m"][axis] + (numpy.arange(count) - (count - 1) / 2) * slab["pitch_m"][axis]
    x = (numpy.asarray(u, float)[None] - centers[:, None]) / slab["pitch_m"][axis]
    n = len(slab["profile_cells"])
    a = numpy.vstack([slab["profile_cells"], [[0, 0, 0]]])[numpy.where(abs(x) <= n / 2, numpy.clip(
        numpy.floor(x + n / 2), 0, n - 1), n).astype(int)]
    return a[..., 0] + x * (a[..., 1] + x * a[..., 2])


def radiance(slab, u, s):
    """L(u -> s) for each channel; u on U, s on S, in the slab's frame."""
    low, high = numpy.array(slab["s_min_m"]), numpy.array(slab["s_max_m"])
    i, j = numpy.floor((numpy.array(s) - low) / (high - low) * slab["texels"]).astype(int)
    if not (0 <= i < slab["texels"][0] and 0 <= j < slab["texels"][1]):
        return numpy.zeros(len(slab["channels"]))
    phi = numpy.outer(basis(slab, 1, [u[1]]), basis(slab, 0, [u[0]]))
    cos2 = slab["delta_m"]**2 / (slab["delta_m"]**2 + sum((numpy.array(s) - u)**2))
    weight = slab["delta_m"]**2 / cos2**2 if slab["weighting"] == "irradiance" else 1.0
    return weight * (slab["coeffs"][..., j, i] * phi).sum(axis=(1, 2))


def flux(slab):
    """Integral of L cos^4(theta) / delta^2 over U and S for each channel."""
    low, high = numpy.array(slab["s_min_m"]), numpy.array(slab["s_max_m"])
    nodes, shares, s = [], [], []
    x, share = numpy.polynomial.legendre.leggauss(8)  # in each pitch of U and each texel of S
    for axis in (0, 1):
        count, pitch = slab["grid"][axis] + len(slab["profile_cells"]) - 1, slab["pitch_m"][axis]
        cells = slab["u_center_m"][axis] + (numpy.arange(count) - (count - 1) / 2) * pitch
        nodes.append((cells[:, None] + x * pitch / 2).ravel())
        shares.append(numpy.tile(share * pitch / 2, count) * basis(slab, axis, nodes[axis]))
        texel = (high - low)[axis] / slab["texels"][axis]
        s.append(low[axis] + (numpy.arange(slab["texels"][axis])[:, None] + 0.5 + x / 2) * texel)
    texel_area = numpy.prod((high - low) / slab["texels"])
    if slab["weighting"] == "irradiance":  # cos^4 and delta^2 cancel
        phi = numpy.outer(shares[1].sum(axis=1), shares[0].sum(axis=1))
        return texel_area * (slab["coeffs"].sum(axis=(3, 4)) * phi).sum(axis=(1, 2))
    dx2, dy2 = ((s[axis] - nodes[axis][:, None, None])**2 for axis in (0, 1))
    total = numpy.zeros(len(slab["channels"]))
    for b, a in numpy.ndindex(len(nodes[1]), len(nodes[0])):
        images = numpy.einsum("crkji,r,k->cji", slab["coeffs"], shares[1][:, b], shares[0][:, a])
        kernel = slab["delta_m"]**2 / (slab["delta_m"]**2 + dy2[b][:, :, None, None] + dx2[a])**2
        total += texel_area * numpy.einsum("cji,jyix,y,x->c", images, kernel, share / 2, share / 2)
    return total


if __name__ == "__main__":
    lamp = read(sys.argv[1])
    answer = {key: lamp[key] for key in ("kind", "format_version", "quantity")}
    answer["flux"] = [flux(slab).tolist() for slab in lamp["slabs"]]
    if len(sys.argv) > 2:
        numbers = [float(text) for text in sys.argv[3:7]]
        answer["radiance"] = radiance(lamp["slabs"][int(sys.argv[2])], numbers[:2], numbers[2:]).tolist()
    answer["slabs"] = [{k: v for k, v in slab.items() if k != "coeffs"} for slab in lamp["slabs"]]
    print(json.dumps(answer, indent=1))
