"""Sides of faces: as many edges on one side as on the one across, so that rows of quads fit.

Where a face has no room for inner nodes, sides of other numbers leave trias that no operation can
remove, as none changes the nodes on a feature. The same holds for a face so round that the edges of
its elements become features.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor, log, sqrt

NARROW = 1.6
"""Widths of a face, over the element size, up to which its sides are matched."""

ALIKE = 2.0
"""Length of a side over that across up to which they are matched."""

TURN = 30.0
"""Degrees that a curve may turn by at a node: from there on its faces would break there."""

SLACK = 0.01
"""Of that turn, since a turn of a circle is measured."""

LEAST = 0.6
"""Length of an edge, over the element size, down to which a turn shortens it."""

HOLE_TURN = 60.0
"""Degrees that a curve of a hole may turn by within one edge, however short the edges become."""

FLAT_TURN = 90.0
"""Degrees in all up to which a curve may become one edge: four quarters of a hole make a square."""

LEAST_LOOP = 4
"""Edges of a loop below which its curves are divided as those of a hole."""

SAME = 1.01
"""Of two curves that a loop is divided into evenly."""


@dataclass(frozen=True)
class Line:
    """A curve that bounds faces: its length, and the degrees that it turns by in all."""

    length: float
    turn: float = 0.0


@dataclass(frozen=True)
class Face:
    """A face of a part.

    Attributes
    ----------
    area : float
    loops : tuple of tuple of int
        The curves of its border in order, the outer and the inner ones.
    is_plane : bool
    """

    area: float
    loops: tuple[tuple[int, ...], ...]
    is_plane: bool = True

    @property
    def has_four_sides(self) -> bool:
        """Whether one loop of four different curves bounds it."""
        return [len(set(loop)) for loop in self.loops] == [4] == [len(loop) for loop in self.loops]

    def is_map(self, divisions: Mapping[int, int]) -> bool:
        """Whether it has four sides, and opposite ones as many edges."""
        if not self.has_four_sides or not set(self.loops[0]) <= divisions.keys():
            return False
        a, b, c, d = (divisions[curve] for curve in self.loops[0])
        return a == c and b == d


def matched_divisions(
    faces: Sequence[Face],
    lines: Mapping[int, Line],
    size: float,
    least: Mapping[int, int] | None = None,
) -> dict[int, int]:
    """Divide the curves around narrow and round faces, opposite ones into as many edges.

    All faces have an even number of border edges where all other curves have one: what is left out
    here is to be divided evenly.

    Parameters
    ----------
    faces : sequence of Face
    lines : mapping of int to Line
        All curves.
    size : float
        Edge length.
    least : mapping of int to int, optional
        Fewest edges of some curves, whatever the size.
    """
    lengths = {curve: line.length for curve, line in lines.items()}
    fewest = _fewest_in_loops(faces, lines, size)
    for curve, edges in (least or {}).items():
        fewest[curve] = max(edges, fewest.get(curve, 1))
    groups = _groups([pair for face in faces for pair in _opposite(face, lengths, size)], lengths)
    matched = {curve for group in groups for curve in group}
    # what the size alone divides finely enough is left to the mesher
    groups += [[c] for c, n in fewest.items() if c not in matched and n > lengths[c] / size]

    def count_of(group: list[int], step: int) -> int:
        floor = max(fewest.get(curve, 1) for curve in group)
        return max(_count([lines[c] for c in group], size, step), ceil(floor / step) * step)

    counts = [count_of(group, 1) for group in groups]
    group_of = {curve: number for number, group in enumerate(groups) for curve in group}
    uses = [
        Counter(group_of[c] for loop in face.loops for c in loop if c in group_of) for face in faces
    ]
    while odd := [u for u in uses if sum(counts[group] * times for group, times in u.items()) % 2]:
        # the odd group that is divided most changes least by an edge more or less
        group = max((g for g in odd[0] if counts[g] * odd[0][g] % 2), key=lambda g: counts[g])
        counts[group] = count_of(groups[group], 2)
    return {curve: counts[number] for curve, number in group_of.items()}


def _fewest_in_loops(
    faces: Sequence[Face], lines: Mapping[int, Line], size: float
) -> dict[int, int]:
    """Fewest edges of curves that turn: those of holes, and of loops with next to no edges.

    A hole of two half circles of an edge each would be a slit. A rounded rim of a plate may
    become one row of quads all the same: its loop has four edges without.
    """
    fewest: dict[int, int] = {}
    for face in faces:
        lengths = [sum(lines[curve].length for curve in loop) for loop in face.loops]
        for loop, length in zip(face.loops, lengths, strict=True):
            edges = sum(max(1, round(lines[curve].length / size)) for curve in loop)
            if edges < LEAST_LOOP or length < max(lengths):
                # gmsh ends the process where the edges of a loop enclose nothing
                each = 1 if len(loop) > 2 else ceil(LEAST_LOOP / len(loop))
                for curve in loop:
                    least = max(each, _fewest(lines[curve].turn))
                    fewest[curve] = max(least, fewest.get(curve, 1))
    return {curve: edges for curve, edges in fewest.items() if edges > 1}


def _fewest(turn: float) -> int:
    return 1 if turn <= FLAT_TURN * (1.0 + SLACK) else ceil(turn / HOLE_TURN - SLACK)


def _opposite(face: Face, lengths: dict[int, float], size: float) -> list[tuple[int, int]]:
    """Pairs of curves of a narrow or round face that are to be divided alike."""
    if len(face.loops) == 2:
        sides = [sum(lengths[c] for c in loop) for loop in face.loops]
        even = all(
            max(lengths[c] for c in loop) <= SAME * min(lengths[c] for c in loop)
            for loop in face.loops
        )
        if len(face.loops[0]) != len(face.loops[1]) or not even:
            return []
        pairs = list(pairwise(face.loops[0] + face.loops[1]))
    elif face.has_four_sides:
        a, b, c, d = face.loops[0]
        pairs = [(a, c), (b, d)]
        sides = sorted((lengths[a] + lengths[c], lengths[b] + lengths[d]))[1:]
    else:
        return []
    width = 2.0 * face.area / sum(sides)
    if width > NARROW * size and (face.is_plane or not face.has_four_sides):
        return []
    return [(a, b) for a, b in pairs if _alike([lengths[a], lengths[b]])]


def _groups(pairs: Sequence[tuple[int, int]], lengths: dict[int, float]) -> list[list[int]]:
    """Curves that are to be divided alike, directly or by way of others."""
    group_of: dict[int, list[int]] = {}
    for a, b in pairs:
        one, other = group_of.get(a, [a]), group_of.get(b, [b])
        both = one if one is other else one + other
        if _alike([lengths[curve] for curve in both]):
            group_of |= dict.fromkeys(both, both)
    return list({id(group): group for group in group_of.values()}.values())


def _alike(values: Sequence[float]) -> bool:
    return 0.0 < max(values) <= ALIKE * min(values)


def _count(group: Sequence[Line], size: float, step: int) -> int:
    """Multiple of `step` by which no line's edges are farther off the size than need be."""
    wanted = [line.length / size for line in group]
    by_turn = max(
        min(ceil(line.turn / TURN - SLACK), floor(line.length / (LEAST * size))) for line in group
    )
    middle: float = sqrt(min(wanted) * max(wanted)) / step
    choices = {max(1, floor(middle)) * step, max(1, ceil(middle)) * step}
    best = min(sorted(choices), key=lambda n: max(abs(log(value / n)) for value in wanted))
    return max(best, ceil(by_turn / step) * step)
