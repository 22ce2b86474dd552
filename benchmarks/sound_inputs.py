"""Small sound inputs of every kind that a run reads, to be damaged."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

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

FOUR_ENTITIES = b"""\
$Entities
0 0 2 0
1 0 0 0 10 15 0 1 7 0
2 10 0 0 15 15 0 0 0
$EndEntities
"""

NASTRAN = {
    "cards.bdf": """\
$ cards of many kinds
CORD2R,5,,0.,0.,0.,0.,0.,1.
,1.,0.,0.
GRID,1,,0.,0.,0.
GRID,2,,5.,0.,0.
GRID           3       5     10.      0.      0.       0     345
GRID*                  4                              0.              5.*
*                     0.
GRID,5,,5.,5.,0.
GRID,6,,10.,5.,0.
CQUAD4         1       7       1       2       5       4     30.      .1+
+                             .1      .1      .1      .1
CQUAD4,2,7,2,3,6,5,,0.05
CTRIA3,3,8,4,5,1
CBAR,9,3,1,2,0.,0.,1.
PSHELL,7,1,.1
PSHELL,8,1,.2,1,,1
MAT1,1,7.+4,,.3
SPC1,1,123456,1,THRU,2
SPC,2,4,345,.0
FORCE,3,6,,1.5,0.,0.,1.
PLOAD4,4,1,.5,,,,THRU,2
PLOAD2,5,-1.,1,2
RBE2,20,1,123,2,4
SET1,30,1,THRU,6,BY,2
ASET1,3,1,2
MPC,6,1,1,1.,2,1,-1.
TEMP,7,1,20.
PARAM,GRDPNT,1
""",
    "case.bdf": """\
SOL 101
CEND
SET 1 = 1,2,THRU,3
SUBCASE 1
  DISP(PLOT) = 1
  LOAD = 3
SUBCASE 2
  SET 1 = ALL
  STRESS = 1
BEGIN BULK
GRID,1,,0.,0.,0.
=,*1,,*5.,==
=2
GRID,11,,0.,5.,0.
GRID,12,,5.,5.,0.
GRID,13,,10.,5.,0.
CQUAD4,1,1,1,2,12,11
CQUAD4,2,1,2,3,13,12
CTRIA6,4,1,1,2,3,11,12,13
SPOINT,100,THRU,105
ENDDATA
""",
}

ABAQUS = {
    "cards.inp": """\
*HEADING
 a plate
** a comment
*NODE, NSET=NALL
1, 0., 0., 0.
2, 5., 0., 0.
3, 10., 0., 0.
4, 0., 5., 0.
5, 5., 5., 0.
6, 10., 5., 0.
*ELEMENT, TYPE=S4R, ELSET="Skin A"
1, 1, 2, 5, 4
2, 2, 3, 6,
 5
*ELEMENT, TYPE=B31, ELSET=BEAMS
9, 1, 2
*NSET, NSET=FIX, GENERATE
1, 4, 3
*ELSET, ELSET=BOTH
Skin A, 2
*SURFACE, NAME=TOP, TYPE=ELEMENT
"Skin A", SPOS
1, S3
*SHELL SECTION, ELSET="Skin A", MATERIAL=STEEL
0.1, 5
*MATERIAL, NAME=STEEL
*ELASTIC
210000., .3
*BOUNDARY
FIX, 1, 6
*INITIAL CONDITIONS, TYPE=TEMPERATURE
NALL, 20.
*STEP
*STATIC
*DLOAD
1, P, .5
*CLOAD
6, 3, 1.
*END STEP
""",
    "parts.inp": """\
*PART, NAME=A
*NODE
1, 0., 0., 0.
2, 5., 0., 0.
3, 5., 5., 0.
4, 0., 5., 0.
*ELEMENT, TYPE=S4
1, 1, 2, 3, 4
*END PART
*PART, NAME=B
*NODE
1, 0., 0., 1.
2, 5., 0., 1.
3, 5., 5., 1.
*ELEMENT, TYPE=S3
1, 1, 2, 3
*END PART
*ASSEMBLY, NAME=ALL
*INSTANCE, NAME=A-1, PART=A
*END INSTANCE
*INSTANCE, NAME=B-1, PART=B
1., 0., 0.
*END INSTANCE
*NSET, NSET=N, INSTANCE=A-1
1, 2
*END ASSEMBLY
""",
}

PLAIN = {
    "arrays.vtu": """\
<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid>
<Piece NumberOfPoints="6" NumberOfCells="3">
<PointData><DataArray type="Float64" Name="T" format="ascii">0 1 2 10 11 12</DataArray></PointData>
<CellData>
<DataArray type="Int32" Name="PartId" format="ascii">1 2 2</DataArray>
<DataArray type="Float32" Name="v" NumberOfComponents="2" format="ascii">1 2 3 4 5 6</DataArray>
</CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 5 0 0 10 0 0 0 5 0 5 5 0 10 5 0
</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">0 1 4 3 1 2 5 4 0 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4 8 10</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">9 9 3</DataArray>
</Cells>
</Piece>
</UnstructuredGrid>
</VTKFile>
""",
    "groups.msh": """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 5 "clamp"
2 11 "skin left"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 5 0 0
3 10 0 0
4 0 5 0
5 5 5 0
6 10 5 0
$EndNodes
$Elements
5
1 15 2 7 1 1
2 1 2 5 4 1 4
3 3 2 11 1 1 2 5 4
4 2 2 22 3 2 3 6
5 2 2 22 3 2 6 5
$EndElements
$NodeData
1
"T"
1
0
3
0
1
6
1 0
2 1
3 2
4 10
5 11
6 12
$EndNodeData
$Periodic
1
0 1 4
1
1 4
$EndPeriodic
""",
    "groups.obj": """\
mtllib a.mtl
o plate
v 0 0 0
v 5 0 0
v 10 0 0
v 0 5 0
v 5 5 0
v 10 5 0
vt 0 0
usemtl steel
f 1/1 2/1 5/1 4/1
g rib
f -5 -4 -1 \\
  -2
l 1 4
""",
    "soup.obj": """\
v 0.000 0.000 0.000
v 5.000 0.000 0.000
v 5.000 5.000 0.000
v 0.000 0.000 0.000
v 5.000 5.000 0.000
v 0.000 5.000 0.000
f 1 2 3
f 4 5 6
""",
    "colours.off": """\
COFF
6 3 0
0 0 0 1 0 0 1
5 0 0 1 0 0 1
10 0 0 1 0 0 1
0 5 0 1 0 0 1
5 5 0 1 0 0 1
10 5 0 1 0 0 1
4 0 1 4 3 255 0 0
3 1 2 5
3 1 5 4 0 0 255
""",
    "words.off": "OFF # words\n4 2 0 0 0\n0 1 0 0 1 1 0 0 1\n0 3 0 1 2 3 0\n2 3\n",
}

OWN_CRITERIA = """\
name = "crash"
base = "standard"
normalised_size = false
penalties = { ideal = 0, good = 0, warn = 0.8, fail = 1, worst = 10 }

[criteria."min size"]
ideal = 5.0
good = 4.5
warn = 3.5
fail = 3.0
worst = 2.0
scaled = false

[criteria."% of trias"]
weight = 2.0
active = true
"""

HYPERMESH = """\
# a comment
1 min length 1 1.0 5.0 4.5 3.5 3.0 2.0
2 max length 1 1.0 5.0 5.5 8.0 10.0 12.0
3 aspect ratio 1 1.0 1.0 2.0 4.4 5.0 10.0
10 jacobian1 1.0 1.0 0.9 0.8 0.7 0.6
penalty value 0.0 0.0 0.8 1.0 10.0
QI color legend 1 2 3
"""

OWN_CONFIG = """\
profile = "thorough"
islands = 4
topology = "edges"
edges = [[0, 1], [1, 2], [2, 3], [3, 0]]
rings = [3, 4, 6]
largest = [60, 100, 160]
migrant-share = 0.1
mode = "overlapped"
seed = 7

[[island]]
population = 8
mutation = 0.3

[[island]]
selection = "tournament"
operations = ["anneal", "remesh", "smooth"]
irregularity = 1.0
"""
