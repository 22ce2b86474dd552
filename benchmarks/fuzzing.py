"""Damaged decks, criteria, procedures, configurations and checkpoints: what is said to each.

Each input is a sound one that is damaged in one to three ways. It is to be read, or refused with a
sentence, within a second; a deck that is read is written too, as it is and with a node moved. An
input is known by its number and the seed: `--show NUMBER` makes it again and shows what becomes of
it.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from functools import partial
from pathlib import Path

from benchmarks.damage import LIMIT, Outcome, batch, damaged, read
from benchmarks.isolation import IsolatedError, isolated
from benchmarks.report import Row, parser, publish
from benchmarks.sound_inputs import Sound, sound_inputs
from meshops.errors import InputError
from tracking.errors import TrackingError

INPUTS = 100_000

TOGETHER = 250
"""Inputs in one process."""


def fuzz(sound: Sequence[Sound], seed: int, count: int, folder: Path) -> Iterator[Outcome]:
    """Read inputs in processes of their own; one that ends a process is found and told."""
    multiprocessing.set_forkserver_preload([batch.__module__])
    batches = [range(i, min(i + TOGETHER, count)) for i in range(0, count, TOGETHER)]
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        for outcomes in threads.map(partial(_isolated_batch, sound, seed, folder), batches):
            yield from outcomes


def _isolated_batch(
    sound: Sequence[Sound], seed: int, folder: Path, numbers: range
) -> list[Outcome]:
    try:
        return isolated(
            batch, sound, seed, list(numbers), str(folder), timeout=len(numbers) * LIMIT + 60.0
        )
    except IsolatedError as error:
        if len(numbers) == 1:
            chosen, _ = damaged(sound, seed, numbers[0])
            return [Outcome(numbers[0], chosen.kind, "crash", str(error), 0.0)]
    half = len(numbers) // 2
    return [
        *_isolated_batch(sound, seed, folder, numbers[:half]),
        *_isolated_batch(sound, seed, folder, numbers[half:]),
    ]


def main() -> None:
    """Read as many damaged inputs as asked, and print the table."""
    options = parser(__doc__)
    options.add_argument("--decks", type=int, default=INPUTS, metavar="N", help="inputs in all")
    options.add_argument("--seed", type=int, default=1, metavar="S")
    options.add_argument("--show", type=int, metavar="NUMBER", help="one input, in this process")
    chosen = options.parse_args()
    if chosen.show is not None:
        _show(chosen.seed, chosen.show)
        return
    with tempfile.TemporaryDirectory() as folder:
        found = list(fuzz(sound_inputs(), chosen.seed, chosen.decks, Path(folder)))
    rows = []
    for kind in sorted({outcome.kind for outcome in found}):
        some = [outcome for outcome in found if outcome.kind == kind]
        how = Counter(outcome.how for outcome in some)
        bad = how["traceback"] + how["crash"] + how["slow"]
        measured = (
            f"{len(some):,}: {how['read']:,} read, {how['refused']:,} refused, "
            f"{how['traceback'] + how['crash']:,} tracebacks, {how['slow']:,} slow; "
            f"slowest {max(outcome.seconds for outcome in some):.2f} s"
        )
        rows.append(Row(kind, measured, f"no traceback, none over {LIMIT:g} s", not bad))
    target = f"{INPUTS:,}" if chosen.decks == INPUTS else ""
    rows.append(Row("all", f"{len(found):,} inputs", target, met=True))
    bad_ones = [outcome for outcome in found if outcome.how not in ("read", "refused")]
    for outcome in bad_ones:
        print(f"{outcome.number} ({outcome.kind}): {outcome.how}: {outcome.why}", file=sys.stderr)
    details = {"seed": chosen.seed, "bad": [asdict(outcome) for outcome in bad_ones]}
    publish("Damaged inputs", rows, details, chosen)


def _show(seed: int, number: int) -> None:
    sound, data = damaged(sound_inputs(), seed, number)
    print(f"{sound.kind}, made of {sound.name}:")
    print(data.decode("latin-1"))
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        try:
            read(sound, data, Path(folder))
            print("read", end="")
        except (InputError, TrackingError) as error:
            print(f"refused: {error}", end="")
        print(f" in {time.perf_counter() - started:.3f} s")


if __name__ == "__main__":
    main()
