"""Ragged arrays: lists of different lengths one after the other, and candidates made of them."""

from __future__ import annotations

import numpy as np

from meshops.mesh import Floats, Ints
from meshops.operations.candidates import Candidates


def candidates_of(
    elements: tuple[Ints, Ints, Ints, Ints],
    *,
    places: tuple[Ints, Floats] | None = None,
    moves: tuple[Ints, Ints, Floats] | None = None,
) -> Candidates:
    """Make candidates of what goes and comes, of new points if any, and of moves if any.

    Parameters
    ----------
    elements
        removed_start, removed, added_start, added.
    places
        point_start, points.
    moves
        moved_start, moved, moved_to.
    """
    none = np.zeros_like(elements[0])
    point_start, points = places or (none, np.zeros((0, 3)))
    moved_start, moved, moved_to = moves or (none, np.zeros(0, np.int32), np.zeros((0, 3)))
    return Candidates(*elements, point_start, points, moved_start, moved, moved_to)


def alternatives(count: int, variants: int) -> tuple[Ints, Ints]:
    """Rows and variants, (K,) each, of `count` places with so many variants of each."""
    rows, ways = np.divmod(np.arange(count * variants, dtype=np.int32), np.int32(variants))
    return rows, ways


def picked(start: Ints, rows: Ints) -> tuple[Ints, Ints]:
    """Where the lists `rows` (K,) begin when they are alone, and the places that they have now.

    `start` (S + 1,): list s has the places from ``start[s]`` to ``start[s + 1]``.
    """
    lengths = np.diff(start)[rows]
    begin = starts(lengths)
    return begin, np.arange(begin[-1], dtype=np.int32) + np.repeat(
        start[rows] - begin[:-1], lengths
    )


def starts(lengths: Ints) -> Ints:
    """(S + 1,) where each list begins, and the last one ends."""
    begin = np.zeros(len(lengths) + 1, np.int32)
    np.cumsum(lengths, out=begin[1:])
    return begin
