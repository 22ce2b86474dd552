"""Options that several commands have, and what is done with their values."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

PATH = click.Path(path_type=Path)

criteria_option = click.option(
    "--criteria",
    metavar="FILE|paper|standard",
    help="What counts as a good element: a built-in set, TOML, or HyperMesh's .criteria text.",
)

size_option = click.option(
    "--size",
    metavar="L|local|FILE",
    help="Target element size: a number, the mesh's own gradation, or a file of x,y,z,size.",
)


def given_settings(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that a user has given, by the keys of a TOML file."""
    given = {name.replace("_", "-"): v for name, v in options.items() if v is not None}
    if "size" in given:
        given["size"] = number_or_name(given["size"])
    return given


def number_or_name(text: str | float) -> float | str:
    """Return a number where the text is one."""
    try:
        return float(text)
    except ValueError:
        return str(text)


def size_given(text: str | None) -> float | str | None:
    """Return a size as a user gives it; a usage error where it is not above 0."""
    size = None if text is None else number_or_name(text)
    if isinstance(size, float) and not 0 < size < float("inf"):
        raise click.UsageError(f"--size is {size}: it must be above 0.")
    return size


def tell(sentence: str) -> None:
    """Tell the user something that is no result."""
    click.echo(sentence, err=True)


def refuse_to_overwrite(path: Path) -> None:
    """Raise InputError where a file is there already."""
    from meshops.errors import InputError

    if path.exists():
        raise InputError(f"{path} is there already; name another file with --out.")
