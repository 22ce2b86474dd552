"""The command line: one file a command group.

Heavy imports wait inside the commands, so that --help answers at once.
"""

from __future__ import annotations

import sys

import click

from islands.cli.check import check
from islands.cli.dashboard import dashboard
from islands.cli.make import example, mesh
from islands.cli.optimize import config, optimize, resume
from islands.cli.picture import picture
from islands.cli.replay import replay

DONE, NOT_GOOD_ENOUGH, BAD_INPUT, HARM, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes: a gate of `check` was not passed; input, or a deck that is written, is not as it
should be."""


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="meshipelago")
def cli() -> None:
    """Repair shell meshes by evolving the repair procedure."""


for _command in (example, check, optimize, resume, config, replay, mesh, picture, dashboard):
    cli.add_command(_command)


def main() -> None:
    """Run a command; bad input ends with one sentence and exit code 2."""
    from meshops.errors import HarmError, InputError
    from tracking.errors import TrackingError

    try:
        cli.main(standalone_mode=False)
    except click.exceptions.Exit as stop:
        sys.exit(stop.exit_code)
    except click.ClickException as error:
        error.show()
        sys.exit(BAD_INPUT)
    except (click.Abort, KeyboardInterrupt):
        click.echo("Interrupted.", err=True)
        sys.exit(INTERRUPTED)
    except HarmError as error:
        click.echo(f"meshipelago: {error}", err=True)
        sys.exit(HARM)
    except (InputError, TrackingError) as error:
        click.echo(f"meshipelago: {error}", err=True)
        sys.exit(BAD_INPUT)
    except OSError as error:
        click.echo(f"meshipelago: {error.filename}: {error.strerror}.", err=True)
        sys.exit(BAD_INPUT)
