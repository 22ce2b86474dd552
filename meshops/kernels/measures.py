"""The measures of one element: lengths, angles and ratios that the criteria look at.

Definitions: Altair's element checks for HyperMesh and OptiStruct.
"""
# ruff: noqa: FBT001 - compiled functions take no keyword-only arguments

from __future__ import annotations

from math import acos, asin, atan2, degrees, exp, inf, nan, sqrt

from meshops.kernels.vectors import (
    Vector,
    add,
    compiled,
    cross,
    dot,
    edge,
    inlined,
    length,
    subtract,
)
from meshops.mesh import Floats, Ints

CRITERIA = 12
"""How many criteria are measured on each element; the thirteenth is of the mesh."""

MIN_SIZE, MAX_LENGTH, ASPECT_RATIO, WARPAGE = 0, 1, 2, 3
MAX_ANGLE_QUAD, MIN_ANGLE_QUAD, MAX_ANGLE_TRIA, MIN_ANGLE_TRIA = 4, 5, 6, 7
SKEW, JACOBIAN, CHORDAL_DEV, TAPER = 8, 9, 10, 11
PERCENT_TRIAS = 12

FLAT = 1e-12
"""Twice the area over the longest edge squared at which an element has no normal."""


@compiled
def _angle_between(u: Vector, v: Vector) -> float:
    """Degrees between two vectors; 0 where one of them is nothing."""
    return degrees(atan2(length(cross(u, v)), dot(u, v)))


@compiled
def _clamp(cosine: float) -> float:
    return min(1.0, max(-1.0, cosine))


@compiled
def _turn(cosine: float, jacobian: float) -> float:
    """Fold a corner's cosine and side into one number that falls as the angle grows to 360."""
    return cosine if jacobian >= 0.0 else -2.0 - cosine


@compiled
def _turned(turn: float) -> float:
    """Degrees of a corner from its turn."""
    if turn >= -1.0:
        return degrees(acos(_clamp(turn)))
    return 360.0 - degrees(acos(_clamp(-2.0 - turn)))


@inlined
def measure_element(
    points: Floats, a: int, b: int, c: int, d: int, sizing: Floats, values: Floats
) -> None:
    """Write the twelve measures of one element into ``values``.

    Parameters
    ----------
    points : (N, 3) float64
    a, b, c, d : int
        Node rows in order around the element; ``d`` is -1 for a tria.
    sizing : (7,) float64
        Not 0: the minimal normalised height instead of the shortest edge. Then a gradient (3,) and
        a place (3,): lengths are over the wanted size there, whose logarithm has that gradient, so
        that an element is measured as if it lay in that place.
    values : (12,) float64
        Lengths in the unit of ``points``, angles in degrees. NaN where a criterion does not apply
        (angles of the other kind) or is not measured here (chordal deviation). An element without
        area or with an edge of no length gets the worst there is where a measure is undefined.
    """
    normalised = sizing[0] != 0.0
    if d < 0:
        _measure_tria(points, a, b, c, normalised, values)
    else:
        _measure_quad(points, a, b, c, d, normalised, values)
    values[CHORDAL_DEV] = nan
    if sizing[1] != 0.0 or sizing[2] != 0.0 or sizing[3] != 0.0:
        growth = 0.0
        for axis in range(3):
            total = points[a, axis] + points[b, axis] + points[c, axis]
            middle = total / 3.0 if d < 0 else (total + points[d, axis]) / 4.0
            growth += sizing[1 + axis] * (middle - sizing[4 + axis])
        values[MIN_SIZE] *= exp(-growth)
        values[MAX_LENGTH] *= exp(-growth)


@inlined
def _measure_tria(points: Floats, a: int, b: int, c: int, normalised: bool, values: Floats) -> None:
    ab, bc, ca = edge(points, a, b), edge(points, b, c), edge(points, c, a)
    lab, lbc, lca = length(ab), length(bc), length(ca)
    longest = max(lab, lbc, lca)
    shortest = min(lab, lbc, lca)
    twice_area = length(cross(ab, bc))
    size = shortest
    if normalised:
        size = 2.0 / sqrt(3.0) * twice_area / longest if longest > 0.0 else 0.0
    values[MIN_SIZE] = size
    values[MAX_LENGTH] = longest
    values[ASPECT_RATIO] = longest / size if size > 0.0 else inf
    values[WARPAGE] = 0.0
    values[MAX_ANGLE_QUAD] = nan
    values[MIN_ANGLE_QUAD] = nan
    values[JACOBIAN] = 1.0
    values[TAPER] = 0.0
    # written so that NaN coordinates end here too
    if not (shortest > FLAT * longest and twice_area > FLAT * longest * longest):
        values[MAX_ANGLE_TRIA] = 180.0
        values[MIN_ANGLE_TRIA] = 0.0
        values[SKEW] = 90.0
        return
    cos_a = -dot(ca, ab) / (lca * lab)
    cos_b = -dot(ab, bc) / (lab * lbc)
    cos_c = -dot(bc, ca) / (lbc * lca)
    values[MAX_ANGLE_TRIA] = degrees(acos(_clamp(min(cos_a, cos_b, cos_c))))
    values[MIN_ANGLE_TRIA] = degrees(acos(_clamp(max(cos_a, cos_b, cos_c))))
    cosine = max(
        _median_cosine(ca, ab, bc, lbc),
        _median_cosine(ab, bc, ca, lca),
        _median_cosine(bc, ca, ab, lab),
    )
    values[SKEW] = degrees(asin(min(1.0, cosine)))


@compiled
def _median_cosine(into: Vector, out: Vector, opposite: Vector, longest: float) -> float:
    """Cosine between a corner's median and the line of its mid-sides, parallel to the far edge."""
    median = subtract(out, into)
    cosine: float = abs(dot(median, opposite)) / (length(median) * longest)
    return cosine


@inlined
def _measure_quad(
    points: Floats, a: int, b: int, c: int, d: int, normalised: bool, values: Floats
) -> None:
    ab, bc = edge(points, a, b), edge(points, b, c)
    cd, da = edge(points, c, d), edge(points, d, a)
    lab, lbc, lcd, lda = length(ab), length(bc), length(cd), length(da)
    longest = max(lab, lbc, lcd, lda)
    shortest = min(lab, lbc, lcd, lda)
    na, nb, nc, nd = cross(da, ab), cross(ab, bc), cross(bc, cd), cross(cd, da)
    normal = add(nb, nd)  # also na + nc, and the cross product of the diagonals
    twice_area = length(normal)
    size = shortest
    if normalised and shortest > 0.0:
        size = min(
            shortest,
            length(na) / max(lda, lab),
            length(nb) / max(lab, lbc),
            length(nc) / max(lbc, lcd),
            length(nd) / max(lcd, lda),
        )
    values[MIN_SIZE] = size
    values[MAX_LENGTH] = longest
    values[ASPECT_RATIO] = longest / size if size > 0.0 else inf
    values[MAX_ANGLE_TRIA] = nan
    values[MIN_ANGLE_TRIA] = nan
    # written so that NaN coordinates end here too
    if not (shortest > FLAT * longest and twice_area > FLAT * longest * longest):
        values[WARPAGE] = 180.0
        values[MAX_ANGLE_QUAD] = 180.0
        values[MIN_ANGLE_QUAD] = 0.0
        values[SKEW] = 90.0
        values[JACOBIAN] = 0.0
        values[TAPER] = 1.0
        return
    values[WARPAGE] = max(_angle_between(na, nc), _angle_between(nb, nd))

    ja, jb = dot(na, normal) / twice_area, dot(nb, normal) / twice_area
    jc, jd = dot(nc, normal) / twice_area, dot(nd, normal) / twice_area
    lowest, mean = min(ja, jb, jc, jd), 0.5 * twice_area
    at_gauss = 1.0 / sqrt(3.0)
    values[JACOBIAN] = (mean + (lowest - mean) * at_gauss) / (
        mean + (max(ja, jb, jc, jd) - mean) * at_gauss
    )
    values[TAPER] = 1.0 - lowest / mean

    turn_a = _turn(-dot(da, ab) / (lda * lab), ja)
    turn_b = _turn(-dot(ab, bc) / (lab * lbc), jb)
    turn_c = _turn(-dot(bc, cd) / (lbc * lcd), jc)
    turn_d = _turn(-dot(cd, da) / (lcd * lda), jd)
    values[MAX_ANGLE_QUAD] = _turned(min(turn_a, turn_b, turn_c, turn_d))
    values[MIN_ANGLE_QUAD] = _turned(max(turn_a, turn_b, turn_c, turn_d))

    along, across = subtract(ab, cd), subtract(bc, da)  # twice the mid-side lines
    lengths = length(along) * length(across)
    cosine = abs(dot(along, across)) / lengths if lengths > 0.0 else 1.0
    values[SKEW] = degrees(asin(min(1.0, cosine)))


@compiled
def measure_elements(points: Floats, elements: Ints, sizing: Floats, values: Floats) -> None:
    """Write the measures of (M, 4) elements into (M, 12) ``values``."""
    for i in range(len(elements)):
        a, b, c, d = elements[i, 0], elements[i, 1], elements[i, 2], elements[i, 3]
        measure_element(points, a, b, c, d, sizing, values[i])
