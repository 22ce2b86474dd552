"""VTK's .vtu files: the shells are edited; all other cells and all arrays stay.

A new point has values that are interpolated on the mesh that was read, a new cell those of the cell
that was nearest. The file is written in the coding that it had.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import numpy as np
from numpy.typing import NDArray

from meshops.errors import InputError
from meshops.formats.file_rows import FileRows
from meshops.formats.fresh import write_edited
from meshops.formats.grid import Grid, Others, Shells, shells_of
from meshops.formats.locks import Lock
from meshops.formats.one_file import OneFile
from meshops.formats.parts import parts_of
from meshops.formats.sources import read_bytes
from meshops.formats.vtu_xml import Document
from meshops.mesh import NO_NODE, Bools, Ids, ShellMesh

TRIA, POLYGON, QUAD = 5, 7, 9
"""VTK's types of the cells that are shells; a polygon is one where it has three or four corners."""

POLYHEDRON = 42

DIMENSIONS = {0: 0, 1: 0, 2: 0, 3: 1, 4: 1, 21: 1, 35: 1, 68: 1, 75: 1} | dict.fromkeys(
    (5, 6, 7, 8, 9, 22, 23, 28, 30, 34, 36, 69, 70, 76, 77), 2
)
"""Dimension of a cell by its type; all others are solids."""

POLYLINE = 4


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of a file: (c,) types, (c + 1,) where their points begin, (k,) these."""

    types: Ids
    start: Ids
    points: Ids

    @property
    def sizes(self) -> Ids:
        """(c,) points of each cell."""
        return np.diff(self.start)

    def of(self, rows: Ids, count: int) -> Ids:
        """(k, count) points of cells that have that many."""
        found: Ids = self.points[self.start[rows][:, None] + np.arange(count)]
        return found


@dataclass(frozen=True, eq=False)
class VtuFile(OneFile):
    """A .vtu file and the mesh of its shells.

    Attributes
    ----------
    source : Path
    data : bytes
        The file as it was read.
    document : Document
    piece : Element
    cells : Cells
    shell_rows : (s,) int64
        Rows of the cells that are shells.
    shells : Shells
    notes : tuple of str
    """

    source: Path
    data: bytes
    document: Document
    piece: Xml.Element
    cells: Cells
    shell_rows: Ids
    shells: Shells
    notes: tuple[str, ...]

    @property
    def mesh(self) -> ShellMesh:
        """Quads and trias, with the regions that arrays of the cells tell."""
        return self.shells.mesh

    @property
    def locks(self) -> tuple[Lock, ...]:
        """What of the mesh is locked."""
        return self.shells.locks

    def check_room(self) -> None:
        """Do nothing: what is new is known by its row."""

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
        """Write the file with ``mesh`` in the place of its shells.

        Raises
        ------
        InputError
            Where ``path`` is the source or cannot be written.
        """
        return write_edited(mesh, path, self.source, self._written)

    def _written(self, mesh: ShellMesh) -> bytes:
        document, points = self.document, _points(self.document, self.piece)
        element_of = np.full(len(self.cells.types), -1, np.int64)
        element_of[self.shell_rows] = self.shells.element_of
        every = np.arange(len(points))
        rows = FileRows.of(self.shells, mesh, points, every, element_of)
        if rows.carried.is_unchanged:
            return self.data
        changed: dict[Xml.Element, NDArray[Any]] = {}
        (place,) = _arrays(self.piece, "Points").values()
        changed[place] = rows.points[:, : _width(document, place)]
        for array in _arrays(self.piece, "PointData").values():
            changed[array] = rows.point_values(document.values(array))
        for array in _arrays(self.piece, "CellData").values():
            changed[array] = rows.cell_values(document.values(array))
        changed |= self._changed_cells(rows)
        return document.written(changed, len(rows.points), len(rows.cell_from))

    def _changed_cells(self, rows: FileRows) -> dict[Xml.Element, NDArray[Any]]:
        cells, parts = self.cells, _arrays(self.piece, "Cells")
        edited = np.zeros(len(cells.types), bool)
        edited[self.shell_rows] = self.shells.element_of >= 0
        types = cells.types[rows.cell_from]
        shell = edited[rows.cell_from]
        size = np.where(rows.corners[:, 3] == NO_NODE, 3, 4)
        other = rows.is_new | ((size != cells.sizes[rows.cell_from]) & (types != POLYGON))
        types = np.where(shell & other, np.where(size == 3, TRIA, QUAD), types)
        sizes = np.where(shell, size, cells.sizes[rows.cell_from])
        points = []
        for row, cell in enumerate(rows.cell_from.tolist()):
            if shell[row]:
                points.append(rows.corners[row, : sizes[row]])
            else:
                points.append(
                    rows.point_of[cells.points[cells.start[cell] : cells.start[cell + 1]]]
                )
        found = {
            parts["connectivity"]: np.concatenate(points),
            parts["offsets"]: np.cumsum(sizes),
            parts["types"]: types,
        }
        return found | self._changed_faces(rows, parts)

    def _changed_faces(
        self, rows: FileRows, parts: dict[str, Xml.Element]
    ) -> dict[Xml.Element, NDArray[Any]]:
        """Faces of polyhedra: they stay, and come in the same order, on rows as they are now."""
        found: dict[Xml.Element, NDArray[Any]] = {}
        for name, of_new in (("faceoffsets", -1), ("polyhedron_offsets", None)):
            if name in parts:
                stops = self.document.values(parts[name]).astype(np.int64)
                last = int(stops.max(initial=0)) if of_new is None else of_new
                found[parts[name]] = np.where(rows.is_new, last, stops[rows.cell_from])
        if "faces" in parts:
            faces = self.document.values(parts["faces"]).astype(np.int64)
            found[parts["faces"]] = _mapped_faces(faces, rows.point_of, self.source.name)
        if "face_connectivity" in parts:
            points = self.document.values(parts["face_connectivity"]).astype(np.int64)
            found[parts["face_connectivity"]] = rows.point_of[points]
        return found


def read_vtu(path: Path, regions: str | None = None) -> VtuFile:
    """Read a .vtu file of one piece.

    Parameters
    ----------
    path : Path
    regions : str, optional
        Name of the array of the cells that tells the regions; otherwise those that are named like a
        part id do.

    Raises
    ------
    InputError
        Where the file is missing or cannot be read, there is no such array, or as
        ``checked_mesh``.
    """
    data, name = read_bytes(path), path.name
    document = Document.parse(data, name)
    pieces = list(document.root.iter("Piece"))
    if len(pieces) != 1:
        raise InputError(f"{name} has {len(pieces)} pieces: save it as one.")
    piece = pieces[0]
    points = _points(document, piece)
    cells = _cells(document, piece, name)
    _check_lengths(document, piece, len(points), len(cells.types), name)
    sizes = cells.sizes
    is_shell = (cells.types == TRIA) & (sizes == 3) | (cells.types == QUAD) & (sizes == 4)
    is_shell |= (cells.types == POLYGON) & ((sizes == 3) | (sizes == 4))
    shell_rows = np.flatnonzero(is_shell)
    corners = np.full((len(shell_rows), 4), NO_NODE, np.int64)
    for count in (3, 4):
        some = sizes[shell_rows] == count
        corners[some, :count] = cells.of(shell_rows[some], count)
    arrays = {
        array_name: document.values(array)[shell_rows]
        for array_name, array in _arrays(piece, "CellData").items()
    }
    parts, names = parts_of(arrays, regions, name)
    _check_faces(document, piece, len(points), len(cells.types))
    grid = Grid(
        source=name,
        points=points,
        node_ids=np.arange(1, len(points) + 1),
        corners=corners,
        shell_ids=shell_rows + 1,
        parts=parts if len(arrays) else np.zeros(len(shell_rows), np.int64),
        others=_others(cells, is_shell),
    )
    shells = shells_of(grid, lambda _: name, lambda _: name)
    notes = list(shells.notes)
    if names and len(np.unique(shells.mesh.region)) > 1:
        words = " and ".join(f"'{found}'" for found in names)
        notes.append(f"The cell array {words} tells the regions.")
    return VtuFile(path, data, document, piece, cells, shell_rows, shells, tuple(notes))


def _arrays(piece: Xml.Element, name: str) -> dict[str, Xml.Element]:
    """DataArrays of a part of a piece, by their names."""
    part = piece.find(name)
    found = [] if part is None else part.findall("DataArray")
    return {array.get("Name") or f"{name} {row}": array for row, array in enumerate(found)}


def _width(document: Document, array: Xml.Element) -> int:
    values = document.values(array)
    return values.shape[1] if values.ndim > 1 else 1


def _points(document: Document, piece: Xml.Element) -> NDArray[np.float64]:
    arrays = _arrays(piece, "Points")
    if len(arrays) != 1:
        raise InputError(f"{document.source} has no points: check the file.")
    values = document.values(next(iter(arrays.values())))
    if len(values) and (values.ndim != 2 or values.shape[1] not in (2, 3)):
        raise InputError(f"{document.source}: a point needs three coordinates; check the file.")
    points = np.zeros((len(values), 3))
    if len(values):
        points[:, : values.shape[1]] = values
    return points


def _cells(document: Document, piece: Xml.Element, name: str) -> Cells:
    arrays = _arrays(piece, "Cells")
    missing = {"connectivity", "offsets", "types"} - arrays.keys()
    if missing:
        raise InputError(f"{name} has no {min(missing)} of cells: there is nothing to repair.")
    read = {key: document.values(arrays[key]) for key in ("connectivity", "offsets", "types")}
    points, stops, types = (read[key].ravel().astype(np.int64) for key in read)
    start = np.concatenate([np.zeros(1, np.int64), stops])
    if len(types) != len(stops) or (np.diff(start) < 0).any() or start[-1] > len(points):
        raise InputError(
            f"{name}: the offsets of the cells do not fit their points; check the file."
        )
    return Cells(types, start, points)


def _check_lengths(
    document: Document, piece: Xml.Element, points: int, cells: int, name: str
) -> None:
    for kind, count in (("PointData", points), ("CellData", cells)):
        for array_name, array in _arrays(piece, kind).items():
            length = len(document.values(array))
            if length != count:
                raise InputError(
                    f"{name}: the array '{array_name}' has {length} values for {count} "
                    f"{'points' if kind == 'PointData' else 'cells'}; check the file."
                )


def _check_faces(document: Document, piece: Xml.Element, points: int, cells: int) -> None:
    arrays = _arrays(piece, "Cells")
    for name in ("faceoffsets", "polyhedron_offsets"):
        if name in arrays and len(document.values(arrays[name])) != cells:
            raise InputError(f"{document.source}: '{name}' does not fit the cells; check the file.")
    if "faces" in arrays:
        faces = document.values(arrays["faces"]).astype(np.int64)
        _mapped_faces(faces, np.arange(points), document.source)
    if "face_connectivity" in arrays:
        nodes = document.values(arrays["face_connectivity"]).astype(np.int64)
        if nodes.size and (nodes.min() < 0 or nodes.max() >= points):
            raise InputError(f"{document.source}: a face names a point that is not there.")


def _mapped_faces(faces: Ids, point_of: Ids, source: str) -> Ids:
    """Faces of polyhedra, 'count, size, points, size, points ...', on other rows of points."""
    found = faces.copy()
    at = 0
    while at < len(faces):
        count, at = int(faces[at]), at + 1
        for _ in range(count):
            size = int(faces[at]) if at < len(faces) else -1
            nodes = faces[at + 1 : at + 1 + size]
            if size < 0 or len(nodes) < size or (nodes < 0).any() or (nodes >= len(point_of)).any():
                raise InputError(f"{source}: the faces of the polyhedra are wrong; check the file.")
            found[at + 1 : at + 1 + size] = point_of[nodes]
            at += 1 + size
    return found


def _others(cells: Cells, is_shell: Bools) -> list[Others]:
    found = []
    sizes = cells.sizes
    for kind in np.unique(cells.types[~is_shell]).tolist():
        rows = np.flatnonzero((cells.types == kind) & ~is_shell)
        for count in np.unique(sizes[rows]).tolist():
            nodes = cells.of(rows[sizes[rows] == count], count)
            dimension = DIMENSIONS.get(kind, 3)
            if kind == POLYLINE and count > 2:
                nodes = np.stack([nodes[:, :-1], nodes[:, 1:]], axis=-1).reshape(-1, 2)
            if count:
                found.append(Others(nodes, dimension))
    return found
