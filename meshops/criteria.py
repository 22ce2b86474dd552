"""Criteria: what counts as a good element, as a value.

A criterion has five levels, ideal to worst; between them its penalty is linear. ``STANDARD`` holds
the defaults that HyperMesh sets for an element size, ``PAPER`` the stricter lengths of the paper's
report. Users bring theirs in a file: see :mod:`meshops.criteria_files`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from meshops import _core
from meshops.errors import InputError
from meshops.mesh import Bools, Floats

NAMES = (
    "min size",
    "max length",
    "aspect ratio",
    "warpage",
    "max angle quad",
    "min angle quad",
    "max angle tria",
    "min angle tria",
    "skew",
    "Jacobian",
    "chordal dev",
    "taper",
    "% of trias",
)
"""The thirteen criteria, in the order of every array that has one place a criterion."""

CRITERIA = 12
"""How many criteria are measured on each element; the thirteenth is of the mesh."""

MIN_SIZE, MAX_LENGTH, ASPECT_RATIO, WARPAGE = 0, 1, 2, 3
MAX_ANGLE_QUAD, MIN_ANGLE_QUAD, MAX_ANGLE_TRIA, MIN_ANGLE_TRIA = 4, 5, 6, 7
SKEW, JACOBIAN, CHORDAL_DEV, TAPER = 8, 9, 10, 11
PERCENT_TRIAS = 12

LENGTHS = ("min size", "max length", "chordal dev")
"""The criteria whose values are lengths; only their levels can be multiples of the target size."""

FALLING = ("min size", "min angle quad", "min angle tria", "Jacobian")
"""The criteria whose levels fall from ideal to worst."""

SIZES = ("min size", "max length", "aspect ratio")
"""The criteria of size; all others but the share of trias are of shape.

An element that fails by its size alone is sound, and would pass in a mesh of another density.
"""

SHAPES = tuple(name for name in NAMES if name not in (*SIZES, "% of trias"))
"""The criteria of shape: what they measure is the same however large an element is, but for the
chordal deviation, which says how well it follows the surface."""

LEVELS = ("ideal", "good", "warn", "fail", "worst")

PENALTIES = (0.0, 0.0, 0.8, 1.0, 10.0)

SLACK = 1e-9
"""Penalty beyond that of the fail level that is rounding, not failure."""

Scalar = TypeVar("Scalar", bound=np.generic)
Levels = tuple[float, float, float, float, float]
Family = Literal["shape", "size"]
ScoringArrays = tuple[Floats, Floats, Bools, Floats, Floats]


@dataclass(frozen=True)
class Criterion:
    """One criterion; raises InputError where its levels, its weight or its scale make no sense.

    Attributes
    ----------
    name : str
        One of ``NAMES``.
    levels : five floats
        Values at which it is ideal, good, warn, fail and worst.
    weight : float
        Its share in an element's and in the compound Q.I.
    active : bool
        Whether it counts at all.
    scaled : bool
        Whether the levels are multiples of the target element size.
    """

    name: str
    levels: Levels
    weight: float = 1.0
    active: bool = True
    scaled: bool = False

    def __post_init__(self) -> None:
        if self.name not in NAMES:
            raise InputError(f'there is no criterion "{self.name}"; choose of {", ".join(NAMES)}')
        if len(self.levels) != len(LEVELS) or not all(map(math.isfinite, self.levels)):
            raise InputError(f'"{self.name}" needs five finite levels: {", ".join(LEVELS)}')
        sign, way = (-1.0, "fall") if self.name in FALLING else (1.0, "rise")
        if not _rises([sign * level for level in self.levels]):
            raise InputError(
                f'the levels of "{self.name}" must {way} from ideal to worst, '
                f"not go {', '.join(f'{level:g}' for level in self.levels)}"
            )
        if not (math.isfinite(self.weight) and self.weight >= 0.0):
            raise InputError(f'the weight of "{self.name}" must be 0 or more, not {self.weight:g}')
        if self.scaled and self.name not in LENGTHS:
            raise InputError(
                f'"{self.name}" is no length: scaled can only be set for {", ".join(LENGTHS)}'
            )


@dataclass(frozen=True)
class Criteria:
    """A named set of all thirteen criteria, in the order of ``NAMES``.

    Attributes
    ----------
    name : str
    criteria : thirteen Criterion
    penalties : five floats
        Penalty at ideal, good, warn, fail and worst; an element fails beyond that of fail.
    normalised_size : bool
        Whether "min size" is the minimal normalised height instead of the shortest edge.
    """

    name: str
    criteria: tuple[Criterion, ...]
    penalties: Levels = PENALTIES
    normalised_size: bool = False

    def __post_init__(self) -> None:
        if tuple(criterion.name for criterion in self.criteria) != NAMES:
            raise ValueError(f"criteria must be {', '.join(NAMES)}, in this order")
        p = self.penalties
        if not (len(p) == len(LEVELS) and all(map(math.isfinite, p)) and p[0] >= 0.0):
            raise InputError("penalties must be five finite numbers, none below 0")
        if not (_rises(p) and p[3] < p[4]):
            raise InputError(
                "penalties must rise from ideal to worst, with worst beyond fail, "
                f"not go {', '.join(f'{level:g}' for level in p)}"
            )

    def __getitem__(self, name: str) -> Criterion:
        """Return the criterion of that name."""
        return self.criteria[NAMES.index(name)]

    def having(self, *changed: Criterion, name: str, penalties: Levels = PENALTIES) -> Criteria:
        """Return a set called ``name`` with some of the criteria replaced."""
        by_name = {criterion.name: criterion for criterion in changed}
        criteria = tuple(by_name.get(criterion.name, criterion) for criterion in self.criteria)
        return replace(self, name=name, criteria=criteria, penalties=penalties)

    def at(self, size: float) -> Scoring:
        """Return what to score with at a target element size, in the mesh's length unit."""
        return Scoring(self, size)


@dataclass(frozen=True)
class Scoring:
    """Criteria at one target element size, as the arrays that the core takes.

    Attributes
    ----------
    criteria : Criteria
    size : float
        Target element size; InputError unless it is positive.
    with_reference : bool
        Whether there is a reference surface. Without one chordal deviation is not active.
    growth : six floats
        The gradient of the logarithm of the target size over the place, and where it is `size`.
    bounds : thirteen floats or None
        The worst that a changed element may have by each criterion of shape, where that is better
        than the fail level; infinite, with the sign of what is bad, where just that counts. None:
        everywhere.
    """

    criteria: Criteria
    size: float
    with_reference: bool = False
    growth: tuple[float, ...] = (0.0,) * 6
    bounds: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.size) and self.size > 0.0):
            raise InputError(f"the target element size must be positive, not {self.size:g}")

    @cached_property
    def levels(self) -> Floats:
        """(13, 6) float64, read-only, bounds last; in the mesh's unit and in degrees."""
        scale = [[self.size if c.scaled else 1.0] for c in self.criteria.criteria]
        levels = np.array([c.levels for c in self.criteria.criteria]) * scale
        unbounded = [-math.inf if name in FALLING else math.inf for name in NAMES]
        return _read_only(np.column_stack([levels, self.bounds or unbounded]))

    @cached_property
    def weights(self) -> Floats:
        """(13,) float64, read-only."""
        return _read_only(np.array([c.weight for c in self.criteria.criteria], np.float64))

    @cached_property
    def active(self) -> Bools:
        """(13,) bool, read-only."""
        active = np.array([c.active for c in self.criteria.criteria])
        active[NAMES.index("chordal dev")] &= self.with_reference
        return _read_only(active)

    @cached_property
    def penalties(self) -> Floats:
        """(5,) float64, read-only."""
        return _read_only(np.array(self.criteria.penalties, np.float64))

    @cached_property
    def arrays(self) -> ScoringArrays:
        """Levels, weights, active, penalties, sizing."""
        return (
            self.levels,
            self.weights,
            self.active,
            self.penalties,
            self.sizing,
        )

    @cached_property
    def core(self) -> _core.Scoring:
        """The same as the core takes it."""
        return _core.Scoring(*self.arrays)

    @cached_property
    def sizing(self) -> Floats:
        """(7,) float64, read-only: how lengths are measured."""
        return _read_only(np.array([self.criteria.normalised_size, *self.growth], np.float64))

    def __getstate__(self) -> dict[str, object]:
        """Arrays are made again where they are needed, so that they stay read-only."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def _rises(values: tuple[float, ...] | list[float]) -> bool:
    return all(a <= b for a, b in pairwise(values)) and values[0] < values[-1]


def _read_only(array: NDArray[Scalar]) -> NDArray[Scalar]:
    array.flags.writeable = False
    return array


STANDARD = Criteria(
    name="standard",
    criteria=(
        Criterion("min size", (1.0, 0.9, 0.4, 0.2, 0.1), scaled=True),
        Criterion("max length", (1.0, 1.2, 1.5, 2.0, 3.0), scaled=True),
        Criterion("aspect ratio", (1.0, 2.0, 4.4, 5.0, 10.0)),
        Criterion("warpage", (0.0, 5.0, 13.0, 15.0, 30.0)),
        Criterion("max angle quad", (90.0, 110.0, 134.0, 140.0, 160.0)),
        Criterion("min angle quad", (90.0, 70.0, 46.0, 40.0, 20.0)),
        Criterion("max angle tria", (60.0, 80.0, 112.0, 120.0, 150.0)),
        Criterion("min angle tria", (60.0, 50.0, 34.0, 30.0, 15.0)),
        Criterion("skew", (0.0, 10.0, 34.0, 40.0, 70.0)),
        Criterion("Jacobian", (1.0, 0.9, 0.7, 0.6, 0.3)),
        Criterion("chordal dev", (0.0, 0.03, 0.08, 0.1, 0.2), scaled=True),
        Criterion("taper", (0.0, 0.2, 0.5, 0.6, 0.9)),
        Criterion("% of trias", (0.0, 6.0, 10.0, 15.0, 20.0)),
    ),
)
"""HyperMesh's defaults for an element size (public: Altair's help on element quality)."""

# Figure 5 gives only the fail levels, at L = 5. The levels around them keep the proportions of the
# standard set, but for the worst length: with 1.8 L two elements of 8.00 get 2 x 4, which is the
# figure's Q.I. of 8.08 less the mean of those that pass.
PAPER = STANDARD.having(
    Criterion("min size", (1.0, 0.9, 0.6, 0.5, 0.2), scaled=True),
    Criterion("max length", (1.0, 1.2, 1.4, 1.5, 1.8), scaled=True),
    Criterion("aspect ratio", (1.0, 2.0, 2.8, 3.0, 6.0)),
    Criterion("chordal dev", (0.0, 0.06, 0.16, 0.2, 0.4), scaled=True),
    name="paper",
)
"""The set of the paper's report, where Figure 5 differs from the standard."""

BUILT_IN = {criteria.name: criteria for criteria in (STANDARD, PAPER)}
