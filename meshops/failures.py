"""Failures: every element that fails, by which criterion, how far, and why it stays."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields

import numpy as np

from meshops.assessment import Assessment
from meshops.criteria import LENGTHS, NAMES, SIZES, Family
from meshops.formats.locks import Lock
from meshops.holding import what_holds
from meshops.mesh import NO_NODE, ShellMesh
from meshops.quality import failed_by_family, failing_penalties
from meshops.topology import topology

TRIED = "tried in vain"
"""Why an element stays that nothing holds, once a run has come to its end."""

SIZE_ALONE = "fails by its size alone: another density would be needed"


@dataclass(frozen=True)
class Failure:
    """An element that fails a criterion.

    Attributes
    ----------
    element : int
        Its id in the deck.
    x, y, z : float
        Its middle.
    criterion : str
    value, limit : float
        What it has and beyond which it fails, in the deck's own length unit or in degrees.
    family : "shape" or "size"
        Of the criterion.
    why : str
        Why the element stays as it is.
    """

    element: int
    x: float
    y: float
    z: float
    criterion: str
    value: float
    limit: float
    family: Family
    why: str


COLUMNS = tuple(field.name for field in fields(Failure))


def failures(
    mesh: ShellMesh,
    assessment: Assessment,
    *,
    locks: Sequence[Lock] = (),
    feature_angle: float,
    otherwise: str = "",
) -> tuple[Failure, ...]:
    """List all failing elements, one entry for each criterion that one fails.

    Parameters
    ----------
    mesh : ShellMesh
        With the ids of its deck.
    assessment : Assessment
    locks : sequence of Lock
    feature_angle : float
        Degrees from which an edge is a feature.
    otherwise : str
        Why an element stays that nothing holds.
    """
    values, penalties = assessment.values(mesh), assessment.penalties(mesh)
    failing = failing_penalties(penalties, assessment.scoring)
    rows = np.flatnonzero(failing.any(axis=1))
    if not len(rows):
        return ()
    _, by_size = failed_by_family(penalties, assessment.scoring)
    factors = assessment.factors(mesh)
    found = topology(mesh, feature_angle=feature_angle)
    held = what_holds(mesh, rows, found, locks)
    listed = []
    for row, holds in zip(rows.tolist(), held, strict=True):
        x, y, z = mesh.points[mesh.elements[row][mesh.elements[row] != NO_NODE]].mean(axis=0)
        why = "; ".join(filter(None, (holds or otherwise, SIZE_ALONE if by_size[row] else "")))
        for place in np.flatnonzero(failing[row]).tolist():
            scale = factors[row] if NAMES[place] in LENGTHS else 1.0
            listed.append(
                Failure(
                    element=int(mesh.element_ids[row]),
                    x=float(x),
                    y=float(y),
                    z=float(z),
                    criterion=NAMES[place],
                    value=float(values[row, place] / scale),
                    limit=float(assessment.scoring.levels[place, 3] / scale),
                    family="size" if NAMES[place] in SIZES else "shape",
                    why=why,
                )
            )
    return tuple(listed)


def csv_text(listed: Sequence[Failure]) -> str:
    """Write failures as a CSV file with a heading; an element comes once for each criterion."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(astuple(failure) for failure in listed)
    return text.getvalue()


def list_text(listed: Sequence[Failure]) -> str:
    """Write failures for a terminal: a line each, and why below it, once an element."""
    lines = []
    before = None
    for failure in listed:
        place = ", ".join(f"{x:.5g}" for x in (failure.x, failure.y, failure.z))
        if failure.element != before:
            lines.append(f"{failure.element} at {place}" + f": {failure.why}" * bool(failure.why))
        before = failure.element
        lines.append(
            f"    {failure.criterion} {failure.value:.5g}, limit {failure.limit:.5g} "
            f"({failure.family})"
        )
    return "".join(f"{line}\n" for line in lines)
