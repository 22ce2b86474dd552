"""How good a mesh is: the penalties of its measures and the tally that they add up to.

Scoring travels as the five arguments of ``Scoring.arrays``, always last and in this order, so that
a caller writes ``tally_elements(points, elements, *scoring.arrays)``:

levels : (13, 5) float64
    Values at which each criterion is ideal, good, warn, fail and worst.
weights : (13,) float64
active : (13,) bool
penalties : (5,) float64
    Penalty at ideal, good, warn, fail and worst.
normalised : bool
    Whether "min size" is the minimal normalised height instead of the shortest edge.

A tally is a float64 vector of ``TALLY_SIZE``. Criterion ``c`` has at ``4 * c`` the sum of the
penalties that pass, then how many pass, the sum of those that fail, and how many fail. The last
places count elements, quads, trias, failed elements and irregular nodes. Elements can be added and
taken away, so an edit is scored by the elements that it touches. Irregular nodes do not follow from
elements one by one: the functions here leave that place as it is, and a workpiece fills it.

No function here allocates an element's scratch: the caller brings it.
"""
# ruff: noqa: FBT001 - compiled functions take no keyword-only arguments

from __future__ import annotations

from math import isfinite, isnan, nan

import numpy as np

from meshops.kernels.measures import (
    CRITERIA,
    PERCENT_TRIAS,
    measure_element,
    measure_elements,
)
from meshops.kernels.vectors import compiled, inlined
from meshops.mesh import Bools, Floats, Ints

__all__ = [
    "CRITERIA",
    "ELEMENTS",
    "FAILED",
    "IRREGULAR",
    "PERCENT_TRIAS",
    "QUADS",
    "SLACK",
    "TALLY_SIZE",
    "TRIAS",
    "add_element",
    "add_values",
    "compound_index",
    "compound_indices",
    "criterion_index",
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

ELEMENTS, QUADS, TRIAS, FAILED, IRREGULAR = 48, 49, 50, 51, 52
TALLY_SIZE = 53

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
def add_values(
    tally: Floats,
    values: Floats,
    is_tria: bool,
    sign: float,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    normalised: bool,
) -> None:
    """Add (``sign`` +1) or take away (-1) an element by its (12,) measures."""
    limit = penalties[3] + SLACK
    failed = False
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
        if p > limit:
            failed = True
            place += 2
        tally[place] += sign * p
        tally[place + 1] += sign
    tally[ELEMENTS] += sign
    tally[TRIAS if is_tria else QUADS] += sign
    if failed:
        tally[FAILED] += sign


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
    normalised: bool,
) -> None:
    """Add (``sign`` +1) or take away (-1) an element; ``values`` is (12,) scratch.

    Taking away needs the points as they were when the element was added.
    """
    measure_element(points, a, b, c, d, normalised, values)
    add_values(tally, values, d < 0, sign, levels, weights, active, penalties, normalised)


@compiled
def penalise(
    values: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    normalised: bool,
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
    normalised: bool,
) -> Floats:
    """Tally of a whole mesh by its (M, 12) measures."""
    tally = np.zeros(TALLY_SIZE)
    for i in range(len(values)):
        add_values(
            tally, values[i], is_tria[i], 1.0, levels, weights, active, penalties, normalised
        )
    return tally


@compiled
def tally_elements(
    points: Floats,
    elements: Ints,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    normalised: bool,
) -> Floats:
    """Tally of (M, 4) elements, chordal deviation left out."""
    tally = np.zeros(TALLY_SIZE)
    values = np.empty(CRITERIA)
    for i in range(len(elements)):
        a, b, c, d = elements[i, 0], elements[i, 1], elements[i, 2], elements[i, 3]
        measure_element(points, a, b, c, d, normalised, values)
        add_values(tally, values, d < 0, 1.0, levels, weights, active, penalties, normalised)
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
    normalised: bool,
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
def compound_indices(
    tallies: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    normalised: bool,
) -> Floats:
    """(P,) compound Q.I. of (P, TALLY_SIZE) tallies; NaN for a tally of NaN."""
    out = np.empty(len(tallies))
    for i in range(len(tallies)):
        if isnan(tallies[i, ELEMENTS]):
            out[i] = nan
        else:
            out[i] = compound_index(tallies[i], levels, weights, active, penalties, normalised)
    return out


@compiled
def order_meshes(
    tallies: Floats,
    first: int,
    second: int,
    share: int,
    irregularity: float,
    prices: Floats,
    invalid: float,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    normalised: bool,
) -> Floats:
    """(P,) fitness of (P, TALLY_SIZE) tallies, as ``Fitness`` has it.

    `first` and `second` are the places in a tally that count first and second, `share` is what the
    second and the irregular nodes are divided by, `irregularity` what these cost, `prices` (P,)
    those of the operations, `invalid` the fitness of a tally of NaN.
    """
    out = np.empty(len(tallies))
    for i in range(len(tallies)):
        tally = tallies[i]
        if not isfinite(tally[ELEMENTS]):
            out[i] = invalid
            continue
        index = compound_index(tally, levels, weights, active, penalties, normalised)
        index += irregularity * tally[IRREGULAR] / share
        finish = (index / (1.0 + index) + prices[i]) / 2.0
        out[i] = 100.0 - tally[first] - (tally[second] + finish) / share
    return out
