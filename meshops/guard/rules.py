"""Rules: whether a change does harm, and whether anything is gained by it.

A part of a change is the elements that went and those that came in one place; parts share no node.
Each rule says of each part whether it breaks it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshops._core import find_edges
from meshops.criteria import MAX_LENGTH, MIN_SIZE, SLACK
from meshops.guard.faults import Appraisal
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, following
from meshops.quality import element_areas
from meshops.subdomain import Aim
from meshops.workpiece import Setting

NEAREST = 12
"""Sides near a new edge, each edge of two elements twice, than which it may not be longer or
shorter where it is out of gradation."""

MOST_AREA = 0.02
"""Of the area of a part of a change: how much more or less it may be. A region keeps its area much
better, but facets of a bent part are not those that were there."""

MOST_CHANGED = 30
"""Elements that may change for each fault that goes."""


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a change: the elements that went, or those that came.

    Attributes
    ----------
    points : (N, 3) float64
    elements : (K, 4) int32
    part : (K,) int64
        The part of the change that each is of.
    irregular : (P,) int64
        Irregular nodes of each part.
    on_edge : (K,) bool
        Whether an element has a side on a free border, or a node that something hangs on.
    appraisal : Appraisal
    """

    points: Floats
    elements: Ints
    part: Ids
    irregular: Ids
    on_edge: Bools
    appraisal: Appraisal

    @property
    def parts(self) -> int:
        """How many parts there are."""
        return len(self.irregular)

    @property
    def is_tria(self) -> Bools:
        """(K,) bool: which elements are trias."""
        tria: Bools = self.elements[:, 3] == NO_NODE
        return tria

    def count(self, chosen: Bools) -> Ids:
        """(P,) how many of some elements (K,) each part has."""
        return np.bincount(self.part[chosen], minlength=self.parts)

    def total(self, values: Floats) -> Floats:
        """(P,) sum of values of elements (K,)."""
        total: Floats = np.bincount(self.part, values, self.parts).astype(np.float64)
        return total


def _faults(side: Side) -> Ids:
    """(P,) trias and elements with a fault."""
    severity = side.appraisal.shape.sum(axis=1) + side.appraisal.size.sum(axis=1)
    return side.count(severity > 0.0) + side.count(side.is_tria)


def is_large(before: Side, after: Side) -> Bools:
    """(P,) bool: where more elements change than the faults that go are worth."""
    changed = np.maximum(
        *(np.bincount(side.part, minlength=side.parts) for side in (before, after))
    )
    large: Bools = changed > MOST_CHANGED * np.maximum(_faults(before) - _faults(after), 1)
    return large


def gains(before: Side, after: Side, aim: Aim) -> Bools:
    """(P,) bool: shape is less severe, or fewer trias, irregular nodes or faults of size are there.

    In this order: nothing of what comes later counts where something before it is worse. Irregular
    nodes, and at last the mean quality of shape, count where faults are not the aim.
    """
    gained = np.zeros(before.parts, bool)
    undecided = np.ones(before.parts, bool)
    for less in (
        _severity(before) - _severity(after),
        before.count(before.is_tria) - after.count(after.is_tria),
        (before.irregular - after.irregular) * (aim != "faults"),
        _count_by_size(before) - _count_by_size(after),
        (_mean_jacobian(after) - _mean_jacobian(before)) * (aim != "faults"),
    ):
        gained |= undecided & (less > SLACK)
        undecided &= np.abs(less) <= SLACK
    return gained


def harms(before: Side, after: Side, pairs: tuple[Ids, Ids], setting: Setting) -> Bools:
    """(P,) bool: which parts of a change break a rule.

    `pairs` are how many trias of each part share an edge with another tria, before and after.
    """
    harmed: Bools = pairs[1] > pairs[0]
    harmed |= np.abs(area_change(before, after)) > MOST_AREA * before.total(_areas(before))
    harmed |= _more_trias(before, after, on_edge=False) | _more_trias(before, after, on_edge=True)
    was, now = before.appraisal.shape, after.appraisal.shape
    for limit in range(was.shape[1]):
        harmed |= _exceeds(was[:, limit], now[:, limit], before.part, after.part, after.parts)
    if setting.keeps_sizes:
        harmed |= _leaves_gradation(before, after, setting)
    return harmed | _worse_by_size(before, after)


def _worse_by_size(before: Side, after: Side) -> Bools:
    """(P,) bool: where faults of size become more or graver, and no folded element goes for that.

    What takes the place of a folded element may be as long and as narrow as all around it.
    """
    worse = _count_by_size(after) > _count_by_size(before)
    severity = [side.total(side.appraisal.size.sum(axis=1)) for side in (before, after)]
    worse |= severity[1] > severity[0] + SLACK
    found: Bools = worse & (_folded(after) >= _folded(before))
    return found


def _folded(side: Side) -> Ids:
    """(P,) concave and folded elements."""
    return side.count(side.appraisal.jacobian <= SLACK)


def _mean_jacobian(side: Side) -> Floats:
    """(P,) mean quality of shape."""
    elements = np.bincount(side.part, minlength=side.parts)
    mean: Floats = side.total(side.appraisal.jacobian) / np.maximum(elements, 1)
    return mean


def _count_by_size(side: Side) -> Ids:
    """(P,) elements with a fault of size."""
    return side.count(side.appraisal.size.sum(axis=1) > 0.0)


def _more_trias(before: Side, after: Side, *, on_edge: bool) -> Bools:
    """(P,) bool: where a tria comes that takes the place of no concave or folded element.

    With `on_edge` those count that have a side on a free border, or a node that something hangs on.
    """
    chosen = [
        side.on_edge if on_edge else np.ones(len(side.part), bool) for side in (before, after)
    ]
    dire = [
        side.count((side.appraisal.jacobian <= SLACK) & some)
        for side, some in zip((before, after), chosen, strict=True)
    ]
    more = after.count(after.is_tria & chosen[1]) - before.count(before.is_tria & chosen[0])
    comes: Bools = more > np.maximum(dire[0] - dire[1], 0)
    return comes


def spoils(before: Side, after: Side) -> Bools:
    """(P,) bool: where regularity or shape get worse and nothing but size is gained by it.

    That is where no fault of shape, no tria and no irregular node goes, and the least or the mean
    quality of shape falls, or irregular nodes come.
    """
    for_size = _severity(before) - _severity(after) <= SLACK
    for_size &= after.count(after.is_tria) >= before.count(before.is_tria)
    for_size &= after.irregular >= before.irregular
    spoilt: Bools = (after.irregular > before.irregular) | _is_less_shapely(before, after)
    return spoilt & for_size


def _severity(side: Side) -> Floats:
    return side.total(side.appraisal.shape.sum(axis=1))


def _exceeds(was: Floats, now: Floats, part: Ids, part_now: Ids, parts: int) -> Bools:
    """(P,) bool: where a fault does not take the place of one that was as severe.

    The severest faults of a part before and after are set against each other, then the next ones.
    """
    exceeds = np.zeros(parts, bool)
    faults = np.nonzero(now > 0.0)[0]
    if not len(faults):
        return exceeds
    place, severity = _ranked(part_now[faults], now[faults])
    there = np.nonzero(was > 0.0)[0]
    known, allowed = _ranked(part[there], was[there])
    if not len(there):
        exceeds[part_now[faults]] = True
        return exceeds
    at = np.minimum(np.searchsorted(known, place), len(known) - 1)
    bad = (known[at] != place) | (severity > allowed[at] + SLACK)
    exceeds[place[bad] >> 32] = True
    return exceeds


def _ranked(part: Ids, severity: Floats) -> tuple[Ids, Floats]:
    """Part and rank of each fault within its part as one number, ascending; and the severities."""
    order = np.lexsort((-severity, part))
    part, severity = part[order].astype(np.int64), severity[order]
    first = np.searchsorted(part, part)
    return (part << 32) + (np.arange(len(part)) - first), severity


def _is_less_shapely(before: Side, after: Side) -> Bools:
    """(P,) bool: where the least or the mean quality of shape is lower than it was."""
    least = []
    for side in (before, after):
        least.append(np.full(side.parts, np.inf))
        np.minimum.at(least[-1], side.part, side.appraisal.jacobian)
    lower: Bools = least[1] < least[0] - SLACK
    return lower | (_mean_jacobian(after) < _mean_jacobian(before) - SLACK)


def _leaves_gradation(before: Side, after: Side, setting: Setting) -> Bools:
    """(P,) bool: where an edge is out of gradation, and longer or shorter than those near it were.

    Beyond the limits of the criteria no new edge may be longer or shorter than the nearest were.
    """
    assert setting.gradation is not None
    leaves = np.zeros(before.parts, bool)
    middles, lengths, part = _edges(after)
    ratio = lengths / setting.gradation.at(middles)
    levels, size = setting.scoring.levels[:, 3], setting.scoring.size
    shortest, longest = levels[MIN_SIZE] / size, levels[MAX_LENGTH] / size
    off = np.nonzero((ratio < shortest) | (ratio > longest))[0]
    if not len(off):
        return leaves
    known, old, _ = _edges(before)
    near = cKDTree(known).query(middles[off], np.arange(1, min(NEAREST, len(known)) + 1))[1]
    too_long = (ratio[off] > longest) & (lengths[off] > old[near].max(axis=1) * (1.0 + SLACK))
    too_short = (ratio[off] < shortest) & (lengths[off] < old[near].min(axis=1) * (1.0 - SLACK))
    leaves[part[off[too_long | too_short]]] = True
    return leaves


def _edges(side: Side) -> tuple[Floats, Floats, Ids]:
    """Middles (E, 3), lengths (E,) and parts (E,) of all edges, those of two elements twice."""
    row, corner = np.nonzero(side.elements != NO_NODE)
    start = side.points[side.elements[row, corner]]
    end = side.points[following(side.elements)[row, corner]]
    return (start + end) / 2.0, np.linalg.norm(end - start, axis=1), side.part[row]


def area_change(before: Side, after: Side) -> Floats:
    """(P,) how much larger each part is after the change."""
    return after.total(_areas(after)) - before.total(_areas(before))


def _areas(side: Side) -> Floats:
    return element_areas(side.points, side.elements)


def tria_pairs(elements: Ints, nodes: int, part: Ids, parts: int) -> Ids:
    """(P,) how many edges between two trias each part has; an element of no part has -1."""
    trias = np.nonzero(elements[:, 3] == NO_NODE)[0]
    if len(trias) < 2:
        return np.zeros(parts, np.int64)
    edge_elements = find_edges(elements[trias], nodes)[2]
    pairs = edge_elements[edge_elements[:, 0] >= 0]
    owner = part[trias[pairs]].max(axis=1)
    return np.bincount(owner[owner >= 0], minlength=parts)
