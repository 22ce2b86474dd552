"""Small sound inputs of every kind that a run reads, to be damaged."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.sound_texts import (
    ABAQUS,
    FOUR_ENTITIES,
    HYPERMESH,
    NASTRAN,
    OWN_CONFIG,
    OWN_CRITERIA,
    PLAIN,
)
from islands.checkpoint import CHECKPOINT, ROUNDS, Checkpoints
from islands.config import load_config
from islands.procedure import Place, Procedure, Round, Step
from islands.search import SearchState
from meshops.criteria import PAPER, STANDARD
from meshops.criteria_files import dump_criteria
from meshops.errors import InputError
from meshops.examples import SIZE
from meshops.formats import KNOWN, read_deck, write_mesh
from meshops.formats.gmsh_stream import Layout, packed
from meshops.formats.gmsh_tables import (
    QUAD,
    TRIA,
    ElementTable,
    NodeTable,
    element_section,
    node_section,
)
from meshops.formats.suffixes import NASTRAN as NASTRAN_SUFFIXES
from meshops.mesh import NO_NODE, ShellMesh
from meshops.operations import ALL_OPERATIONS, NOTHING
from meshops.subdomain import Extent
from tracking.events import MeshSummary, RoundReport, RunStarted
from tracking.journal import JOURNAL, Journal

FAULTS = Path("..") / "shared" / "faults"

LARGEST = 30_000
"""Bytes of a deck that is taken from elsewhere."""

RUN = "the run"
"""What the checkpoint belongs to."""


@dataclass(frozen=True)
class Sound:
    """A sound input.

    Attributes
    ----------
    kind : str
        'deck Nastran', 'criteria' and so on.
    name : str
        Of the file that is damaged.
    data : bytes
    beside : tuple of (str, bytes)
        Other files of the same folder.
    """

    kind: str
    name: str
    data: bytes
    beside: tuple[tuple[str, bytes], ...] = ()


def sound_inputs() -> tuple[Sound, ...]:
    """Make all inputs; decks of `../shared/faults` are among them where they are there."""
    with tempfile.TemporaryDirectory() as folder:
        found = [*_decks(Path(folder)), *_criteria(), *_runs(Path(folder))]
    found += [
        Sound(_kind(path.name), path.name, path.read_bytes())
        for path in sorted(FAULTS.rglob("*"))
        if path.suffix.lower() in KNOWN and 0 < path.stat().st_size <= LARGEST and _is_read(path)
    ]
    return tuple(found)


def _kind(name: str) -> str:
    suffix = Path(f"x{name}").suffix.lower()
    return "deck Nastran" if suffix in NASTRAN_SUFFIXES else f"deck {suffix}"


def _is_read(path: Path) -> bool:
    """Whether a deck is sound by itself: parts of others are not."""
    try:
        read_deck(path)
    except InputError:
        return False
    return True


def small_plate() -> ShellMesh:
    """Nine quads, one of them split, in two regions."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(4) * SIZE, np.arange(4) * SIZE))
    first = [4 * j + i for j in range(3) for i in range(3)]
    quads = [[a, a + 1, a + 5, a + 4] for a in first]
    a, b, c, d = quads.pop()
    elements = [*quads, [a, b, c, NO_NODE], [a, c, d, NO_NODE]]
    region = [1 + (row % 3 == 2) for row in range(len(elements))]
    return ShellMesh.build(np.stack([x, y, 0 * x], axis=1), elements, region=region)


def _decks(folder: Path) -> Iterator[Sound]:
    for suffix in sorted(set(KNOWN) - {*NASTRAN_SUFFIXES[1:]}):
        write_mesh(small_plate(), folder / f"new{suffix}")
        yield Sound(_kind(suffix), f"new{suffix}", (folder / f"new{suffix}").read_bytes())
    for name, text in {**NASTRAN, **ABAQUS, **PLAIN}.items():
        yield Sound(_kind(name), name, text.encode("latin-1"))
    yield Sound(
        "deck Nastran", "whole.bdf", b"BEGIN BULK\nINCLUDE 'part.bdf'\nENDDATA\n",
        (("part.bdf", NASTRAN["cards.bdf"].encode()),),
    )  # fmt: skip
    yield from _binary_decks(folder)


def _binary_decks(folder: Path) -> Iterator[Sound]:
    import meshio

    mesh = small_plate()
    quads, trias = mesh.elements[~mesh.is_tria], mesh.elements[mesh.is_tria, :3]
    region = [mesh.region[~mesh.is_tria], mesh.region[mesh.is_tria]]
    cells = [("quad", quads), ("triangle", trias)]
    plain = meshio.Mesh(mesh.points.copy(), cells, cell_data={"PartId": region})
    meshio.vtu.write(folder / "plain.vtu", plain, compression=None)
    tagged = meshio.Mesh(
        mesh.points.copy(),
        cells,
        cell_data={"gmsh:physical": region, "gmsh:geometrical": region},
    )
    meshio.gmsh.write(folder / "two.msh", tagged, "2.2", binary=True)
    meshio.stl.write(
        folder / "binary.stl", meshio.Mesh(mesh.points.copy(), [("triangle", trias)]), binary=True
    )
    for name, layout in {
        "four.msh": Layout("4.1"),
        "four-binary.msh": Layout("4.1", is_binary=True),
        "old.msh": Layout("4.0"),
    }.items():
        (folder / name).write_bytes(_msh(mesh, layout))
    for name in ("plain.vtu", "two.msh", "binary.stl", *FOUR):
        yield Sound(_kind(name), name, (folder / name).read_bytes())


def _msh(mesh: ShellMesh, layout: Layout) -> bytes:
    """Write a .msh file with an entity for each region, in a layout."""
    count = len(mesh.points)
    owners: list[tuple[int, ...]] = [(2, 1), (2, 2)]
    order = np.lexsort([mesh.is_tria, mesh.region])
    corners = [[node + 1 for node in e if node != NO_NODE] for e in mesh.elements[order].tolist()]
    nodes = NodeTable(
        tags=np.arange(1, count + 1),
        points=mesh.points,
        words=[" ".join(map(repr, p)).encode() for p in mesh.points.tolist()],
        parameters=np.zeros((count, 3)),
        block=np.zeros(count, np.int64),
        blocks=[(2, 1, 0)],
    )
    elements = ElementTable(
        tags=np.arange(1, len(corners) + 1),
        kinds=np.array([QUAD if len(c) == 4 else TRIA for c in corners]),
        start=np.cumsum([0, *map(len, corners)]),
        nodes=np.concatenate(corners),
        owner=mesh.region[order].astype(np.int64) - 1,
        owners=owners,
    )
    one = packed(layout, "i4", [1]) + b"\n" if layout.is_binary else b""
    head = f"$MeshFormat\n{layout.version} {int(layout.is_binary)} {layout.size}\n".encode()
    return b"".join(
        [
            head + one + b'$EndMeshFormat\n$PhysicalNames\n1\n2 7 "skin"\n$EndPhysicalNames\n',
            b"" if layout.is_binary else FOUR_ENTITIES,
            b"$Nodes\n" + node_section(nodes, layout) + b"$EndNodes\n",
            b"$Elements\n" + element_section(elements, layout) + b"$EndElements\n",
        ]
    )


def _criteria() -> Iterator[Sound]:
    yield Sound("criteria", "paper.toml", dump_criteria(PAPER).encode())
    yield Sound("criteria", "own.toml", OWN_CRITERIA.encode())
    yield Sound("criteria", "hyper.criteria", HYPERMESH.encode())


def _runs(folder: Path) -> Iterator[Sound]:
    yield Sound("config.toml", "config.toml", load_config(None, {}).to_toml().encode())
    yield Sound("config.toml", "own.toml", OWN_CONFIG.encode())
    mesh = small_plate()
    steps = (
        Step(ALL_OPERATIONS[0].code, np.array([[3, 4]], np.int32)),
        Step(NOTHING, np.zeros((0, 2), np.int32)),
    )
    rounds = (Round(Extent(3, 60), 0, (Place((1.0, 2.0, 0.0), steps),)),)
    procedure = Procedure(
        rounds=rounds,
        mesh=mesh.digest,
        result=mesh.digest,
        box=np.array([mesh.points.min(axis=0), mesh.points.max(axis=0)]),
        criteria=STANDARD,
        size=SIZE,
        element_size=SIZE,
        size_field=None,
        feature_angle=30.0,
        slides=True,
        seed=1,
    )
    yield Sound("procedure.json", "procedure.json", procedure.to_json(ALL_OPERATIONS).encode())
    state = SearchState(
        mesh=mesh, best=mesh, rounds=rounds, best_rounds=1, credit=np.zeros(3), turn=1, batches=1,
        evaluations=10, performed=10, reports=1, level=0, first_level=0, cycle=0, aim="faults",
        flows_left=0, flows_in_vain=0, reason="", is_done=False,
    )  # fmt: skip
    place = folder / "run"
    place.mkdir()
    checkpoints = Checkpoints(place, RUN)
    checkpoints.keep(state)
    checkpoints.close()
    files = {name: (place / name).read_bytes() for name in (CHECKPOINT, ROUNDS)}
    for name, data in files.items():
        others = tuple((other, files[other]) for other in files if other != name)
        yield Sound("checkpoint", name, data, others)
    journal = Journal(folder / "journal")
    journal.record(
        RunStarted("plate", "run", 1, "local", 2, {"size": 5.0}, MeshSummary(10, 8, 2, 1, 0.5))
    )
    journal.record(RoundReport(0, 3, 4, 2, 1, 1, 2, 3, 100, 90, 1.5, {"smooth": 1.0}))
    data = (folder / "journal" / JOURNAL).read_bytes()
    journal.close()
    yield Sound("journal", JOURNAL, data)


FOUR = ("four.msh", "four-binary.msh", "old.msh")
