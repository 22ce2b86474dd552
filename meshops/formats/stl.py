"""STL files, text or binary: trias that share no points are welded; names of solids stay."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshops.errors import InputError
from meshops.formats.carrying import Carried
from meshops.formats.fresh import write_edited
from meshops.formats.grid import Grid, Shells, shells_of
from meshops.formats.ids import IdSet
from meshops.formats.locks import Lock
from meshops.formats.one_file import OneFile
from meshops.formats.polygon_text import normals_of, solids_text, split_trias
from meshops.formats.sources import read_bytes
from meshops.formats.welding import weld
from meshops.formats.words import resolution
from meshops.mesh import Floats, Ids, ShellMesh

HEAD, RECORD = 80, 50
"""Bytes of the head of a binary file, and of each tria in it."""

SINGLE = 4.0 * float(np.finfo(np.float32).eps)
"""Of the largest coordinate: up to which single precision tells two places apart."""

_RECORD = np.dtype([("normal", "<f4", 3), ("at", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True, eq=False)
class Raw:
    """Trias of a file.

    Attributes
    ----------
    places : (t, 3, 3) float64
    solid : (t,) int64
        Which of the names a tria belongs to.
    names : list of str
    attributes : (t,) uint16
        Of a binary file; colours, often.
    resolution : float
        Up to which the file tells two numbers apart.
    head : bytes
        Of a binary file; empty in a text.
    """

    places: Floats
    solid: Ids
    names: list[str]
    attributes: NDArray[np.uint16]
    resolution: float
    head: bytes = b""


@dataclass(frozen=True, eq=False)
class StlFile(OneFile):
    """An STL file and the mesh of its trias.

    Attributes
    ----------
    source : Path
    data : bytes
        The file as it was read.
    raw : Raw
    tria_of : (m,) int64
        Row of the tria of each element of the mesh.
    shells : Shells
    notes : tuple of str
    """

    source: Path
    data: bytes
    raw: Raw
    tria_of: Ids
    shells: Shells
    notes: tuple[str, ...]

    @property
    def mesh(self) -> ShellMesh:
        """The trias; a region is a solid where the file has several."""
        return self.shells.mesh

    @property
    def locks(self) -> tuple[Lock, ...]:
        """What of the mesh is locked."""
        return self.shells.locks

    def check_room(self) -> None:
        """Do nothing: what is new is known by its row."""

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
        """Write ``mesh`` with its quads split, as text or binary as the file was.

        Raises
        ------
        InputError
            Where ``path`` is the source or cannot be written.
        """
        return write_edited(mesh, path, self.source, self._written)

    def _written(self, mesh: ShellMesh) -> bytes:
        count = max(len(self.raw.places), 1)
        taken = IdSet(ranges={(1, 3 * count, 1)})
        carried = Carried.of(self.mesh, mesh, taken, taken)
        if carried.is_unchanged:
            return self.data
        trias, element = split_trias(mesh)
        source = self.tria_of[carried.element_rows[element]]
        order = np.argsort(self.raw.solid[source], kind="stable")
        places, source = mesh.points[trias[order]], source[order]
        if self.raw.head:
            return _binary(places, self.raw.head, self.raw.attributes[source])
        return solids_text(places, self.raw.solid[source], self.raw.names).encode("latin-1")


def read_stl(path: Path) -> StlFile:
    """Read an STL file.

    Raises
    ------
    InputError
        Where the file is missing, empty, cut short or no STL, or as ``checked_mesh``.
    """
    data, name = read_bytes(path), path.name
    raw = _read(data, name)
    points = raw.places.reshape(-1, 3)
    corners = np.full((len(raw.places), 4), -1, np.int64)
    corners[:, :3] = np.arange(len(points)).reshape(-1, 3)
    welded = weld(points, corners, raw.resolution)
    corners[:, :3] = welded.point_of[corners[:, :3]]
    a, b, c = corners[:, :3].T
    # a tria that has become a line means nothing
    kept = np.flatnonzero((a != b) & (b != c) & (c != a))
    several = len(raw.names) > 1
    grid = Grid(
        source=name,
        points=points,
        node_ids=np.arange(1, len(points) + 1),
        corners=corners[kept],
        shell_ids=kept + 1,
        parts=raw.solid[kept] + 1 if several else np.zeros(len(kept), np.int64),
        held_nodes=welded.held,
        held_by="points on the same place",
    )
    shells = shells_of(grid, lambda _: name, lambda _: name)
    notes = list(shells.notes)
    if len(kept) < len(corners):
        notes.append(f"{len(corners) - len(kept):,} trias without a height are left out.")
    tria_of = shells.mesh.element_ids - 1
    return StlFile(path, data, raw, tria_of, shells, tuple(notes))


def _read(data: bytes, name: str) -> Raw:
    if not data.strip():
        raise InputError(f"{name} cannot be read as stl: it is empty; check the file.")
    if len(data) >= HEAD + 4:
        count = int(np.frombuffer(data, "<u4", 1, HEAD)[0])
        if len(data) == HEAD + 4 + RECORD * count:
            return _read_binary(data, count)
    if data.lstrip()[:5].lower() == b"solid":
        return _read_text(data, name)
    raise InputError(
        f"{name} cannot be read as stl: it is no text, and not as long as its number of trias "
        "says; check the file."
    )


def _read_binary(data: bytes, count: int) -> Raw:
    rows = np.frombuffer(data, _RECORD, count, HEAD + 4)
    places = rows["at"].astype(np.float64).reshape(-1, 3, 3)
    largest = float(np.abs(places).max(initial=0.0))
    solid = np.zeros(count, np.int64)
    return Raw(places, solid, [""], rows["attribute"], SINGLE * largest, data[:HEAD])


def _read_text(data: bytes, name: str) -> Raw:
    words: list[str] = []
    facets: list[int] = []
    solid: list[int] = []
    names: list[str] = []
    has_ended = True
    for number, line in enumerate(data.decode("latin-1").splitlines(), start=1):
        found = line.split()
        key = found[0].lower() if found else ""
        if key == "vertex":
            if len(found) != 4:
                raise InputError(
                    f"{name} cannot be read as stl: line {number} is no vertex; correct it."
                )
            words += found[1:]
        elif key == "solid":
            names.append(line.strip()[5:].strip())
            has_ended = False
        elif key == "endsolid":
            has_ended = True
        elif key == "endfacet":
            if len(words) != 9 * (len(facets) + 1):
                raise InputError(
                    f"{name} cannot be read as stl: the facet that ends in line {number} has not "
                    "three vertices; correct it."
                )
            facets.append(number)
            solid.append(len(names) - 1)
    if len(words) != 9 * len(facets) or not has_ended:
        raise InputError(f"{name} cannot be read as stl: it is cut short; check the file.")
    try:
        values = np.array(words, dtype="U").astype(np.float64) if words else np.zeros(0)
    except ValueError as error:
        raise InputError(f"{name} cannot be read as stl: {error}; correct it.") from error
    places = values.reshape(-1, 3, 3)
    used = sorted(set(solid))
    rows = np.searchsorted(used, np.array(solid, np.int64))
    kept = [names[row] for row in used] or [""]
    attributes = np.zeros(len(places), np.uint16)
    return Raw(places, rows, kept, attributes, resolution(words))


def _binary(places: Floats, head: bytes, attributes: NDArray[np.uint16]) -> bytes:
    rows = np.zeros(len(places), _RECORD)
    rows["normal"], rows["at"], rows["attribute"] = normals_of(places), places, attributes
    return head + np.array(len(places), "<u4").tobytes() + rows.tobytes()
