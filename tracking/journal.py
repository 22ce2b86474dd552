"""Journal: every event of a run in its folder, the source of truth about the run."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from types import GenericAlias
from typing import Any, get_type_hints

from tracking.errors import TrackingError
from tracking.events import (
    Event,
    FaultReport,
    GenerationReport,
    MeshSummary,
    MigrationReport,
    RoundReport,
    RunFinished,
    RunStarted,
)

JOURNAL = "journal.arrow"
HISTORY = "history.parquet"
MIGRATIONS = "migrations.parquet"

# One Arrow IPC stream with the columns kind and payload (JSON), a batch an event. One stream keeps
# the order of events of different kinds; JSON lets a kind gain a column without a new file format
# and gives floats back bit for bit. Typed columns are what the Parquet files are for.
_KINDS: dict[str, type[Event]] = {
    kind.__name__: kind
    for kind in (
        RunStarted,
        GenerationReport,
        MigrationReport,
        FaultReport,
        RoundReport,
        RunFinished,
    )
}


class Journal:
    """Writes every event down at once; on ``close`` makes the tables of the run.

    An event is handed to the operating system before ``record`` returns: a process that is killed
    loses nothing that it recorded. An older journal in the folder is replaced, with its tables; of
    a run that is resumed it begins with the events that are `known`.

    ``close`` writes ``history.parquet``, a row a ``GenerationReport``, and, where individuals have
    migrated, ``migrations.parquet``; ``journal.arrow`` stays. Rows are in the order of generation
    and island: the same events make the same bytes, in whatever order islands have reported.
    """

    def __init__(self, folder: Path, known: Sequence[Event] = ()) -> None:
        import pyarrow as pa

        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for name in (HISTORY, MIGRATIONS):
            (folder / name).unlink(missing_ok=True)
        self._schema = pa.schema([("kind", pa.string()), ("payload", pa.string())])
        unfinished = folder / f".{JOURNAL}.part"
        self._file = unfinished.open("wb")
        self._stream = pa.ipc.new_stream(self._file, self._schema)
        for event in known:
            self.record(event)
        self._file.flush()
        unfinished.replace(folder / JOURNAL)

    def record(self, event: Event) -> None:
        """Append the event and flush."""
        import pyarrow as pa

        row = [[type(event).__name__], [json.dumps(event, default=_plain)]]
        self._stream.write_batch(pa.record_batch(row, schema=self._schema))
        self._file.flush()

    def keep(self, paths: Sequence[Path]) -> None:
        """Do nothing: the files are in the run folder already."""

    def close(self) -> None:
        """End the stream and write the tables."""
        if self._file.closed:
            return
        with self._file:
            self._stream.close()
            self._file.flush()
            os.fsync(self._file.fileno())
        write_tables(self._folder)


def read_journal(folder: Path) -> list[Event]:
    """Read the events of a run, also of one that was killed in the middle of a word.

    Raises
    ------
    TrackingError
        Where the folder has no journal, or one of a later version of meshipelago.
    """
    import pyarrow as pa

    path = folder / JOURNAL
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise TrackingError(
            f"{folder} has no {JOURNAL}: name a folder that a run has written."
        ) from None
    events: list[Event] = []
    try:
        for batch in pa.ipc.open_stream(content):
            # lengths that are wrong would be followed beyond the end of the data
            batch.validate(full=True)
            events += [_decoded(row["kind"], row["payload"]) for row in batch.to_pylist()]
    except (pa.ArrowException, OSError, MemoryError):
        pass  # the stream is cut off here, as a killed process leaves it
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise TrackingError(
            f"{path} is damaged ({error}): remove it, or start the run anew."
        ) from None
    except (KeyError, TypeError) as error:
        raise TrackingError(
            f"{path} holds an event that this version of meshipelago does not know ({error}): "
            "read it with the version that wrote it."
        ) from None
    return events


def write_tables(folder: Path) -> None:
    """Make ``history.parquet`` and ``migrations.parquet`` of the journal in the folder.

    ``Journal.close`` does this; call it for a run that was killed. Raises TrackingError as
    ``read_journal`` does.
    """
    events = read_journal(folder)
    reports = [event for event in events if isinstance(event, GenerationReport)]
    migrations = [event for event in events if isinstance(event, MigrationReport)]
    reports.sort(key=lambda report: (report.generation, report.island))
    migrations.sort(
        key=lambda migration: (migration.generation, migration.source, migration.target)
    )
    _write_table(folder / HISTORY, GenerationReport, reports)
    if migrations:
        _write_table(folder / MIGRATIONS, MigrationReport, migrations)


def _write_table(path: Path, kind: type[Event], rows: Sequence[Event]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    types = {int: pa.int64(), float: pa.float64(), str: pa.string()}
    columns = {
        name: pa.array(
            [getattr(row, name) for row in rows],
            pa.list_(pa.int64()) if isinstance(hint, GenericAlias) else types[hint],
        )
        for name, hint in get_type_hints(kind).items()
    }
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with unfinished.open("wb") as file:
            pq.write_table(pa.table(columns), file)
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def _plain(value: Any) -> Any:
    """Give JSON what it does not know: mappings, dataclasses and numpy's scalars."""
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "item"):
        return value.item()
    return {field.name: getattr(value, field.name) for field in fields(value)}


def _decoded(kind: str, payload: str) -> Event:
    values = json.loads(payload)
    for name in ("before", "after"):
        if values.get(name) is not None:
            values[name] = MeshSummary(**values[name])
    for name in ("genome", "told", "worse"):
        if name in values:
            values[name] = tuple(values[name])
    return _KINDS[kind](**values)
