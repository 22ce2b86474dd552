"""Which nodes and elements the cards of a Nastran deck refer to by number.

Each entry lists the fields of a card that hold node ids (``n``), element ids (``e``) or either
(``b``), counted from 0 after the name: ``n3`` is field 3, ``n3-6`` fields 3 to 6, ``n1/8`` every
eighth field from 1 on, ``n2:`` a list from field 2 to the end, with THRU. Fields after the Quick
Reference Guides of MSC and NX Nastran.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

from meshops.formats.ids import IdSet
from meshops.formats.nastran_cards import Card
from meshops.formats.nastran_shells import CORNERS

_FIELDS: dict[str, str] = {
    "SPC": "n1 n4",
    "SPC1 USET1": "n2:",
    "SPCD SPCR DAREA DELAY DPHASE": "n1 n4",
    "SPCOFF SUPORT ASET BSET CSET OMIT QSET SEQGP": "n0/2",
    "SPCOFF1 ASET1 BSET1 CSET1 OMIT1 QSET1 BNDFIX1 BNDFREE1": "n1:",
    "BNDFIX BNDFREE": "n0/2",
    "SUPORT1 USET": "n1/2",
    "MPC": "n1/8 n4/8",
    "FORCE MOMENT TIC RFORCE RFORCE1 DVGRID": "n1",
    "FORCE1 MOMENT1": "n1 n3 n4",
    "FORCE2 MOMENT2": "n1 n3-6",
    "SLOAD TEMP": "n1 n3 n5",
    "ACCEL1": "n8:",
    "PLOAD": "n2-5",
    "PLOAD1": "e1",
    "PLOAD2": "e2:",
    "CONM1 CONM2": "n1",
    "CBAR CBEAM CBEAM3 CBEND CBUSH CGAP": "n2-4",
    "CBUSH1D CROD CTUBE CVISC": "n2 n3",
    "CONROD RBAR RBAR1 RROD RJOINT": "n1 n2",
    "CELAS1 CELAS2 CDAMP1 CDAMP2 CMASS1 CMASS2": "n2 n4",
    "CELAS3 CDAMP3 CMASS3 CELAS4 CDAMP4 CMASS4": "n2 n3",
    "CWELD CSEAM": "b2:",
    "CFAST": "b3:",
    "RTRPLT RTRPLT1": "n1-3",
    "RBE1": "n1/8 n3/8 n5/8",
    "RSPLINE": "n2:",
    "PLOTEL": "n1 n2 n5 n6",
    "CSHEAR CAABSF": "n2-5",
    "CQUAD8": "n2-9",
    "CQUAD CQUADX": "n2-10",
    "CTRIA6 CTRIAX CTRIAX6": "n2-7",
    "CQUADX4 CPLSTN4 CPLSTS4": "n2-5",
    "CQUADX8 CPLSTN8 CPLSTS8": "n2-9",
    "CTRAX3 CPLSTN3 CPLSTS3": "n2-4",
    "CTRAX6 CPLSTN6 CPLSTS6": "n2-7",
    "CHEXA CPENTA CTETRA CPYRAM CPYRA": "n2:",
    "CORD1R CORD1C CORD1S": "n1-3 n5-7",
    "CHBDYG": "n8:",
    "CHBDYE": "e1",
    "TEMPP1": "e1 e8:",
    "TEMPRB": "e1 e16:",
    "BSURF": "e1:",
    "BLSEG": "n1:",
    "BSURFS PLOADX1 SET1": "b1:",
}

_NAME_NOTHING: frozenset[str] = frozenset(
    word
    for word in """
    INCLUDE BEGIN GRDSET SPOINT EPOINT CORD2R CORD2C CORD2S LOAD SPCADD MPCADD DLOAD GRAV
    ACCEL NSMADD
    TEMPD TEMPADD EIGR EIGRL EIGB EIGC EIGP FREQ FREQ1 FREQ2 FREQ3 FREQ4 FREQ5 TSTEP TSTEPNL NLPARM
    NLPCI NLSTEP TLOAD1 TLOAD2 RLOAD1 RLOAD2 DESVAR DLINK DVPREL1 DVPREL2 DVMREL1 DVMREL2 DCONSTR
    DCONADD DOPTPRM DEQATN DTABLE DRESP2 AERO AEROS MKAERO1 MKAERO2 FLFACT DTI DMI
    PSHELL PCOMP PCOMPG PCOMPS PSHEAR PSOLID PLSOLID PCOMPLS PBAR PBARL PBEAM PBEAML PBCOMP PBEND
    PROD PTUBE PBUSH PBUSHT PBUSH1D PELAS PELAST PDAMP PDAMPT PDAMP5 PMASS PGAP PVISC PFAST PWELD
    PSEAM PLPLANE PPLANE PAABSF CREEP SUPAX BCTSET BGSET BCPROP BCTPARM BGPARM
    SPLINE1 SPLINE2 SPLINE4 SPLINE5 CAERO1 CAERO2 CAERO3 CAERO4 CAERO5 PAERO1 PAERO2 AEFACT AESTAT
    AESURF AELIST AELINK AEPARM TRIM FLUTTER GUST RANDPS RANDT1
    """.split()  # noqa: SIM905 - a table of names reads better as text
)
_NAME_NOTHING_PREFIXES = ("MAT", "TAB")


@dataclass(frozen=True)
class References:
    """Nodes and elements that something else in the deck refers to."""

    nodes: IdSet = field(default_factory=IdSet)
    elements: IdSet = field(default_factory=IdSet)


def collect(cards: Iterable[Card]) -> dict[str, References]:
    """Collect the references of all cards, by the names of the cards.

    An unknown card refers to what its integers match.
    """
    by_name: dict[str, References] = {}
    for card in cards:
        found = by_name.setdefault(card.name, References())
        special = _SPECIAL.get(card.name)
        if special:
            special(card, found)
            continue
        for kind, pick in _rule(card.name):
            _read(found, kind, pick(card.fields))
    return by_name


Pick = Callable[[Sequence[str]], Sequence[str]]


@cache
def _rule(name: str) -> tuple[tuple[str, Pick], ...]:
    spec = _by_name().get(name)
    if spec is None:
        spec = "b0:" if _is_unknown(name) else ""
    return tuple((word[0], _pick(word[1:])) for word in spec.split())


def _is_unknown(name: str) -> bool:
    nothing = name in _NAME_NOTHING or name.startswith(_NAME_NOTHING_PREFIXES)
    return not nothing and name not in _by_name()


@cache
def _by_name() -> dict[str, str]:
    return {name: spec for names, spec in _FIELDS.items() for name in names.split()}


def _pick(places: str) -> Pick:
    if places.endswith(":"):
        return _slice(slice(int(places[:-1]), None))
    if "/" in places:
        start, step = map(int, places.split("/"))
        return _no_ranges(slice(start, None, step))
    first, _, last = places.partition("-")
    return _no_ranges(slice(int(first), int(last or first) + 1))


def _slice(part: slice) -> Pick:
    return lambda fields: fields[part]


def _no_ranges(part: slice) -> Pick:
    return lambda fields: [text for text in fields[part] if text.isdecimal()]


def _read(found: References, kind: str, tokens: Sequence[str]) -> None:
    # on a card that is not known ALL may mean anything
    everything = kind != "b" and "ALL" in map(str.upper, tokens)
    for ids, kinds in ((found.nodes, "nb"), (found.elements, "eb")):
        if kind in kinds:
            ids.read(tokens)
            ids.everything |= everything


def _pload4(card: Card, found: References) -> None:
    """SID EID P1 P2 P3 P4 then G1 and G3 (nodes of a solid) or THRU and EID2."""
    if card.field(6).upper() == "THRU":
        found.elements.read([card.field(1), "THRU", card.field(7)])
        return
    found.elements.read([card.field(1)])
    found.nodes.read(card.fields[6:8])


def _param(card: Card, found: References) -> None:
    """N V, of which GRDPNT names the node that inertia is about."""
    if card.field(0).upper() == "GRDPNT":
        found.nodes.read([card.field(1)])


def _rbe2(card: Card, found: References) -> None:
    """EID GN CM GM1 GM2 ... ALPHA (a real)."""
    found.nodes.read([card.field(1)])
    found.nodes.read(card.fields[3:])


def _rbe3(card: Card, found: References) -> None:
    """EID, REFGRID, REFC, then groups WT C G1 G2 ..., then UM with pairs G C."""
    found.nodes.read([card.field(2)])
    words = [text for text in card.fields[4:] if text]
    if "THRU" in (word.upper() for word in words):
        found.nodes.read(words)
        return
    component_next = False
    in_um = False
    for word in words:
        if word.upper() == "UM":
            in_um, component_next = True, False
        elif word.upper() == "ALPHA":
            return
        elif not word.isdecimal():
            component_next = not in_um
        elif component_next:
            component_next = False
        else:
            found.nodes.read([word])
            component_next = in_um


def used_sets(cards: Iterable[Card], numbers: Collection[int]) -> Iterator[Card]:
    """Pass over SET cards of OptiStruct that nothing uses.

    ``numbers`` are those that case control names; a card that is not known may name one too.
    """
    every = list(cards)
    if not any(card.name == "SET" for card in every):
        yield from every
        return
    used = {str(number) for number in numbers}
    for card in every:
        if card.name not in (*_SPECIAL, *CORNERS, "GRID") and _is_unknown(card.name):
            used.update(card.fields)
    for card in every:
        if card.name != "SET" or card.field(0) in used:
            yield card


def _set3(card: Card, found: References) -> None:
    """SID DES ID1 ID2 ..., where DES says what the ids are."""
    kinds = {"GRID": "n", "POINT": "n", "ELEM": "e", "PROP": ""}
    kind = kinds.get(card.field(1).upper()[:5], "b")
    if kind:
        _read(found, kind, card.fields[2:])


_SPECIAL: dict[str, Callable[[Card, References], None]] = {
    "PARAM": _param,
    "PLOAD4": _pload4,
    "RBE2": _rbe2,
    "RBE3": _rbe3,
    "SET": _set3,
    "SET3": _set3,
}
