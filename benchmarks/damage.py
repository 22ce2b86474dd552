"""One damaged input after the other: made, read, and told what became of it."""

from __future__ import annotations

import resource
import signal
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from random import Random
from types import FrameType

import numpy as np

from benchmarks.mutations import mutated
from benchmarks.sound_inputs import RUN, Sound
from islands.checkpoint import latest_state
from islands.config import load_config
from islands.replay import read_procedure
from meshops.criteria_files import load_criteria
from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.mesh import ShellMesh
from tracking.errors import TrackingError
from tracking.journal import read_journal

LIMIT = 1.0
"""Seconds for an input."""

PATIENCE = 10.0
"""Seconds after which an input is given up."""

NUDGE = 1e-3
"""How far a node is moved, over its coordinates."""

MEMORY = 4 * 2**30
"""Bytes that a process may take."""

AGAIN = 2
"""Times that a slow input is tried once more, since something else may have had the machine."""


@dataclass(frozen=True)
class Outcome:
    """What became of an input.

    Attributes
    ----------
    number : int
    kind : str
    how : 'read', 'refused', 'traceback', 'slow' or 'crash'
    why : str
        The sentence, or the exception and where it was raised.
    seconds : float
    """

    number: int
    kind: str
    how: str
    why: str
    seconds: float


class _GivenUpError(BaseException):
    """Time is up; no `except Exception` takes it."""


def damaged(sound: Sequence[Sound], seed: int, number: int) -> tuple[Sound, bytes]:
    """Return a sound input, and what is made of it."""
    random = Random(f"{seed} {number}")
    kinds = sorted({one.kind for one in sound})
    # as many of each kind, however many sound ones it has
    kind = kinds[number % len(kinds)]
    chosen = random.choice([one for one in sound if one.kind == kind])
    return chosen, mutated(chosen.data, random)


def read(sound: Sound, data: bytes, folder: Path) -> None:
    """Put an input into an empty folder and read it.

    A deck is written back, as it is and with a node moved.

    Raises whatever the reader raises.
    """
    path = folder / sound.name
    for name, other in sound.beside:
        (folder / name).write_bytes(other)
    path.write_bytes(data)
    if sound.kind.startswith("deck"):
        deck = read_deck(path)
        deck.write(deck.mesh, folder / "out" / sound.name)
        deck.write(nudged(deck.mesh), folder / "nudged" / sound.name)
    elif sound.kind == "criteria":
        load_criteria(str(path)).at(1.0)
    elif sound.kind == "procedure.json":
        read_procedure(path)
    elif sound.kind == "config.toml":
        load_config(path, {})
    elif sound.kind == "journal":
        read_journal(folder)
    else:
        latest_state(folder, RUN)


def nudged(mesh: ShellMesh) -> ShellMesh:
    """Move a node that may move, so that not all stays as it was."""
    points = mesh.points.copy()
    points[np.flatnonzero(~mesh.locked_nodes)[:1]] *= 1.0 + NUDGE
    arrays = {field.name: getattr(mesh, field.name) for field in fields(mesh)}
    return ShellMesh.build(**(arrays | {"points": points}))


def outcome_of(sound: Sound, data: bytes, number: int, folder: Path) -> Outcome:
    """Read an input and tell what became of it; a slow one is tried again."""
    best = _tried(sound, data, number, folder)
    for _ in range(AGAIN):
        if best.seconds <= LIMIT or best.how in ("traceback", "crash"):
            break
        again = _tried(sound, data, number, folder)
        best = min(best, again, key=lambda outcome: outcome.seconds)
    if best.seconds > LIMIT and best.how in ("read", "refused"):
        return Outcome(number, sound.kind, "slow", f"{best.how}: {best.why}", best.seconds)
    return best


def batch(sound: Sequence[Sound], seed: int, numbers: Sequence[int], folder: str) -> list[Outcome]:
    """Read inputs one after the other in this process, which may take only so much memory."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("ignore")
    found = []
    for number in numbers:
        chosen, data = damaged(sound, seed, number)
        found.append(outcome_of(chosen, data, number, Path(folder)))
    return found


def _tried(sound: Sound, data: bytes, number: int, folder: Path) -> Outcome:
    started = time.perf_counter()
    how, why = "read", ""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        started = time.perf_counter()
        try:
            with _given_up_after(PATIENCE):
                read(sound, data, Path(place))
        except (InputError, TrackingError) as error:
            how, why = "refused", str(error)
            if "\n" in why.strip():
                how, why = "traceback", f"a sentence of several lines: {why!r}"
        except _GivenUpError:
            how, why = "slow", f"given up after {PATIENCE:g} s"
        except Exception as error:  # this is what is looked for
            frame = traceback.extract_tb(error.__traceback__)[-1]
            at = f"{Path(frame.filename).name}:{frame.lineno}"
            how, why = "traceback", f"{type(error).__name__} at {at}: {error}"[:200]
        seconds = time.perf_counter() - started
    return Outcome(number, sound.kind, how, why, seconds)


@contextmanager
def _given_up_after(seconds: float) -> Iterator[None]:
    def give_up(_signal: int, _frame: FrameType | None) -> None:
        raise _GivenUpError

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
