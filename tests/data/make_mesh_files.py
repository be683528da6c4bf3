# SPDX-License-Identifier: MIT
"""Writes one and the same tetrahedron in every mesh format that the engine loads.

Run `python3 make_mesh_files.py` in this folder. Corners (0,0,0), (1,0,0), (0,2,0), (0,0,3): volume
1, centre of mass (1/4, 1/2, 3/4). The glTF files hold it as two parts of different nodes, halved
and moved, one of them mirrored, so that only a reader that applies node transforms gets it right.
"""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path

VERTICES = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)]
TRIANGLES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]  # counter-clockwise from outside
FOLDER = Path(__file__).resolve().parent


def write_obj() -> None:
    lines = ["# SPDX-License-Identifier: MIT", "# Made by make_mesh_files.py.", "o tetrahedron"]
    lines += [f"v {x:g} {y:g} {z:g}" for x, y, z in VERTICES]
    lines += ["f " + " ".join(str(i + 1) for i in triangle) for triangle in TRIANGLES]
    (FOLDER / "tetrahedron.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_ply() -> None:
    lines = ["ply", "format ascii 1.0", "comment Made by make_mesh_files.py."]
    lines += [f"element vertex {len(VERTICES)}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {len(TRIANGLES)}", "property list uchar int vertex_indices"]
    lines += ["end_header"]
    lines += [f"{x:g} {y:g} {z:g}" for x, y, z in VERTICES]
    lines += ["3 " + " ".join(str(i) for i in triangle) for triangle in TRIANGLES]
    (FOLDER / "tetrahedron.ply").write_text("\n".join(lines) + "\n", encoding="ascii")


def write_stl() -> None:
    text = ["solid tetrahedron"]
    data = b"Made by make_mesh_files.py.".ljust(80, b" ") + struct.pack("<I", len(TRIANGLES))
    for triangle in TRIANGLES:
        text += ["facet normal 0 0 0", "outer loop"]
        text += ["vertex {:g} {:g} {:g}".format(*VERTICES[i]) for i in triangle]
        text += ["endloop", "endfacet"]
        data += struct.pack("<3f", 0, 0, 0)
        data += b"".join(struct.pack("<3f", *VERTICES[i]) for i in triangle)
        data += struct.pack("<H", 0)
    text += ["endsolid tetrahedron"]
    (FOLDER / "tetrahedron_text.stl").write_text("\n".join(text) + "\n", encoding="ascii")
    (FOLDER / "tetrahedron_binary.stl").write_bytes(data)


def gltf_parts() -> tuple[dict[str, object], bytes]:
    """Two nodes: two triangles halved and moved, two triangles halved and mirrored in x."""
    moved = [((x - 1) / 2, y / 2, (z + 4) / 2) for x, y, z in VERTICES]
    mirrored = [(1 - x / 2, y / 2, (z + 2) / 2) for x, y, z in VERTICES]
    turned = [(a, c, b) for a, b, c in TRIANGLES]  # mirroring turns the winding back
    data, views, accessors, meshes = b"", [], [], []
    for points, triangles in ((moved, TRIANGLES[:2]), (mirrored, turned[2:])):
        positions = b"".join(struct.pack("<3f", *point) for point in points)
        indices = b"".join(struct.pack("<3I", *triangle) for triangle in triangles)
        for part in (positions, indices):
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part)})
            data += part
        accessors.append(
            {
                "bufferView": len(views) - 2,
                "componentType": 5126,
                "count": len(points),
                "type": "VEC3",
                "min": [min(p[axis] for p in points) for axis in range(3)],
                "max": [max(p[axis] for p in points) for axis in range(3)],
            }
        )
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": 5125,
                "count": 3 * len(triangles),
                "type": "SCALAR",
            }
        )
        attributes = {"POSITION": len(accessors) - 2}
        meshes.append({"primitives": [{"attributes": attributes, "indices": len(accessors) - 1}]})
    document: dict[str, object] = {
        "asset": {"version": "2.0", "generator": "make_mesh_files.py"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "scale": [2, 2, 2], "translation": [1, 0, -4]},
            {"children": [2], "scale": [2, 2, 2], "translation": [0, 0, -2]},
            {"mesh": 1, "scale": [-1, 1, 1], "translation": [1, 0, 0]},
        ],
        "meshes": meshes,
        "accessors": accessors,
        "bufferViews": views,
    }
    return document, data


def write_gltf() -> None:
    document, data = gltf_parts()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode("ascii")
    separate = document | {"buffers": [{"byteLength": len(data), "uri": uri}]}
    text = json.dumps(separate, indent=1)
    (FOLDER / "tetrahedron.gltf").write_text(text + "\n", encoding="utf-8")

    head = json.dumps(document | {"buffers": [{"byteLength": len(data)}]}).encode("utf-8")
    head += b" " * (-len(head) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(head), 0x4E4F534A) + head
    chunks += struct.pack("<II", len(data), 0x004E4942) + data
    whole = struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks
    (FOLDER / "tetrahedron.glb").write_bytes(whole)


if __name__ == "__main__":
    write_obj()
    write_ply()
    write_stl()
    write_gltf()
