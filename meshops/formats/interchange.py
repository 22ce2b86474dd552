"""Reading interchange formats: .vtu, .msh and .stl through meshio, .obj and .off by ourselves.

These files hold a mesh and little else: they are written anew, not spliced.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from meshops.formats import fresh, polygons
from meshops.formats.checks import Place, checked_mesh
from meshops.formats.interchange_output import (
    NODES,
    REGION_NAMES,
    failing_as,
    meshio_format,
)
from meshops.formats.locks import Lock
from meshops.formats.output import refuse_to_overwrite
from meshops.formats.sources import read_bytes
from meshops.mesh import Floats, Ids, Ints, ShellMesh


@dataclass(frozen=True)
class InterchangeFile:
    """A mesh from an interchange file; nothing of the file is kept but its quads and trias."""

    mesh: ShellMesh
    source: Path
    locks: tuple[Lock, ...] = ()
    notes: tuple[str, ...] = ()

    def check_room(self) -> None:
        """Do nothing: such a file has no ids that could run out."""

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
    points, corners, region = _from_meshio(path, meshio_format(suffix))
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


def _from_meshio(path: Path, file_format: str) -> tuple[Floats, Ids, Ints]:
    import meshio

    read_bytes(path)
    with failing_as(f"{path} cannot be read as {file_format}"):
        found = meshio.read(path, file_format=file_format)
        points = np.zeros((len(found.points), 3))
        points[:, : np.shape(found.points)[1]] = found.points
        corners, regions = [np.zeros((0, 4), np.int64)], [np.zeros(0, np.int32)]
        for i, block in enumerate(found.cells):
            if block.type not in NODES:
                continue
            data = np.zeros((len(block.data), 4), np.int64)
            data[:, : NODES[block.type]] = np.asarray(block.data) + 1
            corners.append(data)
            regions.append(_region(found.cell_data, i, len(data)))
    if file_format == "stl":
        points, corners = _merge_equal(points, corners)
    return points, np.concatenate(corners), np.concatenate(regions)


def _region(cell_data: Mapping[str, Any], block: int, count: int) -> Ints:
    for name in REGION_NAMES:
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
