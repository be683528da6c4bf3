# SPDX-License-Identifier: MIT
"""Makes the many-holed meshes of this folder from cells of a grid: grate.obj, sponge.obj.

Run `python3 make_meshes.py` here to write them again. Metres, longest edge 0.35 and 0.3.
"""

from __future__ import annotations

from itertools import product
from pathlib import Path

Cell = tuple[int, int, int]


def grate() -> set[Cell]:
    """A slab of 7 x 7 x 1 cells with nine holes."""
    return {(x, y, 0) for x, y in product(range(7), range(7)) if not (x % 2 and y % 2)}


def sponge() -> set[Cell]:
    """A cube of 3 x 3 x 3 cells without the middles of its faces and its own: five holes."""
    return {c for c in product(range(3), repeat=3) if sum(i == 1 for i in c) < 2}


def faces(cells: set[Cell]) -> list[list[Cell]]:
    """The quads between a cell and the outside, corners counter-clockwise seen from outside."""
    quads = []
    for cell in sorted(cells):
        for axis, side in product(range(3), (0, 1)):
            neighbour = list(cell)
            neighbour[axis] += 2 * side - 1
            if tuple(neighbour) in cells:
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            quad = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(cell)
                corner[axis] += side
                corner[u] += a
                corner[v] += b
                quad.append((corner[0], corner[1], corner[2]))
            quads.append(quad if side else quad[::-1])
    return quads


def write(name: str, cells: set[Cell], cell_m: float) -> None:
    quads = faces(cells)
    corners = sorted({corner for quad in quads for corner in quad})
    index = {corner: i + 1 for i, corner in enumerate(corners)}
    lines = ["# SPDX-License-Identifier: MIT", "# Made by make_meshes.py. Metres, z up."]
    lines += ["v " + " ".join(f"{cell_m * c:.5f}" for c in corner) for corner in corners]
    for quad in quads:
        a, b, c, d = (index[corner] for corner in quad)
        lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    (Path(__file__).parent / name).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    write("grate.obj", grate(), 0.05)
    write("sponge.obj", sponge(), 0.1)
