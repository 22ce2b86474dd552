"""What a large mesh costs: ``python -m benchmarks.growth [--largest N]``.

The plate is tiled to one connected mesh of up to a million elements, each tile with the same bad
places, and improved in the same number of rounds without a time limit, each size in a process of
its own. The time of a bad place should not depend on how many there are.
"""

from __future__ import annotations

import resource
import sys
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
"""One of every extent, from small subdomains to large ones."""

TIMEOUT = 6 * 3600.0


@dataclass(frozen=True)
class Trial:
    """One size.

    Attributes
    ----------
    elements, bad_before, bad_after : int
        Failed elements and trias.
    seconds : float
        To improve the mesh, without making it.
    gigabytes : float
        The most memory that the process had.
    faults : list of str
        What is wrong with the result.
    """

    elements: int
    bad_before: int
    bad_after: int
    seconds: float
    gigabytes: float
    faults: list[str]

    @property
    def milliseconds(self) -> float:
        """Time of a bad place."""
        return 1e3 * self.seconds / self.bad_before


def trial(elements: int, rounds: int) -> Trial:
    """Improve a tiled plate; the memory is that of this process."""
    warm_up()
    mesh = tiled(elements)
    done = improve(job_of("tiled plate", mesh, size=SIZE, rounds=rounds))
    return Trial(
        elements=done.before.elements,
        bad_before=done.before.failed + done.before.trias,
        bad_after=done.after.failed + done.after.trias,
        seconds=done.seconds,
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
        times = [found.milliseconds for found in trials]
        ratio = max(times) / min(times)
        limit = f"<= {LARGEST_RATIO}"
        rows.append(
            Row("slowest over fastest bad place", f"{ratio:.2f}", limit, ratio <= LARGEST_RATIO)
        )
    details = {"trials": [asdict(found) for found in trials]}
    publish("Growth of time and memory with the size of the mesh", rows, details, chosen)


def _row(found: Trial) -> Row:
    verdict = ", ".join(found.faults) or "valid"
    return Row(
        f"{found.elements:,} elements, {found.bad_before:,} bad",
        f"{found.milliseconds:.1f} ms a bad place, {found.seconds:.0f} s, {found.bad_after:,} left,"
        f" {found.gigabytes:.2f} GB, {verdict}",
        f"valid, < {LARGEST_MEMORY:g} GB",
        not found.faults and found.gigabytes < LARGEST_MEMORY,
    )


if __name__ == "__main__":
    main()
