"""Runs that were interrupted, killed or damaged, and what goes on from them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from islands import session
from islands.checkpoint import BEFORE, CHECKPOINT, ROUNDS, Checkpoints
from islands.cli import cli
from islands.config import Config, load_config
from islands.search import SearchState
from meshops.criteria import PAPER
from meshops.criteria_files import dump_criteria
from meshops.errors import InputError
from meshops.examples import plate
from meshops.formats import write_mesh
from tests.jobs import SMALL, WHOLE
from tracking.events import Event, GenerationReport, RoundReport, RunFinished, RunStarted
from tracking.journal import JOURNAL, read_journal

SETTINGS = {**SMALL, "flow": 1, "track": "off"}


def config_of(**settings: object) -> Config:
    return load_config(None, SETTINGS | settings)


def nobody(_: Config) -> list[None]:
    return []


def optimized(deck: Path, folder: Path, **settings: object) -> str:
    return session.optimize(
        deck, folder, config_of(**settings), nobody, overwrite=False
    ).mesh.digest


def resumed(folder: Path, told: list[str] | None = None, **settings: object) -> str:
    notify = (told if told is not None else []).append
    done = session.resume(folder, settings, nobody, notify)
    assert done is not None
    assert done.status == "finished"
    return done.mesh.digest


def rounds_of(folder: Path) -> list[Event]:
    """Reports of rounds, without what the clock says."""
    return [replace(e, seconds=0.0) for e in read_journal(folder) if isinstance(e, RoundReport)]


@pytest.fixture(scope="module")
def deck(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("deck") / "plate.bdf"
    write_mesh(plate(), path)
    return path


@pytest.fixture(scope="module")
def whole(deck: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run that nothing has disturbed."""
    folder = tmp_path_factory.mktemp("whole") / "run"
    optimized(deck, folder)
    return folder


def digest_of(folder: Path) -> str:
    return str(json.loads((folder / "result.json").read_text())["digest"])


@pytest.fixture
def interrupt(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Ends the next run with Ctrl-C once it has written so many checkpoints."""

    def after(states: int) -> None:
        keep, seen = Checkpoints.keep, []

        def keep_and_interrupt(self: Checkpoints, state: SearchState) -> None:
            keep(self, state)
            seen.append(state)
            if len(seen) == states:
                raise KeyboardInterrupt

        monkeypatch.setattr(Checkpoints, "keep", keep_and_interrupt)

    return after


def test_a_run_can_be_interrupted_between_any_two_rounds(
    deck: Path, whole: Path, tmp_path: Path, interrupt: Callable[[int], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    rounds = len(rounds_of(whole))
    assert rounds >= 4
    for states in range(1, rounds + 1):
        folder = tmp_path / str(states)
        with monkeypatch.context():
            interrupt(states)
            done = session.optimize(deck, folder, config_of(), nobody, overwrite=False)
            assert done.status == "interrupted"
        monkeypatch.undo()
        assert resumed(folder) == digest_of(whole) == digest_of(folder)
        assert rounds_of(folder) == rounds_of(whole)
        events = read_journal(folder)
        seconds = [e.seconds for e in events if isinstance(e, RoundReport | GenerationReport)]
        assert seconds == sorted(seconds)
        assert isinstance(events[-1], RunFinished)
        assert len({event.run_id for event in events if isinstance(event, RunStarted)}) == 1


def test_a_run_can_be_interrupted_again_and_again(
    deck: Path, whole: Path, tmp_path: Path, interrupt: Callable[[int], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    interrupt(2)
    session.optimize(deck, tmp_path / "run", config_of(), nobody, overwrite=False)
    for _ in range(3):
        monkeypatch.undo()
        interrupt(2)
        done = session.resume(tmp_path / "run", {}, nobody, lambda _: None)
        assert done is not None
    monkeypatch.undo()
    if done.status != "finished":
        resumed(tmp_path / "run")
    assert digest_of(tmp_path / "run") == digest_of(whole)
    assert rounds_of(tmp_path / "run") == rounds_of(whole)


@pytest.mark.parametrize("backend", ["local", "ray"])
def test_one_procedure_for_the_whole_mesh_goes_on_from_any_generation(
    deck: Path, tmp_path: Path, interrupt: Callable[[int], None],
    monkeypatch: pytest.MonkeyPatch, backend: str,
) -> None:  # fmt: skip
    """With migrants on their way: what the islands and the sea hold is in the checkpoint."""
    settings = WHOLE | {"islands": 3, "generations": 4, "migration-delay": 1, "elites": 1}

    def told(folder: Path) -> list[Event]:
        events = [e for e in read_journal(folder) if not isinstance(e, RunStarted | RunFinished)]
        return [
            replace(e, seconds=0.0, performed=0) if isinstance(e, GenerationReport) else e
            for e in events
        ]

    digest = optimized(deck, tmp_path / "whole", **settings)
    for generation in (1, 3, 5) if backend == "local" else (2,):
        folder = tmp_path / str(generation)
        interrupt(generation)
        config = config_of(**settings)
        done = session.optimize(deck, folder, config, nobody, overwrite=False)
        monkeypatch.undo()
        assert done.status == "interrupted"
        assert resumed(folder, backend=backend) == digest == digest_of(folder)
        assert told(folder) == told(tmp_path / "whole")


def test_a_killed_run_goes_on(deck: Path, whole: Path, tmp_path: Path) -> None:
    """Killed with its checkpoint half written, as likely as not."""
    folder = tmp_path / "run"
    options = ["--size", "5", "--criteria", "paper", "--flow", "1", "--track", "off", "--quiet"]
    command = [sys.executable, "-c", "from islands.cli import main; main()"]
    child = subprocess.Popen([*command, "optimize", str(deck), "--out", str(folder), *options])
    try:
        end = time.monotonic() + 200
        while not (folder / BEFORE).exists() and child.poll() is None:
            assert time.monotonic() < end
            time.sleep(0.01)
        os.kill(child.pid, signal.SIGKILL)
    finally:
        child.wait()
    assert not (folder / "result.json").exists()
    assert resumed(folder) == digest_of(whole)


@pytest.mark.parametrize("kilobytes", [2, 10, 26, 30])
def test_a_full_disk_ends_a_run_with_a_sentence_and_nothing_that_was_written_is_lost(
    deck: Path, whole: Path, tmp_path: Path, kilobytes: int
) -> None:
    """No file may grow beyond a size: the journal, the rounds or a checkpoint, as it happens."""
    folder = tmp_path / "run"
    options = ["--size", "5", "--criteria", "paper", "--flow", "1", "--track", "off", "--quiet"]
    script = (
        "import resource; from islands.cli import main; "
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({1000 * kilobytes},) * 2); main()"
    )
    command = [sys.executable, "-c", script, "optimize", str(deck), "--out", str(folder)]
    ended = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    (sentence,) = ended.stderr.splitlines()
    assert f"make room and go on with meshipelago resume {folder}" in sentence
    assert not list(folder.glob(".*.part"))
    before = rounds_of(folder)
    assert before == rounds_of(whole)[: len(before)]
    assert resumed(folder) == digest_of(whole)
    assert rounds_of(folder) == rounds_of(whole)


def test_files_that_settings_name_may_be_named_otherwise_or_move(
    deck: Path, tmp_path: Path, interrupt: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is in them counts: relative paths become absolute ones in the folder's settings."""
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text(dump_criteria(PAPER))
    Path("sizes.csv").write_text("0,0,0,5\n100,100,0,6\n")
    settings = {"criteria": "mine.toml", "size": "sizes.csv"}
    digest = optimized(deck, tmp_path / "whole", **settings)
    interrupt(2)
    session.optimize(deck, tmp_path / "run", config_of(**settings), nobody, overwrite=False)
    monkeypatch.undo()
    (tmp_path / "elsewhere").mkdir()
    for name in ("mine.toml", "sizes.csv"):
        (tmp_path / name).rename(tmp_path / "elsewhere" / name)
    moved = {key: str(tmp_path / "elsewhere" / name) for key, name in settings.items()}
    assert resumed(tmp_path / "run", **moved) == digest
    Path(moved["size"]).write_text("0,0,0,5\n100,100,0,7\n")
    interrupt(2)
    again = tmp_path / "again"
    session.optimize(deck, again, config_of(**moved), nobody, overwrite=False)
    monkeypatch.undo()
    Path(moved["size"]).write_text("0,0,0,5\n100,100,0,8\n")
    with pytest.raises(InputError, match="another run"):
        session.resume(again, {}, nobody, lambda _: None)


def test_the_same_command_goes_on_and_leaves_a_config_file_of_the_user(
    stopped: Path, whole: Path, deck: Path, tmp_path: Path
) -> None:
    options = ["--size", "5", "--criteria", "paper", "--flow", "1", "--track", "off", "--quiet"]
    result = CliRunner().invoke(
        cli, ["optimize", str(deck), "--out", str(stopped), "--resume", *options]
    )
    assert result.exit_code == 0
    assert digest_of(stopped) == digest_of(whole)
    own = tmp_path / "own" / session.CONFIG
    own.parent.mkdir()
    own.write_text("flow = 1\n")
    result = CliRunner().invoke(
        cli, ["optimize", str(deck), "--out", str(own.parent), "--resume", *options]
    )
    assert "is not empty" in str(result.exception)
    assert own.read_text() == "flow = 1\n"


@pytest.mark.parametrize("lost", [(JOURNAL,), (JOURNAL, session.RUN)])
def test_a_run_that_was_killed_before_it_had_begun_can_be_tried_again(
    stopped: Path, whole: Path, deck: Path, lost: tuple[str, ...]
) -> None:
    for name in (CHECKPOINT, BEFORE, ROUNDS, "result.json", *lost):
        (stopped / name).unlink()
    if session.RUN not in lost:
        assert resumed(stopped) == digest_of(whole)
        return
    for path in stopped.iterdir():
        if path.name != session.CONFIG:
            path.unlink()
    options = ["--size", "5", "--criteria", "paper", "--flow", "1", "--track", "off", "--quiet"]
    arguments = ["optimize", str(deck), "--out", str(stopped), "--resume", *options]
    assert CliRunner().invoke(cli, arguments).exit_code == 0
    assert digest_of(stopped) == digest_of(whole)
    assert "has ended already" in CliRunner().invoke(cli, arguments).output


def test_a_run_without_a_checkpoint_begins_anew(stopped: Path, whole: Path) -> None:
    for name in (CHECKPOINT, BEFORE):
        (stopped / name).unlink()
    assert resumed(stopped) == digest_of(whole)
    assert rounds_of(stopped) == rounds_of(whole)


def test_a_run_whose_time_was_up_goes_on_without_a_limit(
    deck: Path, whole: Path, tmp_path: Path
) -> None:
    config = config_of(**{"time-limit": 0.2})
    done = session.optimize(deck, tmp_path / "run", config, nobody, overwrite=False)
    assert done.status == "time-limit"
    assert resumed(tmp_path / "run") == digest_of(whole)


@pytest.fixture
def stopped(
    deck: Path, tmp_path: Path, interrupt: Callable[[int], None], monkeypatch: pytest.MonkeyPatch
) -> Path:
    """A run with a checkpoint and the one before it."""
    interrupt(3)
    session.optimize(deck, tmp_path / "run", config_of(), nobody, overwrite=False)
    monkeypatch.undo()
    return tmp_path / "run"


@pytest.mark.parametrize("damage", ["cut", "changed", "empty"])
def test_a_damaged_checkpoint_is_told_and_the_one_before_it_is_used(
    stopped: Path, whole: Path, damage: str
) -> None:
    path = stopped / CHECKPOINT
    content = bytearray(path.read_bytes())
    if damage == "changed":
        middle = len(content) // 2
        content[middle] ^= 1
    path.write_bytes({"cut": content[:-100], "changed": content, "empty": b""}[damage])
    told: list[str] = []
    assert resumed(stopped, told) == digest_of(whole)
    assert len(told) == 1
    assert str(path) in told[0]
    assert "goes on from the checkpoint before it" in told[0]


@pytest.mark.parametrize("lost", [(CHECKPOINT, BEFORE), (ROUNDS,)])
def test_without_any_sound_checkpoint_the_user_is_told(stopped: Path, lost: tuple[str]) -> None:
    for name in lost:
        (stopped / name).write_bytes(b"no arrow")
    with pytest.raises(InputError, match=r"is damaged.*is damaged.*anew"):
        session.resume(stopped, {}, nobody, lambda _: None)


def test_a_checkpoint_of_another_run_is_refused(stopped: Path) -> None:
    file = stopped / session.CONFIG
    file.write_text(file.read_text().replace("seed = 1", "seed = 2"))
    with pytest.raises(InputError, match="another run"):
        session.resume(stopped, {}, nobody, lambda _: None)


def test_a_changed_deck_is_refused(stopped: Path, deck: Path, tmp_path: Path) -> None:
    about = json.loads((stopped / session.RUN).read_text())
    other = tmp_path / "other.bdf"
    other.write_text(deck.read_text().replace("CQUAD4", "CQUADR", 1))
    (stopped / session.RUN).write_text(json.dumps(about | {"source": str(other), "mesh": "x"}))
    with pytest.raises(InputError, match="another mesh"):
        session.resume(stopped, {}, nobody, lambda _: None)


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no run.json"):
        session.resume(tmp_path, {}, nobody, lambda _: None)


def test_a_run_that_has_ended_stays_as_it_is(whole: Path) -> None:
    assert not any((whole / name).exists() for name in (CHECKPOINT, BEFORE, ROUNDS))
    before = (whole / "result.json").read_bytes()
    assert session.resume(whole, {}, nobody, lambda _: None) is None
    assert (whole / "result.json").read_bytes() == before


def test_settings_are_saved_in_full_and_load_back_equal(whole: Path, deck: Path) -> None:
    assert load_config(whole / session.CONFIG, {}) == config_of()
    for settings in ({"profile": "paper"}, {"profile": "thorough"}, {"migrant-share": 0.5}):
        config = load_config(None, settings)
        file = deck.parent / "settings.toml"
        file.write_text(config.to_toml())
        assert load_config(file, {}) == config
