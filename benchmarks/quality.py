"""How good the meshes become, beside those of the tools that a user would otherwise pick.

``python -m benchmarks.quality [ROW ...]`` with rows of: plate, planar, solids, wing, fuselage,
polygon, search; all of them without any. The peers run in the same command. Needs the extra
``bench`` (gmsh) and the folder of real meshes, ``--data``.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.improving import CRITERIA, Improvement, improved, job_of, processes
from benchmarks.isolation import IsolatedError
from benchmarks.measures import Shape
from benchmarks.parts import PARTS
from benchmarks.peers import CONFIGURATIONS, Configuration, gmsh_polygon, gmsh_solid
from benchmarks.planar import FLOW, planar
from benchmarks.report import Row, parser, publish
from benchmarks.search import search
from islands.cli.make import FLOW_OF_NEW_MESHES
from islands.run import Finished
from meshops.criteria_files import load_criteria
from meshops.examples import SIZE, plate
from meshops.formats import read_deck
from meshops.geometry import mesh_geometry
from meshops.mesh import ShellMesh
from meshops.quality_index import QualityIndex, quality_index
from meshops.topology import topology

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"

Found = tuple[list[Row], dict[str, Any]]
"""Rows of the table, and details for the JSON file."""

PLATE_SECONDS, DECK_SECONDS, POLYGON_SECONDS = 10.0, 300.0, 60.0

SOLIDS = {"trimesh_featuretype.STEP": 127.7 / 40, "trimesh_plate_holes.STL": 305.0 / 40}
"""Element size by file: 1/40 of the longest side."""

PAPER_SHAPE = Shape(sys.maxsize, 0.94, 0.83, 0.11, float("inf"))
"""The means that the FreeMesh-RL paper (Pan et al., 2023) gives; it counts no singular nodes."""


def plate_row(options: argparse.Namespace) -> Found:
    """Improve the plate with one seed after the other."""
    with processes(options.workers) as pool:
        runs = list(pool.map(_improve_plate, range(1, options.seeds + 1)))
    seconds = [run.solved_after for run in runs]
    solved = sum(value <= PLATE_SECONDS for value in seconds)
    target = -(-9 * len(runs) // 10)
    row = Row(
        "plate: 0 failed, trias at the parity bound",
        f"{solved} of {len(runs)} seeds, median {statistics.median(seconds):.1f} s, worst "
        f"{max(seconds):.1f} s",
        f">= {target} within {PLATE_SECONDS:g} s",
        solved >= target,
    )
    return [row], {"plate": [_summary(run.done) for run in runs]}


def planar_row(options: argparse.Namespace) -> Found:
    """Improve what gmsh makes of planar parts."""
    parts = [part for part in PARTS if part.name in (options.part or [part.name])]
    chosen = [c for c in CONFIGURATIONS if c.algorithm in (options.algorithm or [c.algorithm])]
    return planar(parts, chosen, options.workers)


def solids_row(options: argparse.Namespace) -> Found:
    """Mesh the surfaces of solids as ``meshipelago mesh`` does, and improve them."""
    rows: list[Row] = []
    details: dict[str, Any] = {}
    for name, size in SOLIDS.items():
        path = options.data / name
        best, peer = min(_solid_peers(path, size), key=lambda found: found[0].failed)
        job = job_of(name, mesh_geometry(path, size), size=size, flow=FLOW_OF_NEW_MESHES)
        done = improved(job, DECK_SECONDS).done
        after = done.after
        rows += [
            _row(f"{name}: % of trias", after.percent_trias, 1.0, f"gmsh {best.percent_trias:.1f}"),
            _row(f"{name}: failed", after.failed, best.failed / 4, f"gmsh {best.failed}, {peer}"),
        ]
        details[name] = _summary(done) | {"gmsh": best.to_json()}
    return rows, details


def wing_row(options: argparse.Namespace) -> Found:
    """Improve a deck with many trias."""
    name = "pynastran_dummy_wing_metallic.bdf"
    done = _improve_deck(options.data / name)
    rows = [
        _row(
            "wing: % of trias",
            done.after.percent_trias,
            6.0,
            f"from {done.before.percent_trias:.1f}",
        ),
        _failed_row("wing", done),
    ]
    return rows, {"wing": _summary(done)}


def fuselage_row(options: argparse.Namespace) -> Found:
    """Improve a deck with many T-junctions, all of which must stay."""
    path = options.data / "tacs_fuselage.bdf"
    before = junctions(read_deck(path).mesh)
    done = _improve_deck(path)
    changed = (before - junctions(done.mesh)) + (junctions(done.mesh) - before)
    rows = [
        _failed_row("fuselage", done),
        _row(
            "fuselage: T-junction edges changed",
            changed.total(),
            0,
            f"of {before.total()}",
        ),
    ]
    return rows, {"fuselage": _summary(done)}


def polygon_row(options: argparse.Namespace) -> Found:
    """Mesh a polygon with a fixed border by quads alone."""
    places = np.array(json.loads((options.data / "polygons" / "boundary8.json").read_text()))
    size = float(np.median(np.linalg.norm(np.roll(places, -1, axis=0) - places, axis=1)))
    scoring = load_criteria(CRITERIA).at(size)
    start = _with_locked_border(gmsh_polygon(places, Configuration(8, 1)))
    done = improved(job_of("polygon", start, size=size, flow=FLOW), POLYGON_SECONDS).done
    ours, gmsh = Shape.of(done.mesh, scoring), Shape.of(start, scoring)
    rows = [_row("polygon: trias", done.after.trias, 0, f"gmsh {done.before.trias}")]
    for name, sign in (
        ("singular_nodes", 1.0),
        ("scaled_jacobian", -1.0),
        ("stretch", -1.0),
        ("taper", 1.0),
    ):
        value, best = (
            getattr(ours, name),
            min(
                (getattr(peer, name) for peer in (gmsh, PAPER_SHAPE)), key=lambda peer: sign * peer
            ),
        )
        rows.append(
            Row(
                f"polygon: {name.replace('_', ' ')}",
                f"{value:.3g} (gmsh {getattr(gmsh, name):.3g})",
                f"{'<' if sign > 0 else '>'} {best:.3g}",
                sign * value < sign * best,
            )
        )
    return rows, {"polygon": {"ours": vars(ours), "gmsh": vars(gmsh), "run": _summary(done)}}


def search_row(options: argparse.Namespace) -> Found:
    """Compare the islands with other ways to search, on the same budget."""
    return search(options.seeds, options.workers, options.picture)


ROWS: dict[str, Callable[[argparse.Namespace], Found]] = {
    "plate": plate_row,
    "planar": planar_row,
    "solids": solids_row,
    "wing": wing_row,
    "fuselage": fuselage_row,
    "polygon": polygon_row,
    "search": search_row,
}


def junctions(mesh: ShellMesh) -> Counter[tuple[object, ...]]:
    """Edges where three and more elements meet: the places of their ends, and how many meet."""
    found = topology(mesh)
    ends = mesh.points[found.edges[found.is_t_junction]].tolist()
    uses = found.uses[found.is_t_junction].tolist()
    return Counter(
        (*sorted(map(tuple, pair)), count) for pair, count in zip(ends, uses, strict=True)
    )


def _solid_peers(path: Path, size: float) -> Iterator[tuple[QualityIndex, Configuration]]:
    """Judge what each configuration of gmsh makes of a solid, where it makes anything."""
    scoring = load_criteria(CRITERIA).at(size)
    for configuration in CONFIGURATIONS:
        try:
            mesh = gmsh_solid(path, size, configuration)
        except IsolatedError as error:
            print(f"{path.name}, {configuration}: {error}", file=sys.stderr)
        else:
            yield quality_index(mesh, scoring), configuration


def _improve_plate(seed: int) -> Improvement:
    return improved(job_of("plate", plate(), size=SIZE, seed=seed), PLATE_SECONDS)


def _improve_deck(path: Path) -> Finished:
    return improved(job_of(path.name, read_deck(path).mesh), DECK_SECONDS).done


def _with_locked_border(mesh: ShellMesh) -> ShellMesh:
    found = topology(mesh)
    locked = mesh.locked_nodes.copy()
    locked[found.edges[found.is_border]] = True
    return ShellMesh.build(mesh.points, mesh.elements, region=mesh.region, locked_nodes=locked)


def _row(case: str, value: float, limit: float, beside: str) -> Row:
    return Row(case, f"{value:.4g} ({beside})", f"<= {limit:g}", value <= limit)


def _failed_row(case: str, done: Finished) -> Row:
    cut = 1.0 - done.after.failed / max(done.before.failed, 1)
    return Row(
        f"{case}: failing elements",
        f"{done.before.failed} to {done.after.failed}: {cut:.0%} less, {done.seconds:.0f} s",
        f">= 80 % less within {DECK_SECONDS:g} s",
        cut >= 0.8 and done.seconds <= DECK_SECONDS,
    )


def _summary(done: Finished) -> dict[str, Any]:
    return {
        "seconds": done.seconds,
        "evaluations": done.performed,
        "before": done.before.to_json(),
        "after": done.after.to_json(),
        "digest": done.mesh.digest,
    }


def main() -> None:
    """Measure the rows that are asked for."""
    options = parser(__doc__)
    options.add_argument("rows", nargs="*", metavar="ROW", help=", ".join(ROWS))
    options.add_argument("--data", type=Path, default=DATA, help="folder of the real meshes")
    options.add_argument("--seeds", type=int, default=10, help="of the plate and of search")
    options.add_argument("--workers", type=int, default=2, help="processes that improve meshes")
    options.add_argument("--part", action="append", help="planar: just this part; repeatable")
    options.add_argument("--algorithm", action="append", type=int, help="planar: just gmsh's")
    options.add_argument("--picture", type=Path, help="search: draw the curves to a PNG file")
    chosen = options.parse_args()
    if unknown := [name for name in chosen.rows if name not in ROWS]:
        options.error(f"there is no row {', '.join(unknown)}; choose of {', '.join(ROWS)}")
    rows: list[Row] = []
    details: dict[str, Any] = {}
    for name in chosen.rows or ROWS:
        found, more = ROWS[name](chosen)
        rows += found
        details.update(more)
        print(f"{name}: done", file=sys.stderr)
    publish("Quality, by the criteria of the paper", rows, details, chosen)


if __name__ == "__main__":
    main()
