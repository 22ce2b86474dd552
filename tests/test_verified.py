"""A deck is read again from its bytes before it gets its name."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from meshops.errors import HarmError, InputError
from meshops.formats import read_deck, write_mesh
from meshops.formats.verified import differences, write_verified
from meshops.mesh import NEW
from tests.decks import bad_plate
from tests.meshes import sheet, with_

SUFFIXES = [".bdf", ".inp", ".vtu", ".msh", ".obj", ".off"]


def edited(mesh):
    """Some nodes moved, an element split in two: what edits make of a mesh."""
    points = mesh.points.copy()
    points[20] += (0.3, -0.2, 0.0)
    row = int(np.flatnonzero(~mesh.is_tria)[3])
    a, b, c, d = mesh.elements[row]
    kept = np.arange(len(mesh.elements)) != row
    return replace(
        mesh,
        points=points,
        elements=np.concatenate([mesh.elements[kept], [[a, b, c, -1], [a, c, d, -1]]]).astype(
            np.int32
        ),
        region=np.concatenate([mesh.region[kept], [mesh.region[row]] * 2]).astype(np.int32),
        locked_elements=np.append(mesh.locked_elements[kept], [False, False]),
        element_ids=np.append(mesh.element_ids[kept], [NEW, NEW]),
    )


def renewed(mesh):
    """Elements that are new by name alone: they are on the nodes of others that are gone."""
    ids = mesh.element_ids.copy()
    ids[::3] = NEW
    return replace(mesh, element_ids=ids)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_elements_on_the_nodes_of_gone_ones_are_written_with_their_ids(
    tmp_path: Path, suffix: str
) -> None:
    write_mesh(bad_plate(), tmp_path / f"a{suffix}")
    deck = read_deck(tmp_path / f"a{suffix}")
    written = write_verified(deck, edited(renewed(deck.mesh)), tmp_path / f"b{suffix}")
    kept = written.mesh.element_ids[:-2]
    if suffix in (".bdf", ".inp", ".msh"):
        assert set(kept.tolist()) <= set(deck.mesh.element_ids.tolist())
    assert len(read_deck(tmp_path / f"b{suffix}").mesh.elements) == len(deck.mesh.elements) + 1


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_elements_may_change_where_no_node_does(tmp_path: Path, suffix: str) -> None:
    write_mesh(bad_plate(), tmp_path / f"a{suffix}")
    deck = read_deck(tmp_path / f"a{suffix}")
    mesh = replace(edited(deck.mesh), points=deck.mesh.points)
    write_verified(deck, mesh, tmp_path / f"b{suffix}")
    assert len(read_deck(tmp_path / f"b{suffix}").mesh.elements) == len(deck.mesh.elements) + 1


def joined(mesh):
    """Two trias that share an edge as one quad."""
    first, *others = mesh.elements[:, :3].tolist()
    row, other = next((i, o) for i, o in enumerate(others, 1) if len(set(o) & set(first)) == 2)
    (apex,) = set(other) - set(first)
    place = next(k for k in range(3) if {first[k], first[(k + 1) % 3]} <= set(other))
    quad = [*first[: place + 1], apex, *first[place + 1 :]]
    kept = np.ones(len(mesh.elements), bool)
    kept[row] = False
    elements, ids = mesh.elements.copy(), mesh.element_ids.copy()
    elements[0], ids[0] = quad, NEW
    return replace(
        mesh,
        elements=elements[kept],
        element_ids=ids[kept],
        region=mesh.region[kept],
        locked_elements=mesh.locked_elements[kept],
    )


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_ids_of_the_report_are_those_of_the_file(tmp_path: Path, suffix: str) -> None:
    write_mesh(bad_plate(), tmp_path / f"a{suffix}")
    deck = read_deck(tmp_path / f"a{suffix}")
    mesh = edited(deck.mesh)
    written = write_verified(deck, mesh, tmp_path / f"b{suffix}")
    assert written.files == (tmp_path / f"b{suffix}",)
    numbered, again = written.mesh, read_deck(tmp_path / f"b{suffix}").mesh
    assert (numbered.element_ids != NEW).all()
    assert differences(numbered, again) == ()
    places = dict(zip(again.element_ids.tolist(), range(len(again.elements)), strict=True))
    for element, number in enumerate(numbered.element_ids.tolist()):
        here = numbered.points[numbered.elements[element][numbered.elements[element] >= 0]]
        row = again.elements[places[number]]
        assert here == pytest.approx(again.points[row[row >= 0]])
    assert {path.name for path in tmp_path.iterdir()} == {f"a{suffix}", f"b{suffix}"}


def test_an_element_of_a_file_of_trias_has_the_id_of_its_first_tria(tmp_path: Path) -> None:
    write_mesh(bad_plate(), tmp_path / "a.stl")
    deck = read_deck(tmp_path / "a.stl")
    mesh = deck.mesh
    numbered = write_verified(deck, joined(mesh), tmp_path / "b.stl").mesh
    again = read_deck(tmp_path / "b.stl").mesh
    places = dict(zip(again.element_ids.tolist(), range(len(again.elements)), strict=True))
    for element, number in zip(numbered.elements, numbered.element_ids.tolist(), strict=True):
        tria = {tuple(p) for p in again.points[again.elements[places[number]][:3]].tolist()}
        mine = {tuple(p) for p in numbered.points[element[element >= 0]].tolist()}
        assert tria <= mine


@dataclass(frozen=True, eq=False)
class Careless:
    """A deck that writes something else than it was given."""

    deck: object
    spoil: object

    def __getattr__(self, name):
        return getattr(self.deck, name)

    def write(self, mesh, path):
        written = self.deck.write(mesh, path)
        path.write_text(self.spoil(path.read_text()))
        return written


@pytest.mark.parametrize(
    ("pattern", "instead", "word"),
    [
        ("CQUAD4,7,1,", "CQUAD4,7007,1,", "element"),
        ("GRID,20,,", "GRID,20,,9", "node 20"),
        ("CQUAD4,7,1,7,", "CQUAD4,7,1,30,", "7 is on other nodes"),
        ("CQUAD4,7,1,", "CQUAD4,7,2,", "7 is of another property"),
        ("CQUAD4,7,1,", "CQUAD4,7,1,x", "cannot be read"),
        ("CQUAD4,7,1,", "$", "missing"),
    ],
)
def test_what_is_not_the_model_is_not_written(
    tmp_path: Path, pattern: str, instead: str, word: str
) -> None:
    deck_file = tmp_path / "a.bdf"
    deck_file.write_text(free_field(bad_plate()))
    deck = Careless(read_deck(deck_file), lambda text: text.replace(pattern, instead, 1))
    assert pattern in deck_file.read_text()
    with pytest.raises(HarmError, match="not written") as caught:
        write_verified(deck, deck.mesh, tmp_path / "b.bdf")  # type: ignore[arg-type]
    assert word in str(caught.value)
    assert [path.name for path in tmp_path.iterdir()] == ["a.bdf"]


def free_field(mesh):
    rows = [f"GRID,{i},,{x!r},{y!r},{z!r}" for i, (x, y, z) in enumerate(mesh.points.tolist(), 1)]
    for i, row in enumerate(mesh.elements.tolist(), 1):
        nodes = ",".join(str(node + 1) for node in row if node >= 0)
        rows.append(f"{'CTRIA3' if row[3] < 0 else 'CQUAD4'},{i},1,{nodes}")
    return "\n".join([*rows, "PSHELL,1,1,1.0", ""])


def test_an_invariant_that_is_broken_keeps_the_deck_from_being_written(tmp_path: Path) -> None:
    write_mesh(bad_plate(), tmp_path / "a.bdf")
    deck = read_deck(tmp_path / "a.bdf")
    seen = []

    def verify(before, after):
        seen.append((before, after))
        return ("the area is another one",)

    with pytest.raises(HarmError, match="the area is another one"):
        write_verified(deck, edited(deck.mesh), tmp_path / "b.bdf", verify)
    assert seen[0][0] is deck.mesh
    assert len(seen[0][1].elements) == len(deck.mesh.elements) + 1
    assert [path.name for path in tmp_path.iterdir()] == ["a.bdf"]


def test_included_files_go_with_a_deck_that_is_not_written(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    text = free_field(bad_plate())
    shells = "\n".join(line for line in text.splitlines() if line.startswith("C"))
    rest = "\n".join(line for line in text.splitlines() if not line.startswith("C"))
    (tmp_path / "in/shells.bdf").write_text(shells + "\n")
    (tmp_path / "in/a.bdf").write_text(f"BEGIN BULK\n{rest}\nINCLUDE 'shells.bdf'\n")
    deck = read_deck(tmp_path / "in/a.bdf")
    with pytest.raises(HarmError):
        write_verified(deck, edited(deck.mesh), tmp_path / "out/a.bdf", lambda *_: ("wrong",))
    assert list((tmp_path / "out").iterdir()) == []
    written = write_verified(deck, edited(deck.mesh), tmp_path / "out/a.bdf")
    assert {path.name for path in written.files} == {"a.bdf", "shells.bdf"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"a.bdf", "shells.bdf"}
    assert len(read_deck(tmp_path / "out/a.bdf").mesh.elements) == len(deck.mesh.elements) + 1


def test_a_deck_is_never_written_over_itself(tmp_path: Path) -> None:
    write_mesh(bad_plate(), tmp_path / "a.bdf")
    before = (tmp_path / "a.bdf").read_bytes()
    deck = read_deck(tmp_path / "a.bdf")
    with pytest.raises(InputError, match="deck itself"):
        write_verified(deck, edited(deck.mesh), tmp_path / "a.bdf")
    assert (tmp_path / "a.bdf").read_bytes() == before


@pytest.mark.parametrize(
    ("name", "text", "chosen"),
    [
        ("a.bdf", "2", [3, 4]),
        ("a.bdf", "PID 2", [3, 4]),
        ("a.bdf", "set 7", [1, 3]),
        ("a.bdf", "7", [1, 3]),
        ("a.bdf", "1:3:2", [1, 3]),
        ("a.bdf", "4, 1:2", [1, 2, 4]),
        ("a.bdf", "4", [4]),
        ("a.inp", "Skin", [3, 4]),
        ("a.inp", "1,3", [1, 3]),
    ],
)
def test_a_part_of_a_deck_is_named(tmp_path: Path, name: str, text: str, chosen: list[int]) -> None:
    nodes = [(i + 1, i % 5, i // 5) for i in range(10)]
    shells = [(i, i, i + 1, i + 6, i + 5) for i in range(1, 5)]
    nastran = ["SET 7 = 1,3", "DISP = NONE", "BEGIN BULK"]
    nastran += [f"GRID,{i},,{x}.,{y}.,0." for i, x, y in nodes]
    nastran += [f"CQUAD4,{i},{1 if i < 3 else 2}," + ",".join(map(str, row)) for i, *row in shells]
    abaqus = ["*NODE", *(f"{i}, {x}., {y}., 0." for i, x, y in nodes)]
    for elset, some in (("WEB", shells[:2]), ("SKIN", shells[2:])):
        abaqus += [f"*ELEMENT, TYPE=S4, ELSET={elset}"]
        abaqus += [", ".join(map(str, row)) for row in some]
    (tmp_path / "a.bdf").write_text("\n".join(["CEND", *nastran, "ENDDATA", ""]))
    (tmp_path / "a.inp").write_text("\n".join([*abaqus, ""]))
    deck = read_deck(tmp_path / name)
    assert deck.mesh.element_ids[deck.select(text)].tolist() == chosen


@pytest.mark.parametrize("text", ["900:1000", "3:1", "NOWHERE", "1:2:0", "1,,2", "-4"])
def test_a_part_that_is_not_there_is_said(tmp_path: Path, text: str) -> None:
    write_mesh(bad_plate(), tmp_path / "a.bdf")
    with pytest.raises(InputError, match="--only"):
        read_deck(tmp_path / "a.bdf").select(text)


def test_locks_name_what_they_hold_by_its_ids(tmp_path: Path) -> None:
    write_mesh(bad_plate(), tmp_path / "a.bdf")
    text = (tmp_path / "a.bdf").read_text()
    cards = "FORCE,1,12,,1.,0.,0.,1.\nPLOAD1,1,7,FZ,LE,0.,1.,1.,1.\n"
    (tmp_path / "a.bdf").write_text(text.replace("ENDDATA", cards + "ENDDATA"))
    deck = read_deck(tmp_path / "a.bdf")
    assert {(lock.kind, lock.cards, lock.ids) for lock in deck.locks} == {
        ("nodes", "FORCE", (12,)),
        ("elements", "PLOAD1", (7,)),
    }
    assert all(lock.count == len(lock.ids) for lock in deck.locks)


def test_a_deck_that_the_search_has_made_worse_is_not_written(tmp_path, monkeypatch):
    """The guard left out, a run on perfect rows that fail by size is stopped at the end."""
    from islands import finishing, rounds
    from islands.cli import main

    write_mesh(sheet(6, 6), tmp_path / "part.bdf")

    def worse(before, *_, **__):
        """Take the guard's place, and pull a node out of a sound mesh."""
        points = before.mesh.points.copy()
        middle = np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1))
        points[middle] += (0.9, 0.8, 0.0)
        return with_(before.mesh, points=points)

    monkeypatch.setattr(rounds, "guarded", worse)
    monkeypatch.setattr(finishing, "guarded", worse)
    out = tmp_path / "run"
    line = ["meshipelago", "optimize", str(tmp_path / "part.bdf"), "--out", str(out)]
    monkeypatch.setattr("sys.argv", [*line, "--track", "off", "--quiet"])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 3
    assert not (out / "part.bdf").exists()
    assert not (out / "result.json").exists()
