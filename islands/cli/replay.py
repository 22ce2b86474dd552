"""The command that performs a procedure again."""

from __future__ import annotations

from pathlib import Path

import click

from islands.cli.options import PATH, refuse_to_overwrite


@click.command()
@click.argument("procedure", type=PATH)
@click.argument("mesh", type=PATH)
@click.option("--out", type=PATH, required=True, help="The mesh to write.")
def replay(procedure: Path, mesh: Path, out: Path) -> None:
    """Perform a procedure again, bit for bit on its own mesh, or try it on another one."""
    from islands.replay import replay_file
    from meshops.formats import check_writable_suffix

    check_writable_suffix(out)
    refuse_to_overwrite(out)
    click.echo(replay_file(procedure, mesh, out))
