"""Assessment: all that a mesh is judged by, so that reports, pictures and files agree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from meshops._core import penalise
from meshops.criteria import CHORDAL_DEV, LEVELS, NAMES, Criteria, Scoring
from meshops.mesh import Bools, Floats, ShellMesh
from meshops.quality import (
    chordal_deviation,
    element_values,
    failing_penalties,
    index_of_penalties,
)
from meshops.quality_index import QualityIndex, index_of_values
from meshops.sizing import SizeField, at_even_size, size_factors

_FLAT = 1e-6
"""Extent across a plane surface, relative to its largest extent."""

EVEN = "even"
"""The gradation of a mesh that is to have the same size everywhere."""


@dataclass(frozen=True, eq=False)
class Assessment:
    """Criteria at a size, the wanted size by place, and the surface that a mesh stands for.

    Attributes
    ----------
    scoring : Scoring
    sizes : SizeField or None
        The wanted size by place, where it is not the same everywhere: an element is judged as if
        its place had the size of `scoring`.
    gradation : str
        What `sizes` is called: ``even``, ``local`` or the name of a file.
    reference : ShellMesh or None
        The surface that chordal deviation is measured from; None: it is not looked at, nor where
        the surface is a plane, which nothing deviates from.
    """

    scoring: Scoring
    sizes: SizeField | None = None
    gradation: str = EVEN
    reference: ShellMesh | None = None

    @property
    def criteria(self) -> Criteria:
        """The criteria set."""
        return self.scoring.criteria

    @cached_property
    def full_scoring(self) -> Scoring:
        """The scoring, with the chordal deviation where there is a reference surface."""
        curved = self.reference is not None and not _is_plane(self.reference)
        return replace(self.scoring, with_reference=curved)

    def values(self, mesh: ShellMesh) -> Floats:
        """(M, 12) measures of the elements, lengths as at the size of the scoring."""
        even = mesh if self.sizes is None else at_even_size(mesh, self.sizes, self.scoring.size)
        values = element_values(even, self.scoring)
        if self.reference is not None and self.full_scoring.active[CHORDAL_DEV]:
            deviation = chordal_deviation(mesh, self.reference)
            values[:, CHORDAL_DEV] = deviation * self.factors(mesh)
        return values

    def factors(self, mesh: ShellMesh) -> Floats:
        """(M,) what a length of each element is multiplied by before it is judged."""
        if self.sizes is None:
            return np.ones(len(mesh.elements))
        return size_factors(mesh, self.sizes, self.scoring.size)

    def penalties(self, mesh: ShellMesh) -> Floats:
        """(M, 12) penalties; NaN where a criterion is not active or does not apply."""
        penalties: Floats = penalise(self.values(mesh), self.full_scoring.core)
        return penalties

    def failing(self, mesh: ShellMesh) -> Bools:
        """(M,) bool: which elements fail one of the active criteria."""
        failing: Bools = np.any(failing_penalties(self.penalties(mesh), self.scoring), axis=1)
        return failing

    def element_index(self, mesh: ShellMesh) -> Floats:
        """(M,) Q.I. of each element."""
        return index_of_penalties(self.penalties(mesh), self.scoring)

    def quality(self, mesh: ShellMesh) -> QualityIndex:
        """Report on a mesh by all active criteria."""
        return index_of_values(mesh, self.values(mesh), self.full_scoring)

    def text(self) -> str:
        """Say by what it judges, in one line."""
        sizes = {EVEN: "the same everywhere", "local": "in the mesh's own gradation"}
        where = sizes.get(self.gradation, f"as {self.gradation} says")
        return f"criteria {self.criteria.name}, size {self.scoring.size:.6g} {where}"

    def limits_text(self) -> str:
        """Say where each active criterion fails, lengths at the size of the scoring."""
        scoring = self.full_scoring
        return ", ".join(
            f"{name} {scoring.levels[place, 3]:.4g}"
            for place, name in enumerate(NAMES)
            if scoring.active[place]
        )

    def document(self) -> Mapping[str, Any]:
        """Make what JSON holds of it: the whole levels, scaled ones as multiples of the size."""
        return {
            "criteria": self.criteria.name,
            "size": self.scoring.size,
            "gradation": self.gradation,
            "normalised_size": self.criteria.normalised_size,
            "penalties": dict(zip(LEVELS, self.criteria.penalties, strict=True)),
            "levels": {
                c.name: dict(zip(LEVELS, c.levels, strict=True))
                | {"weight": c.weight, "active": c.active, "scaled": c.scaled}
                for c in self.criteria.criteria
            },
        }


def _is_plane(surface: ShellMesh) -> bool:
    spread = np.linalg.eigvalsh(np.cov(surface.points.T, bias=True))
    return bool(spread[0] <= _FLAT**2 * spread[2])
