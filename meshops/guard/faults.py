"""Faults of elements: what breaks a limit of shape or of size, and by how much."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshops._core import measure_elements, penalise
from meshops.criteria import (
    ASPECT_RATIO,
    CRITERIA,
    JACOBIAN,
    MAX_ANGLE_QUAD,
    MAX_ANGLE_TRIA,
    MAX_LENGTH,
    MIN_ANGLE_QUAD,
    MIN_ANGLE_TRIA,
    MIN_SIZE,
    SKEW,
    SLACK,
    TAPER,
    WARPAGE,
)
from meshops.mesh import NO_NODE, Bools, Floats, Ints, centres_of
from meshops.workpiece import Setting

SHAPE_LIMITS = (
    (MAX_ANGLE_QUAD, MAX_ANGLE_TRIA),
    (MIN_ANGLE_QUAD, MIN_ANGLE_TRIA),
    (SKEW,),
    (JACOBIAN,),
    (TAPER,),
    (WARPAGE,),
)
"""Criteria that are one limit, since those of one are those of quads and of trias."""

SIZE_LIMITS = ((MIN_SIZE,), (MAX_LENGTH,), (ASPECT_RATIO,))


@dataclass(frozen=True, eq=False)
class Appraisal:
    """What is to be said of some elements.

    Attributes
    ----------
    shape, size : (K, 6), (K, 3) float64
        Severity of their faults by each limit; 0 for none.
    penalty : (K,) float64
        The highest by shape.
    fails : (K,) bool
        Whether a criterion of shape fails.
    jacobian : (K,) float64
        Scaled, by the angles: 1 for a regular element, 0 or less for one that is flat or concave.
    """

    shape: Floats
    size: Floats
    penalty: Floats
    fails: Bools
    jacobian: Floats


def appraise(points: Floats, elements: Ints, setting: Setting) -> Appraisal:
    """Appraise elements (K, 4) on points, lengths by the sizes that the setting wants anywhere."""
    scoring = setting.scoring
    if setting.gradation is not None:
        scoring = replace(scoring, growth=(0.0,) * 6)
    values = measure_elements(points, elements, scoring.sizing)
    if setting.gradation is not None:
        local = setting.gradation.at(centres_of(points, elements))
        values[:, [MIN_SIZE, MAX_LENGTH]] *= (scoring.size / local)[:, None]
    penalties = penalise(values, scoring.core)
    limit = scoring.penalties[3] + SLACK
    fails = penalties > limit
    bound = scoring.levels[:CRITERIA, 5]
    falls = scoring.levels[:CRITERIA, 4] < scoring.levels[:CRITERIA, 0]
    with np.errstate(invalid="ignore"):
        beyond = np.where(
            falls, values < bound * (1.0 - SLACK), values > bound * (1.0 + SLACK)
        ) & ~np.isnan(penalties)
    severity = np.where(fails, penalties, np.where(beyond, 1.0, 0.0))
    shapes = [c for limits in SHAPE_LIMITS for c in limits]
    return Appraisal(
        shape=_by_limit(severity, SHAPE_LIMITS),
        size=_by_limit(severity, SIZE_LIMITS),
        penalty=np.nan_to_num(penalties[:, shapes]).max(axis=1, initial=0.0),
        fails=fails[:, shapes].any(axis=1),
        jacobian=_scaled_jacobian(values, elements[:, 3] == NO_NODE),
    )


def _by_limit(severity: Floats, limits: tuple[tuple[int, ...], ...]) -> Floats:
    columns = [severity[:, list(criteria)].max(axis=1) for criteria in limits]
    return np.stack(columns, axis=1)


def _scaled_jacobian(values: Floats, is_tria: Bools) -> Floats:
    """(K,) least sine of the angles of elements, over that of a regular one."""
    least = np.where(is_tria, values[:, MIN_ANGLE_TRIA], values[:, MIN_ANGLE_QUAD])
    most = np.where(is_tria, values[:, MAX_ANGLE_TRIA], values[:, MAX_ANGLE_QUAD])
    sines = np.minimum(np.sin(np.radians(least)), np.sin(np.radians(most)))
    scaled: Floats = np.where(is_tria, np.sin(np.radians(least)) / np.sin(np.pi / 3.0), sines)
    return scaled
