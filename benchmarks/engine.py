"""Cost of the engine itself: what an evaluation takes where the fitness costs next to nothing.

Ours are the individuals of operation GAs, through all layers: islands in a ring, procedures of ten
operations and their common beginnings, operation GAs of ten individuals and ten generations, edits
and digests of meshes. The peers evolve individuals of ten genes, in the same run.
"""

from __future__ import annotations

import time
from typing import Any

from benchmarks.engine_peers import PEERS, measured
from benchmarks.isolation import isolated
from benchmarks.report import Row, parser, publish
from benchmarks.trivial import trivial_schedule, trivial_work
from islands.archipelago import Archipelago, Executor, Milestone
from islands.executors.local import LocalExecutor

PAYLOADS = (0, 1, 10)
"""Megabytes that the problem carries."""

HERE, ON_RAY = 0.05, 0.1
"""Milliseconds an evaluation, at the most."""

EVEN = 1.5
"""How much dearer an evaluation may be with another payload, or after many generations."""

EARLY, LATE, WINDOW = 10, 5000, 200
"""Generations between which the cost must not grow, and how many are timed there."""

PROCESSES = 2
TIMEOUT = 300.0
MEGABYTE = 10**6


def milliseconds(executor: Executor, payload: int, generations: int = 12) -> float:
    """Return what an evaluation takes on two islands; the first generation is the start."""
    work = trivial_work(payload)
    schedule = trivial_schedule(2, individuals=10, genes=10, generations=generations)
    marks = [
        (time.perf_counter(), _performed(milestone))
        for milestone in executor.evolve([Archipelago(0, work, schedule)])
    ]
    (started, before), (ended, after) = marks[0], marks[-1]
    return 1e3 * (ended - started) / (after - before)


def here(payload: int) -> float:
    """Measure ours in one process."""
    milliseconds(LocalExecutor(), 0, 2)
    return milliseconds(LocalExecutor(), payload)


def on_ray(payload: int) -> float:
    """Measure ours on Ray."""
    from islands.executors.ray import RayExecutor

    executor = RayExecutor(workers=PROCESSES)
    try:
        milliseconds(executor, 0, 2)
        return milliseconds(executor, payload)
    finally:
        executor.close()


def over_generations() -> tuple[float, float]:
    """Return milliseconds a generation in one process, early and late in a long run."""
    work = trivial_work(0)
    schedule = trivial_schedule(2, individuals=4, genes=4, generations=LATE)
    at = [
        time.perf_counter() for _ in LocalExecutor().evolve([Archipelago(0, work, schedule)])
    ]  # fmt: skip
    early, late = at[EARLY + WINDOW] - at[EARLY], at[LATE] - at[LATE - WINDOW]
    return 1e3 * early / WINDOW, 1e3 * late / WINDOW


def _performed(milestone: Milestone) -> int:
    return sum(state.performed for state in milestone.islands)


def main() -> None:
    """Measure all, and print the table."""
    options = parser(__doc__).parse_args()
    rows: list[Row] = []
    details: dict[str, Any] = {}
    for name, call, most in (
        ("ours, one process", here, HERE),
        ("ours, Ray", on_ray, ON_RAY),
    ):
        found = [
            isolated(call, MEGABYTE * size, timeout=TIMEOUT, method="spawn") for size in PAYLOADS
        ]
        details[name] = found
        rows.append(Row(name, _words(found), f"< {most} ms", max(found) < most))
        ratio = max(found) / min(found)
        even = f"{ratio:.2f} times from the cheapest to the dearest"
        rows.append(Row(f"{name}: payloads", even, f"<= {EVEN}", ratio <= EVEN))
    early, late = isolated(over_generations, timeout=TIMEOUT, method="spawn")
    details["generations"] = early, late
    grown = (
        f"{late / early:.2f} times from generation {EARLY} to {LATE} ({early:.1f}, {late:.1f} ms)"
    )
    rows.append(Row("ours, one process: generations", grown, f"<= {EVEN}", late <= EVEN * early))
    for name in PEERS:
        found = [measured(name, MEGABYTE * size, TIMEOUT) for size in PAYLOADS]
        details[name] = found
        rows.append(Row(name, _words(found), "", met=True))
    sizes = ", ".join(f"{size}" for size in PAYLOADS)
    publish(f"An evaluation in ms, {sizes} MB carried by the problem", rows, details, options)


def _words(found: list[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in found)


if __name__ == "__main__":
    main()
