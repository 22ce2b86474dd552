"""What the optimiser does to a deck besides what it is asked for.

``python -m benchmarks.harm [GROUP ...]`` with groups of: shared, faults, gmsh, structured; all of
them without any. Each deck is improved, written, read again, and compared with what it was by
:mod:`meshops.harm`, which shares nothing with the search. No deck may be worse in any column. What
cannot be read, or is locked throughout, is told and is no harm. Sizes are judged by the gradation
that a deck had. Needs the extra ``bench`` (gmsh) and the folder of real decks, ``--shared``.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.harm_decks import GROUPS, SHARED, Source
from benchmarks.improving import improved, job_of, processes
from benchmarks.report import parser
from meshops.criteria_files import load_criteria
from meshops.errors import InputError
from meshops.harm import Harm, compare, local_sizes, median_size

CRITERIA = ("paper", "standard")

GRACE = 120.0
"""Seconds beyond three time limits after which a run counts as hanging."""

Column = tuple[str, Callable[[Harm], str]]


@dataclass(frozen=True)
class Outcome:
    """What came of a deck.

    Attributes
    ----------
    name, criteria : str
    planted : int
        Faults of shape that were put in.
    harm : Harm or None
        None where there is no result.
    seconds : float
    refused : str
        Why the program would not work on it; empty where it did.
    failure : str
        What went wrong in the run or in writing; empty where nothing did.
    """

    name: str
    criteria: str
    planted: int
    harm: Harm | None = None
    seconds: float = 0.0
    refused: str = ""
    failure: str = ""

    @property
    def complaints(self) -> tuple[str, ...]:
        """All that is worse, one sentence each."""
        failure = (self.failure,) if self.failure else ()
        return failure + (self.harm.worse() if self.harm else ())


def measure(source: Source, criteria: str, limit: float) -> Outcome:
    """Improve one deck and compare what is written with what was read."""
    outcome = Outcome(source.name, criteria, source.planted)
    try:
        before = source.load()
        job = job_of(source.name, before, criteria=criteria)
    except InputError as error:
        return replace(outcome, refused=str(error))
    started = time.monotonic()
    done = improved(job, limit).done
    seconds = time.monotonic() - started
    try:
        after, failure = source.written(done.mesh), ""
    except InputError as error:
        after, failure = done.mesh, f"it cannot be written: {error}"
    scoring = load_criteria(criteria).at(median_size(before))
    harm = compare(before, after, scoring, local_sizes(before, after))
    return replace(outcome, harm=harm, seconds=seconds, failure=failure)


class Worker:
    """A process for one deck after the other, and a new one where it crashes or hangs.

    `start` makes the pool of the one process.
    """

    def __init__(self, start: Callable[[], ProcessPoolExecutor]) -> None:
        self._start = start
        self._pool: ProcessPoolExecutor | None = None
        self._others = multiprocessing.active_children()

    def measure(self, source: Source, criteria: str, limit: float) -> Outcome:
        """Return what `measure` does, or an outcome that says why there is none."""
        self._pool = self._pool or self._start()
        future = self._pool.submit(measure, source, criteria, limit)
        try:
            return future.result(timeout=3.0 * limit + GRACE)
        except BrokenProcessPool:
            failure = "the process crashed"
        except TimeoutError:
            failure = f"the run did not end within {3.0 * limit + GRACE:g} s"
        except Exception as error:  # whatever a run raises is what this benchmark is there to tell
            return Outcome(source.name, criteria, 0, failure=f"{type(error).__name__}: {error}")
        self.close()
        return Outcome(source.name, criteria, 0, failure=failure)

    def close(self) -> None:
        """End the process."""
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)
            for child in multiprocessing.active_children():
                if child not in self._others:
                    child.terminate()
        self._pool = None


COLUMNS: tuple[Column, ...] = (
    ("elements", lambda h: _pair(h.before.elements, h.after.elements)),
    ("by shape", lambda h: _pair(h.before.failed_by_shape, h.after.failed_by_shape)),
    ("by size", lambda h: _pair(h.before.failed_by_size_alone, h.after.failed_by_size_alone)),
    ("trias", lambda h: _pair(h.before.trias, h.after.trias)),
    ("adjacent", lambda h: _pair(h.before.adjacent_trias, h.after.adjacent_trias)),
    (
        "scaled J",
        lambda h: _pair(h.before.least_scaled_jacobian, h.after.least_scaled_jacobian, ".3f"),
    ),
    ("least angle", lambda h: _pair(h.before.least_angle, h.after.least_angle, ".1f")),
    ("largest", lambda h: _pair(h.before.greatest_angle, h.after.greatest_angle, ".1f")),
    ("size ratio", lambda h: _pair(_spread(h.before), _spread(h.after), "s")),
    ("rows", lambda h: f"{h.rows.least:.2f}"),
    ("lines %", lambda h: f"{100 * h.border_deviation:.2g}"),
    ("surface %", lambda h: f"{100 * max(0.0, h.surface.excess):.2g}"),
    ("area %", lambda h: f"{100 * h.area_change:.2g}"),
    ("changed", lambda h: str(h.changed_elements)),
    ("a fault", lambda h: f"{h.changed_per_fault:.1f}"),
    ("other ids", lambda h: str(h.other_ids)),
)
"""Head and cell of each column: before > after, or what changed."""


def table(outcomes: Sequence[Outcome]) -> str:
    """Return all decks as lines of text; below each what is worse."""
    heads = ["deck", "criteria", *(head for head, _ in COLUMNS), "seconds", "worse"]
    rows = [_cells(outcome) for outcome in outcomes]
    widths = [max(len(row[k]) for row in (heads, *rows)) for k in range(len(heads))]
    lines = []
    for row, outcome in zip((heads, *rows), (None, *outcomes), strict=True):
        cells = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        lines.append(cells.rstrip())
        if outcome:
            notes = (*outcome.complaints, outcome.refused)
            lines += [f"    {note}" for note in notes if note]
    return "\n".join(lines)


def totals(outcomes: Sequence[Outcome]) -> dict[str, int]:
    """Count over all decks: how many are worse, and what was repaired of all and of the planted."""
    measured = [outcome for outcome in outcomes if outcome.harm]
    made = [outcome for outcome in measured if outcome.planted]
    return {
        "decks": len(outcomes),
        "refused": sum(bool(outcome.refused) for outcome in outcomes),
        "worse": sum(bool(outcome.complaints) for outcome in outcomes),
        "left as they are": sum(not (o.harm and o.harm.changed_elements) for o in measured),
        "decks with planted faults": len(made),
        "their faults of shape before": _sum(made, lambda h: h.before.failed_by_shape),
        "their faults of shape after": _sum(made, lambda h: h.after.failed_by_shape),
        "their trias before": _sum(made, lambda h: h.before.trias),
        "their trias after": _sum(made, lambda h: h.after.trias),
        "faults of shape before": _sum(measured, lambda h: h.before.failed_by_shape),
        "faults of shape after": _sum(measured, lambda h: h.after.failed_by_shape),
        "trias before": _sum(measured, lambda h: h.before.trias),
        "trias after": _sum(measured, lambda h: h.after.trias),
    }


def _cells(outcome: Outcome) -> list[str]:
    harm = outcome.harm
    cells = [cell(harm) if harm else "" for _, cell in COLUMNS]
    count = "refused" if outcome.refused else str(len(outcome.complaints) or "")
    return [outcome.name, outcome.criteria, *cells, f"{outcome.seconds:.1f}", count]


def _pair(before: Any, after: Any, form: str = "d") -> str:
    one, other = format(before, form), format(after, form)
    return one if one == other else f"{one} > {other}"


def _spread(standing: Any) -> str:
    return f"{standing.least_size:.2f}-{standing.greatest_size:.2f}"


def _sum(outcomes: Sequence[Outcome], value: Callable[[Harm], int]) -> int:
    return sum(value(outcome.harm) for outcome in outcomes if outcome.harm)


def _as_json(outcome: Outcome) -> dict[str, Any]:
    return {**vars(outcome), "harm": outcome.harm.to_json() if outcome.harm else None}


def _options() -> argparse.Namespace:
    options = parser(__doc__)
    options.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS))
    options.add_argument("--seeds", type=int, default=100, help="of the structured decks")
    options.add_argument("--time-limit", type=float, default=10.0, metavar="S", help="for a deck")
    options.add_argument("--shared", type=Path, default=SHARED, help="folder of data and faults")
    options.add_argument(
        "--criteria", action="append", choices=CRITERIA, help="just these; repeatable"
    )
    options.add_argument("--only", metavar="TEXT", default="", help="decks whose name has this")
    chosen = options.parse_args()
    if unknown := [name for name in chosen.groups if name not in GROUPS]:
        options.error(f"there is no group {', '.join(unknown)}; choose of {', '.join(GROUPS)}")
    return chosen


def main() -> None:
    """Measure the groups that are asked for."""
    chosen = _options()
    outcomes: list[Outcome] = []
    worker = Worker(partial(processes, 1))
    try:
        for group in chosen.groups or GROUPS:
            for source in GROUPS[group](chosen):
                if chosen.only not in source.name:
                    continue
                for criteria in chosen.criteria or CRITERIA:
                    outcomes.append(worker.measure(source, criteria, chosen.time_limit))
                    print(f"{source.name}, {criteria}: done", file=sys.stderr)
    finally:
        worker.close()
    summary = totals(outcomes)
    print(table(outcomes))
    print("\n".join(f"{name}: {count}" for name, count in summary.items()))
    if chosen.json:
        document = {"totals": summary, "decks": [_as_json(outcome) for outcome in outcomes]}
        chosen.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    if chosen.check and summary["worse"]:
        sys.exit(1)


if __name__ == "__main__":
    main()
