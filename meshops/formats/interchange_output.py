"""Whole new files of interchange formats: .vtu and .msh through meshio, others by ourselves."""

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
from meshops.formats.output import write_whole
from meshops.formats.polygon_text import obj_text, off_text, stl_text
from meshops.mesh import Floats, Ints, ShellMesh

NODES = {"quad": 4, "triangle": 3}
"""Nodes of the cells that are shells, by meshio's name for them."""


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
    texts = {".obj": obj_text, ".off": off_text, ".stl": stl_text}
    if suffix in texts:
        text = texts[suffix](mesh)
        write_whole(path, lambda temporary: temporary.write_text(text))
        return
    rows = [np.flatnonzero(~mesh.is_tria), np.flatnonzero(mesh.is_tria)]
    kinds = [("quad", rows[0]), ("triangle", rows[1])]
    present = [(kind, some) for kind, some in kinds if len(some)]
    cells = [(kind, mesh.elements[some, : NODES[kind]]) for kind, some in present]
    names = ("region",) if suffix == ".vtu" else ("gmsh:physical", "gmsh:geometrical")
    values: dict[str, NDArray[Any]] = dict.fromkeys(names, mesh.region)
    if suffix == ".vtu":
        values |= {name: np.asarray(value) for name, value in (cell_data or {}).items()}
    by_kind = {name: [value[some] for _, some in present] for name, value in values.items()}
    _write_meshio(path, mesh.points, cells, by_kind)


def _write_meshio(
    path: Path,
    points: Floats,
    cells: list[tuple[str, Ints]],
    cell_data: dict[str, list[NDArray[Any]]],
) -> None:
    import meshio

    # a plain ASCII file of format 2.2 is what most programs read
    options = {".msh": {"file_format": "gmsh22", "binary": False}}
    keywords = options.get(path.suffix.lower(), {"file_format": "vtu"})

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
