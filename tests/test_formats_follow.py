"""Even pressures follow the shells that they are on; all that follows does so on a public deck."""

from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.formats.fortran import real
from meshops.mesh import NO_NODE
from meshops.patch import components, extract, stitch
from meshops.topology import topology
from tests.meshes import area_vectors
from tests.strips import GRIDS, SHELLS, changed_lines, deck_maker, halved, strip, written

WING = Path(__file__).parents[2] / "shared" / "data" / "pynastran_dummy_wing_metallic.bdf"


@pytest.fixture
def deck(tmp_path):
    return deck_maker(tmp_path)


def test_a_pressure_is_an_attribute_of_its_shell(deck):
    loads = "PLOAD4,7,1,.5\nPLOAD4,7,2,5.-1\nPLOAD4*,7,3,.5,.50\nPLOAD4,8,4,.5\n"
    mesh = deck(GRIDS + SHELLS + loads).mesh
    assert not mesh.locked_elements.any()
    assert mesh.region.tolist() == [0, 0, 0, 1, 2]
    assert topology(mesh).crossable.sum() == 2


def test_the_order_of_loads_on_a_shell_does_not_matter_but_their_number_does(deck):
    loads = "PLOAD4,7,1,.5\nPLOAD2,8,2.,1\nPLOAD2,8,2.,2\nPLOAD4,7,2,.5\n"
    twice = loads.replace("1\nPLOAD2", "1\nPLOAD4,7,3,.5\nPLOAD4,7,3,.5\nPLOAD4,7,4,.5\nPLOAD2")
    assert deck(GRIDS + SHELLS + loads).mesh.region.tolist() == [0, 0, 1, 1, 1]
    assert deck(GRIDS + SHELLS + twice).mesh.region.tolist() == [0, 0, 1, 2, 3]


LOADS = """\
PLOAD4         7       1 .001557
PLOAD4         7       3 .001557
$ between
PLOAD2,9,2.5,2
PLOAD4         7       2 .001557
PLOAD2,9,2.5,1
PLOAD4*                8               4      1.23456789
*
FORCE,1,11,,1.,0.,0.,1.
"""


def test_loads_of_gone_shells_go_and_new_shells_get_their_own(deck):
    source = deck(GRIDS + SHELLS + LOADS)
    text = written(source, halved(source.mesh, 2, 4))
    assert text.endswith(
        """\
PLOAD4         7       1 .001557
PLOAD4         7       3 .001557
$ between
PLOAD4         7      27 .001557
PLOAD4         7      28 .001557
PLOAD2,9,2.5,1
PLOAD2,9,2.5,27
PLOAD2,9,2.5,28
PLOAD4*                8              29      1.23456789
*
PLOAD4*                8              30      1.23456789
*
FORCE,1,11,,1.,0.,0.,1.
"""
    )
    kept = [line for line in SHELLS.splitlines() if line[7] not in "24"]
    assert text.startswith(GRIDS + "\n".join([*kept, ""]))


def test_a_rewired_shell_keeps_its_load(deck):
    source = deck(GRIDS + SHELLS + LOADS)
    to = np.array([[*source.mesh.elements[0, :3], NO_NODE]])
    mesh = apply(source.mesh, Edit(rewired=np.array([0]), rewired_to=to))
    assert written(source, mesh).endswith("CQUAD4,5,1,15,16,26,25\n" + LOADS)


@pytest.mark.parametrize(
    ("load", "left", "new"),
    [
        (
            "PLOAD4         7       1     2.5                            THRU       5",
            [
                "PLOAD4         7       1     2.5",
                "PLOAD4         7       3     2.5                            THRU       5",
            ],
            "PLOAD4         7      27     2.5                            THRU      28",
        ),
        (
            "PLOAD2,7,2.5,1,THRU,5",
            ["PLOAD2,7,2.5,1", "PLOAD2,7,2.5,3,THRU,5"],
            "PLOAD2,7,2.5,27,28",
        ),
        ("PLOAD2,7,2.5,5,2,1", ["PLOAD2,7,2.5,5,1"], "PLOAD2,7,2.5,27,28"),
    ],
)
def test_a_load_of_several_shells_is_parted_where_one_goes(deck, load, left, new):
    source = deck(GRIDS + SHELLS + load + "\n")
    assert not source.mesh.locked_elements.any()
    went, came = changed_lines(load, written(source, halved(source.mesh, 2)).split("26,25\n")[1])
    shells, loads = came[:2], came[2:]
    assert went == [load]
    assert [line.split(",")[0] for line in shells] == ["CTRIA3", "CTRIA3"]
    assert loads == [*left, new]


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_what_nobody_edits_stays_byte_for_byte(deck, end):
    text = (strip("30.", "3.+1", "", "0.0", "12") + LOADS).replace("\n", end)
    source = deck(text)
    assert written(source, source.mesh) == text


def test_loads_of_an_included_file_stay_in_it(tmp_path, deck):
    (tmp_path / "loads.bdf").write_text(LOADS)
    source = deck(GRIDS + SHELLS + "INCLUDE 'loads.bdf'\n")
    source.write(halved(source.mesh, 2), tmp_path / "new" / "out.bdf")
    text = (tmp_path / "new" / "loads.bdf").read_text()
    assert "PLOAD2,9,2.5,1\nPLOAD2,9,2.5,27\nPLOAD2,9,2.5,28\n" in text


def test_a_load_on_what_is_no_shell_is_left_to_it(deck, tmp_path):
    dangling = "PLOAD4,7,27,9.\n"
    source = deck(GRIDS + SHELLS + dangling)
    text = written(source, halved(source.mesh, 2))
    assert text.endswith(dangling)
    # the new shells have other ids, or they would be loaded
    assert not any(item.pressures for item in read_deck(tmp_path / "out.bdf").regions)


# --- a public deck ----------------------------------------------------------------------------


def loads_by_property(deck):
    """Resultant of each pressure on each property; it is one of the border where that is fixed."""
    total = defaultdict(lambda: np.zeros(3))
    for region, vector in zip(deck.mesh.region, area_vectors(deck.mesh), strict=True):
        item = deck.regions[region]
        for pressure in item.pressures:
            total[item.pid, pressure.key] += real(pressure.value) * vector
    return total


@pytest.mark.skipif(not WING.exists(), reason="no shared data")
def test_the_wing_keeps_its_loads_and_directions(tmp_path):
    source = read_deck(WING)
    mesh = source.mesh
    assert not mesh.locked_elements.any()
    assert len(source.regions) < 100
    follow = {*source.directions.region.tolist()} | {
        number for number, item in enumerate(source.regions) if item.pressures
    }
    # each such region anew: its inner nodes go, and trias fan out from its middle
    for region in sorted(follow):
        topo = topology(mesh)
        for rows in components(topo, mesh.region == region):
            patch = extract(topo, rows)
            middle = patch.points[: patch.border_nodes].mean(axis=0)
            fan = [(a, b, patch.border_nodes, NO_NODE) for a, b in patch.border]
            mesh = apply(mesh, stitch(mesh, patch, middle[None], np.array(fan, np.int32)))
            break
    assert (mesh.element_ids == 0).sum() > 500
    source.write(mesh, tmp_path / "out.bdf")
    again = read_deck(tmp_path / "out.bdf")
    assert not again.mesh.locked_elements.any()
    before, after = loads_by_property(source), loads_by_property(again)
    assert before.keys() == after.keys()
    for key, force in before.items():
        np.testing.assert_allclose(after[key], force, atol=1e-6 * np.linalg.norm(force))
    old, new = source.directions, again.directions
    assert len(new.angles) > 100
    for centre_, direction in zip(new.centres, new.directions, strict=True):
        near = old.directions[np.argmin(np.linalg.norm(old.centres - centre_, axis=1))]
        # the skin is curved, and a fan is not quite on it
        assert near @ direction > np.cos(np.radians(5.0))
