"""Gmsh's .msh files: the shells are edited, and all else is written as it was read.

The version, the encoding, physical groups, entities, lines, points, solids, elements of second
order and periodic nodes stay; so do values at nodes and elements, as far as these do.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshops.errors import InputError
from meshops.formats.carrying import Carried
from meshops.formats.fresh import write_edited
from meshops.formats.gmsh_data import carried_data, data_section, read_data, without_elements
from meshops.formats.gmsh_edits import edited_elements, edited_nodes
from meshops.formats.gmsh_sections import Section, layout_of, periodic_nodes, sections_of
from meshops.formats.gmsh_stream import Layout
from meshops.formats.gmsh_tables import (
    NODES,
    QUAD,
    TRIA,
    ElementTable,
    NodeTable,
    dimension_of,
    element_section,
    node_section,
    read_elements,
    read_nodes,
    read_physicals,
)
from meshops.formats.grid import Grid, Others, Shells, shells_of
from meshops.formats.ids import IdSet
from meshops.formats.locks import Lock
from meshops.formats.one_file import OneFile
from meshops.formats.sources import read_bytes
from meshops.mesh import NO_NODE, Ids, ShellMesh


@dataclass(frozen=True, eq=False)
class GmshFile(OneFile):
    """A .msh file and the mesh of its shells.

    Attributes
    ----------
    source : Path
    data : bytes
        The file as it was read.
    layout : Layout
    sections : list of Section
    nodes : NodeTable
    elements : ElementTable
    shell_rows : (s,) int64
        Rows of the quads and trias in ``elements``.
    shells : Shells
    """

    source: Path
    data: bytes
    layout: Layout
    sections: list[Section]
    nodes: NodeTable
    elements: ElementTable
    shell_rows: Ids
    shells: Shells

    @property
    def mesh(self) -> ShellMesh:
        """Quads and trias; a region is a physical group, or an entity that is in none."""
        return self.shells.mesh

    @property
    def locks(self) -> tuple[Lock, ...]:
        """What of the mesh is locked."""
        return self.shells.locks

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be known besides."""
        return self.shells.notes

    def check_room(self) -> None:
        """Do nothing: numbers up to the largest integer are free for what is new."""

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
        """Write the file with ``mesh`` in the place of its shells.

        Raises
        ------
        InputError
            Where ``path`` is the source or cannot be written.
        """
        return write_edited(mesh, path, self.source, self._written)

    def _written(self, mesh: ShellMesh) -> bytes:
        tags = IdSet(set(self.nodes.tags.tolist()))
        carried = Carried.of(self.mesh, mesh, tags, IdSet(set(self.elements.tags.tolist())))
        if carried.is_unchanged:
            return self.data
        owner = self._owners(carried)
        entities = np.array([owner[1] if len(owner) > 1 else 0 for owner in self.elements.owners])
        nodes = edited_nodes(self.nodes, carried, entities[owner], self.layout)
        elements = edited_elements(self.elements, self._element_of(), carried, owner)
        pieces, at = [], 0
        for section in self.sections:
            pieces.append(self.data[at : section.start])
            body = self.data[section.start : section.stop]
            if section.name == "Nodes":
                body = node_section(nodes, self.layout)
            elif section.name == "Elements":
                body = element_section(elements, self.layout)
            elif section.name in ("NodeData", "ElementData"):
                body = self._carried(section, body, carried)
            elif section.name == "ElementNodeData":
                d = carried.difference
                lost = np.concatenate([d.gone_elements, d.element_ids[d.rewired]])
                body = without_elements(self._name(section), body, self.layout, lost)
            pieces.append(body)
            at = section.stop
        return b"".join([*pieces, self.data[at:]])

    def _owners(self, carried: Carried) -> Ids:
        """(M,) owner of each element of the edited mesh, a row of ``elements.owners``."""
        first = np.zeros(len(self.mesh.elements), np.int64)
        rows = np.flatnonzero(self.shells.element_of >= 0)[::-1]
        first[self.shells.element_of[rows]] = self.elements.owner[self.shell_rows[rows]]
        found: Ids = first[carried.element_rows]
        return found

    def _element_of(self) -> Ids:
        """Mesh row of each element of the file, -1 where it is none of the mesh."""
        found = np.full(len(self.elements.tags), -1, np.int64)
        found[self.shell_rows] = self.shells.element_of
        return found

    def _carried(self, section: Section, body: bytes, carried: Carried) -> bytes:
        table = read_data(self._name(section), body, self.layout)
        d = carried.difference
        if section.name == "NodeData":
            ids, new, gone = self.mesh.node_ids, d.node_ids, d.gone_nodes
            carry = carried.node_values
        else:
            ids, new, gone = self.mesh.element_ids, d.element_ids, d.gone_elements
            carry = carried.element_values
        return data_section(carried_data(table, ids, new, gone, carry), self.layout)

    def _name(self, section: Section) -> str:
        return f"{self.source.name}: ${section.name}"


def read_gmsh(path: Path) -> GmshFile:
    """Read a .msh file of the version 2.2, 4.0 or 4.1.

    Raises
    ------
    InputError
        Where the file is missing, of another version, cut short or wrong, or as ``checked_mesh``.
    """
    data, name = read_bytes(path), path.name
    sections = sections_of(data, name)
    layout = layout_of(data, sections, name)
    bodies: dict[str, tuple[str, bytes]] = {}
    for section in sections:
        if section.name in ("Nodes", "Elements") and section.name in bodies:
            raise InputError(f"{name} has two sections ${section.name}: join them.")
        bodies[section.name] = (f"{name}: ${section.name}", data[section.start : section.stop])
    for needed in ("Nodes", "Elements"):
        if needed not in bodies:
            raise InputError(f"{name} has no ${needed}: there is nothing to repair.")
    nodes = read_nodes(*bodies["Nodes"], layout)
    elements = read_elements(*bodies["Elements"], layout)
    physicals = read_physicals(*bodies["Entities"], layout) if "Entities" in bodies else {}
    shell_rows = np.flatnonzero(np.isin(elements.kinds, (TRIA, QUAD)))
    if layout.version == "2.2":
        keys = [_part_2(owner) for owner in elements.owners]
    else:
        keys = [_part_4(owner, physicals) for owner in elements.owners]
    held = np.zeros(len(nodes.tags), bool)
    if "Periodic" in bodies:
        held = np.isin(nodes.tags, periodic_nodes(*bodies["Periodic"], layout))
    rows_of = _NodeRows(nodes.tags, name)
    grid = Grid(
        source=name,
        points=nodes.points,
        node_ids=nodes.tags,
        corners=_shell_corners(elements, shell_rows, rows_of),
        shell_ids=elements.tags[shell_rows],
        parts=_numbered(keys)[elements.owner[shell_rows]] if len(shell_rows) else shell_rows,
        others=_others(elements, rows_of),
        held_nodes=held,
        held_by="$Periodic",
    )
    place = f"{name}: $Elements"
    shells = shells_of(grid, lambda _: f"{name}: $Nodes", lambda _: place)
    return GmshFile(path, data, layout, sections, nodes, elements, shell_rows, shells)


def _part_2(owner: tuple[int, ...]) -> tuple[int, ...]:
    """Tell what a region is known by: a physical group, or 0 and an entity where there is none."""
    physical, entity = (*owner, 0, 0)[:2]
    return (physical,) if physical else (0, entity)


def _part_4(
    owner: tuple[int, ...], physicals: dict[tuple[int, int], tuple[int, ...]]
) -> tuple[int, ...]:
    dimension, entity = owner
    # a negative group is one whose elements are turned round
    groups = tuple(sorted(physicals.get((dimension, entity), ())))
    return groups or (0, entity)


def _numbered(keys: list[tuple[int, ...]]) -> Ids:
    """Region of each key: the number of a physical group, or of an entity where none has any."""
    single: dict[tuple[int, ...], int] = {key: key[0] for key in keys if len(key) == 1}
    if not single and all(len(key) == 2 and key[0] == 0 for key in keys):
        return np.array([key[1] for key in keys], np.int64)
    number = max([0, *(abs(value) for value in single.values())])
    numbers = dict(single)
    for key in keys:
        numbers.setdefault(key, number + 1 + len(numbers) - len(single))
    return np.array([numbers[key] for key in keys], np.int64)


class _NodeRows:
    """Finds rows of nodes by their tags."""

    def __init__(self, tags: Ids, name: str) -> None:
        self._order = np.argsort(tags, kind="stable")
        self._sorted = tags[self._order]
        self._name = name
        twice = np.flatnonzero(np.diff(self._sorted) == 0)
        if len(twice):
            tag = self._sorted[twice[0]]
            raise InputError(f"{name}: $Nodes defines node {tag} a second time; remove one.")
        if len(tags) and self._sorted[0] < 1:
            raise InputError(f"{name}: $Nodes has a node {self._sorted[0]}; number them from 1.")

    def of(self, tags: Ids) -> Ids:
        """Rows of tags of any shape; raises InputError where one is not there."""
        if not len(self._sorted):
            raise InputError(f"{self._name}: $Elements names nodes, but there are none.")
        places = np.minimum(np.searchsorted(self._sorted, tags), len(self._sorted) - 1)
        missing = tags[self._sorted[places] != tags]
        if missing.size:
            raise InputError(
                f"{self._name}: $Elements names node {missing.flat[0]}, which is not defined; "
                "add the node or correct the element."
            )
        return self._order[places]


def _shell_corners(elements: ElementTable, rows: Ids, rows_of: _NodeRows) -> Ids:
    corners = np.full((len(rows), 4), NO_NODE, np.int64)
    for kind in (TRIA, QUAD):
        some = elements.kinds[rows] == kind
        if some.any():
            count = NODES[kind]
            corners[some, :count] = rows_of.of(elements.corners(rows[some], count))
    return corners


def _others(elements: ElementTable, rows_of: _NodeRows) -> list[Others]:
    found = []
    for kind in np.setdiff1d(elements.kinds, (TRIA, QUAD)).tolist():
        rows = np.flatnonzero(elements.kinds == kind)
        nodes = rows_of.of(elements.corners(rows, NODES[kind]))
        found.append(Others(nodes, dimension_of(kind)))
    return found
