"""The command line as a user meets it: files, sentences, exit codes."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from islands.checkpoint import BEFORE, CHECKPOINT, ROUNDS
from islands.cli import main
from meshops.formats import read_deck, write_mesh
from meshops.mesh import ShellMesh
from tests.decks import bad_plate

RUN = "from islands.cli import main; main()"
FAST = ["--track", "off", "--size", "5", "--islands", "1", "--generations", "1"]
FAST += ["--population", "3"]
OUTPUTS = {
    "deck.bdf",
    "mesh.vtu",
    "procedure.json",
    "procedure.txt",
    "before.png",
    "after.png",
    "history.parquet",
    "result.json",
    "journal.arrow",
    "quality_before.txt",
    "quality_after.txt",
    "config.toml",
    "criteria.toml",
    "failed.csv",
    "run.json",
}


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    path = tmp_path / "deck.bdf"
    write_mesh(bad_plate(), path)
    return path


@pytest.fixture
def call(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., tuple[int, str, str]]:
    """Run the command line in tmp_path; exit code, standard output, standard error."""

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["meshipelago", *map(str, arguments)])
        try:
            main()
            code = 0
        except SystemExit as stop:
            code = int(stop.code or 0)
        return code, *capsys.readouterr()

    return run


def test_optimize_writes_everything(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    original = deck.read_bytes()
    code, out, _ = call("optimize", deck, "--out", "run", *FAST)
    assert code == 0
    run = tmp_path / "run"
    assert {path.name for path in run.iterdir()} == OUTPUTS
    assert deck.read_bytes() == original
    result = json.loads((run / "result.json").read_text())
    assert result["seed"] == 1
    assert result["backend"] == "local"
    assert set(result) >= {"seconds", "evaluations", "fitness", "procedure", "digest"}
    for when in ("before", "after"):
        counts = {"elements", "quads", "trias", "failed", "failed_by_shape", "failed_by_size"}
        assert set(result[when]) == counts | {"compound_qi"}
    assert result["after"]["failed"] < result["before"]["failed"]
    after = read_deck(run / "deck.bdf").mesh
    assert (len(after.elements), after.is_tria.sum()) == (
        result["after"]["elements"],
        result["after"]["trias"],
    )
    assert (run / "procedure.txt").read_text() == result["procedure"] + "\n"
    assert "generation 0" in out
    assert f"{result['before']['failed']} failed elements -> {result['after']['failed']}" in out
    assert (run / "before.png").read_bytes()[:4] == b"\x89PNG"


def test_replay_makes_the_same_deck(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    call("optimize", deck, "--out", "run", "--quiet", *FAST)
    code, out, _ = call("replay", "run/procedure.json", deck, "--out", "again.bdf")
    assert code == 0
    assert json.loads((tmp_path / "run/result.json").read_text())["digest"] in out
    assert (tmp_path / "again.bdf").read_bytes() == (tmp_path / "run/deck.bdf").read_bytes()


def test_replay_on_another_mesh_improves_it_and_says_by_how_much(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path
) -> None:
    call("optimize", deck, "--out", "run", "--quiet", *FAST)
    write_mesh(bad_plate(seed=5), tmp_path / "other.bdf")
    code, out, _ = call("replay", "run/procedure.json", "other.bdf", "--out", "again.bdf")
    assert code == 0
    assert "another mesh" in out
    told = re.search(r"(\d+) failed elements and (\d+) trias -> (\d+) .* and (\d+) trias", out)
    assert told
    failed, trias, failed_after, trias_after = map(int, told.groups())
    assert (failed_after, trias_after) < (failed, trias)
    assert trias == read_deck(tmp_path / "other.bdf").mesh.is_tria.sum()
    assert trias_after == read_deck(tmp_path / "again.bdf").mesh.is_tria.sum()


def test_replay_of_element_numbers_on_another_mesh_is_refused(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path
) -> None:
    call("optimize", deck, "--out", "run", "--quiet", "--profile", "paper", *FAST)
    write_mesh(bad_plate(seed=5), tmp_path / "other.bdf")
    code, _, err = call("replay", "run/procedure.json", "other.bdf", "--out", "again.bdf")
    assert code == 2
    assert "another mesh" in err
    assert not (tmp_path / "again.bdf").exists()


def test_check_prints_and_writes_the_report(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    code, out, _ = call("check", deck, "--criteria", "paper", "--size", "5", "--json", "q.json")
    assert code == 0
    report = json.loads((tmp_path / "q.json").read_text())
    assert set(report) >= {"elements", "quads", "trias", "failed", "compound_qi", "rows"}
    assert len(report["rows"]) == 13
    assert "compound Q.I. =" in out
    assert "max angle quad" in out


def test_picture_and_example(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    assert call("example", "plate", "--out", "plate.bdf")[0] == 0
    assert call("picture", "plate.bdf", "--out", "plate.png", "--size", "5")[0] == 0
    assert (tmp_path / "plate.png").read_bytes()[:4] == b"\x89PNG"
    assert read_deck(tmp_path / "plate.bdf").mesh.is_tria.sum() == 11


def test_a_config_file_and_options_over_it(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "c.toml").write_text(
        'profile = "paper"\nseed = 7\npopulation = 3\ngenerations = 4\nsize = 5.0\ntrack = "off"\n'
    )
    code, out, _ = call("optimize", deck, "--out", "run", "--config", "c.toml", "--generations", 0)
    assert code == 0
    assert json.loads((tmp_path / "run/result.json").read_text())["seed"] == 7
    assert "generation 0" in out
    assert "generation 1" not in out


GRID = "GRID,{},,{},{},0.\n"
SQUARE = "".join(
    GRID.format(i + 1, x, y) for i, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)])
)
BAD_DECKS = {
    "an empty mesh": ("GRID,1,,0.,0.,0.\n", "shell"),
    "NaN coordinates": ("GRID,1,,nan,0.,0.\n" + SQUARE[11:] + "CQUAD4,1,1,1,2,3,4\n", "line 1"),
    "a missing node": (SQUARE + "CQUAD4,1,1,1,2,3,9\n", "9"),
    "a node twice": (SQUARE + "CQUAD4,1,1,1,2,3,3\n", "twice"),
    "duplicate elements": (SQUARE + "CQUAD4,1,1,1,2,3,4\nCQUAD4,2,1,2,3,4,1\n", "same"),
    "locked throughout": (SQUARE + "CQUAD4,1,1,1,2,3,4\nTEMPP1,1,1,20.\n", "locked"),
}


@pytest.mark.parametrize("name", BAD_DECKS)
def test_bad_decks(call, tmp_path: Path, name: str) -> None:  # type: ignore[no-untyped-def]
    text, word = BAD_DECKS[name]
    (tmp_path / "bad.bdf").write_text(text)
    before = set(tmp_path.iterdir())
    code, out, err = call("optimize", "bad.bdf", "--out", "run", *FAST)
    assert (code, out) == (2, "")
    assert word in err
    assert "bad.bdf" in err
    assert err.count("\n") == 1
    assert "Traceback" not in err
    assert set(tmp_path.iterdir()) == before


BAD_CALLS = {
    "missing file": "missing.bdf --out run",
    "unknown format": "deck.xyz --out run",
    "bad criteria": "deck.bdf --out run --criteria bad.toml",
    "missing criteria": "deck.bdf --out run --criteria nothing.toml",
    "bad config": "deck.bdf --out run --config bad.toml",
    "bad population": "deck.bdf --out run --population 0",
    "bad size": "deck.bdf --out run --size -1",
    "folder in use": "deck.bdf --out used",
    "out is a file": "deck.bdf --out deck.bdf",
    "out holds the deck": "deck.bdf --out . --overwrite",
    "unreachable Ray": "deck.bdf --out run --backend ray --address 127.0.0.1:1",
    "no Ray address": "deck.bdf --out run --backend ray --address nonsense",
    "one operation on islands": "deck.bdf --out run --operation remesh --islands 2",
}


@pytest.mark.parametrize("name", BAD_CALLS)
def test_bad_calls(call, deck: Path, tmp_path: Path, name: str) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "deck.xyz").write_text("x")
    (tmp_path / "bad.toml").write_text("[criteria.skewness]\nfail = 3\n")
    (tmp_path / "used").mkdir()
    (tmp_path / "used/notes.txt").write_text("mine")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    code, out, err = call("optimize", *BAD_CALLS[name].split(), "--track", "off")
    assert (code, out) == (2, "")
    assert err.strip()
    assert "Traceback" not in err
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_an_unreachable_tracking_server_does_not_stop_the_run(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path
) -> None:
    arguments = [*FAST[2:], "--track", "http://127.0.0.1:1"]
    code, _, err = call("optimize", deck, "--out", "run", "--quiet", *arguments)
    assert code == 0
    assert "tracking server" in err
    assert {path.name for path in (tmp_path / "run").iterdir()} == OUTPUTS


def test_files_are_not_overwritten_unless_asked(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "there.bdf").write_text("mine")
    assert call("example", "plate", "--out", "there.bdf")[0] == 2
    assert call("picture", deck, "--out", "there.bdf")[0] == 2
    assert (tmp_path / "there.bdf").read_text() == "mine"
    (tmp_path / "run").mkdir()
    (tmp_path / "run/notes.txt").write_text("mine")
    assert call("optimize", deck, "--out", "run", "--overwrite", "--quiet", *FAST)[0] == 0


@pytest.mark.parametrize("suffix", [".inp", ".vtu", ".msh", ".stl", ".obj", ".off"])
def test_the_result_has_the_format_of_the_input(call, tmp_path: Path, suffix: str) -> None:  # type: ignore[no-untyped-def]
    write_mesh(bad_plate(), tmp_path / f"part{suffix}")
    code, _, err = call("optimize", f"part{suffix}", "--out", "run", "--quiet", *FAST)
    assert (code, err) == (0, "")
    after = read_deck(tmp_path / f"run/part{suffix}").mesh
    assert np.ptp(after.points, axis=0) == pytest.approx([50.0, 40.0, 0.0])


# A shell that starts a job in the background has it ignore Ctrl-C: the test must not depend on it.
LISTEN = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"


def unmendable() -> ShellMesh:
    """A plate whose border fails for ever, so that a patient run goes on and on."""
    plate = bad_plate()
    points = plate.points.copy()
    points[1] = points[0] + (0.0, 0.1, 0.0)
    return replace(plate, points=points, locked_nodes=np.ones(len(points), bool))


@pytest.mark.parametrize(
    ("number", "settings"),
    [
        (signal.SIGINT, "rounds = 100000\npatience = 100000\n"),
        (signal.SIGTERM, 'profile = "paper"\ngenerations = 100000\n'),
    ],
    ids=["rounds", "whole"],
)
def test_an_interrupt_keeps_the_best_and_exits_with_130(
    tmp_path: Path, number: signal.Signals, settings: str
) -> None:
    write_mesh(unmendable(), tmp_path / "deck.bdf")
    (tmp_path / "c.toml").write_text(settings + 'track = "off"\nsize = 5.0\nislands = 1\n')
    options = ["--out", "run", "--config", "c.toml"]
    process = subprocess.Popen(
        [sys.executable, "-c", LISTEN + RUN, "optimize", "deck.bdf", *options],
        stdout=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    try:
        assert process.stdout
        for line in process.stdout:
            if "generation 3 " in line:
                break
        process.send_signal(number)
        process.stdout.read()
        assert process.wait(timeout=60) == 130
    finally:
        process.kill()
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert names - {CHECKPOINT, BEFORE, ROUNDS} == OUTPUTS
    assert CHECKPOINT in names
    assert json.loads((tmp_path / "run/result.json").read_text())["status"] == "interrupted"


def test_help_answers_at_once() -> None:
    command = [sys.executable, "-c", RUN, "--help"]
    subprocess.run(command, check=True, capture_output=True)
    seconds = []
    for _ in range(5):
        started = time.perf_counter()
        out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        seconds.append(time.perf_counter() - started)
    assert "optimize" in out
    imports = subprocess.run(
        [sys.executable, "-X", "importtime", *command[1:]], capture_output=True, text=True
    ).stderr
    assert not {"numpy", "ray", "mlflow", "pymeshlab"} & {
        line.rsplit("|", 1)[-1].strip() for line in imports.splitlines()
    }
    assert min(seconds) < 1.0  # a guard against heavy imports; the figure is in the README
