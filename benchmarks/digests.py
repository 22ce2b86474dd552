"""The same seed, whoever computes it: digests of one job on all backends, killed and resumed.

A row a seed; the plate at the settings of `benchmarks.faults`.
"""

from __future__ import annotations

import signal
import sys
import tempfile
import time
from dataclasses import asdict

from benchmarks.faults import KILL_SECONDS, LEAST_KILLS, Place, Run
from benchmarks.report import Row, parser, publish

SEEDS = (1, 2, 3)
SHOWN = 8
"""Characters of a digest."""

RAY = "--backend", "ray", "--workers"


def digests(place: Place, seed: int) -> dict[str, Run]:
    """Run a seed in all ways."""
    found = {"local": place.run(f"local-{seed}", seed)}
    for workers in ("1", "2", "4"):
        found[f"Ray {workers}"] = place.run(f"ray-{workers}-{seed}", seed, *RAY, workers)
    name = f"killed-{seed}"
    killed = place.run_under_fire(name, seed, KILL_SECONDS, *RAY, "2")
    found[f"Ray 2, {killed.killed} killed"] = killed
    for title, first, then in (
        ("driver killed, resumed", (), ()),
        ("resumed on Ray", (), (*RAY, "2")),
        ("Ray's driver killed, resumed locally", (*RAY, "2"), ("--backend", "local")),
    ):
        name = f"{title}-{seed}"
        process = place.start(name, seed, *first)
        time.sleep(found["Ray 2" if first else "local"].seconds / 2.0)
        process.send_signal(signal.SIGKILL)
        process.wait()
        found[title] = place.resume(name, *then)
    return found


def main() -> None:
    """Run all seeds, and print the table."""
    options = parser(__doc__)
    options.add_argument("--seeds", type=int, default=len(SEEDS), metavar="N")
    chosen = options.parse_args()
    rows, details = [], {}
    with tempfile.TemporaryDirectory() as folder:
        place = Place.make(folder)
        for seed in SEEDS[: chosen.seeds]:
            found = digests(place, seed)
            details[str(seed)] = {title: asdict(run) for title, run in found.items()}
            shown = "  ".join(f"{title}: {run.digest[:SHOWN]}" for title, run in found.items())
            print(f"seed {seed}: {shown}", file=sys.stderr)
            kills = max(run.killed for run in found.values())
            is_one = len({run.digest for run in found.values()}) == 1
            rows.append(Row(f"seed {seed}", shown, "all equal", is_one))
            rows.append(
                Row("  workers killed", str(kills), f">= {LEAST_KILLS}", kills >= LEAST_KILLS)
            )
    publish("Digests", rows, details, chosen)


if __name__ == "__main__":
    main()
