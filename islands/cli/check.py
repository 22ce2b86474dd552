"""The command that judges a mesh: a table, a list, JSON, and a gate."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from islands.cli.options import PATH, criteria_option, size_given, size_option, tell

if TYPE_CHECKING:
    from meshops.gate import Condition
    from meshops.quality_index import QualityIndex

NOT_GOOD_ENOUGH = 1


@click.command()
@click.argument("mesh", type=PATH)
@criteria_option
@size_option
@click.option(
    "--like", type=PATH, metavar="RUN_FOLDER", help="Judge by what that run has judged by."
)
@click.option(
    "--fail-on",
    multiple=True,
    metavar="CONDITION",
    help='Exit with 1 where it is met: "failed>0", "shape>0", "min angle quad<40"; repeatable.',
)
@click.option("--all", "every", is_flag=True, help="List every failing element, and what holds it.")
@click.option(
    "--json", "json_file", metavar="FILE|-", help="Also write the report as JSON; -: only that."
)
@click.option("--overwrite", is_flag=True, help="Write the JSON over a file that is no report.")
def check(
    mesh: Path,
    criteria: str | None,
    size: str | None,
    like: Path | None,
    fail_on: tuple[str, ...],
    json_file: str | None,
    *,
    every: bool,
    overwrite: bool,
) -> None:
    """Print the QualityIndex of a mesh, or of the deck that a run wrote.

    A deck in the folder of its run is judged by what the run judged by.
    """
    from islands.checking import json_text, prepare_report, subject_of
    from islands.results import write_text
    from meshops.failures import list_text
    from meshops.gate import Condition

    conditions = [Condition.parse(text) for text in fail_on]
    subject = subject_of(mesh, criteria=criteria, size=size_given(size), like=like)
    target = Path(json_file) if json_file not in (None, "-") else None
    if target is not None:
        prepare_report(target, subject.deck.files, overwrite=overwrite)
    report = subject.assessment.quality(subject.deck.mesh)
    listed = subject.failures() if every else ()
    text = json_text(subject, report, listed if every else None) if json_file else ""
    if json_file == "-":
        click.echo(text, nl=False)
    else:
        click.echo("\n".join(subject.told))
        click.echo("\n".join(["", *_coloured(report)]))
        if listed:
            click.echo(f"\n{list_text(listed)}", nl=False)
    if target is not None:
        write_text(target, text)
    _heed(conditions, report)


def _heed(conditions: Iterable[Condition], report: QualityIndex) -> None:
    """Say which conditions are met, and end with 1 where one is."""
    met = [condition for condition in conditions if condition.is_met(report)]
    for condition in met:
        tell(condition.sentence(report))
    if met:
        sys.exit(NOT_GOOD_ENOUGH)


def _coloured(report: QualityIndex) -> Iterator[str]:
    """Lines of the table; on a terminal rows in which elements fail are red."""
    first, *lines = report.table().splitlines()
    plain = "NO_COLOR" in os.environ
    yield first if plain else click.style(first, bold=True)
    for place, line in enumerate(lines):
        fails = place < len(report.rows) and bool(report.rows[place].percent_failed)
        yield line if plain or not fails else click.style(line, fg="red")
