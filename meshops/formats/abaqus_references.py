"""Which nodes and elements the keywords of an Abaqus deck refer to by number."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from meshops.formats.abaqus_blocks import Block, id_list, plain_id, records
from meshops.formats.ids import IdSet

_NODE_FIRST = ("BOUNDARY", "CLOAD", "TEMPERATURE", "FIELD")
_ELEMENT_FIRST = ("DLOAD", "DSLOAD", "SURFACE")
_SPLITTING = ("NODE", "ELSET", "PART", "END PART", "INSTANCE", "END INSTANCE", "ASSEMBLY")
_NAME_NOTHING: frozenset[str] = frozenset(
    name.strip()
    for name in """
    HEADING; PREPRINT; PARAMETER; MATERIAL; ELASTIC; PLASTIC; DENSITY; EXPANSION; CONDUCTIVITY;
    SPECIFIC HEAT; DAMPING; HYPERELASTIC; VISCOELASTIC; USER MATERIAL; DEPVAR; ORIENTATION;
    SHELL SECTION; SHELL GENERAL SECTION; SOLID SECTION; BEAM SECTION; BEAM GENERAL SECTION;
    MEMBRANE SECTION; CONNECTOR SECTION; SECTION CONTROLS; TRANSVERSE SHEAR STIFFNESS; MASS;
    SPRING; DASHPOT; ROTARY INERTIA; HOURGLASS STIFFNESS; AMPLITUDE; STEP; END STEP; STATIC;
    DYNAMIC; FREQUENCY; BUCKLE; STEADY STATE DYNAMICS; MODAL DYNAMIC; VISCO; CONTROLS; RESTART;
    OUTPUT; NODE OUTPUT; ELEMENT OUTPUT; ENERGY OUTPUT; CONTACT OUTPUT; NODE PRINT; NODE FILE;
    EL PRINT; EL FILE; ENERGY PRINT; MONITOR; FILE FORMAT; PRINT; SURFACE INTERACTION; FRICTION;
    CONTACT; CONTACT INCLUSIONS; CONTACT PROPERTY ASSIGNMENT; CONTACT PAIR; TIE; END ASSEMBLY;
    TRANSFORM; PHYSICAL CONSTANTS; SYSTEM; INCLUDE
    """.split(";")  # noqa: SIM905 - a table of names reads better as text
)
_EDGE_LABEL = re.compile(r"E(?:D[A-Z]+)?\d|EDGE", re.IGNORECASE)


def collect(blocks: Iterable[Block], lines: Sequence[str]) -> tuple[IdSet, IdSet]:
    """Nodes and elements that blocks refer to; an unknown keyword refers to both.

    Shell elements themselves are to be left out of ``blocks``; sets of elements lock nothing,
    because they follow the mesh.
    """
    nodes, elements = IdSet(), IdSet()
    for block in blocks:
        if block.keyword in _NAME_NOTHING or block.keyword in _SPLITTING:
            continue
        nodes.read(value for name, value in block.parameters.items() if "NODE" in name)
        _read_data(block, lines, nodes, elements)
    return nodes, elements


def edge_sets(blocks: Iterable[Block], lines: Sequence[str]) -> set[str]:
    """Names of the sets that surfaces and loads use edge by edge: E1 is another edge elsewhere."""
    names = set()
    for block in blocks:
        if block.keyword not in _ELEMENT_FIRST:
            continue
        for position in block.data:
            first, _, rest = lines[position].partition(",")
            if _EDGE_LABEL.match(rest.strip()):
                names.add(first.strip().strip('"').upper().rpartition(".")[2])
    return names


def words(blocks: Iterable[Block], lines: Sequence[str]) -> set[str]:
    """Every word, in capitals, that keywords other than output use: names of sets among them."""
    found: set[str] = set()
    for block in blocks:
        if block.keyword == "NODE" or "OUTPUT" in block.keyword or block.keyword.endswith("FILE"):
            continue
        found.update(block.parameters.values())
        for position in block.data:
            found.update(token.strip().upper() for token in lines[position].split(","))
    return found


def _read_data(block: Block, lines: Sequence[str], nodes: IdSet, elements: IdSet) -> None:
    if block.keyword == "NSET":
        nodes.update(id_list(block, lines))
        return
    firsts = [plain_id(lines[position].split(",")[0]) for position in block.data]
    if block.keyword in _NODE_FIRST or block.parameters.get("TYPE") == "NODE":
        nodes.read(firsts)
        return
    if block.keyword in _ELEMENT_FIRST:
        elements.read(firsts)
        return
    if block.keyword in ("ELEMENT", "MPC"):
        for record in records(block, lines):
            nodes.read(map(plain_id, record.values[1:]))
        return
    tokens = [plain_id(token) for position in block.data for token in lines[position].split(",")]
    nodes.read(tokens)
    elements.read(tokens)
