"""Failed elements of the public decks, counted before by another program (see SOURCES.md)."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshops.criteria import STANDARD, Criterion
from meshops.formats.nastran import read_nastran
from meshops.quality import element_penalties, median_edge

DATA = Path(__file__).parents[2] / "shared" / "data"

CRITERIA = STANDARD.having(
    Criterion("min size", (1.0, 0.9, 0.6, 0.5, 0.2), scaled=True),
    Criterion("max length", (1.0, 1.2, 1.4, 1.5, 1.8), scaled=True),
    Criterion("aspect ratio", (1.0, 2.0, 2.8, 3.0, 6.0)),
    replace(STANDARD["warpage"], active=False),
    name="sources",
)


@pytest.mark.parametrize(
    ("deck", "trias", "failing"),
    [
        ("pynastran_dummy_wing_metallic", 339, 191),
        ("tacs_disk", 22, 24),
        ("tacs_fuselage", 480, 936),
    ],
)
def test_failing_elements_of_the_decks(deck, trias, failing):
    path = DATA / f"{deck}.bdf"
    if not path.exists():
        pytest.skip(f"{path.name} is not here")
    mesh = read_nastran(path).mesh
    penalties = element_penalties(mesh, CRITERIA.at(median_edge(mesh)))
    penalties[mesh.is_tria, 8] = np.nan  # that count has a skew for quads only
    assert mesh.is_tria.sum() == trias
    assert np.any(penalties > 1.0, axis=1).sum() == failing
