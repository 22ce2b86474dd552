"""Tests of what is made of events for eyes: the overview, the note, progress, the fan-out."""

import io
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracking.events import (
    FaultReport,
    GenerationReport,
    MeshSummary,
    RoundReport,
    RunFinished,
    RunStarted,
)
from tracking.fanout import Fanout
from tracking.metrics import Metrics
from tracking.overview import ALL_ISLANDS, Overview
from tracking.progress import ProgressDisplay, ProgressLines, progress
from tracking.report import NOTE_LENGTH, markdown_report

BEFORE = MeshSummary(
    elements=120,
    quads=109,
    trias=11,
    failed=12,
    compound_qi=3.21,
    failed_by_shape=8,
    failed_by_size=4,
)
AFTER = MeshSummary(elements=98, quads=94, trias=4, failed=0, compound_qi=0.5)
START = RunStarted("plate", "id", 7, "local", 2, {"islands": 2}, BEFORE)
END = RunFinished(
    "finished", "all generations done", AFTER, 96.0, 12.3, 1200, 900, "0 1-2\n2 -", "abc"
)

ROUND = RoundReport(
    *(0, 3, 12, 7, 4, 9, 6, 8, 4200, 2100, 33.35, {"remesh": 0.25, "nothing": 0.75}),
    number=6,
    step=5,
)


def report(island=1, generation=3, best=90.0, best_so_far=92.0):
    return GenerationReport(
        island, generation, best, 80.0, 70.0, best_so_far, 8, 4, 1.234, 1200, 900, 12.34, "0 1-2"
    )


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_individuals_that_could_not_be_scored_are_told_with_their_reason():
    stream = io.StringIO()
    ProgressLines(stream).record(FaultReport(3, 1, "it crashed"))
    assert "generation 3  island 1  not scored: it crashed" in stream.getvalue()


def test_a_generation_is_summed_up_when_all_islands_have_reported_it():
    # each report counts the evaluations of all islands: they are not to count again
    overview = Overview(2)
    first = replace(report(0, 0, best=90.0, best_so_far=95.0), mean=60.0, worst=10.0, trias=5)
    second = replace(report(1, 0, best=91.0, best_so_far=91.0), seconds=20.0)
    assert overview.add(first) == []
    (summed,) = overview.add(second)
    assert summed == replace(
        first,
        island=ALL_ISLANDS,
        best=91.0,
        mean=70.0,
        worst=10.0,
        seconds=20.0,
    )
    assert overview.rest() == []


def test_a_later_generation_does_not_wait_for_a_slow_island():
    overview = Overview(2)
    assert overview.add(report(0, 0, best_so_far=90.0)) == []
    (summed,) = overview.add(report(0, 1, best_so_far=91.0))
    assert summed.generation == 0
    assert overview.add(report(1, 0, best_so_far=99.0)) == []  # late, but it counts for the next
    (summed,) = overview.rest()
    assert (summed.generation, summed.best_so_far, summed.evaluations) == (1, 99.0, 1200)


@given(
    st.integers(1, 4).flatmap(
        lambda islands: st.tuples(
            st.just(islands),
            st.lists(
                st.tuples(st.integers(0, islands - 1), st.integers(0, 5), st.integers(0, 9)),
                max_size=20,
            ),
        )
    )
)
def test_summaries_come_once_a_generation_and_in_order(case):
    islands, told = case
    overview = Overview(islands)
    summed = []
    for island, generation, fitness in told:
        summed += overview.add(report(island, generation, best=fitness))
    summed += overview.rest()
    generations = [one.generation for one in summed]
    assert generations == sorted(set(generations))
    assert set(generations) <= {generation for _, generation, _ in told}
    if told:
        assert max(generations) == max(generation for _, generation, _ in told)


def test_metrics_of_a_run():
    metrics = Metrics()
    points = list(metrics.points(START, 1))
    assert {(p.island, p.key, p.value, p.step) for p in points} == {
        (ALL_ISLANDS, "before/elements", 120.0, 0),
        (ALL_ISLANDS, "before/quads", 109.0, 0),
        (ALL_ISLANDS, "before/trias", 11.0, 0),
        (ALL_ISLANDS, "before/failed", 12.0, 0),
        (ALL_ISLANDS, "before/failed_by_shape", 8.0, 0),
        (ALL_ISLANDS, "before/failed_by_size", 4.0, 0),
        (ALL_ISLANDS, "before/compound_qi", 3.21, 0),
    }
    points = list(metrics.points(report(), 2))
    assert {(p.island, p.timestamp, p.step) for p in points} == {(1, 2, 3)}
    assert {p.key: p.value for p in points} == {
        "fitness/best": 90.0,
        "fitness/mean": 80.0,
        "fitness/worst": 70.0,
        "fitness/best_so_far": 92.0,
        "mesh/trias": 8.0,
        "mesh/failed": 4.0,
        "mesh/compound_qi": 1.234,
    }
    points = list(metrics.points(ROUND, 3))
    assert {(p.island, p.timestamp, p.step) for p in points} == {(ALL_ISLANDS, 3, 5)}
    assert {p.key: p.value for p in points} == {
        "round/places": 12.0,
        "round/changed": 7.0,
        "round/solved": 4.0,
        "round/rings": 3.0,
        "round/failed": 9.0,
        "round/trias": 6.0,
        "round/irregular": 8.0,
        "rate/remesh": 0.25,
        "rate/nothing": 0.75,
    }
    points = list(metrics.points(END, 4))
    assert {p.island for p in points} == {ALL_ISLANDS}
    assert {(p.key, p.value) for p in points} >= {("fitness/best", 90.0), ("after/failed", 0.0)}


def test_the_last_values_of_a_run_are_those_of_its_result():
    metrics = Metrics()
    points = [p for event in (START, report(), ROUND, END) for p in metrics.points(event, 1)]
    last = {p.key: p.value for p in sorted(points, key=lambda p: p.step) if p.island == ALL_ISLANDS}
    assert last["fitness/best_so_far"] == END.fitness
    assert (last["mesh/failed"], last["mesh/trias"]) == (AFTER.failed, AFTER.trias)
    assert last["mesh/compound_qi"] == AFTER.compound_qi
    assert (last["cost/evaluations"], last["cost/known_before"]) == (1200, 0.25)
    assert last["cost/seconds"] == END.seconds


def test_what_a_run_costs_is_counted_once():
    metrics = Metrics()
    events = (START, report(0, 0), report(1, 0), replace(report(0, 1), evaluations=1300), END)
    points = [p for event in events for p in metrics.points(event, 1)]
    costs = [p for p in points if p.key == "cost/evaluations"]
    assert {p.island for p in costs} == {ALL_ISLANDS}
    assert [p.value for p in costs] == [1200, 1300, 1200]


def test_note_tells_the_mesh_before_and_after_and_the_procedure():
    note = markdown_report(replace(START, note="A *plate*."), END)
    assert note.startswith("A *plate*.")
    assert "| failed elements | 12 | 0 |" in note
    assert "| compound Q.I. | 3.21 | 0.5 |" in note
    assert note.endswith("```\n0 1-2\n2 -\n```")
    assert "| trias | 11 |  |" in markdown_report(START)


@given(st.integers(0, 2 * NOTE_LENGTH), st.integers(0, 2 * NOTE_LENGTH))
def test_note_fits_and_its_code_block_is_closed(words, lines):
    note = markdown_report(
        replace(START, note="x" * words), replace(END, procedure="2 -\n" * lines)
    )
    assert len(note) <= NOTE_LENGTH
    assert note.count("```") % 2 == 0


def test_lines_of_a_run():
    stream = io.StringIO()
    lines = progress(stream)
    assert isinstance(lines, ProgressLines)
    for event in (START, report(), ROUND, END):
        lines.record(event)
    lines.close()
    assert stream.getvalue().splitlines() == [
        "plate  seed 7  2 islands  local  before: 120 elements  failed 12 (8 by shape, 4 by size "
        "alone)  trias 11  Q.I. 3.21",
        "generation 3  island 1  fitness 92.000  failed 4  trias 8  Q.I. 1.23  evaluations 1200  "
        "12.3 s",
        "round 6  12 places of 3 rings  7 better, 4 without a fault  failed 9  trias 6  "
        "irregular 8  33.4 s",
        "finished: all generations done  fitness 96.000  evaluations 1200  12.3 s",
    ]


def test_terminal_gets_a_table_with_a_row_an_island(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "120")
    stream = Terminal()
    display = progress(stream)
    assert isinstance(display, ProgressDisplay)
    display.record(replace(START, name="[plate]"))
    display.record(report(island=1, generation=3))
    display.record(report(island=0, generation=2))
    display.record(report(island=1, generation=4))
    display.record(ROUND)
    display.record(END)
    display.close()
    display.close()
    last = stream.getvalue().rpartition("[plate]")[2]
    assert "before: 120 elements  failed 12 (8 by shape, 4 by size alone)  trias 11" in last
    rows = [line.replace("│", " ").split() for line in last.splitlines() if "92.0" in line]
    assert rows == [
        ["0", "2", "92.0", "4", "8", "1.23", "1200", "12.3", "s"],
        ["1", "4", "92.0", "4", "8", "1.23", "1200", "12.3", "s"],
    ]
    assert "finished: all generations done" in last


class Spy:
    def __init__(self, *, error=None):
        self.calls = []
        self.error = error

    def record(self, event):
        self.calls.append(event)

    def keep(self, paths):
        self.calls.append(paths)

    def close(self):
        self.calls.append("close")
        if self.error is not None:
            raise self.error


def test_fanout_reaches_all_and_closes_all_whatever_one_of_them_does(tmp_path):
    spies = [Spy(), Spy(error=OSError("the disk is full")), Spy()]
    fanout = Fanout(spies)
    fanout.record(START)
    fanout.keep([tmp_path])
    with pytest.raises(OSError, match="disk"):
        fanout.close()
    assert [spy.calls for spy in spies] == [[START, [tmp_path], "close"]] * 3
