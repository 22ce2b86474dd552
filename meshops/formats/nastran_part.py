"""One section of bulk data of a Nastran deck: its linear shells as a mesh, and how they go back."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshops.formats import nastran_nodes as nodes
from meshops.formats.checks import checked_mesh, note_on, on_same_nodes, without_repeated_nodes
from meshops.formats.difference import Difference, compare
from meshops.formats.ids import IdSet, check_room
from meshops.formats.locks import Lock, most_first
from meshops.formats.nastran_cards import Card
from meshops.formats.nastran_case import CaseControl
from meshops.formats.nastran_contents import Contents
from meshops.formats.nastran_directions import MaterialDirections, part_by_direction
from meshops.formats.nastran_fields import carried_pressures
from meshops.formats.nastran_loads import Layer, Pressure
from meshops.formats.nastran_locks import (
    locks_of_elements,
    locks_of_memberships,
    locks_of_references,
)
from meshops.formats.nastran_output import Update
from meshops.formats.nastran_regions import find_regions
from meshops.formats.nastran_shells import CORNERS, Attributes
from meshops.formats.nastran_systems import integer_at
from meshops.formats.node_attributes import Memberships, share_memberships, take_over_ids
from meshops.formats.pressure_fields import Field, sort_loads
from meshops.formats.sources import Sources
from meshops.mesh import Ids, ShellMesh

LARGEST_ID = 99_999_999


@dataclass(frozen=True, eq=False)
class Part:
    """The shells of a section of bulk data.

    Attributes
    ----------
    mesh : ShellMesh
        In the ids of the section; ``region`` counts ``regions``.
    contents : Contents
    regions : list of Attributes
        What new elements of each region take over.
    memberships : list of frozenset of Membership
        What each node has.
    shared : list of frozenset of Membership
        What new nodes of each region get.
    systems : list of int
        The system in which new nodes of each region give their coordinates.
    fields : dict of Layer to Field
        Pressures that differ by element.
    directions : MaterialDirections
    locks : tuple of Lock
    notes : tuple of str
    """

    mesh: ShellMesh
    contents: Contents
    regions: list[Attributes]
    memberships: list[Memberships]
    shared: list[Memberships]
    systems: list[int]
    fields: dict[Layer, Field[Pressure]]
    directions: MaterialDirections
    locks: tuple[Lock, ...]
    notes: tuple[str, ...]

    def update(self, mesh: ShellMesh) -> Update:
        """Find what changes where ``mesh`` stands in the place of the part's.

        Raises
        ------
        InputError
            Where no ids are left.
        ValueError
            Where the mesh does not descend from this one.
        """
        change = self.change(mesh)
        contents = self.contents
        return Update(
            contents=contents,
            change=change,
            regions=self.regions,
            shared=self.shared,
            systems=self.systems,
            angles=self.directions.changed_angles(change.mesh, change),
            pressures=carried_pressures(
                self.mesh, change, self.regions, self.fields, contents.systems, contents.grids[0]
            ),
        )

    def change(self, mesh: ShellMesh) -> Difference:
        """Compare the part's mesh with one that descends from it; see ``compare``."""
        taken_nodes, taken_elements = self._taken()
        return compare(
            self.mesh,
            take_over_ids(self.mesh, mesh, self.memberships, self.shared, nodes.is_listed),
            taken_nodes=taken_nodes,
            taken_elements=taken_elements,
            limit=LARGEST_ID,
        )

    def check_room(self) -> None:
        """Raise InputError where there are fewer free ids than the mesh has nodes or elements."""
        taken_nodes, taken_elements = self._taken()
        check_room(self.mesh.node_ids, taken_nodes, LARGEST_ID, "nodes")
        check_room(self.mesh.element_ids, taken_elements, LARGEST_ID, "elements")

    def _taken(self) -> tuple[IdSet, IdSet]:
        """Ids that no new node and no new element may have.

        A range that holds all nodes or all shells takes none: it may hold new ones too.
        """
        contents = self.contents
        every = contents.referenced()
        taken_nodes, taken_elements = IdSet(), IdSet()
        for taken, others in ((taken_nodes, every.nodes), (taken_elements, every.elements)):
            taken.update(contents.taken)
            taken.update(others)
        for card in contents.node_cards:
            for entry in card.entries:
                if not (entry.ids.ranges and entry.ids.mask(self.mesh.node_ids).all()):
                    taken_nodes.update(entry.ids)
        for load in contents.pressures:
            _take(taken_elements, load.elements, self.mesh.element_ids)
        return taken_nodes, taken_elements


def read_part(sources: Sources, contents: Contents, case: CaseControl) -> Part:
    """Read the shells of a section.

    Raises
    ------
    InputError
        Where a card cannot be read or the mesh fails the checks of ``checked_mesh``.
    """
    shells = contents.shells
    element_ids = np.array([integer_at(card, 0, sources) for card in shells], np.int64)
    corners, is_repeated = without_repeated_nodes(_corners(shells, sources))
    loads = sort_loads(contents.pressures, element_ids, corners)
    regions = find_regions(
        shells, element_ids, loads, _sets_of(element_ids, case), contents.oriented
    )
    used = set(corners.ravel().tolist())
    grids = [card for card in contents.grids if int(card.field(0)) in used]
    node_ids = np.array([int(card.field(0)) for card in grids], np.int64)
    every = contents.referenced()
    every.nodes.update(case.nodes)
    every.elements.update(case.elements)
    mesh = checked_mesh(
        source=sources.name,
        points=contents.systems.basic_points(grids),
        node_ids=node_ids,
        corners=corners,
        element_ids=element_ids,
        region=regions.region,
        locked_nodes=every.nodes.mask(node_ids),
        locked_elements=every.elements.mask(element_ids) | ~regions.is_uniform | is_repeated,
        node_place=lambda row: sources.where(grids[row].lines[0]),
        element_place=lambda row: sources.where(shells[row].lines[0]),
    )
    memberships = nodes.node_memberships(contents, case.node_sets, mesh.node_ids, sources)
    shared = share_memberships(mesh.elements, mesh.region, memberships)
    held = nodes.held_nodes(contents, mesh.node_ids)
    locked_nodes = np.logical_or.reduce([mesh.locked_nodes, shared.locked_nodes, *held.values()])
    mesh = replace(
        mesh,
        region=_frozen(shared.region),
        locked_nodes=_frozen(locked_nodes),
        locked_elements=_frozen(mesh.locked_elements | shared.locked_elements),
    )
    mesh, before = part_by_direction(mesh, regions.angles)
    of_region = shared.before[before]
    same = on_same_nodes(mesh.elements)
    return Part(
        mesh=mesh,
        contents=contents,
        regions=[regions.attributes[region] for region in of_region],
        memberships=memberships,
        shared=[shared.shared[region] for region in before],
        systems=_systems(mesh, contents),
        fields=loads.fields,
        directions=MaterialDirections.of(mesh, regions.angles),
        locks=most_first(
            [
                *locks_of_references(mesh, contents, case, held),
                *locks_of_memberships(mesh, memberships, shared),
                *locks_of_elements(
                    mesh,
                    [
                        ("a thickness that differs from node to node", ~regions.is_uniform),
                        ("on the same nodes as another", same),
                        ("a node twice in a quad", is_repeated),
                    ],
                ),
            ]
        ),
        notes=(
            *note_on(element_ids, same, "On the same nodes as another shell, and left as they are"),
            *note_on(
                element_ids,
                is_repeated,
                "A quad that names a node twice is a tria, and left as it is",
            ),
        ),
    )


def _corners(shells: Sequence[Card], sources: Sources) -> Ids:
    """(M, 4) int64 node ids, 0 last in a tria."""
    corners = np.zeros((len(shells), 4), np.int64)
    for row, card in enumerate(shells):
        count = CORNERS[card.name]
        corners[row, :count] = [integer_at(card, 2 + i, sources) for i in range(count)]
    return corners


def _sets_of(element_ids: Ids, case: CaseControl) -> list[frozenset[int]]:
    """Numbers of the output sets that each shell is in, but for those that hold all of them."""
    found: list[set[int]] = [set() for _ in element_ids]
    for definition in case.element_sets:
        mask = definition.ids.mask(element_ids)
        if not mask.all():
            for row in np.flatnonzero(mask).tolist():
                found[row].add(definition.number)
    return [frozenset(mine) for mine in found]


def _systems(mesh: ShellMesh, contents: Contents) -> list[int]:
    """Return the system in which all nodes of a region give their coordinates, or the default."""
    of_node = [contents.systems.system_of(contents.grid_by_id[i]) for i in mesh.node_ids.tolist()]
    rows, sides = np.nonzero(mesh.elements >= 0)
    pairs = np.stack([mesh.region[rows], np.array(of_node)[mesh.elements[rows, sides]]], axis=1)
    found: defaultdict[int, list[int]] = defaultdict(list)
    for region, system in np.unique(pairs, axis=0).tolist():
        found[region].append(system)
    default = contents.systems.default
    every = [found[region] for region in range(int(mesh.region.max()) + 1)]
    return [systems[0] if len(systems) == 1 else default for systems in every]


def _take(taken: IdSet, elements: Sequence[int], element_ids: Ids) -> None:
    if not isinstance(elements, range):
        taken.singles.update(elements)
    elif not ((element_ids >= elements.start) & (element_ids < elements.stop)).all():
        taken.ranges.add((elements.start, elements.stop - 1, 1))


def _frozen(values: np.ndarray) -> np.ndarray:
    values.setflags(write=False)
    return values
