"""How good a mesh is: the penalties of its measures and the tally that they add up to.

Scoring travels as the five arguments of ``Scoring.arrays``, always last and in this order, so that
a caller writes ``tally_elements(points, elements, *scoring.arrays)``:

levels : (13, 6) float64
    Values at which each criterion is ideal, good, warn, fail and worst, and the bound: the worst
    that a changed element may have, infinite where just the fail level counts.
weights : (13,) float64
active : (13,) bool
penalties : (5,) float64
    Penalty at ideal, good, warn, fail and worst.
sizing : (7,) float64
    How lengths are measured, see :func:`meshops.kernels.measures.measure_element`.

A tally is a float64 vector of ``TALLY_SIZE``. Criterion ``c`` has at ``4 * c`` the sum of the
penalties that pass, then how many pass, the sum of those that fail, and how many fail. The last
places count elements, quads, trias, failed elements, irregular nodes and elements that fail by
shape, and add up the severity of faults of shape and of size: the penalties beyond the fail level,
1 for what is just beyond its bound. Elements can be added and taken away, so an edit is scored by
the elements that it touches. Irregular nodes do not follow from elements one by one: the functions
here leave that place as it is, and a workpiece fills it.

No function here allocates an element's scratch: the caller brings it.
"""
# ruff: noqa: FBT001 - compiled functions take no keyword-only arguments

from __future__ import annotations

from math import floor, isfinite, isnan, nan

import numpy as np

from meshops.kernels.measures import (
    ASPECT_RATIO,
    CRITERIA,
    PERCENT_TRIAS,
    measure_element,
    measure_elements,
)
from meshops.kernels.vectors import compiled, inlined
from meshops.mesh import Bools, Floats, Ints

__all__ = [
    "CRITERIA",
    "DIRE",
    "ELEMENTS",
    "FAILED",
    "IRREGULAR",
    "PERCENT_TRIAS",
    "QUADS",
    "SHAPE",
    "SHAPE_FAILED",
    "SIZE",
    "SLACK",
    "TALLY_SIZE",
    "TRIAS",
    "add_element",
    "add_values",
    "compound_index",
    "compound_indices",
    "criterion_index",
    "fault_of",
    "measure_element",
    "measure_elements",
    "order_meshes",
    "penalise",
    "penalty",
    "penalty_between",
    "percent_trias",
    "tally_elements",
    "tally_values",
]

ELEMENTS, QUADS, TRIAS, FAILED, IRREGULAR, SHAPE_FAILED, SHAPE, SIZE = range(48, 56)
TALLY_SIZE = 56

GRAIN = float(2**20)
"""Severities are whole multiples of 1 / GRAIN, so that sums of them are exact in any order."""

DIRE = 30.0
"""Severity by shape of an element that no solver takes, concave or folded: beyond the worst level
by three limits. One tria may come where such a one goes."""

HARM = 60.0
"""What a harm costs over the least fault of shape: more than mending any one element gains."""

WORST_SIZE = 31.0
"""More than the severity by size that any element can have."""

SLACK = 1e-9
"""Penalty beyond that of the fail level that is rounding, not failure."""


@compiled
def penalty(value: float, levels: Floats, penalties: Floats) -> float:
    """Penalty of a value: linear between the levels, constant outside them, NaN for NaN.

    ``levels`` and ``penalties`` are (5,): ideal, good, warn, fail, worst. The levels may rise or
    fall.
    """
    p: float = penalty_between(
        value, levels[0], levels[1], levels[2], levels[3], levels[4], penalties
    )
    return p


@inlined
def penalty_between(
    value: float,
    ideal: float,
    good: float,
    warn: float,
    fail: float,
    worst: float,
    penalties: Floats,
) -> float:
    """`penalty` with the levels one by one."""
    # scalars, because a row of an array costs more to make than the penalty
    if worst < ideal:
        value, ideal, good, warn, fail, worst = -value, -ideal, -good, -warn, -fail, -worst
    if value <= ideal:
        p: float = penalties[0]
    elif value <= good:
        p = _between(value, ideal, good, penalties[0], penalties[1])
    elif value <= warn:
        p = _between(value, good, warn, penalties[1], penalties[2])
    elif value <= fail:
        p = _between(value, warn, fail, penalties[2], penalties[3])
    elif value <= worst:
        p = _between(value, fail, worst, penalties[3], penalties[4])
    else:
        p = nan if isnan(value) else penalties[4]
    return p


@inlined
def _between(value: float, low: float, high: float, at_low: float, at_high: float) -> float:
    return at_low + (value - low) / (high - low) * (at_high - at_low)


@inlined
def fault_of(
    value: float, p: float, ideal: float, worst: float, bound: float, limit: float
) -> float:
    """Severity of a value: its penalty beyond the limit, 1 where just its bound is broken, or 0."""
    if p > limit:
        return floor(p * GRAIN + 0.5) / GRAIN
    if (value < bound * (1.0 - SLACK)) if worst < ideal else (value > bound * (1.0 + SLACK)):
        return 1.0
    return 0.0


@inlined
def add_values(
    tally: Floats,
    values: Floats,
    is_tria: bool,
    sign: float,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> None:
    """Add (``sign`` +1) or take away (-1) an element by its (12,) measures."""
    limit = penalties[3] + SLACK
    failed = failed_by_shape = False
    for c in range(CRITERIA):
        if not active[c]:
            continue
        p = penalty_between(
            values[c],
            levels[c, 0],
            levels[c, 1],
            levels[c, 2],
            levels[c, 3],
            levels[c, 4],
            penalties,
        )
        if isnan(p):
            continue
        place = 4 * c
        fault = fault_of(values[c], p, levels[c, 0], levels[c, 4], levels[c, 5], limit)
        tally[SHAPE if c > ASPECT_RATIO else SIZE] += sign * fault
        if p > limit:
            failed = True
            failed_by_shape = failed_by_shape or c > ASPECT_RATIO
            place += 2
        tally[place] += sign * p
        tally[place + 1] += sign
    tally[ELEMENTS] += sign
    tally[TRIAS if is_tria else QUADS] += sign
    if failed:
        tally[FAILED] += sign
    if failed_by_shape:
        tally[SHAPE_FAILED] += sign


@inlined
def add_element(
    tally: Floats,
    points: Floats,
    a: int,
    b: int,
    c: int,
    d: int,
    sign: float,
    values: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> None:
    """Add (``sign`` +1) or take away (-1) an element; ``values`` is (12,) scratch.

    Taking away needs the points as they were when the element was added.
    """
    measure_element(points, a, b, c, d, sizing, values)
    add_values(tally, values, d < 0, sign, levels, weights, active, penalties, sizing)


@compiled
def penalise(
    values: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> Floats:
    """(M, 12) penalties of (M, 12) measures; NaN where a criterion is inactive or not measured."""
    out = np.full(values.shape, nan)
    for i in range(values.shape[0]):
        for c in range(CRITERIA):
            if active[c]:
                out[i, c] = penalty(values[i, c], levels[c], penalties)
    return out


@compiled
def tally_values(
    values: Floats,
    is_tria: Bools,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> Floats:
    """Tally of a whole mesh by its (M, 12) measures."""
    tally = np.zeros(TALLY_SIZE)
    for i in range(len(values)):
        add_values(tally, values[i], is_tria[i], 1.0, levels, weights, active, penalties, sizing)
    return tally


@compiled
def tally_elements(
    points: Floats,
    elements: Ints,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> Floats:
    """Tally of (M, 4) elements, chordal deviation left out."""
    tally = np.zeros(TALLY_SIZE)
    values = np.empty(CRITERIA)
    for i in range(len(elements)):
        a, b, c, d = elements[i, 0], elements[i, 1], elements[i, 2], elements[i, 3]
        measure_element(points, a, b, c, d, sizing, values)
        add_values(tally, values, d < 0, 1.0, levels, weights, active, penalties, sizing)
    return tally


@compiled
def criterion_index(tally: Floats, c: int) -> float:
    """Q.I. of an element criterion: mean penalty that passes plus the sum of those that fail."""
    passing = tally[4 * c] / tally[4 * c + 1] if tally[4 * c + 1] > 0.5 else 0.0
    failing = tally[4 * c + 2] if tally[4 * c + 3] > 0.5 else 0.0
    return passing + failing


@compiled
def percent_trias(tally: Floats) -> float:
    """Trias in percent of the elements; 0 for no elements."""
    return 100.0 * tally[TRIAS] / tally[ELEMENTS] if tally[ELEMENTS] > 0.5 else 0.0


@compiled
def compound_index(
    tally: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> float:
    """Compound Q.I.: weighted mean over the criteria that pass plus the weighted sum of the rest.

    A criterion passes when no element fails it, also when it applies to none: its Q.I. is 0 then.
    So the mean is not taken over fewer criteria, and higher, once the last tria has gone.
    """
    passing, passing_weight, failing = 0.0, 0.0, 0.0
    for c in range(CRITERIA):
        if not active[c]:
            continue
        index = weights[c] * criterion_index(tally, c)
        if tally[4 * c + 3] > 0.5:
            failing += index
        else:
            passing += index
            passing_weight += weights[c]
    if active[PERCENT_TRIAS]:
        index = penalty(percent_trias(tally), levels[PERCENT_TRIAS], penalties)
        if index > penalties[3] + SLACK:
            failing += weights[PERCENT_TRIAS] * index
        else:
            passing += weights[PERCENT_TRIAS] * index
            passing_weight += weights[PERCENT_TRIAS]
    return failing + (passing / passing_weight if passing_weight > 0.0 else 0.0)


@compiled
def passing_index(tally: Floats, weights: Floats, active: Bools) -> float:
    """Weighted mean over the criteria of the mean penalty of the elements that pass."""
    total, weight = 0.0, 0.0
    for c in range(CRITERIA):
        if active[c]:
            weight += weights[c]
            if tally[4 * c + 1] > 0.5:
                total += weights[c] * tally[4 * c] / tally[4 * c + 1]
    return total / weight if weight > 0.0 else 0.0


@compiled
def compound_indices(
    tallies: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> Floats:
    """(P,) compound Q.I. of (P, TALLY_SIZE) tallies; NaN for a tally of NaN."""
    out = np.empty(len(tallies))
    for i in range(len(tallies)):
        if isnan(tallies[i, ELEMENTS]):
            out[i] = nan
        else:
            out[i] = compound_index(tallies[i], levels, weights, active, penalties, sizing)
    return out


@compiled
def order_meshes(
    tallies: Floats,
    trias_first: bool,
    limits: Floats,
    share: int,
    irregularity: float,
    prices: Floats,
    invalid: float,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> Floats:
    """(P,) fitness of (P, TALLY_SIZE) tallies, as ``Fitness`` has it.

    `trias_first` lets trias and faults of shape change places. `limits` (TALLY_SIZE,) is what must
    not be exceeded. `share` is what comes second is divided by, `irregularity` what irregular nodes
    cost, `prices` (P,) what operations do, `invalid` the fitness of a tally of NaN.
    """
    out = np.empty(len(tallies))
    for i in range(len(tallies)):
        tally = tallies[i]
        if not isfinite(tally[ELEMENTS]):
            out[i] = invalid
            continue
        shape, size, trias = tally[SHAPE], tally[SIZE], tally[TRIAS]
        dire = floor(max(limits[SHAPE] - shape, 0.0) / DIRE)
        harm = max(trias - limits[TRIAS] - dire, 0.0)
        harm += max(size - limits[SIZE] - WORST_SIZE * dire, 0.0)
        first, second = shape, trias
        if trias_first:
            harm += max(shape - limits[SHAPE], 0.0)
            first, second = trias, shape / share
        # not the compound Q.I.: what fails adds so much to it that nothing else counts any more
        index = passing_index(tally, weights, active) + irregularity * tally[IRREGULAR] / share
        finish = (index / (1.0 + index) + min(prices[i] / share, 1.0)) / 2.0
        finish += size / (WORST_SIZE * share)
        out[i] = 100.0 - first - HARM * harm - (second + finish) / share
    return out
