"""Included files: where they are looked for, and that a written tree stands by itself."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.errors import InputError
from meshops.formats import read_deck

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "nastran"
GRIDS = "".join(f"GRID,{10 * j + i},,{i}.,{j}.,0.\n" for j in range(1, 4) for i in range(1, 4))
SHELLS = "".join(
    f"CQUAD4,{3 * j + i},1,{10 * j + i},{10 * j + i + 1},{10 * j + i + 11},{10 * j + i + 10}\n"
    for j in (1, 2)
    for i in (1, 2)
)


def lines_of(path, root=None):
    """Lines as a solver reads them: an include is beside the including file or beside the deck."""
    root = root or path.parent
    text = path.read_text("latin-1")
    for line in re.sub(r"(INCLUDE\s+'[^'\n]*)\n([^']*')", r"\1\2", text).splitlines():
        found = re.match(r"\s*INCLUDE\s+'([^']+)'", line)
        if not found:
            yield line
            continue
        written = found[1].replace("\\", "/")
        tried = [folder / written for folder in (path.parent, root)]
        yield from lines_of(next(p for p in tried if p.is_file()), root)


def cards(path):
    return sorted(line for line in lines_of(path) if line.strip())


def moved(mesh):
    """The mesh with its first node that is free and inside moved a bit."""
    uses = np.bincount(mesh.elements[mesh.elements >= 0])
    row = np.flatnonzero(~mesh.locked_nodes & (uses == 4))[0]
    return apply(mesh, Edit(moved=np.array([row]), moved_to=mesh.points[[row]] + 0.125))


def tree(tmp_path, files):
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_a_nested_include_is_found_beside_the_deck(tmp_path):
    all_ = "INCLUDE 'model/g.dat'\nINCLUDE 's.dat'\n"
    deck = "BEGIN BULK\nINCLUDE 'model/all.dat'\n"
    tree(
        tmp_path,
        {"d.bdf": deck, "model/all.dat": all_, "model/g.dat": GRIDS, "model/s.dat": SHELLS},
    )
    source = read_deck(tmp_path / "d.bdf")
    out = tmp_path / "new" / "d.bdf"
    source.write(moved(source.mesh), out)
    assert (out.parent / "model" / "all.dat").read_text() == all_
    assert len(set(cards(out)) ^ set(cards(tmp_path / "d.bdf"))) == 2


@pytest.mark.parametrize("up", ["../", "..\\"])
def test_a_file_outside_the_folder_goes_below_the_written_deck(tmp_path, up):
    deck = f"BEGIN BULK\nINCLUDE '{up}bulk/g.dat'\nINCLUDE '../bulk/s.dat'\n"
    tree(tmp_path / "a", {"run/d.bdf": deck, "bulk/g.dat": GRIDS, "bulk/s.dat": SHELLS})
    source = read_deck(tmp_path / "a" / "run" / "d.bdf")
    out = tmp_path / "b" / "d.bdf"
    source.write(moved(source.mesh), out)
    before = cards(tmp_path / "a" / "run" / "d.bdf")
    # the tree stands by itself: nothing of the old one is needed
    shutil.rmtree(tmp_path / "a")
    assert len(set(cards(out)) ^ set(before)) == 2
    assert str(tmp_path) not in out.read_text()


def test_a_relative_path_that_still_leads_to_its_file_stays(tmp_path):
    deck = "BEGIN BULK\nINCLUDE '../bulk/g.dat'\nINCLUDE '../bulk/s.dat'\n"
    tree(tmp_path, {"run/d.bdf": deck, "bulk/g.dat": GRIDS, "bulk/s.dat": SHELLS})
    source = read_deck(tmp_path / "run" / "d.bdf")
    source.write(moved(source.mesh), tmp_path / "again" / "d.bdf")
    text = (tmp_path / "again" / "d.bdf").read_text()
    assert text == deck.replace("../bulk/g.dat", "bulk/g.dat")
    assert (tmp_path / "bulk" / "g.dat").read_text() == GRIDS


def test_a_logical_name_stands_for_a_folder(tmp_path, monkeypatch):
    deck = "ASSIGN LIB='lib'\nBEGIN BULK\nINCLUDE 'LIB:g.dat'\nINCLUDE 'MESHES:s.dat'\n"
    tree(tmp_path, {"d.bdf": deck, "lib/g.dat": GRIDS, "elsewhere/s.dat": SHELLS})
    monkeypatch.setenv("MESHES", str(tmp_path / "elsewhere"))
    source = read_deck(tmp_path / "d.bdf")
    assert len(source.mesh.elements) == 4
    source.write(moved(source.mesh), tmp_path / "new" / "d.bdf")
    text = (tmp_path / "new" / "d.bdf").read_text()
    assert text == deck
    assert (tmp_path / "new" / "lib" / "g.dat").is_file()
    assert not (tmp_path / "new" / "s.dat").exists()
    assert len(read_deck(tmp_path / "new" / "d.bdf").mesh.elements) == 4


def test_a_logical_name_that_nobody_defines_is_told(tmp_path):
    tree(tmp_path, {"d.bdf": "BEGIN BULK\nINCLUDE 'NOWHERE:g.dat'\n"})
    with pytest.raises(InputError, match=r"line 2: .* define NOWHERE by an ASSIGN"):
        read_deck(tmp_path / "d.bdf")


@pytest.mark.parametrize("first", ["BEGIN BULK\n", "GRID,99,,5.,5.,5.\n"])
def test_a_byte_order_mark_is_no_part_of_the_first_card(tmp_path, first):
    path = tmp_path / "d.bdf"
    path.write_bytes(b"\xef\xbb\xbf" + (first + GRIDS + SHELLS).encode())
    source = read_deck(path)
    source.write(moved(source.mesh), tmp_path / "new.bdf")
    assert (tmp_path / "new.bdf").read_bytes().startswith(b"\xef\xbb\xbf" + first.encode())
    assert len(read_deck(tmp_path / "new.bdf").mesh.points) == 9


def test_a_byte_order_mark_stays_where_the_first_card_changes(tmp_path):
    path = tmp_path / "d.bdf"
    grids = GRIDS.splitlines(keepends=True)
    grids.insert(0, grids.pop(4))
    path.write_bytes(b"\xef\xbb\xbf" + ("".join(grids) + SHELLS).encode())
    source = read_deck(path)
    source.write(moved(source.mesh), tmp_path / "new.bdf")
    assert (tmp_path / "new.bdf").read_bytes().startswith(b"\xef\xbb\xbfGRID,22,,2.125,")


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
@pytest.mark.parametrize("name", ["include_from_root/main.bdf", "include_absolute/run/main.bdf"])
def test_trees_of_decks(tmp_path, name):
    source = read_deck(FAULTS / name)
    out = tmp_path / "out" / "main.bdf"
    source.write(moved(source.mesh), out)
    assert len(set(cards(out)) ^ set(cards(FAULTS / name))) == 2
    assert str(FAULTS) not in "".join(p.read_text() for p in out.parent.rglob("*.*") if p.is_file())
