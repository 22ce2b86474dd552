"""How much faster more workers are: plates with one and two, and islands that sleep.

Evaluations sleep, on a Ray that is told to have as many CPUs as there are processes: what is
measured is what the archipelago, Ray and this machine add to the time that the same steps need by
themselves. Above `MOST` processes islands share them, as they do wherever there are more islands
than CPUs, since each process takes 0.1 GB.
"""

from __future__ import annotations

import statistics
import time
from typing import Any

import numpy as np

from benchmarks.improving import job_of
from benchmarks.isolation import isolated
from benchmarks.report import Row, parser, publish
from benchmarks.tiling import tiled
from benchmarks.trivial import trivial_schedule, trivial_work
from islands.archipelago import Archipelago, Executor, Mode, Schedule
from islands.executors.ray import RayExecutor, connect
from islands.run import Job, run
from meshops.examples import SIZE, plate
from meshops.mesh import Floats

PLATES = {0: (1, 2, 3, 4, 5), 12_000: (1,)}
"""Elements of the plate, tiled to so many (0: as it is), and the seeds."""

FASTER = 1.8

ISLANDS = {4: 0.95, 16: 0.95, 64: 0.95, 256: 0.9}
"""How many islands, and the efficiency that they are to have."""

MOST = 128
SECONDS = 1.0
"""Of an evaluation, an operation GA."""

GENES, GENERATIONS = 4, 8
TIMEOUT = 1500.0


def plate_seconds(elements: int, workers: int) -> float:
    """Return what a plate takes at default settings, the mean of its seeds, Ray running."""
    connect(None, workers)
    executor = RayExecutor(workers=workers)
    mesh = tiled(elements) if elements else plate()
    jobs = [job_of("plate", mesh, size=SIZE, seed=seed) for seed in PLATES[elements]]
    try:
        _seconds(job_of("plate", plate(), size=SIZE), executor)  # starts the actors
        return statistics.fmean(_seconds(job, executor) for job in jobs)
    finally:
        executor.close()


def _seconds(job: Job, executor: Executor) -> float:
    started = time.monotonic()
    run(job, executor, lambda _: None, started)
    return time.monotonic() - started


def efficiency(islands: int, mode: Mode) -> float:
    """Return the time that the sleeping needs over the time that all took, the actors running."""
    processes = min(islands, MOST)
    connect(None, processes)
    executor = RayExecutor(workers=processes)
    schedule = trivial_schedule(islands, 2, GENES, GENERATIONS, mode)
    work = trivial_work(0, seconds=SECONDS)
    try:
        list(executor.evolve([Archipelago(0, trivial_work(0), trivial_schedule(islands, 2, 1, 1))]))
        started = time.monotonic()
        milestones = list(executor.evolve([Archipelago(0, work, schedule)]))
        took = time.monotonic() - started
    finally:
        executor.close()
    individuals = work.problem.breeding.individuals * (work.problem.breeding.generations + 1)
    performed = np.array([[state.performed for state in m.islands] for m in milestones])
    sleeps = np.diff(performed, axis=0, prepend=0) / individuals
    return needed(schedule, sleeps * SECONDS, processes) / took


def needed(schedule: Schedule, seconds: Floats, processes: int) -> float:
    """Return the time of a schedule whose steps take (generations, islands) seconds, and no more.

    Island i is always at process i modulo their number, as `RayExecutor` has it.
    """
    ends = np.zeros_like(seconds)
    free = np.zeros(processes)
    for generation, steps in enumerate(seconds):
        for island in range(len(steps)):
            begins = free[island % processes]
            left, together = schedule.departure(generation), generation - schedule.lead
            if left is not None:
                sources = [source for source, target in schedule.links if target == island]
                begins = max([begins, *ends[left - 1, sources]])
            if together > 0:
                begins = max(begins, ends[together - 1].max())
            ends[generation, island] = free[island % processes] = begins + steps[island]
    return float(ends[-1].max())


def main() -> None:
    """Measure all, and print the table."""
    options = parser(__doc__)
    options.add_argument("--most", type=int, default=max(ISLANDS), metavar="ISLANDS")
    chosen = options.parse_args()
    rows: list[Row] = []
    details: dict[str, Any] = {"plate": {}, "islands": {}}
    for elements in PLATES:
        one, two = (
            isolated(plate_seconds, elements, n, timeout=TIMEOUT, method="spawn") for n in (1, 2)
        )
        details["plate"][elements] = [one, two]
        tiles = f", tiled to {elements:,} elements" if elements else ""
        rows.append(
            Row(
                f"the plate{tiles}, default settings: 2 workers over 1",
                f"{one / two:.2f} times as fast ({one:.2f} s, {two:.2f} s)",
                f">= {FASTER}",
                one / two >= FASTER,
            )
        )
    for islands, least in ISLANDS.items():
        if islands > chosen.most:
            continue
        for mode in ("synchronous", "overlapped"):
            found = isolated(efficiency, islands, mode, timeout=TIMEOUT, method="spawn")
            details["islands"][f"{islands} {mode}"] = found
            name = f"{islands} islands that sleep, {mode}"
            rows.append(Row(name, f"efficiency {found:.3f}", f">= {least}", found >= least))
    publish("More workers", rows, details, chosen)


if __name__ == "__main__":
    main()
