"""What the keywords of an Abaqus deck say of nodes and elements, by number and by set.

Most data lines begin with a node, an element or a set, and say the same of each of its members: a
support, a temperature, a pressure. These are facts, and what is new takes them over. Others name
nodes or elements for good. A keyword that is not known here is taken to name whatever it could.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from meshops.formats.abaqus_blocks import Block, fields, name_key, records
from meshops.formats.abaqus_scopes import Scope
from meshops.formats.fortran import canonical
from meshops.formats.ids import IdSet, is_id

Policy = Literal["shared", "apart", "unknown", "output"]
"""What a keyword makes of a set of nodes: new members are alike; they would be one more of what
there is once for each node; nobody knows; they are printed."""

_FACTS_OF_NODES = {
    **{"BOUNDARY": 2, "KINEMATIC COUPLING": 2, "TEMPERATURE": 0, "FIELD": 0},
    **{"NODAL THICKNESS": 0, "PRESSURE STRESS": 0, "MASS FLOW RATE": 0, "SURFACE": 0},
}
"""How many of the values behind a node say what is said of it, and not how much."""
_INITIAL = {
    **{"TEMPERATURE": 0, "FIELD": 0, "PRESSURE": 0, "PORE PRESSURE": 0, "RATIO": 0},
    **{"SATURATION": 0, "CONCENTRATION": 0, "VELOCITY": 1, "DISPLACEMENT": 1},
}
"""The same for the types of *INITIAL CONDITIONS that speak of nodes."""
_FACTS_OF_ELEMENTS = ("DLOAD", "DFLUX", "FILM", "RADIATE", "SURFACE")
_APART = ("CLOAD", "CFLUX", "CFILM", "CRADIATE", "CECHARGE", "CECURRENT", "CFLOW", "INERTIA")
_NAMES_ELEMENTS = ("DISTRIBUTION", "INITIAL CONDITIONS", "MODEL CHANGE", "DSLOAD", "DSFLUX")
_NAMES_SETS = ("SUBMODEL", "ADAPTIVE MESH CONSTRAINT")
_SHARING = ("RIGID BODY", "TRANSFORM", *_NAMES_SETS)
_PRINTING = ("NODE OUTPUT", "NODE PRINT", "NODE FILE", "CONTACT FILE", "CONTACT PRINT", "SFILE")
_BY_NODE_NUMBER = ("TEMPERATURE", "FIELD", "INITIAL CONDITIONS", "PRESSURE STRESS")
_DEFINING = frozenset(
    {
        *("NODE", "NSET", "ELSET", "PART", "END PART", "INSTANCE", "END INSTANCE", "ASSEMBLY"),
        *("END ASSEMBLY", "INCLUDE"),
    }
)
_NAMES_NOTHING: frozenset[str] = frozenset(
    name.strip()
    for name in """
    HEADING; PREPRINT; PARAMETER; MATERIAL; ELASTIC; PLASTIC; DENSITY; EXPANSION; CONDUCTIVITY;
    SPECIFIC HEAT; DAMPING; HYPERELASTIC; VISCOELASTIC; USER MATERIAL; DEPVAR; ORIENTATION;
    SHELL SECTION; SHELL GENERAL SECTION; SOLID SECTION; BEAM SECTION; BEAM GENERAL SECTION;
    MEMBRANE SECTION; CONNECTOR SECTION; SECTION CONTROLS; TRANSVERSE SHEAR STIFFNESS; MASS;
    SPRING; DASHPOT; ROTARY INERTIA; HOURGLASS STIFFNESS; AMPLITUDE; STEP; END STEP; STATIC;
    DYNAMIC; FREQUENCY; BUCKLE; STEADY STATE DYNAMICS; MODAL DYNAMIC; MODAL DAMPING; VISCO;
    HEAT TRANSFER; COUPLED TEMPERATURE-DISPLACEMENT; UNCOUPLED TEMPERATURE-DISPLACEMENT;
    CONTROLS; RESTART; OUTPUT; ELEMENT OUTPUT; ENERGY OUTPUT; CONTACT OUTPUT; EL PRINT; EL FILE;
    ELEMENT PRINT; ELEMENT FILE; ENERGY PRINT; ENERGY FILE; FILE FORMAT; PRINT; SECTION PRINT;
    SURFACE INTERACTION; SURFACE BEHAVIOR; FRICTION; CONTACT; CONTACT INCLUSIONS;
    CONTACT PROPERTY ASSIGNMENT; CONTACT PAIR; CONTACT CONTROLS; CLEARANCE; TIE; COUPLING;
    KINEMATIC; DISTRIBUTING; PHYSICAL CONSTANTS; SYSTEM; VALUES AT INFINITY; DISTRIBUTION TABLE;
    MONITOR; RIGID BODY; TRANSFORM; TIME POINTS; FILTER; SURFACE PROPERTY ASSIGNMENT; NO COMPRESSION
    """.split(";")  # noqa: SIM905 - a table of names reads better as text
) | frozenset(_PRINTING)


class Fact(NamedTuple):
    """What a data line says of its subject.

    Attributes
    ----------
    kind : tuple of str
        Keyword, parameters, step, and the values that say what is said.
    value : tuple of str
        How much. Of two facts of one kind the later holds.
    """

    kind: tuple[str, ...]
    value: tuple[str, ...]


class Row(NamedTuple):
    """A data line: of whom it speaks, what it says, and where it stands.

    Attributes
    ----------
    instance : str
        'I1.' where the subject is of an instance, or ''.
    subject : str
        An id or the name of a set, without the instance.
    token : str
        Both, as it stands in the deck.
    """

    instance: str
    subject: str
    token: str
    fact: Fact
    block: Block
    position: int


class SetUse(NamedTuple):
    """A keyword that uses a set of nodes other than by facts."""

    token: str
    block: Block
    policy: Policy


@dataclass(eq=False)
class Uses:
    """All that blocks say of the nodes and elements of a scope.

    Attributes
    ----------
    node_rows, element_rows : list of Row
    set_uses : list of SetUse
    nodes, elements : dict of str to IdSet
        What is named for good, by the keyword that names it.
    """

    node_rows: list[Row] = field(default_factory=list)
    element_rows: list[Row] = field(default_factory=list)
    set_uses: list[SetUse] = field(default_factory=list)
    nodes: dict[str, IdSet] = field(default_factory=dict)
    elements: dict[str, IdSet] = field(default_factory=dict)


def read_uses(blocks: Iterable[Block], lines: Sequence[str], scope: Scope) -> Uses:
    """Read all blocks that speak of a scope but those of its nodes and shells themselves."""
    reader = _Reader(lines, scope)
    for block in blocks:
        reader.read(block)
    return reader.uses


class _Reader:
    def __init__(self, lines: Sequence[str], scope: Scope) -> None:
        self.uses = Uses()
        self._lines = lines
        self._scope = scope

    def read(self, block: Block) -> None:
        keyword = block.keyword
        if keyword in _DEFINING:
            return
        self._read_parameters(block)
        if keyword in _NAMES_NOTHING:
            return
        of_nodes = _key_values(block)
        if of_nodes is not None:
            self.uses.node_rows += self._rows(block, of_nodes)
        elif keyword in _FACTS_OF_ELEMENTS:
            self.uses.element_rows += self._rows(block, 1)
        elif keyword in _NAMES_ELEMENTS:
            self._name(block, self._firsts(block), elements=True)
        elif keyword in _APART:
            self._name(block, self._firsts(block), nodes=True, policy="apart")
        elif keyword in ("ELEMENT", "MPC"):
            tokens = [t for record in records(block, self._lines) for t in record.values[1:]]
            self._name(block, tokens, nodes=True, policy="apart")
        elif keyword == "EQUATION":
            self._name(block, self._terms(block), nodes=True, policy="apart")
        else:
            tokens = [t for position in block.data for t in fields(self._lines[position])]
            known = keyword in _NAMES_SETS
            policy: Policy = "shared" if known else "unknown"
            self._name(block, tokens, nodes=True, elements=not known, policy=policy)

    def _read_parameters(self, block: Block) -> None:
        for name, value in block.written.items():
            if not value or not ("NODE" in name or "NSET" in name):
                continue
            policy: Policy = "unknown"
            if block.keyword in _SHARING:
                policy = "shared" if "NSET" in name else "apart"
            elif block.keyword in _PRINTING or block.keyword == "MONITOR":
                policy = "output"
            elif "NODE" in name:
                policy = "apart"
            self._name(block, [value], nodes=True, policy=policy)
        reads_results = "FILE" in block.parameters and "INTERPOLATE" not in block.parameters
        if block.keyword in _BY_NODE_NUMBER and reads_results:
            every = IdSet(everything=True)
            self.uses.nodes[_title(block) + ", FILE"] = every
            self.uses.elements[_title(block) + ", FILE"] = every

    def _name(
        self,
        block: Block,
        tokens: Iterable[str],
        *,
        nodes: bool = False,
        elements: bool = False,
        policy: Policy = "unknown",
    ) -> None:
        named = IdSet()
        for token in tokens:
            parted = self._scope.own(token) if token else None
            if parted is None:
                continue
            if is_id(parted[1]):
                named.singles.add(int(parted[1]))
            elif nodes:
                self.uses.set_uses.append(SetUse(token, block, policy))
        for wanted, place in ((nodes, self.uses.nodes), (elements, self.uses.elements)):
            if wanted and named.singles:
                place.setdefault(_title(block), IdSet()).update(named)

    def _firsts(self, block: Block) -> list[str]:
        return [fields(self._lines[position])[0] for position in block.data]

    def _terms(self, block: Block) -> list[str]:
        rows = [fields(self._lines[position]) for position in block.data]
        return [token for row in rows if len(row) > 1 for token in row[::3]]

    def _rows(self, block: Block, key_values: int) -> list[Row]:
        parameters = (f"{name}={value}" for name, value in sorted(block.parameters.items()))
        head = (block.keyword, *parameters, str(block.step))
        found = []
        for position in block.data:
            token, *values = fields(self._lines[position])
            parted = self._scope.own(token) if token else None
            if parted is None:
                continue
            texts = [canonical(name_key(value)) for value in values]
            if block.keyword == "BOUNDARY" and texts and not any(texts[1:2]):
                texts[1:2] = texts[:1]  # one degree of freedom is a range too
            while texts and not texts[-1]:
                texts.pop()
            what = (*texts[:key_values], *[""] * (key_values - len(texts)))
            fact = Fact((*head, *what), tuple(texts[key_values:]))
            found.append(Row(*parted, token, fact, block, position))
        return found


def cards_of(row: Row) -> str:
    """Name what a row is, for a reader: '*BOUNDARY' or 'NSET FIX in *BOUNDARY'."""
    title = _title(row.block)
    return title if is_id(row.subject) else f"NSET {row.subject} in {title}"


def _title(block: Block) -> str:
    kind = block.parameters.get("TYPE", "")
    with_type = kind and block.keyword in ("ELEMENT", "INITIAL CONDITIONS", "SURFACE")
    return f"*{block.keyword}" + (f", TYPE={kind}" if with_type else "")


def _key_values(block: Block) -> int | None:
    """Count the values that belong to the kind of a fact of nodes; None for other blocks."""
    kind = block.parameters.get("TYPE", "")
    if block.keyword == "INITIAL CONDITIONS":
        return {name_key(name): count for name, count in _INITIAL.items()}.get(kind)
    if block.keyword == "SURFACE" and kind != "NODE":
        return None
    return _FACTS_OF_NODES.get(block.keyword)
