"""Writing interchange formats: .vtu, .msh and .stl through meshio, .obj and .off by ourselves."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshops.errors import InputError
from meshops.formats import polygons
from meshops.formats.output import write_whole
from meshops.mesh import NO_NODE, Floats, Ids, Ints, ShellMesh

NODES = {"quad": 4, "triangle": 3}
"""Nodes of the cells that are shells, by meshio's name for them."""

REGION_NAMES = ("gmsh:physical", "region")
"""Cell data that tell the region, in the order of preference."""


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
    order, quads = written_order(mesh, suffix), np.count_nonzero(~mesh.is_tria)
    kinds = [("quad", order[:quads]), ("triangle", order[quads:])]
    present = [(kind, some) for kind, some in kinds if len(some)]
    cells = [(kind, mesh.elements[some, : NODES[kind]]) for kind, some in present]
    names = REGION_NAMES[1:] if suffix == ".vtu" else ("gmsh:physical", "gmsh:geometrical")
    values: dict[str, NDArray[Any]] = dict.fromkeys(names, mesh.region)
    if suffix == ".vtu":
        values |= {name: np.asarray(value) for name, value in (cell_data or {}).items()}
    by_kind = {name: [value[some] for _, some in present] for name, value in values.items()}
    _write_meshio(path, meshio_format(suffix), mesh.points, cells, by_kind)


def written_order(mesh: ShellMesh, suffix: str) -> Ids:
    """(M,) int64 rows of the elements in the order in which a file of the suffix has them.

    An .stl file has two trias for each quad, in the order of the elements.
    """
    if suffix.lower() in (".vtu", ".msh"):
        return np.concatenate([np.flatnonzero(~mesh.is_tria), np.flatnonzero(mesh.is_tria)])
    return np.arange(len(mesh.elements))


def meshio_format(suffix: str) -> str:
    """Return meshio's name for the format of a suffix."""
    return "gmsh" if suffix == ".msh" else suffix[1:]


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
        with failing_as(f"{path} cannot be written"):
            # meshio converts the arrays that it is given in place
            mesh = meshio.Mesh(points.copy(), cells, cell_data=cell_data)
            meshio.write(temporary, mesh, **keywords)

    write_whole(path, write)


@contextlib.contextmanager
def failing_as(sentence: str) -> Iterator[None]:
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
