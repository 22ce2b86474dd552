"""What of the verifiers' lines counts as bad."""

import pytest

from benchmarks.verdicts import bad

SOUND = """shells 373 -> 370  trias 11 -> 1  nodes 417 -> 419
 elset EALL: 373->370 area 9305.97->9306.85 (+0.009%)
free edges 99->99 length 493.818->493.76
concave/inverted 0 -> 0 degenerate 0 -> 0 missing nodes 0 -> 0
min ang 43.4->48.2 max ang 143.5->140.3 max aspect 1.93->1.79 min edge 3.558->3.699
normals: min dot 1.000, flipped triangles 0 of 739
coincident node pairs 0 -> 0 orphan nodes 0 -> 0
before rc 0 t 0.2 finished True err [] nwarn 0 [] umax 0.213622 R at BC [-4.03e-10 3.1e-09 -73.686]
after rc 0 t 0.1 finished True err [] nwarn 0 [] umax 0.2142 R at BC [-7.8e-09 -2.1e-08 -73.7]"""


def test_a_sound_deck_has_nothing_bad():
    assert bad(SOUND.splitlines()) == []


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("trias 11 -> 1", "trias 11 -> 12", "trias 11 -> 12"),
        ("9305.97->9306.85", "9305.97->9290.0", "area 9305.97 -> 9290.0"),
        ("inverted 0 -> 0", "inverted 0 -> 1", "inverted 0 -> 1"),
        ("degenerate 0 -> 0", "degenerate 1 -> 2", "degenerate 1 -> 2"),
        ("43.4->48.2", "43.4->40.0", "least angle 43.4 -> 40.0"),
        ("143.5->140.3", "143.5->145.0", "largest angle 143.5 -> 145.0"),
        ("1.93->1.79", "1.93->3.5", "aspect 1.93 -> 3.5"),
        ("flipped triangles 0", "flipped triangles 3", "flipped trias 0 -> 3"),
        ("pairs 0 -> 0", "pairs 0 -> 2", "nodes at one place 0 -> 2"),
        ("orphan nodes 0 -> 0", "orphan nodes 0 -> 2", "orphan nodes 0 -> 2"),
        ("umax 0.2142", "umax 0.225576", "largest displacement 0.213622 -> 0.225576"),
        ("-73.7]", "-74.0]", "reactions"),
        ("after rc 0 t 0.1 finished True", "after rc 201 t 0.1 finished False", "does not solve"),
        ("free edges", "!! shells without section 0 -> 3 free edges", "without section"),
        ("free edges", " nset N1 set 3->2 DANGLING 1 free edges", "DANGLING"),
        ("free edges", "BAD  shells on the same nodes free edges", "same nodes"),
    ],
)
def test_each_fault_is_told_by_itself(old, new, told):
    assert old in SOUND
    (found,) = bad(SOUND.replace(old, new).splitlines())
    assert told in found


def test_what_could_not_be_solved_before_is_no_fault():
    lines = SOUND.replace("before rc 0 t 0.2 finished True", "before rc 1 t 0.2 finished False")
    assert bad(lines.replace("umax 0.2142", "umax 9.9").splitlines()) == []
