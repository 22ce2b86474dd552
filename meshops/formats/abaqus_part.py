"""One part of an Abaqus deck: its elements as a mesh, what it says of them, and how it is written.

A deck without parts is one part. Ids are those of the part.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from meshops.formats.abaqus_blocks import Block, records
from meshops.formats.abaqus_items import (
    Items,
    corner_array,
    id_array,
    is_shell,
    point_array,
    read_items,
)
from meshops.formats.abaqus_locks import find_locks
from meshops.formats.abaqus_nodes import (
    NodeAttributes,
    followed_by_new_nodes,
    new_nodes,
    node_attributes,
    with_old_ids,
    write_facts,
)
from meshops.formats.abaqus_regions import (
    ElementFacts,
    Region,
    element_facts,
    find_regions,
    members_of,
    write_element_facts,
)
from meshops.formats.abaqus_scopes import Scope
from meshops.formats.abaqus_sets import NamedSets
from meshops.formats.abaqus_uses import Fact, read_uses
from meshops.formats.abaqus_writing import write_elements, write_first_lists, write_nodes
from meshops.formats.checks import checked_mesh, note_on, on_same_nodes, without_repeated_nodes
from meshops.formats.difference import Difference, compare
from meshops.formats.ids import IdSet, check_room
from meshops.formats.locks import Lock
from meshops.formats.node_attributes import (
    Memberships,
    memberships_of_new_nodes,
    share_memberships,
)
from meshops.formats.sources import Sources
from meshops.formats.splice import Splice
from meshops.mesh import NO_NODE, Bools, Ids, Ints, ShellMesh

LARGEST_ID = 999_999_999


@dataclass(frozen=True, eq=False)
class Part:
    """The elements of a part, its lines, and what they say.

    Attributes
    ----------
    mesh : ShellMesh
        ``region`` counts ``regions``.
    scope : Scope
    regions : list of Region
    shared : list of frozenset of Membership
        What the nodes of each region have in common.
    locks : list of Lock
    notes : list of str
    """

    mesh: ShellMesh
    scope: Scope
    regions: list[Region]
    shared: list[Memberships]
    locks: list[Lock]
    notes: list[str]
    _sources: Sources
    _nodes: Items
    _shells: Items
    _nsets: NamedSets
    _elsets: NamedSets
    _attributes: NodeAttributes
    _facts: ElementFacts
    _taken_nodes: IdSet
    _taken_elements: IdSet

    def splice(self, splice: Splice, mesh: ShellMesh) -> None:
        """Put a mesh that descends from this part's in its place.

        Raises
        ------
        InputError
            Where no ids are left for what is new.
        ValueError
            Where the mesh does not descend from this part's.
        """
        change = self.change(mesh)
        new = new_nodes(
            self._attributes,
            memberships_of_new_nodes(change.mesh, self.shared),
            followed_by_new_nodes(change.mesh, self.mesh, self._attributes.followed),
            change.node_ids,
        )
        gone = frozenset(change.gone_nodes.tolist())
        joining = write_nodes(splice, self._nodes, change, new.joining)
        write_first_lists(splice, self._nodes, self._nsets, joining)
        self._nsets.write(splice, gone=gone, joining=joining)
        write_facts(splice, self._sources.stream, self._attributes, new, gone)
        write_elements(splice, self._shells, change, self.regions)
        self._write_memberships_of_elements(splice, change)

    def change(self, mesh: ShellMesh) -> Difference:
        """Compare the part's mesh with one that descends from it; see ``compare``."""
        return compare(
            self.mesh,
            with_old_ids(self.mesh, mesh, self._attributes, self.shared),
            taken_nodes=self._taken_nodes,
            taken_elements=self._taken_elements,
            limit=LARGEST_ID,
        )

    def sets_of(self, region: int) -> set[str]:
        """Names of the sets that all elements of a region are in."""
        mine = self.regions[region]
        lists = {item.name for item in self._elsets if item.identity in mine.lists}
        return (lists | {mine.elset}) - {""}

    def elements_of_sets(self) -> dict[str, Bools]:
        """Return the elements of each set, (M,) bool, by its name."""
        ids = self.mesh.element_ids
        masks = self._elsets.masks(ids, _ids_of_headers(self._shells, ids))
        return {item.name: masks[item.identity] for item in self._elsets}

    def check_room(self) -> None:
        """Raise InputError where there are fewer free ids than the mesh has nodes or elements."""
        check_room(self.mesh.node_ids, self._taken_nodes, LARGEST_ID, "nodes")
        check_room(self.mesh.element_ids, self._taken_elements, LARGEST_ID, "elements")

    def _write_memberships_of_elements(self, splice: Splice, change: Difference) -> None:
        lists: dict[str, list[int]] = defaultdict(list)
        facts: dict[Fact, list[int]] = defaultdict(list)
        for row in change.new_elements:
            region = self.regions[change.mesh.region[row]]
            element = int(change.element_ids[row])
            for name in region.lists:
                lists[name].append(element)
            for fact in region.facts:
                facts[fact].append(element)
        gone = frozenset(change.gone_elements.tolist())
        self._elsets.write(splice, gone=gone, joining=lists)
        lines = self._sources.stream
        write_element_facts(splice, lines, self._facts, gone=gone, joining=facts)
        graded = {
            number: [layer for layer, _ in region.graded]
            for number, region in enumerate(self.regions)
        }
        self._facts.pressures.splice(splice, lines, self.mesh, change, graded)


def read_part(scope: Scope, every: Sequence[Block], sources: Sources) -> Part:
    """Read the part of a scope out of the blocks of a deck.

    Raises
    ------
    InputError
        Where nodes or elements cannot be read, or the mesh fails the checks of ``checked_mesh``.
    """
    lines = sources.stream
    spoken = [block for block in every if scope.is_spoken_of(block)]
    others = [block for block in spoken if not is_shell(block)]
    uses = read_uses(others, lines, scope)
    own = [block for block in every if block.scope == scope.name]
    shells = read_items([block for block in own if is_shell(block)], sources)
    nodes = read_items([block for block in own if block.keyword == "NODE"], sources)
    element_ids, node_ids = id_array(shells, sources), id_array(nodes, sources)
    corners, is_repeated = without_repeated_nodes(corner_array(shells, sources))
    elsets, nsets = NamedSets("ELSET", spoken, lines), NamedSets("NSET", spoken, lines)
    in_elsets = elsets.masks(element_ids, _ids_of_headers(shells, element_ids))
    facts = element_facts(
        uses.element_rows,
        shells,
        element_ids,
        corners,
        lambda row: members_of(row, elsets, in_elsets, scope, len(element_ids)),
    )
    regions, region = find_regions(shells, element_ids, elsets, facts)
    plain = _plain_mesh(sources, nodes, shells, node_ids, element_ids, corners, region)
    of_elset = {item.name: _nodes_of(plain, in_elsets[item.identity]) for item in elsets}
    members = nsets.masks(plain.node_ids, _ids_of_headers(nodes, node_ids), of_elset)
    attributes = node_attributes(plain, nsets, members, uses, scope)
    common = share_memberships(plain.elements, plain.region, attributes.memberships)
    same = on_same_nodes(plain.elements)
    locks = find_locks(plain, uses, facts, attributes, common, nsets, elsets, in_elsets)
    locks.elements |= {"on the same nodes": same, "a node twice": is_repeated}
    locked_nodes, locked_elements = locks.masks(plain)
    return Part(
        mesh=ShellMesh.build(
            plain.points,
            plain.elements,
            region=common.region,
            locked_nodes=locked_nodes | common.locked_nodes,
            locked_elements=locked_elements | common.locked_elements,
            node_ids=plain.node_ids,
            element_ids=plain.element_ids,
        ),
        scope=scope,
        regions=[regions[before] for before in common.before],
        shared=common.shared,
        locks=locks.told(plain),
        notes=[
            *note_on(element_ids, same, "On the same nodes as another shell, and left as they are"),
            *note_on(
                element_ids,
                is_repeated,
                "A quad that names a node twice is a tria, and left as it is",
            ),
        ],
        _sources=sources,
        _nodes=nodes,
        _shells=shells,
        _nsets=nsets,
        _elsets=elsets,
        _attributes=attributes,
        _facts=facts,
        _taken_nodes=_taken(node_ids, [*uses.nodes.values(), *_numbers(nsets)]),
        _taken_elements=_taken(
            element_ids,
            [*uses.elements.values(), *_numbers(elsets), _ids_of_elements(others, lines)],
        ),
    )


def _plain_mesh(
    sources: Sources,
    nodes: Items,
    shells: Items,
    node_ids: Ids,
    element_ids: Ids,
    corners: Ids,
    region: Ints,
) -> ShellMesh:
    return checked_mesh(
        source=sources.name,
        points=point_array(nodes, sources),
        node_ids=node_ids,
        corners=corners,
        element_ids=element_ids,
        region=region,
        locked_nodes=np.zeros(len(node_ids), bool),
        locked_elements=np.zeros(len(element_ids), bool),
        node_place=lambda row: sources.where(nodes.records[row].lines[0]),
        element_place=lambda row: sources.where(shells.records[row].lines[0]),
    )


def _ids_of_headers(items: Items, ids: Ids) -> dict[int, IdSet]:
    found: dict[int, IdSet] = defaultdict(IdSet)
    for block, number in zip(items.blocks, ids.tolist(), strict=True):
        found[block.header[0]].singles.add(number)
    return found


def _nodes_of(mesh: ShellMesh, elements: Bools) -> Bools:
    corners = mesh.elements[elements]
    mask = np.zeros(len(mesh.points), bool)
    mask[corners[corners != NO_NODE]] = True
    return mask


def _taken(ids: Ids, others: Iterable[IdSet]) -> IdSet:
    taken = IdSet(set(ids.tolist()))
    for other in others:
        taken.update(other)
    return taken


def _numbers(sets: NamedSets) -> list[IdSet]:
    return [item.numbers for item in sets]


def _ids_of_elements(blocks: Iterable[Block], lines: Sequence[str]) -> IdSet:
    found = IdSet()
    for block in blocks:
        if block.keyword == "ELEMENT":
            found.read(record.values[0] for record in records(block, lines))
    return found
