"""The command that shows MLflow's pages."""

from __future__ import annotations

import sys

import click


@click.command()
@click.option("--port", type=click.IntRange(1, 65535), default=5000, show_default=True)
def dashboard(port: int) -> None:
    """Show the MLflow pages of the store in this folder, until Ctrl-C."""
    from tracking.dashboard import serve_dashboard

    sys.exit(serve_dashboard(port, announce=click.echo))
