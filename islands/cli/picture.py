"""The command that draws a mesh."""

from __future__ import annotations

from pathlib import Path

import click

from islands.cli.options import PATH, criteria_option, refuse_to_overwrite, size_given, size_option


@click.command()
@click.argument("mesh", type=PATH)
@click.option("--out", type=PATH, required=True, help="The PNG to write.")
@criteria_option
@size_option
def picture(mesh: Path, out: Path, criteria: str | None, size: str | None) -> None:
    """Draw a mesh, with its trias and failed elements in colour."""
    from islands.checking import subject_of
    from meshops.pictures import draw

    refuse_to_overwrite(out)
    subject = subject_of(mesh, criteria=criteria, size=size_given(size))
    draw(subject.deck.mesh, subject.assessment, out, title=subject.path.name)
