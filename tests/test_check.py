"""check as a gate, as a list, as JSON; and by what a run has judged, said everywhere alike."""

import csv
import json
import os
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from islands.cli import cli
from islands.folder import assessment_of_run
from meshops.criteria import NAMES
from meshops.errors import InputError
from meshops.formats import read_deck, write_mesh
from meshops.mesh import ShellMesh
from tests.decks import bad_plate
from tests.test_cli import FAST, call, deck
from tracking.events import RunStarted
from tracking.journal import read_journal

__all__ = ["call", "deck"]

QUICK = [*FAST, "--quiet"]
FIGURES = ("elements", "quads", "trias", "failed", "failed_by_shape", "failed_by_size")


def told(out: str) -> dict[str, str]:
    """The closing figures of a table."""
    return {
        line.split("=")[0].strip(): line.split("=")[1].strip()
        for line in out.splitlines()
        if " =" in line
    }


@pytest.fixture
def poor(tmp_path: Path) -> Path:
    """A plate in which something fails by its size alone and stays: a locked oblong."""
    path = tmp_path / "poor.inp"
    rows = ["*NODE"]
    for j in range(4):
        rows += [f"{10 * j + i + 1}, {x}, {5.0 * j}, 0." for i, x in enumerate((0, 5, 9, 31, 36))]
    rows += ["*ELEMENT, TYPE=S4, ELSET=SKIN"]
    for j in range(3):
        for i in range(4):
            first = 10 * j + i + 1
            rows.append(f"{4 * j + i + 1}, {first}, {first + 1}, {first + 11}, {first + 10}")
    path.write_text("\n".join([*rows, ""]))
    return path


def test_a_gate_is_passed_or_not(call, poor: Path) -> None:  # type: ignore[no-untyped-def]
    options = ("--size", 5, "--criteria", "paper")
    assert call("check", poor, *options, "--fail-on", "shape>0")[0] == 0
    code, out, err = call("check", poor, *options, "--fail-on", "shape>0", "--fail-on", "failed>0")
    assert code == 1
    assert err == 'Fails on "failed>0": failed is 3.\n'
    assert "compound Q.I." in out
    code, _, err = call("check", poor, *options, "--fail-on", "aspect ratio>=4")
    assert (code, err) == (1, 'Fails on "aspect ratio>=4": the worst aspect ratio is 4.4.\n')
    for nonsense in ("failed", "nothing>0", "failed>x"):
        code, out, err = call("check", poor, *options, "--fail-on", nonsense)
        assert (code, out) == (2, "")
        assert nonsense in err


def test_a_table_fits_a_terminal_and_has_no_colours_in_a_file(call, poor: Path) -> None:  # type: ignore[no-untyped-def]
    _, out, _ = call("check", poor, "--size", 5)
    assert max(map(len, out.splitlines()[1:])) <= 80
    assert "\x1b" not in out
    assert told(out)["by size alone"] == told(out)["# of failed"] == "3"


def test_json_alone_on_the_standard_output(call, poor: Path) -> None:  # type: ignore[no-untyped-def]
    code, out, err = call("check", poor, "--size", 5, "--json", "-", "--fail-on", "failed>0")
    assert code == 1
    assert "failed is 3" in err
    report = json.loads(out)
    assert [row["name"] for row in report["rows"]] == list(NAMES)
    assert report["judged_by"]["size"] == 5.0
    assert set(report["judged_by"]["levels"]) == set(NAMES)
    assert "failures" not in report


def test_all_failing_elements_are_listed(call, poor: Path) -> None:  # type: ignore[no-untyped-def]
    options = ("--size", 5, "--criteria", "paper", "--all")
    code, out, _ = call("check", poor, *options)
    assert code == 0
    assert "3 at 20, 2.5, 0: at a border; fails by its size alone" in out
    assert "max length 22, limit 7.5 (size)" in out
    report = json.loads(call("check", poor, *options, "--json", "-")[1])
    assert {item["element"] for item in report["failures"]} == {3, 7, 11}
    assert report["failures"][0] | {"why": ""} == {
        "element": 3,
        "x": 20.0,
        "y": 2.5,
        "z": 0.0,
        "criterion": "max length",
        "value": 22.0,
        "limit": 7.5,
        "family": "size",
        "why": "",
    }


def test_a_report_never_costs_a_file(call, poor: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    shutil.copy(poor, tmp_path / "other.inp")
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "mine.json").write_text('{"mine": 1}')
    (tmp_path / "link.json").symlink_to(poor)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    for target in ("poor.inp", "other.inp", "notes.txt", "mine.json", "link.json", ".", "no/a"):
        code, out, err = call("check", poor, "--json", target)
        assert (code, out) == (2, "")
        assert target in err
    for target in ("poor.inp", "other.inp", "link.json"):
        assert call("check", poor, "--json", target, "--overwrite")[0] == 2
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert call("check", poor, "--json", "mine.json", "--overwrite")[0] == 0
    assert call("check", poor, "--json", "new.json")[0] == 0
    assert call("check", poor, "--json", "new.json", "--size", 7)[0] == 0  # our own report
    assert json.loads((tmp_path / "new.json").read_text())["size"] == 7.0


@pytest.mark.parametrize("size", [None, "local", "sizes.csv"])
def test_check_says_of_a_written_deck_what_its_run_said(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path, size: str | None
) -> None:
    (tmp_path / "sizes.csv").write_text("x,y,z,size\n0,0,0,5\n50,40,0,4\n")
    options = [*QUICK[:2], *QUICK[4:], "--criteria", "paper"]
    options += ["--size", size] if size else []
    assert call("optimize", deck, "--out", "run", "--time-limit", "20", *options)[0] == 0
    run = tmp_path / "run"
    result = json.loads((run / "result.json").read_text())
    for arguments in (["run"], ["run/deck.bdf"], ["run/deck.bdf", "--like", "run"]):
        report = json.loads(call("check", *arguments, "--json", "-")[1])
        assert {name: report[name] for name in FIGURES} == {
            name: result["after"][name] for name in FIGURES
        }
        assert report["compound_qi"] == pytest.approx(result["after"]["compound_qi"], rel=1e-6)
        assert report["judged_by"] == result["judged_by"]
    # what the report of the run shows is what check shows, ids and all
    out = call("check", "run")[1]
    assert (run / "quality_after.txt").read_text().splitlines()[2:] == out.splitlines()[-22:]
    rows = list(csv.DictReader((run / "failed.csv").read_text().splitlines()))
    assert len({row["element"] for row in rows}) == result["after"]["failed"]
    listed = json.loads(call("check", "run", "--all", "--json", "-")[1])["failures"]
    assert [(str(item["element"]), item["criterion"]) for item in listed] == [
        (row["element"], row["criterion"]) for row in rows
    ]


def test_what_a_run_judges_by_stands_in_all_its_records(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "mine.toml").write_text('base = "paper"\n[criteria.skew]\nwarn = 24\nfail = 25\n')
    options = ("--criteria", "mine.toml", "--out", "run", "--time-limit", "20")
    code, out, _ = call("optimize", deck, *options, *FAST[:2], *FAST[4:])
    assert code == 0
    assert "judged by criteria mine, size " in out
    assert "skew 25" in " ".join(out.split())
    run = tmp_path / "run"
    judged = json.loads((run / "result.json").read_text())["judged_by"]
    (started,) = (e for e in read_journal(run) if isinstance(e, RunStarted))
    assert judged["levels"]["skew"]["fail"] == 25.0
    assert started.settings["judged-size"] == judged["size"]
    assert started.settings["gradation"] == judged["gradation"] == "local"
    assert "fail = 25.0" in str(started.settings["levels"])
    # the user's file may change or go: the run has its own
    (tmp_path / "mine.toml").unlink()
    shutil.move(run, tmp_path / "elsewhere")
    moved = assessment_of_run(tmp_path / "elsewhere")
    assert moved.document() == judged
    config = (tmp_path / "elsewhere/config.toml").read_text()
    assert f"judged-size = {judged['size']}" in config
    assert 'criteria = "criteria.toml"' in config


def test_another_deck_is_judged_like_a_run(call, deck: Path, poor: Path) -> None:  # type: ignore[no-untyped-def]
    call("optimize", deck, "--out", "run", "--criteria", "paper", *QUICK)
    report = json.loads(call("check", poor, "--like", "run", "--json", "-")[1])
    assert (report["judged_by"]["criteria"], report["judged_by"]["size"]) == ("paper", 5.0)
    other = json.loads(
        call("check", poor, "--like", "run", "--criteria", "standard", "--json", "-")[1]
    )
    assert (other["judged_by"]["criteria"], other["judged_by"]["size"]) == ("standard", 5.0)


@pytest.mark.parametrize("name", ["no", "empty"])
def test_a_folder_without_a_run_is_said(call, deck: Path, tmp_path: Path, name: str) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "empty").mkdir()
    assert call("check", "empty")[0] == 2
    code, out, err = call("check", deck, "--like", name)
    assert (code, out) == (2, "")
    assert name in err
    with pytest.raises(InputError):
        assessment_of_run(tmp_path / name)


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_what_is_built_in_comes_before_what_lies_about(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path, kind: str
) -> None:
    for name in ("paper", "standard", "local"):
        (tmp_path / name).mkdir() if kind == "folder" else (tmp_path / name).write_text("x")
    options = ["--time-limit", "20", *QUICK[:2], *QUICK[4:]]
    code, _, err = call(
        "optimize", deck, "--criteria", "paper", "--size", "local", "--out", "run", *options
    )
    assert (code, err) == (0, "")
    config = (tmp_path / "run/config.toml").read_text()
    assert 'criteria = "paper"' in config
    assert 'size = "local"' in config
    assert call("resume", "run", "--quiet")[0] == 0
    code, _, err = call("check", deck, "--criteria", str(tmp_path / "paper"))
    assert code == 2
    assert "Traceback" not in err


LOCKED = "SPC1,1,123456,1,THRU,9\n"


def test_what_is_locked_is_told_before_it_runs(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    write_mesh(bad_plate(), tmp_path / "held.bdf")
    text = (tmp_path / "held.bdf").read_text()
    (tmp_path / "held.bdf").write_text(text.replace("ENDDATA", LOCKED + "ENDDATA"))
    mesh = read_deck(tmp_path / "held.bdf").mesh
    total = f"locked: {mesh.locked_nodes.sum()} of {len(mesh.points)} nodes"
    assert total in call("check", "held.bdf")[1]
    out = call("optimize", "held.bdf", "--out", "run", *FAST)[1]
    assert total in out[: out.index("generation 0")]


def test_only_a_part_is_repaired(call, deck: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    before = read_deck(deck).mesh
    chosen = before.element_ids[before.points[before.elements[:, :3], 0].max(axis=1) <= 25.0]
    only = ",".join(map(str, chosen))
    assert call("optimize", deck, "--out", "run", "--only", only, *QUICK)[0] == 0
    after = read_deck(tmp_path / "run/deck.bdf").mesh
    rest = {
        element: before.points[row[row >= 0]].tolist()
        for element, row in zip(before.element_ids.tolist(), before.elements, strict=True)
        if element not in set(chosen.tolist())
    }
    there = {
        element: after.points[row[row >= 0]].tolist()
        for element, row in zip(after.element_ids.tolist(), after.elements, strict=True)
    }
    assert {element: there.get(element) for element in rest} == rest
    assert there != {
        element: before.points[row[row >= 0]].tolist()
        for element, row in zip(before.element_ids.tolist(), before.elements, strict=True)
    }
    code, out, _ = call("replay", "run/procedure.json", deck, "--out", "again.bdf")
    assert code == 0
    assert "bit for bit" in out
    assert (tmp_path / "again.bdf").read_bytes() == (tmp_path / "run/deck.bdf").read_bytes()
    code, _, err = call("optimize", deck, "--out", "other", "--only", "NOTHING", *QUICK)
    assert code == 2
    assert "NOTHING" in err
    assert not (tmp_path / "other").exists()


def test_a_deck_that_is_not_the_model_ends_with_3(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "meshops.formats.verified.differences", lambda model, again: ("node 5 is elsewhere",)
    )
    code, _, err = call("optimize", deck, "--out", "run", *QUICK)
    assert code == 3
    assert "node 5 is elsewhere" in err
    assert "Traceback" not in err
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert not [name for name in names if name.endswith(".bdf")]
    assert "result.json" not in names


def test_a_folder_that_may_not_be_written_to_is_told_before_the_search(  # type: ignore[no-untyped-def]
    call, deck: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda _, mode: mode != os.W_OK)
    for arguments in (
        ("optimize", deck, "--out", "no/run", *FAST),
        ("mesh", deck, "--out", "no/a.bdf"),
        ("replay", "p.json", deck, "--out", "no/a.bdf"),
    ):
        code, out, err = call(*arguments)
        assert (code, out) == (2, "")
        assert f"{tmp_path} may not be written to" in err
    assert not (tmp_path / "no").exists()


def test_ids_that_are_not_there_are_told_before_the_search(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    write_mesh(bad_plate(), tmp_path / "full.bdf")
    text = (tmp_path / "full.bdf").read_text()
    full = "CBAR,99999999,9,1,2,1.,0.,0.\nSET3,9,ELEM,1,THRU,99999998\n"
    (tmp_path / "full.bdf").write_text(text.replace("ENDDATA", full + "ENDDATA"))
    code, out, err = call("optimize", "full.bdf", "--out", "run", *FAST)
    if code:  # where such a range reserves nothing, there are ids enough
        assert (code, out) == (2, "")
        assert "ids" in err or "locked" in err
        assert not (tmp_path / "run").exists()


def test_a_run_that_ends_worse_in_anything_says_so(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    from dataclasses import replace

    from tests.jobs import finish, job

    done = finish(job(bad_plate()))
    assert done.worse == ()
    worse = replace(
        done,
        before=replace(done.before, failed_by_shape=1, failed_by_size=0, trias=2, compound_qi=1.0),
        after=replace(done.after, failed_by_shape=0, failed_by_size=3, trias=4, compound_qi=2.5),
        irregular_before=1,
        irregular_after=2,
    )
    assert worse.worse == (
        "elements that fail by size alone 0 -> 3",
        "trias 2 -> 4",
        "compound Q.I. 1.0 -> 2.5",
        "irregular nodes 1 -> 2",
    )


def shared_places(mesh: ShellMesh) -> set[tuple[float, ...]]:
    """Places of the nodes that elements of several regions use."""
    regions: dict[int, set[int]] = {}
    for row, region in zip(mesh.elements.tolist(), mesh.region.tolist(), strict=True):
        for node in row:
            regions.setdefault(node, set()).add(region)
    return {
        tuple(mesh.points[node].tolist())
        for node, found in regions.items()
        if node >= 0 and len(found) > 1
    }


def test_an_array_of_a_file_tells_the_parts(call, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    mesh = bad_plate()
    half = (mesh.points[mesh.elements[:, :3], 0].mean(axis=1) > 25.0).astype(int)
    write_mesh(mesh, tmp_path / "a.vtu", cell_data={"layer": half + 3})
    options = ("--out", "run", *QUICK)
    assert call("optimize", "a.vtu", "--regions", "layer", *options)[0] == 0
    between = [
        shared_places(read_deck(tmp_path / name, regions="layer").mesh)
        for name in ("a.vtu", "run/a.vtu")
    ]
    assert len(between[0]) == 9
    assert between[1] == between[0]
    code, _, err = call("optimize", "a.vtu", "--regions", "nothing", "--out", "other", *QUICK)
    assert code == 2
    assert "nothing" in err


def test_rows_in_which_elements_fail_are_red_on_a_terminal(
    poor: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    arguments = ["check", str(poor), "--size", "5", "--criteria", "paper"]
    shown = CliRunner().invoke(cli, arguments, color=True).output.splitlines()
    red = [line for line in shown if line.startswith("\x1b[31m")]
    assert [line.split("  ")[1].strip() for line in red] == ["max length", "aspect ratio"]
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in CliRunner().invoke(cli, arguments, color=True).output
