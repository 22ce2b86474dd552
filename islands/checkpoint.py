"""Checkpoint: a run as it is between two rounds or generations, from where it can go on.

What is promised: a checkpoint is there whole or not at all, the one before it stays beside it, and
one that is damaged or of another run is not used. What goes on from it ends with the mesh of the
run that was never stopped. Its size is that of the mesh, or of the population: each round of the
procedure is written once, to a stream of its own.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from islands.milestones import milestone_arrays, milestone_figures, read_milestone
from islands.procedure import Round, read_round, round_document
from islands.search import SearchState, State
from meshops.errors import InputError
from meshops.mesh import ShellMesh, digest_of
from meshops.operations import ALL_OPERATIONS

if TYPE_CHECKING:
    import pyarrow as pa

FORMAT = "meshipelago checkpoint 2"

CHECKPOINT, BEFORE, ROUNDS = "checkpoint.arrow", "checkpoint-before.arrow", "rounds.arrow"

_MESHES = ("mesh", "best")
_SEPARATE = {*_MESHES, "rounds", "credit"}
_FIGURES = [field.name for field in fields(SearchState) if field.name not in _SEPARATE]


class Checkpoints:
    """Writes the state of a run down whenever it has changed.

    Parameters
    ----------
    folder : Path
        Of the run.
    run : str
        What the answer of the run depends on, as a digest.
    state : SearchState, Milestone or None
        What the run goes on from; its rounds are written anew, without those that it has dropped.
    """

    def __init__(self, folder: Path, run: str, state: State | None = None) -> None:
        self._folder = folder
        self._run = run
        self._rounds: tuple[Round, ...] = ()
        self._entries = 0
        if state is None:
            self.discard()
            self._start_stream(folder / ROUNDS)
            return
        unfinished = folder / f".{ROUNDS}.part"
        self._start_stream(unfinished)
        if isinstance(state, SearchState):
            self._append(state.rounds)
        unfinished.replace(folder / ROUNDS)
        self._write(state)
        (folder / BEFORE).unlink(missing_ok=True)

    def keep(self, state: State) -> None:
        """Write a state down; the last one becomes the one before it."""
        if isinstance(state, SearchState):
            self._append(state.rounds)
        self._write(state)

    def close(self) -> None:
        """End the stream of rounds; the files stay."""
        with self._file:
            self._stream.close()

    def discard(self) -> None:
        """Remove the files: the run is over."""
        for name in (CHECKPOINT, BEFORE, ROUNDS):
            (self._folder / name).unlink(missing_ok=True)

    def _start_stream(self, path: Path) -> None:
        import pyarrow as pa

        self._schema = pa.schema([("number", pa.int64()), ("round", pa.string())])
        self._file = path.open("wb")
        self._stream = pa.ipc.new_stream(self._file, self._schema)

    def _append(self, rounds: tuple[Round, ...]) -> None:
        """Write the rounds that are not there yet; those that were dropped are written over."""
        import pyarrow as pa

        same = 0
        for one, other in zip(rounds, self._rounds, strict=False):
            if one is not other:
                break
            same += 1
        for number in range(same, len(rounds)):
            text = json.dumps(round_document(rounds[number], ALL_OPERATIONS))
            self._stream.write_batch(pa.record_batch([[number], [text]], schema=self._schema))
            self._entries += 1
        self._rounds = rounds
        self._file.flush()
        os.fsync(self._file.fileno())

    def _write(self, state: State) -> None:
        """Write a checkpoint whole; the one that was there becomes the one before it."""
        import pyarrow as pa

        heading: dict[str, Any] = {"format": FORMAT, "run": self._run}
        if isinstance(state, SearchState):
            heading |= {
                "figures": {name: getattr(state, name) for name in _FIGURES},
                "rounds": len(state.rounds),
                "entries": self._entries,
            }
            arrays = dict(_arrays(state))
        else:
            heading |= {"milestone": milestone_figures(state)}
            arrays = milestone_arrays(state)
        rows = [
            ("heading", np.frombuffer(json.dumps(heading).encode(), np.uint8)),
            *arrays.items(),
        ]
        table = pa.table(
            {
                "name": [name for name, _ in rows],
                "dtype": [array.dtype.str for _, array in rows],
                "shape": pa.array([array.shape for _, array in rows], pa.list_(pa.int64())),
                "data": pa.array([array.tobytes() for _, array in rows], pa.large_binary()),
            }
        )
        table = table.replace_schema_metadata({"digest": digest_of(rows)})
        path = self._folder / CHECKPOINT
        unfinished = path.with_name(f".{CHECKPOINT}.part")
        try:
            with unfinished.open("wb") as file:
                with pa.ipc.new_file(file, table.schema) as writer:
                    writer.write_table(table)
                file.flush()
                os.fsync(file.fileno())
            if path.exists():
                path.replace(self._folder / BEFORE)
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)


def latest_state(folder: Path, run: str) -> tuple[State | None, str]:
    """Read the last state of a run, or the one before it where the last is damaged.

    Returns the state, None where there is none yet, and a sentence on what was damaged, or "".

    Raises InputError where the folder is of another run or all checkpoints are damaged.
    """
    sentences: list[str] = []
    for name in (CHECKPOINT, BEFORE):
        path = folder / name
        if not path.exists():
            continue
        try:
            return _read(path, folder / ROUNDS, run), " ".join(sentences)
        except _DamagedError as error:
            sentences.append(f"{path} is damaged ({error}).")
    if sentences:
        raise InputError(" ".join([*sentences, "Start the run anew with optimize --overwrite."]))
    return None, ""


_DAMAGE = (ArithmeticError, LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError)
"""What bytes that are not as they were written make pyarrow, numpy and json raise."""


def _first_line(error: BaseException) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)


class _DamagedError(Exception):
    """A file is not as it was written."""


def _read(path: Path, stream: Path, run: str) -> State:
    import pyarrow as pa

    try:
        with path.open("rb") as file:
            table = pa.ipc.open_file(file).read_all()
        # lengths that are wrong would be followed beyond the end of the data
        table.validate(full=True)
        rows = [
            (row["name"], np.frombuffer(row["data"], row["dtype"]).reshape(row["shape"]))
            for row in table.to_pylist()
        ]
        wanted = (table.schema.metadata or {}).get(b"digest", b"").decode()
        heading = json.loads(bytes(rows[0][1]))
    except _DAMAGE as error:
        raise _DamagedError(_first_line(error)) from None
    if digest_of(rows) != wanted:
        raise _DamagedError("its digest differs")
    if heading["format"] != FORMAT:
        raise InputError(
            f"{path} is of the format {heading['format']!r}, not {FORMAT!r}: resume the run with "
            "the version of meshipelago that wrote it."
        )
    if heading["run"] != run:
        raise InputError(
            f"{path} belongs to another run: the mesh, the criteria or a setting is another one "
            "now; start anew with optimize."
        )
    arrays = dict(rows[1:])
    if "milestone" in heading:
        return read_milestone(heading["milestone"], arrays)
    rounds = _read_rounds(stream, heading["entries"], heading["rounds"])
    mesh = _mesh(arrays, "mesh")
    best = _mesh(arrays, "best") if "best.points" in arrays else mesh
    known: dict[str, Any] = heading["figures"]
    return SearchState(mesh=mesh, best=best, rounds=rounds, credit=arrays["credit"].copy(), **known)


def _read_rounds(path: Path, entries: int, count: int) -> tuple[Round, ...]:
    """Read the first entries of the stream; of those of one round the last one counts."""
    import pyarrow as pa

    found: dict[int, str] = {}
    try:
        with path.open("rb") as file:
            for number, batch in enumerate(_batches(pa.ipc.open_stream(file))):
                if number == entries:
                    break
                batch.validate(full=True)
                (row,) = batch.to_pylist()
                found[row["number"]] = row["round"]
        return tuple(read_round(json.loads(found[i]), ALL_OPERATIONS) for i in range(count))
    except _DAMAGE as error:
        raise _DamagedError(f"{path.name}: {_first_line(error)}") from None


def _batches(reader: pa.ipc.RecordBatchStreamReader) -> Iterator[pa.RecordBatch]:
    """Batches up to where a process that was killed has left the stream."""
    import pyarrow as pa

    try:
        yield from reader
    except (pa.ArrowInvalid, OSError):
        return


def _arrays(state: SearchState) -> Iterator[tuple[str, NDArray[Any]]]:
    yield "credit", state.credit
    for name in _MESHES:
        mesh: ShellMesh = getattr(state, name)
        if name == "best" and state.best is state.mesh:
            continue
        for field in fields(mesh):
            yield f"{name}.{field.name}", getattr(mesh, field.name)


def _mesh(arrays: dict[str, NDArray[Any]], name: str) -> ShellMesh:
    return ShellMesh.build(**{f.name: arrays[f"{name}.{f.name}"] for f in fields(ShellMesh)})
