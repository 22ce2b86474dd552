"""What the islands gain over other ways to search, with the same operations and budget.

The islands search for so many seconds; the others then get as many evaluations, and as many
seconds, and are read at both. One that is slow at evaluations is stopped after five times the
seconds, and read there.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.competitors import OTHERS, Budget, Curve, Reading, islands
from benchmarks.improving import job_of, processes
from benchmarks.parts import PARTS
from benchmarks.peers import Configuration, gmsh_mesh
from benchmarks.planar import FLOW
from benchmarks.report import Row
from islands.run import Job
from meshops.examples import SIZE, plate
from meshops.mesh import Floats

SECONDS = 10.0
"""Of each search."""

START = Configuration(5, 0)
"""How gmsh meshes the first planar part: the hardest start that leaves trias and failures."""

ISLANDS = "islands"
_POINTS = 200
_DPI = 150


@dataclass(frozen=True)
class Contest:
    """One seed of one job.

    Attributes
    ----------
    budget : Budget
        What the islands spent.
    curves : mapping of str to Curve
        By competitor.
    """

    budget: Budget
    curves: Mapping[str, Curve]

    def reached(self, name: str) -> tuple[Reading, Reading]:
        """Return the best reading within the budget of evaluations, and within that of time."""
        curve, budget = self.curves[name], self.budget
        return (
            [r for r in curve if r.evaluations <= budget.evaluations][-1],
            [r for r in curve if r.seconds <= budget.seconds][-1],
        )


def search(seeds: int, workers: int, picture: Path | None) -> tuple[list[Row], dict[str, Any]]:
    """Let all competitors search with so many seeds on the plate and on a part."""
    part = PARTS[0]
    jobs = (
        job_of("plate", plate(), size=SIZE, flow=FLOW),
        job_of(part.name, gmsh_mesh(part, START), size=part.size, flow=FLOW),
    )
    contests: dict[str, list[Contest]] = {}
    with processes(workers) as pool:
        for job in jobs:
            waiting = [pool.submit(contest, job, seed) for seed in range(1, seeds + 1)]
            contests[job.name] = [future.result() for future in waiting]
    if picture:
        draw_curves(contests, picture)
    rows = [row for name, found in contests.items() for row in _rows(name, found)]
    details = {name: [_plain(c) for c in found] for name, found in contests.items()}
    return rows, {"search": details}


def contest(job: Job, seed: int) -> Contest:
    """Let the islands search, and then the others on the same budget."""
    first = islands(job, Budget(0, SECONDS), seed)
    budget = Budget(first[-1].evaluations, first[-1].seconds)
    return Contest(
        budget,
        {ISLANDS: first} | {name: other(job, budget, seed) for name, other in OTHERS.items()},
    )


def draw_curves(contests: Mapping[str, Sequence[Contest]], path: Path) -> None:
    """Draw bad elements over evaluations and over seconds, the median of all seeds, to a PNG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.0 * len(contests)), layout="constrained")
    axes = figure.subplots(len(contests), 2, squeeze=False)
    for (name, found), line in zip(contests.items(), axes, strict=True):
        for axis, unit in zip(line, ("evaluations", "seconds"), strict=True):
            end = statistics.median(getattr(c.budget, unit) for c in found)
            places = np.linspace(0.0, end, _POINTS)
            for competitor in found[0].curves:
                curves = [_bad_at(c.curves[competitor], unit, places) for c in found]
                axis.plot(places, np.median(curves, axis=0), label=competitor)
            axis.set(xlabel=unit, ylabel="failed elements + trias", title=name)
            axis.set_yscale("symlog", linthresh=1.0)
        line[0].legend()
    figure.savefig(path, dpi=_DPI)


def _bad_at(curve: Curve, unit: str, places: Floats) -> Floats:
    """(P,) failed elements and trias at the last reading at or before each place."""
    spent = np.array([getattr(reading, unit) for reading in curve])
    bad = np.array([float(reading.failed + reading.trias) for reading in curve])
    found: Floats = bad[np.searchsorted(spent, places, side="right").clip(1) - 1]
    return found


def _rows(name: str, contests: Sequence[Contest]) -> list[Row]:
    ours = statistics.median(c.curves[ISLANDS][-1].fitness for c in contests)
    rows = [
        Row(f"{name}: {ISLANDS}", _median([c.reached(ISLANDS)[1] for c in contests]), "", met=True)
    ]
    for other in OTHERS:
        readings = list(zip(*(c.reached(other) for c in contests), strict=True))
        best = max(statistics.median(r.fitness for r in column) for column in readings)
        measured = f"{_median(readings[0])}; in the same time {_median(readings[1])}"
        rows.append(Row(f"{name}: {other}", measured, f"< {ours:.4f}", best < ours))
    return rows


def _median(readings: Sequence[Reading]) -> str:
    failed, trias, fitness = (
        statistics.median(getattr(r, key) for r in readings)
        for key in ("failed", "trias", "fitness")
    )
    return f"{fitness:.4f} ({failed:g} failed, {trias:g} trias)"


def _plain(found: Contest) -> dict[str, Any]:
    return {
        "budget": asdict(found.budget),
        "curves": {name: [asdict(r) for r in curve] for name, curve in found.curves.items()},
    }
