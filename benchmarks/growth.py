"""What a large mesh costs: ``python -m benchmarks.growth [--largest N]``.

The plate is tiled to one connected mesh of up to a million elements, each tile with the same bad
places, and improved in the same number of rounds without a time limit, each size in a process of
its own. The time of a bad place should not depend on how many there are. It is that of the clock,
as a user sees it; beside it stands that of the processor, which other work on the machine hardly
changes.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from benchmarks.improving import job_of, warm_up
from benchmarks.isolation import IsolatedError, isolated
from benchmarks.report import Row, parser, publish
from benchmarks.tiling import tiled
from benchmarks.validity import faults
from islands.run import improve
from meshops.examples import SIZE

ELEMENTS = (4_000, 40_000, 400_000, 1_000_000)

LARGEST_RATIO = 1.5
"""Slowest over fastest time of a bad place."""

LARGEST_MEMORY = 4.0
"""GB at a million elements."""

ROUNDS = 5
"""Of each size alike: the first has most of the work, the others what it left."""

LEAST_SECONDS = 30.0
"""A mesh that is done sooner is improved again: in a second or two it is the machine's other work
that says how long it takes, and not the program."""

TIMEOUT = 6 * 3600.0


@dataclass(frozen=True)
class Trial:
    """One size.

    Attributes
    ----------
    elements, bad_before, bad_after : int
        Failed elements and trias.
    seconds, processor_seconds : float
        To improve the mesh, without making it; the mean of all times that it was done.
    gigabytes : float
        The most memory that the process had.
    faults : list of str
        What is wrong with the result.
    """

    elements: int
    bad_before: int
    bad_after: int
    seconds: float
    processor_seconds: float
    gigabytes: float
    faults: list[str]

    @property
    def milliseconds(self) -> float:
        """Time of a bad place."""
        return 1e3 * self.seconds / self.bad_before

    @property
    def processor_milliseconds(self) -> float:
        """Time of a bad place without what the processor did for others."""
        return 1e3 * self.processor_seconds / self.bad_before


def trial(elements: int, rounds: int) -> Trial:
    """Improve a tiled plate; the memory is that of this process."""
    warm_up()
    mesh = tiled(elements)
    job = job_of("tiled plate", mesh, size=SIZE, rounds=rounds)
    before = time.process_time()
    runs = [improve(job)]
    while sum(run.seconds for run in runs) < LEAST_SECONDS:
        runs.append(improve(job))
    processor_seconds = (time.process_time() - before) / len(runs)
    done = runs[0]
    return Trial(
        elements=done.before.elements,
        bad_before=done.before.failed + done.before.trias,
        bad_after=done.after.failed + done.after.trias,
        seconds=sum(run.seconds for run in runs) / len(runs),
        processor_seconds=processor_seconds,
        gigabytes=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2,
        faults=faults(mesh, done.mesh),
    )


def main() -> None:
    """Measure all sizes up to the largest."""
    options = parser(__doc__)
    options.add_argument("--largest", type=int, default=max(ELEMENTS), metavar="N")
    options.add_argument("--rounds", type=int, default=ROUNDS, metavar="N")
    chosen = options.parse_args()
    trials: list[Trial] = []
    rows: list[Row] = []
    for elements in (count for count in ELEMENTS if count <= chosen.largest):
        try:
            found = isolated(trial, elements, chosen.rounds, timeout=TIMEOUT, method="spawn")
        except IsolatedError as error:
            rows.append(Row(f"{elements:,} elements", str(error), "a result", met=False))
            continue
        trials.append(found)
        rows.append(_row(found))
        print(f"{elements:,}: {found.seconds:.0f} s", file=sys.stderr)
    if trials:
        ratio = _spread([found.milliseconds for found in trials])
        processor = _spread([found.processor_milliseconds for found in trials])
        rows.append(
            Row(
                "slowest over fastest bad place",
                f"{ratio:.2f} ({processor:.2f} by the processor's time)",
                f"<= {LARGEST_RATIO}",
                ratio <= LARGEST_RATIO,
            )
        )
    details = {"trials": [asdict(found) for found in trials]}
    publish("Growth of time and memory with the size of the mesh", rows, details, chosen)


def _spread(times: Sequence[float]) -> float:
    return max(times) / min(times)


def _row(found: Trial) -> Row:
    verdict = ", ".join(found.faults) or "valid"
    return Row(
        f"{found.elements:,} elements, {found.bad_before:,} bad",
        f"{found.milliseconds:.1f} ms a bad place ({found.processor_milliseconds:.1f} of the"
        f" processor's), {found.seconds:.0f} s, {found.bad_after:,} left,"
        f" {found.gigabytes:.2f} GB, {verdict}",
        f"valid, < {LARGEST_MEMORY:g} GB",
        not found.faults and found.gigabytes < LARGEST_MEMORY,
    )


if __name__ == "__main__":
    main()
