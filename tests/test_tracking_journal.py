import math
import signal
import subprocess
import sys
import tempfile
from dataclasses import fields, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracking.errors import TrackingError
from tracking.events import (
    FaultReport,
    GenerationReport,
    MeshSummary,
    MigrationReport,
    RoundReport,
    RunFinished,
    RunStarted,
)
from tracking.journal import HISTORY, JOURNAL, MIGRATIONS, Journal, read_journal, write_tables

counts = st.integers(0, 2**53)
figures = st.floats(allow_nan=False)
words = st.text(max_size=20)
summaries = st.builds(MeshSummary, counts, counts, counts, counts, figures)
reports = st.builds(
    GenerationReport,
    island=st.integers(0, 3),
    generation=st.integers(0, 9),
    best=figures,
    mean=figures,
    worst=figures,
    best_so_far=figures,
    trias=counts,
    failed=counts,
    compound_qi=figures,
    evaluations=counts,
    performed=counts,
    seconds=figures,
    procedure=st.text(st.characters(exclude_categories=["Cs"]), max_size=20),
)
migrations = st.builds(
    MigrationReport, counts, counts, counts, figures, st.lists(counts, max_size=5).map(tuple)
)
starts = st.builds(
    RunStarted,
    name=words,
    run_id=words,
    seed=counts,
    backend=words,
    islands=counts,
    settings=st.dictionaries(words, words | counts | figures | st.booleans(), max_size=3),
    before=summaries,
    note=words,
)
ends = st.builds(
    RunFinished,
    status=st.sampled_from(["finished", "interrupted", "time-limit", "failed"]),
    reason=words,
    after=st.none() | summaries,
    fitness=figures,
    seconds=figures,
    evaluations=counts,
    performed=counts,
    procedure=words,
    digest=words,
)
rounds = st.builds(
    RoundReport,
    turn=counts,
    rings=counts,
    places=counts,
    changed=counts,
    solved=counts,
    failed=counts,
    trias=counts,
    evaluations=counts,
    performed=counts,
    seconds=figures,
    rates=st.dictionaries(words, figures, max_size=3),
)
faults = st.builds(FaultReport, counts, counts, words)
events = st.lists(reports | migrations | faults | rounds | starts | ends, max_size=12)

REPORT = GenerationReport(0, 0, 9.0, 8.0, 7.0, 9.0, 3, 2, 1.5, 10, 9, 0.5, "0 1-2\n2 -")
MOVE = MigrationReport(5, 0, 1, 92.0, (2, 0, 1))


def written(folder, recorded):
    journal = Journal(folder)
    for event in recorded:
        journal.record(event)
    journal.close()
    return folder


@settings(max_examples=25, deadline=None)
@given(events)
def test_reads_back_what_was_recorded(recorded):
    with tempfile.TemporaryDirectory() as folder:
        assert read_journal(written(Path(folder), recorded)) == recorded


@settings(max_examples=30, deadline=None)
@given(st.lists(reports, max_size=12))
def test_history_holds_every_report(recorded):
    with tempfile.TemporaryDirectory() as folder:
        table = pq.read_table(written(Path(folder), recorded) / HISTORY)
    assert table.column_names == [field.name for field in fields(GenerationReport)]
    rows = [GenerationReport(**row) for row in table.to_pylist()]
    assert rows == sorted(recorded, key=lambda report: (report.generation, report.island))


@settings(max_examples=15, deadline=None)
@given(
    st.lists(reports, unique_by=lambda r: (r.generation, r.island), max_size=8).flatmap(
        lambda some: st.tuples(st.just(some), st.permutations(some))
    )
)
def test_tables_do_not_depend_on_the_order_in_which_islands_report(orders):
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
        first, second = (
            (written(Path(folder), order) / HISTORY).read_bytes()
            for folder, order in zip((one, two), orders, strict=True)
        )
    assert first == second


def test_migrations_get_a_table_only_when_there_are_any(tmp_path):
    assert not (written(tmp_path, [REPORT]) / MIGRATIONS).exists()
    rows = pq.read_table(written(tmp_path, [REPORT, MOVE]) / MIGRATIONS).to_pylist()
    assert [MigrationReport(**{**row, "genome": tuple(row["genome"])}) for row in rows] == [MOVE]


def test_a_stream_cut_off_at_any_byte_gives_the_events_before_the_cut(tmp_path):
    recorded = [REPORT, MOVE, replace(REPORT, generation=1)]
    path = written(tmp_path, recorded) / JOURNAL
    content = path.read_bytes()
    lengths = []
    for length in range(len(content) + 1):
        path.write_bytes(content[:length])
        read = read_journal(tmp_path)
        assert read == recorded[: len(read)]
        lengths.append(len(read))
    assert lengths == sorted(lengths)
    assert set(lengths) == {0, 1, 2, 3}


def test_a_killed_process_loses_nothing_that_it_recorded(tmp_path):
    program = """
import sys
from dataclasses import replace
from pathlib import Path
from tests.test_tracking_journal import REPORT
from tracking.journal import Journal
journal = Journal(Path(sys.argv[1]))
for generation in range(1_000_000):
    journal.record(replace(REPORT, generation=generation))
    print(generation, flush=True)
"""
    child = subprocess.Popen(
        [sys.executable, "-c", program, str(tmp_path)],
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parents[1],
    )
    assert child.stdout is not None
    told = [int(child.stdout.readline()) for _ in range(50)]
    child.send_signal(signal.SIGKILL)
    told += [int(line) for line in child.stdout.read().splitlines(keepends=True) if b"\n" in line]
    assert child.wait() == -signal.SIGKILL
    child.stdout.close()

    read = [event.generation for event in read_journal(tmp_path)]
    assert read == list(range(len(read)))
    assert len(read) >= len(told)
    assert not (tmp_path / HISTORY).exists()
    write_tables(tmp_path)
    assert pq.read_table(tmp_path / HISTORY)["generation"].to_pylist() == read


def test_an_older_record_in_the_folder_is_replaced_whole(tmp_path):
    written(tmp_path, [REPORT, MOVE])
    journal = Journal(tmp_path)
    assert read_journal(tmp_path) == []
    assert [path.name for path in tmp_path.iterdir()] == [JOURNAL]
    journal.close()


def test_closing_twice_is_closing_once(tmp_path):
    journal = Journal(tmp_path)
    journal.record(REPORT)
    journal.close()
    before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    journal.close()
    assert {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()} == before
    assert {path.name for path in before} == {JOURNAL, HISTORY}


def test_settings_may_be_any_mapping_and_figures_come_from_numpy(tmp_path):
    summary = MeshSummary(np.int64(4), np.int32(3), 1, 0, np.float32(0.5))
    start = RunStarted("plate", "r", 1, "local", 1, MappingProxyType({"a": np.True_}), summary)
    (read,) = read_journal(written(tmp_path, [start]))
    assert read == replace(start, settings={"a": True}, before=MeshSummary(4, 3, 1, 0, 0.5))


def test_what_is_not_a_number_is_kept(tmp_path):
    report = replace(REPORT, mean=math.nan, worst=-math.inf)
    (read,) = read_journal(written(tmp_path, [report]))
    (row,) = pq.read_table(tmp_path / HISTORY).to_pylist()
    for mean, worst in ((read.mean, read.worst), (row["mean"], row["worst"])):
        assert math.isnan(mean)
        assert worst == -math.inf


def test_a_folder_without_a_journal_is_named(tmp_path):
    with pytest.raises(TrackingError, match=str(tmp_path)):
        read_journal(tmp_path)
