"""Assessing: by what a run, or a check, judges a mesh."""

from __future__ import annotations

from pathlib import Path

from meshops.assessment import EVEN, Assessment
from meshops.criteria import Criteria
from meshops.formats.verified import Verify
from meshops.mesh import ShellMesh
from meshops.quality import median_edge
from meshops.sizing import LOCAL, parse_size

Size = float | str | None
"""As a user gives it: a number, ``local``, ``even`` (the median edge) or a file of sizes; None: the
mesh's own gradation, where the criteria go by the size of elements."""


def assessment_of(
    mesh: ShellMesh,
    criteria: Criteria,
    size: Size,
    *,
    judged_size: float | None = None,
    reference: ShellMesh | None = None,
) -> Assessment:
    """Return what a mesh is judged by where a user gives these settings.

    `judged_size` is what lengths are judged by where `size` is no number; None: the median edge.
    Raises InputError where the size is none.
    """
    if size is None:
        by_size = any(criterion.scaled and criterion.active for criterion in criteria.criteria)
        size = LOCAL if by_size else EVEN
    number = None if isinstance(size, str) else size
    sizes = parse_size(size, mesh) if isinstance(size, str) and size != EVEN else None
    return Assessment(
        scoring=criteria.at(number or judged_size or median_edge(mesh)),
        sizes=sizes,
        gradation=EVEN if sizes is None else gradation_name(str(size)),
        reference=reference,
    )


def gradation_name(size: str) -> str:
    """Return what a size field is called in reports."""
    return LOCAL if size == LOCAL else Path(size).name


def verifier(assessment: Assessment) -> Verify:
    """Return what says in what a mesh is worse than another one, for a deck that is to be written.

    It shares no code with the search.
    """

    def verify(before: ShellMesh, after: ShellMesh) -> tuple[str, ...]:
        from meshops import harm

        sizes = None
        if assessment.sizes is not None:
            sizes = (
                assessment.sizes.at(harm.middles_of(before)),
                assessment.sizes.at(harm.middles_of(after)),
            )
        return harm.verify(before, after, assessment.scoring, sizes)

    return verify
