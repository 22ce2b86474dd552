"""The element types of Abaqus and CalculiX that are elements of the mesh here, and their partners.

Conventional shells, membranes, and plane and axisymmetric elements: all that is linear and has
three or four corners. A quad that becomes a tria, and a tria that becomes a quad, needs the type of
the other number of corners.
"""

from __future__ import annotations

from collections.abc import Mapping

_FAMILIES: Mapping[str, str] = {
    "shell": "S4 S3; S4R S3 S3R; S4RS S3RS; S4RSW S3RS; S4R5 STRI3; S4T S3T; S4RT S3RT; DS4 DS3",
    "membrane": "M3D4 M3D3; M3D4R M3D3",
    "plane stress": "CPS4 CPS3; CPS4R CPS3; CPS4I CPS3; CPS4T CPS3T; CPS4RT CPS3T",
    "plane strain": """CPE4 CPE3; CPE4R CPE3; CPE4I CPE3; CPE4H CPE3H; CPE4RH CPE3H; CPE4IH CPE3H;
        CPE4T CPE3T; CPE4RT CPE3T; CPE4P CPE3P; CPE4RP CPE3P""",
    "generalised plane strain": "CPEG4 CPEG3; CPEG4R CPEG3; CPEG4I CPEG3; CPEG4H CPEG3H",
    "axisymmetric": """CAX4 CAX3; CAX4R CAX3; CAX4I CAX3; CAX4H CAX3H; CAX4RH CAX3H; CAX4IH CAX3H;
        CAX4T CAX3T; CAX4RT CAX3T; CAX4P CAX3P; CAX4RP CAX3P; CGAX4 CGAX3; CGAX4R CGAX3""",
    "plane heat": "DC2D4 DC2D3; DCAX4 DCAX3",
    "plane acoustic": "AC2D4 AC2D3; ACAX4 ACAX3",
}
_WITH_TWO_SIDES = ("shell", "membrane")

_PARTNERS: dict[str, list[str]] = {}
"""To each type those of the other number of corners; the first where nothing else decides."""
_FAMILY: dict[str, str] = {}
CORNERS: dict[str, int] = {}
"""The number of nodes of each type."""

for _family, _pairs in _FAMILIES.items():
    for _pair in _pairs.split(";"):
        _quad, *_trias = _pair.split()
        for _tria in _trias:
            _PARTNERS.setdefault(_quad, []).append(_tria)
            _PARTNERS.setdefault(_tria, []).append(_quad)
            _FAMILY[_quad] = _FAMILY[_tria] = _family
            CORNERS[_quad], CORNERS[_tria] = 4, 3


def has_sides(kind: str) -> bool:
    """Tell whether a face of the type is one of its two sides, and not one of its edges."""
    return _FAMILY[kind] in _WITH_TWO_SIDES


def pair(kind: str, beside: Mapping[str, int], in_deck: Mapping[str, int]) -> tuple[str, str]:
    """Find the types of the quads and of the trias of a region that holds elements of one type.

    Parameters
    ----------
    kind : str
    beside, in_deck : mapping of str to int
        Numbers of the elements by type, of those in the same sets and of all. The more frequent
        partner is taken; where there is none, the first one that the solvers know.
    """
    partners = _PARTNERS[kind]
    relatives = [
        other
        for other in _FAMILY
        if _FAMILY[other] == _FAMILY[kind] and CORNERS[other] != CORNERS[kind]
    ]
    for candidates, counts in ((partners, beside), (relatives, beside), (partners, in_deck)):
        present = [other for other in candidates if counts.get(other)]
        if present:
            partner = max(present, key=lambda other: (counts[other], -candidates.index(other)))
            break
    else:
        partner = partners[0]
    return (kind, partner) if CORNERS[kind] == 4 else (partner, kind)
