"""A hundred structured decks: strips, webs, flanges, rings, graded plates, boxes, stiffened panels.

An engineer has made such meshes on purpose: rows, aspect and gradation are meant. Most have no
fault of shape, so that the best that can be done is nothing (just the corners of perforated plates
are skewed by nature); some have a few that are planted, so that doing nothing is seen too. The same
seed gives the same deck.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.planting import planted
from meshops.mesh import Floats, ShellMesh

DECKS = 100

PLANTED_SHARE = 0.3
"""Of the decks that have faults."""

Sides = tuple[Floats, Floats]
"""Places along both sides of a patch, (n,) and (m,), each from 0 to 1."""

Rng = np.random.Generator


@dataclass(frozen=True, eq=False)
class StructuredDeck:
    """A mesh that was made row by row.

    Attributes
    ----------
    name : str
        Seed and kind.
    mesh : ShellMesh
        Each patch is a region of its own where the kind has several properties.
    planted : int
        Faults of shape that were put in: 0 for most.
    """

    name: str
    mesh: ShellMesh
    planted: int


def structured(seed: int) -> StructuredDeck:
    """Make the deck of a seed."""
    kinds = list(KINDS)
    kind = kinds[seed % len(kinds)]
    rng = np.random.default_rng([seed, 12])
    mesh = KINDS[kind](rng)
    count = 0
    if rng.random() < PLANTED_SHARE:
        mesh, count = planted(mesh, rng, faults=int(rng.integers(1, 4)))
    return StructuredDeck(f"{seed:03d} {kind}{' with faults' if count else ''}", mesh, count)


def graded(count: int, ratio: float) -> Floats:
    """(count + 1,) places from 0 to 1; each step is `ratio` times the one before."""
    steps = np.cumsum(ratio ** np.arange(count))
    return np.concatenate([[0.0], steps / steps[-1]])


def patch(place: Callable[[Floats, Floats], Sequence[Floats]], sides: Sides) -> ShellMesh:
    """Lay a grid of quads on a surface, a function of two arrays from 0 to 1."""
    u, v = (axis.ravel() for axis in np.meshgrid(*sides, indexing="ij"))
    points = np.stack([np.broadcast_to(c, u.shape) for c in place(u, v)], axis=1)
    node = np.arange(len(u)).reshape(len(sides[0]), len(sides[1]))
    corners = (node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:])
    return ShellMesh.build(points, np.stack(corners, axis=-1).reshape(-1, 4))


def welded(patches: Sequence[ShellMesh]) -> ShellMesh:
    """Join patches where they meet; each becomes a region."""
    points = np.concatenate([mesh.points for mesh in patches])
    grain = 1e-6 * np.ptp(points, axis=0).max()
    _, first, rows = np.unique(
        np.round(points / grain), axis=0, return_index=True, return_inverse=True
    )
    offsets = np.cumsum([0, *(len(mesh.points) for mesh in patches)])
    elements = [
        rows.ravel()[mesh.elements + offset] for mesh, offset in zip(patches, offsets, strict=False)
    ]
    region = np.repeat(np.arange(len(patches)) + 1, [len(e) for e in elements])
    return ShellMesh.build(points[first], np.concatenate(elements), region=region)


def extruded(
    legs: Sequence[tuple[tuple[float, float], tuple[float, float], int]],
    along: Floats,
    length: float,
) -> ShellMesh:
    """Extrude legs of a section, each from (y, z) to (y, z) with so many rows, along x."""

    def leg(start: tuple[float, float], end: tuple[float, float], rows: int) -> ShellMesh:
        def place(u: Floats, v: Floats) -> Sequence[Floats]:
            y, z = (a + (b - a) * v for a, b in zip(start, end, strict=True))
            return length * u, y, z

        return patch(place, (along, graded(rows, 1.0)))

    return welded([leg(*each) for each in legs])


def _along(rng: Rng, least: int = 16, most: int = 40) -> Floats:
    return graded(int(rng.integers(least, most)), float(rng.choice([1.0, 1.0, 1.03, 1.06])))


def _rows(rng: Rng, most: int = 7) -> int:
    return int(rng.integers(1, most))


def _length(rng: Rng, along: Floats, width: float, rows: int) -> float:
    """Length of a strip whose elements have an aspect between 1 and 5."""
    return width / rows * (len(along) - 1) * float(rng.choice([1.0, 1.5, 2.5, 4.0, 5.0]))


def _strip(rng: Rng) -> ShellMesh:
    along, rows, width = _along(rng), _rows(rng), float(rng.uniform(5, 30))
    return extruded([((0, 0), (width, 0), rows)], along, _length(rng, along, width, rows))


def _i_section(rng: Rng) -> ShellMesh:
    along, web, flange = _along(rng), _rows(rng), _rows(rng, 4)
    height, half = float(rng.uniform(30, 60)), float(rng.uniform(8, 20))
    legs = [((0.0, 0.0), (0.0, height), web)]
    legs += [((0, z), (side * half, z), flange) for z in (0.0, height) for side in (-1, 1)]
    return extruded(legs, along, _length(rng, along, height, web))


def _t_section(rng: Rng) -> ShellMesh:
    along, web, flange = _along(rng), _rows(rng), _rows(rng, 4)
    height, half = float(rng.uniform(20, 50)), float(rng.uniform(8, 20))
    legs = [((0.0, 0.0), (0.0, height), web)]
    legs += [((0, 0), (side * half, 0), flange) for side in (-1, 1)]
    return extruded(legs, along, _length(rng, along, height, web))


def _l_section(rng: Rng) -> ShellMesh:
    along, one, other = _along(rng), _rows(rng), _rows(rng)
    width, height = float(rng.uniform(10, 40)), float(rng.uniform(10, 40))
    legs = [((0.0, 0.0), (width, 0.0), one), ((0.0, 0.0), (0.0, height), other)]
    return extruded(legs, along, _length(rng, along, width, one))


def _u_section(rng: Rng) -> ShellMesh:
    along, web, flange = _along(rng), _rows(rng), _rows(rng, 4)
    width, height = float(rng.uniform(20, 50)), float(rng.uniform(8, 25))
    legs = [((0.0, 0.0), (width, 0.0), web)]
    legs += [((x, 0.0), (x, height), flange) for x in (0.0, width)]
    return extruded(legs, along, _length(rng, along, width, web))


def _ring(rng: Rng, turn: float = 2.0 * np.pi) -> ShellMesh:
    around, rows = int(rng.integers(24, 60)), _rows(rng)
    inner = float(rng.uniform(10, 40))
    outer = inner * float(rng.choice([1.08, 1.3, 2.0]))

    def place(u: Floats, v: Floats) -> Sequence[Floats]:
        radius = inner + (outer - inner) * v
        return radius * np.cos(turn * u), radius * np.sin(turn * u), 0.0 * u

    growth = float(rng.choice([1.0, 1.1, 1.3]))
    return welded([patch(place, (graded(around, 1.0), graded(rows, growth)))])


def _sector(rng: Rng) -> ShellMesh:
    return _ring(rng, float(rng.choice([0.5, 1.0, 1.5])) * np.pi)


def _graded_plate(rng: Rng) -> ShellMesh:
    columns, rows = (int(n) for n in rng.integers(12, 26, 2))
    length, width = float(rng.uniform(80, 160)), float(rng.uniform(40, 80))
    growth = [float(rng.choice([1.0, 1.05, 1.1, 1.15])) for _ in range(2)]
    sides = graded(columns, growth[0]), graded(rows, growth[1])
    return patch(lambda u, v: (length * u, width * v, 0.0 * u), sides)


def _tapered_plate(rng: Rng) -> ShellMesh:
    columns, rows = int(rng.integers(14, 30)), _rows(rng, 9)
    length, width = float(rng.uniform(80, 160)), float(rng.uniform(20, 50))
    end = float(rng.uniform(0.4, 0.8))

    def place(u: Floats, v: Floats) -> Sequence[Floats]:
        return length * u, width * (1.0 - (1.0 - end) * u) * (v - 0.5), 0.0 * u

    return patch(place, (graded(columns, 1.0), graded(rows, 1.0)))


def _box(rng: Rng) -> ShellMesh:
    """Make a closed section with a web in the middle and ribs across it."""
    along, rows = graded(4 * int(rng.integers(3, 6)), 1.0), _rows(rng, 5)
    width, height = float(rng.uniform(15, 30)), float(rng.uniform(15, 30))
    length = width / rows * (len(along) - 1) * float(rng.choice([1.0, 1.5, 2.5]))
    legs = [((y, z), (y + width, z), rows) for y in (0.0, width) for z in (0.0, height)]
    legs += [((y, 0.0), (y, height), rows) for y in (0.0, width, 2.0 * width)]
    square = graded(rows, 1.0), graded(rows, 1.0)

    def rib(x: float, y: float) -> ShellMesh:
        def place(u: Floats, v: Floats) -> Sequence[Floats]:
            return length * x + 0.0 * u, y + width * u, height * v

        return patch(place, square)

    ribs = [rib(x, y) for x in (0.25, 0.75) for y in (0.0, width)]
    skin = extruded(legs, along, length)
    return _one_region_each(welded([skin, *ribs]), skin)


def _one_region_each(mesh: ShellMesh, first: ShellMesh) -> ShellMesh:
    """Give the first elements back the regions that they had before they were welded again."""
    region = mesh.region + first.region.max()
    region[: len(first.region)] = first.region
    return replace(mesh, region=region)


def _stiffened_panel(rng: Rng) -> ShellMesh:
    along, bays, rows = _along(rng, 14, 26), int(rng.integers(2, 5)), _rows(rng, 5)
    pitch, height, deep = float(rng.uniform(15, 30)), float(rng.uniform(5, 15)), _rows(rng, 4)
    legs = [((pitch * k, 0.0), (pitch * (k + 1), 0.0), rows) for k in range(bays)]
    legs += [((pitch * k, 0.0), (pitch * k, height), deep) for k in range(1, bays)]
    return extruded(legs, along, _length(rng, along, pitch, rows))


def _cylinder(rng: Rng) -> ShellMesh:
    around, rows = int(rng.integers(24, 48)), int(rng.integers(6, 14))
    radius = float(rng.uniform(15, 40))
    step = 2.0 * np.pi * radius / around * float(rng.choice([0.5, 1.0, 2.0, 4.0]))
    narrow = float(rng.choice([1.0, 1.0, 0.7]))

    def place(u: Floats, v: Floats) -> Sequence[Floats]:
        here, angle = radius * (1.0 - (1.0 - narrow) * v), 2.0 * np.pi * u
        return here * np.cos(angle), here * np.sin(angle), step * rows * v

    return welded([patch(place, (graded(around, 1.0), graded(rows, 1.0)))])


def _perforated_plate(rng: Rng) -> ShellMesh:
    """Square cells with a round hole each, meshed from the hole to the square."""
    side, rows = 4 * int(rng.integers(1, 4)), int(rng.integers(3, 7))
    cell, radius = float(rng.uniform(20, 40)), float(rng.uniform(0.15, 0.27))
    columns, lines = int(rng.integers(1, 4)), int(rng.integers(1, 3))
    growth = float(rng.choice([1.0, 1.15]))

    def quarter(x: float, y: float, turn: float) -> ShellMesh:
        def place(u: Floats, v: Floats) -> Sequence[Floats]:
            angle = np.pi / 2.0 * (u - 0.5)
            inner = np.stack([radius * np.cos(angle), radius * np.sin(angle)])
            outer = np.stack([0.5 + 0.0 * u, u - 0.5])
            local = inner + v * (outer - inner)
            cos, sin = np.cos(turn), np.sin(turn)
            return (
                cell * (x + cos * local[0] - sin * local[1]),
                cell * (y + sin * local[0] + cos * local[1]),
                0.0 * u,
            )

        return patch(place, (graded(side, 1.0), graded(rows, growth)))

    cells = [
        quarter(x, y, k * np.pi / 2.0)
        for x in range(columns)
        for y in range(lines)
        for k in range(4)
    ]
    joined = welded(cells)
    return replace(joined, region=np.ones_like(joined.region))


KINDS: dict[str, Callable[[Rng], ShellMesh]] = {
    "strip": _strip,
    "I section": _i_section,
    "ring": _ring,
    "graded plate": _graded_plate,
    "T section": _t_section,
    "box with T-junctions": _box,
    "perforated plate": _perforated_plate,
    "L section": _l_section,
    "cylinder": _cylinder,
    "tapered plate": _tapered_plate,
    "stiffened panel": _stiffened_panel,
    "U section": _u_section,
    "sector": _sector,
}
"""How to make each kind."""
