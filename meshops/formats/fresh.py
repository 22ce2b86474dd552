"""Whole new files for a mesh that comes from no deck."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from meshops.formats.abaqus_output import element_row, node_row, set_rows
from meshops.formats.difference import deck_corners
from meshops.formats.fortran import real_field
from meshops.formats.ids import IdSet, with_new_ids
from meshops.formats.interchange_output import write_interchange
from meshops.formats.nastran_cards import Form, card_lines
from meshops.formats.output import refuse_to_overwrite, write_whole
from meshops.formats.suffixes import ABAQUS, NASTRAN, check_writable_suffix
from meshops.mesh import Ids, ShellMesh

_LARGEST_ID = 99_999_999


def write_mesh(
    mesh: ShellMesh, path: Path, *, cell_data: Mapping[str, ArrayLike] | None = None
) -> None:
    """Write a mesh as a new file in the format of the suffix.

    A deck gets the nodes and shells: region r becomes property r, or set REGION_r; where regions
    start below 1, they are counted from 1. What is locked is named by SET3 cards, or by sets of the
    name LOCKED, so that it is locked again when the deck is read.

    Parameters
    ----------
    cell_data : mapping of str to (M,) or (M, k) arrays
        Values of the elements in their order, for .vtu alone.

    Raises
    ------
    InputError
        Where the suffix is of no known format or the file cannot be written.
    """
    check_writable_suffix(path)
    suffix = path.suffix.lower()
    if suffix in NASTRAN + ABAQUS:
        rows = _nastran(mesh) if suffix in NASTRAN else _abaqus(mesh)
        text = "\n".join([*rows, ""])
        write_whole(path, lambda temporary: temporary.write_text(text))
        return
    write_interchange(mesh, path, cell_data)


def write_edited(
    mesh: ShellMesh, path: Path, source: Path, written: Callable[[ShellMesh], bytes]
) -> tuple[Path, ...]:
    """Write an edited mesh in the format of its file, or as a new file of another format.

    Parameters
    ----------
    mesh : ShellMesh
    path, source : Path
        The file to write and that which was read.
    written : callable
        What is in the file of the same format.

    Returns the files that were written.

    Raises
    ------
    InputError
        Where ``path`` is the source or cannot be written.
    """
    refuse_to_overwrite(path, [source])
    if path.suffix.lower() != source.suffix.lower():
        write_mesh(mesh, path)
        return (path,)
    data = written(mesh)
    write_whole(path, lambda temporary: temporary.write_bytes(data))
    return (path,)


def _nastran(mesh: ShellMesh) -> list[str]:
    node_ids, element_ids, corners, properties = _numbers(mesh)
    rows = ["CEND", "BEGIN BULK"]
    for node, point in zip(node_ids.tolist(), mesh.points.tolist(), strict=True):
        rows += card_lines("GRID", [str(node), "", *map(real_field, point)], Form(wide=True))
    for values in zip(element_ids.tolist(), properties.tolist(), corners.tolist(), strict=True):
        element, pid, nodes = values
        name = "CQUAD4" if nodes[3] else "CTRIA3"
        fields = [str(value) for value in (element, pid, *nodes) if value]
        rows += card_lines(name, fields, Form())
    for number, (kind, ids) in enumerate(_locked(mesh, node_ids, element_ids), 1):
        if len(ids):
            named = ("GRID", "ELEM")[kind == "elements"]
            rows += card_lines("SET3", [str(number), named, *map(str, ids)], Form())
    return [*rows, "ENDDATA"]


def _abaqus(mesh: ShellMesh) -> list[str]:
    node_ids, element_ids, corners, properties = _numbers(mesh)
    rows = ["*NODE"]
    for node, point in zip(node_ids.tolist(), mesh.points.tolist(), strict=True):
        rows.append(node_row(node, point))
    for pid in np.unique(properties):
        for kind, wanted in (("S4R", False), ("S3", True)):
            some = np.flatnonzero((properties == pid) & (mesh.is_tria == wanted))
            rows += [f"*ELEMENT, TYPE={kind}, ELSET=REGION_{pid}"] if len(some) else []
            rows += map(element_row, element_ids[some].tolist(), corners[some].tolist())
    for kind, ids in _locked(mesh, node_ids, element_ids):
        name = ("NSET", "ELSET")[kind == "elements"]
        if len(ids):
            rows += [f"*{name}, {name}=LOCKED", *set_rows([str(number) for number in ids])]
    return rows


def _locked(mesh: ShellMesh, node_ids: Ids, element_ids: Ids) -> list[tuple[str, list[int]]]:
    return [
        ("nodes", node_ids[mesh.locked_nodes].tolist()),
        ("elements", element_ids[mesh.locked_elements].tolist()),
    ]


def _numbers(mesh: ShellMesh) -> tuple[Ids, Ids, Ids, Ids]:
    """Node ids, element ids, corners and property ids, all positive."""
    node_ids = with_new_ids(mesh.node_ids, IdSet(), _LARGEST_ID)
    element_ids = with_new_ids(mesh.element_ids, IdSet(), _LARGEST_ID)
    shift = 1 - min(int(mesh.region.min(initial=1)), 1)
    properties = mesh.region.astype(np.int64) + shift
    return node_ids, element_ids, deck_corners(mesh, node_ids), properties
