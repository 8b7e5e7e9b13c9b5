#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a table-top scene for a small lamp: a grating, a ball and a cube under it, a few centimetres in all.

    python3 make_table_scene.py LUMINAIRE.exr > scene.gltf     (the scene names the luminaire; keep them together)
"""
import base64
import json
import math
import struct
import sys


def box(center, half):
    """24 vertices with flat normals, 12 triangles."""
    positions, normals, triangles = [], [], []
    for axis in range(3):
        for sign in (-1, 1):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            first = len(positions)
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = [0.0, 0.0, 0.0]
                p[axis], p[a], p[b] = sign, u * sign, v
                positions.append([c + h * x for c, h, x in zip(center, half, p)])
                normals.append([float(sign) if k == axis else 0.0 for k in range(3)])
            triangles += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
    return positions, normals, triangles


def ball(center, radius, rings=48, sectors=96):
    positions, normals, triangles = [], [], []
    for r in range(rings + 1):
        for s in range(sectors + 1):
            polar, azimuth = math.pi * r / rings, 2 * math.pi * s / sectors
            n = [math.sin(polar) * math.cos(azimuth), math.cos(polar), math.sin(polar) * math.sin(azimuth)]
            normals.append(n)
            positions.append([c + radius * x for c, x in zip(center, n)])
    for r in range(rings):
        for s in range(sectors):
            a = r * (sectors + 1) + s
            b = a + sectors + 1
            triangles += [[a, a + 1, b], [b, a + 1, b + 1]]
    return positions, normals, triangles


def joined(shapes):
    positions, normals, triangles = [], [], []
    for p, n, t in shapes:
        triangles += [[i + len(positions) for i in triangle] for triangle in t]
        positions += p
        normals += n
    return positions, normals, triangles


def look_at(eye, target):
    """Column-major matrix of a camera that looks along its -z, +y up."""
    back = [e - t for e, t in zip(eye, target)]
    length = math.sqrt(sum(x * x for x in back))
    back = [x / length for x in back]
    right = [back[2], 0.0, -back[0]]
    length = math.hypot(right[0], right[2])
    right = [x / length for x in right]
    up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
          back[0] * right[1] - back[1] * right[0]]
    return right + [0.0] + up + [0.0] + back + [0.0] + list(eye) + [1.0]


MM = 1e-3
MESHES = [
    ("table", [0.8, 0.8, 0.8], 1.0, [box((0, -1 * MM, 0), (80 * MM, 1 * MM, 80 * MM))]),
    ("grating", [0.7, 0.7, 0.7], 1.0,
     [box((x * MM, 20 * MM, -8 * MM), (0.4 * MM, 0.4 * MM, 9 * MM)) for x in range(-12, -1, 2)]),
    ("ball", [0.9, 0.9, 0.9], 0.35, [ball((13 * MM, 6 * MM, 4 * MM), 6 * MM)]),
    ("cube", [0.8, 0.8, 0.8], 1.0, [box((-4 * MM, 4 * MM, 14 * MM), (4 * MM, 4 * MM, 4 * MM))]),
]


def main():
    blob = b""
    gltf = {"asset": {"version": "2.0"}, "extensionsUsed": ["NEARFIELD_luminaire"], "scene": 0,
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 1.5, "znear": 0.001}}]}

    def accessor(rows, code, component, kind):
        nonlocal blob
        data = b"".join(struct.pack("<3" + code, *row) for row in rows)
        gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        blob += data
        entry = {"bufferView": len(gltf["bufferViews"]) - 1, "componentType": component,
                 "count": len(rows) * (3 if kind == "SCALAR" else 1), "type": kind}
        if kind == "VEC3":
            entry["min"] = [min(row[k] for row in rows) for k in range(3)]
            entry["max"] = [max(row[k] for row in rows) for k in range(3)]
        gltf["accessors"].append(entry)
        return len(gltf["accessors"]) - 1

    for name, color, roughness, shapes in MESHES:
        positions, normals, triangles = joined(shapes)
        gltf["materials"].append({"name": name, "pbrMetallicRoughness": {
            "baseColorFactor": color + [1.0], "metallicFactor": 0.0, "roughnessFactor": roughness}})
        primitive = {"attributes": {"POSITION": accessor(positions, "f", 5126, "VEC3"),
                                    "NORMAL": accessor(normals, "f", 5126, "VEC3")},
                     "indices": accessor(triangles, "I", 5125, "SCALAR"), "material": len(gltf["materials"]) - 1}
        gltf["meshes"].append({"name": name, "primitives": [primitive]})
        gltf["nodes"].append({"name": name, "mesh": len(gltf["meshes"]) - 1})
    gltf["nodes"].append({"name": "camera", "camera": 0, "matrix": look_at((22 * MM, 45 * MM, 70 * MM), (0, 5 * MM, 0))})
    half = math.sqrt(0.5)  # light along +z turned down
    gltf["nodes"].append({"name": "lamp", "translation": [0.0, 28 * MM, 0.0], "rotation": [half, 0.0, 0.0, half],
                          "extensions": {"NEARFIELD_luminaire": {"uri": sys.argv[1]}}})
    gltf["scenes"] = [{"nodes": list(range(len(gltf["nodes"])))}]
    gltf["buffers"] = [{"byteLength": len(blob), "uri": "data:application/octet-stream;base64," +
                        base64.b64encode(blob).decode()}]
    json.dump(gltf, sys.stdout)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main()
