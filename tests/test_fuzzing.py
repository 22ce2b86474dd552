"""Damaged inputs of every kind are read or refused in one sentence; and who measures that."""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks import damage
from benchmarks.damage import damaged, outcome_of, read
from benchmarks.mutations import MUTATIONS, mutated
from benchmarks.sound_inputs import sound_inputs
from meshops.errors import InputError
from tracking.errors import TrackingError

SOUND = sound_inputs()
KINDS = sorted({sound.kind for sound in SOUND})


def answer(sound, data):
    """The sentence that an input is refused with, or that it is read."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            read(sound, data, Path(folder))
        except (InputError, TrackingError) as error:
            return str(error)
    return "It is read."


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25, deadline=None)
@given(number=st.integers(0, 10**9))
def test_a_damaged_input_is_read_or_refused_in_one_sentence(kind, number):
    random = Random(number)
    sound = random.choice([sound for sound in SOUND if sound.kind == kind])
    sentence = answer(sound, mutated(sound.data, random))
    assert sentence.strip()
    assert "\n" not in sentence


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind.startswith("deck")])
@pytest.mark.parametrize("data", [b"", b"\n", b"\0" * 200, bytes(range(256)) * 2])
def test_empty_files_and_bytes_of_no_meaning_are_refused(kind, data):
    sound = next(sound for sound in SOUND if sound.kind == kind)
    with tempfile.TemporaryDirectory() as folder, pytest.raises(InputError) as caught:
        read(sound, data, Path(folder))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "sound", [s for s in SOUND if s.kind.startswith("deck")], ids=lambda s: s.name
)
def test_a_deck_that_is_cut_short_anywhere_is_read_or_refused(sound):
    for share in range(1, 12):
        assert "\n" not in answer(sound, sound.data[: len(sound.data) * share // 12])


def test_what_is_damaged_follows_from_its_number():
    assert damaged(SOUND, 1, 77) == damaged(SOUND, 1, 77)
    assert damaged(SOUND, 1, 77)[1] != damaged(SOUND, 2, 77)[1]
    assert {damaged(SOUND, 1, number)[0].kind for number in range(len(KINDS))} == set(KINDS)


@pytest.mark.parametrize("mutation", MUTATIONS)
@given(data=st.binary(max_size=60), seed=st.integers(0, 99))
def test_any_bytes_can_be_damaged(mutation, data, seed):
    assert isinstance(mutation(data, Random(seed)), bytes)


def _outcome(monkeypatch, reader, tmp_path):
    monkeypatch.setattr(damage, "read", reader)
    return outcome_of(SOUND[0], b"", 5, tmp_path)


def test_outcomes_are_told_apart(monkeypatch, tmp_path):
    def raising(error):
        def reader(*_):
            raise error

        return reader

    assert _outcome(monkeypatch, lambda *_: None, tmp_path).how == "read"
    assert _outcome(monkeypatch, raising(InputError("a sentence.")), tmp_path).how == "refused"
    assert _outcome(monkeypatch, raising(InputError("two\nlines.")), tmp_path).how == "traceback"
    bad = _outcome(monkeypatch, raising(KeyError("x")), tmp_path)
    assert bad.how == "traceback"
    assert "KeyError at test_fuzzing.py" in bad.why
    monkeypatch.setattr(damage, "LIMIT", 0.01)
    assert _outcome(monkeypatch, lambda *_: time.sleep(0.02), tmp_path).how == "slow"
    monkeypatch.setattr(damage, "PATIENCE", 0.05)
    hanging = _outcome(monkeypatch, lambda *_: time.sleep(5.0), tmp_path)
    assert hanging.how == "slow"
    assert hanging.seconds < 1.0
    assert list(tmp_path.iterdir()) == []


def test_the_command_counts_and_leaves_nothing_behind(tmp_path):
    rest = tmp_path / "tmp"
    rest.mkdir()
    command = [sys.executable, "-m", "benchmarks.fuzzing", "--decks", "120", "--seed", "5"]
    command += ["--check", "--json", str(tmp_path / "found.json")]
    done = subprocess.run(
        command,
        env=os.environ | {"TMPDIR": str(rest)},
        cwd=Path(__file__).parents[1],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    rows = json.loads((tmp_path / "found.json").read_text())["rows"]
    assert [row["case"] for row in rows] == [*KINDS, "all"]
    assert list(rest.iterdir()) == []
