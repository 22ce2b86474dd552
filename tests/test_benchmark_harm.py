"""The benchmark of harm: every deck has a row, whatever becomes of it."""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from os import _exit
from pathlib import Path

import pytest

from benchmarks.harm import Outcome, Worker, measure, table, totals
from benchmarks.harm_decks import Source, of_files
from benchmarks.structured import structured
from meshops.criteria import PAPER
from meshops.formats import write_mesh
from meshops.harm import compare
from tests.meshes import sheet


@dataclass(frozen=True)
class Crashing(Source):
    def load(self):
        _exit(3)


@dataclass(frozen=True)
class Raising(Source):
    def load(self):
        raise RuntimeError("no such luck")


def harm(before, after):
    return compare(before, after, PAPER.at(1.0))


def test_a_deck_is_run_and_compared_with_what_is_written(tmp_path):
    path = tmp_path / "grid.bdf"
    write_mesh(sheet(5, 4), path)
    outcome = measure(Source("grid", path=path), "paper", 1.0)
    assert (outcome.refused, outcome.failure) == ("", "")
    assert outcome.harm.before.elements == 20
    assert outcome.complaints == ()


def test_a_deck_that_is_refused_has_a_row_with_the_reason(tmp_path):
    path = tmp_path / "empty.bdf"
    path.write_text("BEGIN BULK\nENDDATA\n")
    outcome = measure(Source("empty", path=path), "paper", 1.0)
    assert "no linear shell" in outcome.refused
    assert outcome.complaints == ()
    assert "no linear shell" in table([outcome])
    assert totals([outcome])["refused"] == 1


def test_a_run_that_crashes_or_raises_has_a_row_and_the_next_one_runs():
    worker = Worker(lambda: ProcessPoolExecutor(1, mp_context=get_context("fork")))
    try:
        raised = worker.measure(Raising("luckless"), "paper", 1.0)
        crashed = worker.measure(Crashing("doomed"), "paper", 1.0)
        after = worker.measure(Raising("another"), "paper", 1.0)
    finally:
        worker.close()
    assert "no such luck" in raised.failure
    assert crashed.failure == "the process crashed"
    assert "no such luck" in after.failure
    text = table([raised, crashed, after])
    assert [name in text for name in ("luckless", "doomed", "another")] == [True] * 3
    assert totals([raised, crashed, after])["worse"] == 3


def test_what_is_worse_stands_below_its_row():
    fine = Outcome("fine", "paper", 0, harm(sheet(4, 4), sheet(4, 4)))
    worse = Outcome("worse", "paper", 0, harm(sheet(4, 4), sheet(4, 4, trias=0.9)))
    lines = table([fine, worse]).splitlines()
    assert lines[1].startswith("fine")
    assert lines[2].startswith("worse")
    assert all(line.startswith("    ") for line in lines[3:])
    assert len(lines) > 4
    assert totals([fine, worse])["worse"] == 1


def test_what_was_planted_is_counted_as_repaired():
    deck = next(d for d in map(structured, range(20)) if d.planted)
    again = Outcome(deck.name, "paper", deck.planted, harm(deck.mesh, deck.mesh))
    counts = totals([again])
    assert counts["decks with planted faults"] == 1
    assert counts["their faults of shape before"] == counts["their faults of shape after"] > 0


@pytest.mark.skipif(not Path("../shared/faults").is_dir(), reason="the faults are not here")
def test_every_deck_of_a_folder_is_found():
    names = [source.name for source in of_files(Path("../shared/faults"))]
    assert "faults/nastran/needles_from_clean_rows.bdf" in names
    assert "faults/FAULTS.md" not in names
