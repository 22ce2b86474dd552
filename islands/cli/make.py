"""Commands that make a mesh: of geometry, or an example."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from islands.cli.options import PATH, criteria_option, refuse_to_overwrite

FLOW_OF_NEW_MESHES = 3
"""Rounds for a better flow of what `mesh` makes: there is no mesh yet that is to be kept."""


@click.command()
@click.argument("name", type=click.Choice(["plate"]))
@click.option("--out", type=PATH, required=True, help="The deck to write.")
def example(name: str, out: Path) -> None:
    """Write an example mesh; `plate` is the test piece of the paper."""
    from meshops.examples import EXAMPLES
    from meshops.formats import write_mesh

    refuse_to_overwrite(out)
    write_mesh(EXAMPLES[name](), out)


@click.command()
@click.argument("part", type=PATH)
@click.option("--out", type=PATH, required=True, help="The mesh to write.")
@criteria_option
@click.option("--size", type=float, metavar="L", help="Target element size.")
@click.option("--seed", type=int, metavar="S")
@click.option("--time-limit", type=float, metavar="SECONDS")
def mesh(part: Path, out: Path, **options: Any) -> None:
    """Mesh a part (.stl; with the extra "cad" .step and .iges too), then repair the mesh."""
    from islands.cli.options import given_settings, size_given
    from islands.config import load_config
    from islands.results import closing_words
    from islands.run import Job, improve
    from meshops.criteria_files import load_criteria
    from meshops.formats import check_writable_suffix, write_mesh
    from meshops.geometry import default_size, mesh_geometry

    check_writable_suffix(out)
    refuse_to_overwrite(out)
    given = given_settings(options)
    size_given(given.get("size"))
    shells = mesh_geometry(part, given.get("size"))
    given.setdefault("size", default_size(shells.points))
    given.setdefault("flow", FLOW_OF_NEW_MESHES)
    config = load_config(None, given)
    job = Job.of(part.name, shells, load_criteria(config.criteria), config)
    done = improve(job)
    write_mesh(done.mesh, out)
    click.echo(f"{out}: {len(done.mesh.elements)} elements; {closing_words(done)}")
