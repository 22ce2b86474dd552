"""Commands that begin from geometry or from what an earlier run has found."""

import json
from pathlib import Path

import pytest

from meshops.formats import read_deck, write_mesh
from tests.decks import bad_plate
from tests.test_cli import FAST, call, deck

__all__ = ["call", "deck"]


def test_a_part_is_meshed_and_repaired(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    write_mesh(bad_plate(), tmp_path / "part.stl")
    code, out, _ = call("mesh", "part.stl", "--size", 5, "--criteria", "paper", "--out", "deck.bdf")
    assert code == 0
    made = read_deck(tmp_path / "deck.bdf").mesh
    assert f"{len(made.elements)} elements" in out
    assert made.is_tria.mean() < 0.1
    assert call("mesh", "part.stl", "--out", "deck.bdf")[0] == 2


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("part.stl", "--out", "deck.xyz"), "xyz"),
        (("no.stl", "--out", "deck.bdf"), "no.stl"),
        (("no.step", "--out", "deck.bdf"), "no.step"),
        (("part.stl", "--size", "-1", "--out", "deck.bdf"), "above 0"),
    ],
)
def test_parts_that_cannot_be_meshed(call, tmp_path: Path, arguments, sentence: str) -> None:  # type: ignore[no-untyped-def]
    write_mesh(bad_plate(), tmp_path / "part.stl")
    code, _, error = call("mesh", *arguments)
    assert code == 2
    assert sentence in error
    assert "Traceback" not in error
    assert [path.name for path in tmp_path.iterdir()] == ["part.stl"]


def test_a_run_begins_from_another(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert call("optimize", deck, "--out", "first", *FAST)[0] == 0
    write_mesh(bad_plate(seed=3), tmp_path / "other.bdf")
    warm = ("--warm-start", "first", "--out", "second")
    assert call("optimize", "other.bdf", *warm, *FAST)[0] == 0
    result = json.loads((tmp_path / "second" / "result.json").read_text())
    before, after = result["before"], result["after"]
    assert (after["failed"], after["trias"]) < (before["failed"], before["trias"])
    again = call("replay", "second/procedure.json", "other.bdf", "--out", "again.bdf")
    assert again[0] == 0
    assert (tmp_path / "again.bdf").read_bytes() == (tmp_path / "second/other.bdf").read_bytes()


def test_a_start_that_is_not_there(call, deck: Path) -> None:  # type: ignore[no-untyped-def]
    code, _, error = call("optimize", deck, "--warm-start", "nowhere", "--out", "run", *FAST)
    assert code == 2
    assert "nowhere" in error
    assert not (deck.parent / "run").exists()
