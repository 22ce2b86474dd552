"""Which elements fail by shape, which by size, and how far beyond their limits they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.criteria import FALLING, NAMES, Scoring
from meshops.harm.shapes import Shapes
from meshops.mesh import Bools, Floats

SHAPE = (
    "warpage",
    "max angle quad",
    "min angle quad",
    "max angle tria",
    "min angle tria",
    "skew",
    "Jacobian",
    "taper",
)
SIZE = ("min size", "max length", "aspect ratio")

SLACK = 1e-6
"""Share of a limit beyond it that is rounding: a deck gives coordinates with eight characters."""

MOST = 100.0
"""Bound of a severity: an edge without length has an infinite aspect ratio."""


@dataclass(frozen=True, eq=False)
class Failures:
    """How M elements stand by the limits.

    Attributes
    ----------
    shape, size : (M,) bool
        Which break a limit of shape, and which one of size.
    severity : dict of (M,) float64
        By each limit: how far beyond it, 0 where it is kept, 1 at the worst level and linear from
        the limit on, at most `MOST`.
    """

    shape: Bools
    size: Bools
    severity: dict[str, Floats]

    @property
    def size_alone(self) -> Bools:
        """(M,) bool: which break limits of size and none of shape."""
        found: Bools = self.size & ~self.shape
        return found

    @property
    def shape_severity(self) -> Floats:
        """(M,) sum over the limits of shape."""
        return self._sum(SHAPE)

    @property
    def size_severity(self) -> Floats:
        """(M,) sum over the limits of size."""
        return self._sum(SIZE)

    def _sum(self, names: tuple[str, ...]) -> Floats:
        parts = [self.severity[name] for name in names if name in self.severity]
        return np.sum(parts, axis=0) if parts else np.zeros(len(self.shape))


def failures(shapes: Shapes, scoring: Scoring, sizes: Floats | None = None) -> Failures:
    """Judge elements by the active criteria.

    `sizes`, (M,), are the target sizes of the elements; None: that of `scoring` for all. Lengths
    that do not follow the target size stay as the criteria give them.
    """
    values = _values(shapes, scoring)
    severity = {}
    for criterion in scoring.criteria.criteria:
        if criterion.name not in values or not criterion.active:
            continue
        fail, worst = criterion.levels[3:]
        unit = (sizes if sizes is not None else scoring.size) if criterion.scaled else 1.0
        severity[criterion.name] = _beyond(
            values[criterion.name],
            fail * np.asarray(unit),
            worst * np.asarray(unit),
            criterion.name,
        )
    nothing = np.zeros(len(shapes.area), bool)
    shape = np.any([nothing, *(severity[n] > 0.0 for n in SHAPE if n in severity)], axis=0)
    size = np.any([nothing, *(severity[n] > 0.0 for n in SIZE if n in severity)], axis=0)
    return Failures(shape, size, severity)


def _beyond(values: Floats, fail: Floats, worst: Floats, name: str) -> Floats:
    """How far values lie beyond a limit, over the way from there to the worst level."""
    sign = -1.0 if name in FALLING else 1.0
    way = np.maximum(sign * (worst - fail), 0.01 * np.abs(fail) + SLACK)
    excess = sign * (values - fail)
    excess = np.where(excess > SLACK * np.maximum(np.abs(fail), SLACK), excess, 0.0)
    return np.where(np.isnan(values), 0.0, np.minimum(excess / way, MOST))


def _values(shapes: Shapes, scoring: Scoring) -> dict[str, Floats]:
    """By criterion; NaN where one does not apply."""
    quad = np.where(shapes.is_tria, np.nan, 1.0)
    tria = np.where(shapes.is_tria, 1.0, np.nan)
    normalised = scoring.criteria.normalised_size
    values = {
        "min size": shapes.height if normalised else shapes.shortest,
        "max length": shapes.longest,
        "aspect ratio": shapes.aspect(normalised=normalised),
        "warpage": shapes.warpage,
        "max angle quad": shapes.greatest_angle * quad,
        "min angle quad": shapes.least_angle * quad,
        "max angle tria": shapes.greatest_angle * tria,
        "min angle tria": shapes.least_angle * tria,
        "skew": shapes.skew,
        "Jacobian": shapes.jacobian,
        "taper": shapes.taper,
    }
    assert set(values) == {*SHAPE, *SIZE} <= set(NAMES)
    return values
