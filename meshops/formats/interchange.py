"""Interchange formats: .vtu, .msh and .stl through meshio, .obj and .off read here.

These files hold a mesh and little else: they are written anew, not spliced.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshops.errors import InputError
from meshops.formats import fresh, polygons
from meshops.formats.checks import Place, checked_mesh
from meshops.formats.output import refuse_to_overwrite, write_whole
from meshops.formats.sources import read_bytes
from meshops.mesh import NO_NODE, Floats, Ids, Ints, ShellMesh

_NODES = {"quad": 4, "triangle": 3}
_REGION_NAMES = ("gmsh:physical", "region")


@dataclass(frozen=True)
class InterchangeFile:
    """A mesh from an interchange file; nothing of the file is kept but its quads and trias."""

    mesh: ShellMesh
    source: Path

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write ``mesh`` as a whole new file; raises InputError where ``path`` is the source."""
        refuse_to_overwrite(path, [self.source])
        fresh.write_mesh(mesh, path)


def read_interchange(path: Path) -> InterchangeFile:
    """Read the quads and trias of a file; other cells are passed over.

    Points of a plane mesh get z = 0, equal points of an STL file become one node. Regions are
    taken from the cell data ``gmsh:physical`` or ``region``.

    Raises
    ------
    InputError
        Where the file is missing or cannot be read, has a polygon of more than four corners, or the
        mesh fails the checks of ``checked_mesh``.
    """
    suffix = path.suffix.lower()
    if suffix in (".obj", ".off"):
        read = polygons.read_obj if suffix == ".obj" else polygons.read_off
        found = read(path)
        region = np.zeros(len(found.corners), np.int32)
        return InterchangeFile(
            _mesh(
                path,
                found.points,
                found.corners,
                region,
                node_place=lambda row: f"{path.name}, line {found.point_lines[row]}",
                element_place=lambda row: f"{path.name}, line {found.corner_lines[row]}",
            ),
            path,
        )
    points, corners, region = _from_meshio(path, _meshio_format(suffix))
    return InterchangeFile(
        _mesh(
            path,
            points,
            corners,
            region,
            node_place=lambda _: path.name,
            element_place=lambda _: path.name,
        ),
        path,
    )


def write_interchange(
    mesh: ShellMesh, path: Path, cell_data: Mapping[str, ArrayLike] | None = None
) -> None:
    """Write a mesh as .vtu, .msh (2.2), .stl, .obj or .off.

    The quads come first in .vtu and .msh, then the trias, with their regions. An STL file knows
    only trias: quads are split along the shorter diagonal.

    Parameters
    ----------
    cell_data : mapping of str to (M,) or (M, k) arrays
        Values of the elements, in their order; only .vtu holds them.
    """
    suffix = path.suffix.lower()
    if suffix in (".obj", ".off"):
        text = polygons.obj_text(mesh) if suffix == ".obj" else polygons.off_text(mesh)
        write_whole(path, lambda temporary: temporary.write_text(text))
        return
    if suffix == ".stl":
        cells = [("triangle", _split_quads(mesh))]
        _write_meshio(path, "stl", mesh.points, cells, {})
        return
    rows = [np.flatnonzero(~mesh.is_tria), np.flatnonzero(mesh.is_tria)]
    kinds = [("quad", rows[0]), ("triangle", rows[1])]
    present = [(kind, some) for kind, some in kinds if len(some)]
    cells = [(kind, mesh.elements[some, : _NODES[kind]]) for kind, some in present]
    names = _REGION_NAMES[1:] if suffix == ".vtu" else ("gmsh:physical", "gmsh:geometrical")
    values: dict[str, NDArray[Any]] = dict.fromkeys(names, mesh.region)
    if suffix == ".vtu":
        values |= {name: np.asarray(value) for name, value in (cell_data or {}).items()}
    by_kind = {name: [value[some] for _, some in present] for name, value in values.items()}
    _write_meshio(path, _meshio_format(suffix), mesh.points, cells, by_kind)


def _meshio_format(suffix: str) -> str:
    return "gmsh" if suffix == ".msh" else suffix[1:]


def _from_meshio(path: Path, file_format: str) -> tuple[Floats, Ids, Ints]:
    import meshio

    read_bytes(path)
    with _failing_as(f"{path} cannot be read as {file_format}"):
        found = meshio.read(path, file_format=file_format)
        points = np.zeros((len(found.points), 3))
        points[:, : np.shape(found.points)[1]] = found.points
        corners, regions = [np.zeros((0, 4), np.int64)], [np.zeros(0, np.int32)]
        for i, block in enumerate(found.cells):
            if block.type not in _NODES:
                continue
            data = np.zeros((len(block.data), 4), np.int64)
            data[:, : _NODES[block.type]] = np.asarray(block.data) + 1
            corners.append(data)
            regions.append(_region(found.cell_data, i, len(data)))
    if file_format == "stl":
        points, corners = _merge_equal(points, corners)
    return points, np.concatenate(corners), np.concatenate(regions)


def _region(cell_data: Mapping[str, Any], block: int, count: int) -> Ints:
    for name in _REGION_NAMES:
        if name in cell_data:
            values: Ints = np.asarray(cell_data[name][block]).astype(np.int32).reshape(count)
            return values
    return np.zeros(count, np.int32)


def _merge_equal(points: Floats, corners: list[Ids]) -> tuple[Floats, list[Ids]]:
    distinct, first, inverse = np.unique(points, axis=0, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    number = np.concatenate([[0], rank[inverse.ravel()] + 1])
    return distinct[np.argsort(first)], [number[some] for some in corners]


def _mesh(
    path: Path,
    points: Floats,
    corners: Ids,
    region: Ints,
    *,
    node_place: Place,
    element_place: Place,
) -> ShellMesh:
    return checked_mesh(
        source=path.name,
        points=points,
        node_ids=np.arange(1, len(points) + 1),
        corners=corners,
        element_ids=np.arange(1, len(corners) + 1),
        region=region,
        locked_nodes=np.zeros(len(points), bool),
        locked_elements=np.zeros(len(corners), bool),
        node_place=node_place,
        element_place=element_place,
    )


def _split_quads(mesh: ShellMesh) -> Ints:
    """(K, 3) trias: those of the mesh, and two for each quad, in the order of the elements."""
    a, b, c, d = mesh.elements.T
    p = mesh.points
    other = np.linalg.norm(p[b] - p[d], axis=1) < np.linalg.norm(p[a] - p[c], axis=1)
    first = np.where(other, [a, b, d], [a, b, c]).T
    second = np.where(other, [b, c, d], [a, c, d]).T
    first[mesh.is_tria] = mesh.elements[mesh.is_tria, :3]
    second[mesh.is_tria] = NO_NODE
    both = np.stack([first, second], axis=1).reshape(-1, 3)
    trias: Ints = both[both[:, 0] != NO_NODE]
    return trias


def _write_meshio(
    path: Path,
    file_format: str,
    points: Floats,
    cells: list[tuple[str, Ints]],
    cell_data: dict[str, list[NDArray[Any]]],
) -> None:
    import meshio

    # a plain ASCII file of format 2.2 is what most programs read
    options = {"gmsh": {"file_format": "gmsh22", "binary": False}}
    keywords = options.get(file_format, {"file_format": file_format})

    def write(temporary: Path) -> None:
        with _failing_as(f"{path} cannot be written"):
            # meshio converts the arrays that it is given in place
            mesh = meshio.Mesh(points.copy(), cells, cell_data=cell_data)
            meshio.write(temporary, mesh, **keywords)

    write_whole(path, write)


@contextlib.contextmanager
def _failing_as(sentence: str) -> Iterator[None]:
    """Turn whatever meshio raises into an InputError, and keep it from printing."""
    unheard = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(unheard),
            contextlib.redirect_stderr(unheard),
            warnings.catch_warnings(action="ignore"),
        ):
            yield
    except OSError:
        raise
    except (Exception, SystemExit) as error:
        reason = str(error).strip().rstrip(".") or type(error).__name__
        raise InputError(f"{sentence}: {reason}; check the file.") from error
