"""The QualityIndex report: how a mesh stands by each criterion, and its compound Q.I."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

import numpy as np

from meshops import _core
from meshops.criteria import CRITERIA, LENGTHS, NAMES, PERCENT_TRIAS, SLACK, Scoring
from meshops.mesh import NEW, Floats, ShellMesh
from meshops.quality import (
    element_values,
    failed_by_family,
    failing_penalties,
    index_of_penalties,
)
from meshops.quality_sums import ELEMENTS, FAILED, QUADS, TRIAS

SHOWN = 3
"""How many of the worst elements a row names."""

WIDTH = 80
"""Columns of the table: what a terminal has at the least."""

HEAD = ("#", "Criterion", "Fails at", "% failed", "Worst", "Q.I.")
LEFT = (0, 1)
"""Columns that stand on the left."""


@dataclass(frozen=True)
class CriterionRow:
    """How the mesh stands by one criterion; None where there is nothing to say.

    Attributes
    ----------
    number : int
        Place in the report, from 1.
    name : str
    active : bool
    failure : float
        Value beyond which an element fails.
    percent_failed : float or None
        Of the elements that the criterion applies to.
    worst : float or None
        Worst value; infinite for the aspect ratio of an element with an edge of no length.
    index : float or None
        Mean penalty of the elements that pass plus the sum of those of the elements that fail.
    worst_elements : up to three str
        Deck ids of the worst failing elements; an element that is new has its place in the mesh,
        from 1, and a star.
    """

    number: int
    name: str
    active: bool
    failure: float
    percent_failed: float | None = None
    worst: float | None = None
    index: float | None = None
    worst_elements: tuple[str, ...] = ()


@dataclass(frozen=True)
class QualityIndex:
    """The report on a mesh.

    Attributes
    ----------
    criteria : str
        Name of the criteria set.
    size : float
        Target element size.
    rows : thirteen CriterionRow
    compound_qi : float
        Weighted mean over the criteria that pass plus the weighted sum over those that fail: it
        grows with the number of failed elements.
    mean_element_qi : float
        Mean Q.I. of an element, which compares across meshes; 0 for no element.
    elements, quads, trias, failed : int
    failed_by_shape, failed_by_size : int
        Failed elements that fail a criterion of shape, and those that fail by their size alone.
    percent_trias : float
    """

    criteria: str
    size: float
    rows: tuple[CriterionRow, ...]
    compound_qi: float
    mean_element_qi: float
    elements: int
    quads: int
    trias: int
    failed: int
    failed_by_shape: int
    failed_by_size: int
    percent_trias: float

    def table(self) -> str:
        """Return the report as text, as the paper's Figure 5 has it, 80 columns wide.

        The line after the heading is that of the first row.
        """
        cells = [[*HEAD], *(self._cells(row) for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines = [
            "  ".join(
                cell.ljust(width) if place in LEFT else cell.rjust(width)
                for place, (cell, width) in enumerate(zip(line, widths, strict=True))
            )
            for line in cells
        ]
        room = WIDTH - sum(widths) - 2 * len(widths)
        ids = ["Worst elements", *(_fitting(row.worst_elements, room) for row in self.rows)]
        lines = [f"{line}  {worst}" for line, worst in zip(lines, ids, strict=True)]
        closing = {
            "compound Q.I. =": f"{self.compound_qi:.2f}",
            "# of quads =": str(self.quads),
            "# of trias =": str(self.trias),
            "% trias =": f"{self.percent_trias:.2f}",
            "# of failed =": str(self.failed),
            "  by shape =": str(self.failed_by_shape),
            "  by size alone =": str(self.failed_by_size),
            "mean element Q.I. =": f"{self.mean_element_qi:.2f}",
        }
        edge = sum(widths[:3]) + 4
        lines += [label + value.rjust(edge - len(label)) for label, value in closing.items()]
        return "".join(line.rstrip() + "\n" for line in lines)

    def to_json(self) -> dict[str, object]:
        """Return the report as what json can write; None for a number that is not finite."""
        return {
            "criteria": self.criteria,
            "size": self.size,
            "elements": self.elements,
            "quads": self.quads,
            "trias": self.trias,
            "failed": self.failed,
            "failed_by_shape": self.failed_by_shape,
            "failed_by_size": self.failed_by_size,
            "percent_trias": self.percent_trias,
            "compound_qi": self.compound_qi,
            "mean_element_qi": self.mean_element_qi,
            "rows": [
                {key: _finite(value) for key, value in asdict(row).items()} for row in self.rows
            ],
        }

    def _cells(self, row: CriterionRow) -> list[str]:
        # lengths keep three significant digits of the target size, however small the unit
        decimals = max(2, 2 - math.floor(math.log10(self.size))) if row.name in LENGTHS else 2
        numbers = [
            "" if value is None else _figure(value, places)
            for value, places in (
                (row.failure, decimals),
                (row.percent_failed, 2),
                (row.worst, decimals),
                (row.index, 2),
            )
        ]
        return [str(row.number), row.name, *numbers]


def quality_index(
    mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None
) -> QualityIndex:
    """Report on a mesh by all active criteria.

    Chordal deviation is looked at where a reference surface is given and the criterion is active.
    """
    scoring = replace(scoring, with_reference=reference is not None)
    return index_of_values(mesh, element_values(mesh, scoring, reference), scoring)


def index_of_values(mesh: ShellMesh, values: Floats, scoring: Scoring) -> QualityIndex:
    """Report on a mesh by the (M, 12) measures of its elements."""
    penalties = _core.penalise(values, scoring.core)
    tally = _core.sum_measures(values, mesh.is_tria, scoring.core)
    rows = [
        _element_row(mesh, scoring, c, values[:, c], penalties[:, c], tally)
        for c in range(CRITERIA)
    ]
    element_qi = index_of_penalties(penalties, scoring)
    by_shape, by_size = failed_by_family(penalties, scoring)
    return QualityIndex(
        criteria=scoring.criteria.name,
        size=scoring.size,
        rows=(*rows, _trias_row(scoring, tally)),
        compound_qi=_core.compound_index(tally, scoring.core),
        mean_element_qi=float(element_qi.mean()) if len(element_qi) else 0.0,
        elements=int(tally[ELEMENTS]),
        quads=int(tally[QUADS]),
        trias=int(tally[TRIAS]),
        failed=int(tally[FAILED]),
        failed_by_shape=int(np.count_nonzero(by_shape)),
        failed_by_size=int(np.count_nonzero(by_size)),
        percent_trias=_core.percent_trias(tally),
    )


def _element_row(
    mesh: ShellMesh, scoring: Scoring, c: int, values: Floats, penalties: Floats, tally: Floats
) -> CriterionRow:
    row = _blank_row(scoring, c)
    measured = np.flatnonzero(~np.isnan(penalties))
    if not len(measured):
        return row
    badness = values if scoring.levels[c, 4] > scoring.levels[c, 0] else -values
    failed = np.flatnonzero(failing_penalties(penalties, scoring))
    worst = failed[np.argsort(-badness[failed], kind="stable")[:SHOWN]]
    return replace(
        row,
        percent_failed=100.0 * len(failed) / len(measured),
        worst=float(values[measured[np.argmax(badness[measured])]]),
        index=float(_core.criterion_indices(tally)[c]),
        worst_elements=tuple(_label(mesh, element) for element in worst),
    )


def _trias_row(scoring: Scoring, tally: Floats) -> CriterionRow:
    row = _blank_row(scoring, PERCENT_TRIAS)
    if not row.active:
        return row
    percent = _core.percent_trias(tally)
    index = _core.penalty_of(percent, PERCENT_TRIAS, scoring.core)
    failing = index > scoring.penalties[3] + SLACK
    return replace(row, percent_failed=100.0 * failing, worst=percent, index=float(index))


def _blank_row(scoring: Scoring, c: int) -> CriterionRow:
    return CriterionRow(
        c + 1, NAMES[c], active=bool(scoring.active[c]), failure=float(scoring.levels[c, 3])
    )


def _figure(value: float, decimals: int) -> str:
    """Write a number; a very large one by its first digits."""
    return f"{value:.{decimals}f}" if not 1e7 <= abs(value) < math.inf else f"{value:.3e}"


def _fitting(ids: tuple[str, ...], room: int) -> str:
    """As many of the ids as there is room for, but one at the least."""
    text = ""
    for label in ids:
        longer = f"{text}  {label}" if text else label
        if text and len(longer) > room:
            break
        text = longer
    return text


def _label(mesh: ShellMesh, element: int) -> str:
    known = int(mesh.element_ids[element])
    return f"{element + 1}*" if known == NEW else str(known)


def _finite(value: object) -> object:
    return None if isinstance(value, float) and not math.isfinite(value) else value
