"""What the README shows must work as it stands there."""

import re
import shlex
import textwrap
import tomllib
from pathlib import Path

import click
import pytest

from islands.cli import cli
from islands.config import load_config
from meshops.criteria_files import load_criteria

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
INDENTED = re.compile(r"(?:^ {4}.*\n|^\n(?= {4}))+", re.MULTILINE)
BLOCKS = [textwrap.dedent(text) for text in INDENTED.findall(README)]
COMMAND = re.compile(
    r"meshipelago ((?:check|dashboard|example|mesh|optimize|picture|replay)\b[^\n`#&]*)"
)


def block(word: str) -> str:
    return next(text for text in BLOCKS if word in text)


def test_the_criteria_file(tmp_path: Path) -> None:
    path = tmp_path / "crash.toml"
    path.write_text(block("[criteria"))
    criteria = load_criteria(str(path))
    assert criteria.name == "crash"
    assert criteria["min size"].levels[3] == 3.0
    assert criteria["% of trias"].weight == 2.0


def test_the_config_file_holds_the_defaults(tmp_path: Path) -> None:
    path = tmp_path / "config.toml"
    path.write_text(block("operation-population"))
    config = load_config(path, {})
    assert config == load_config(None, {})
    assert set(tomllib.loads(path.read_text())) <= set(config.flat())


@pytest.mark.parametrize("command", sorted(set(COMMAND.findall(README))))
def test_commands_parse(command: str) -> None:
    name, *arguments = shlex.split(command)
    known = cli.commands[name]
    known.make_context(name, arguments, resilient_parsing=False)
    assert isinstance(known, click.Command)


def test_pictures_are_there() -> None:
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]*)\)", README)
    assert pictures
    for picture in pictures:
        assert (Path(__file__).parents[1] / picture).is_file()
