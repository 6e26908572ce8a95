"""What is wrong with a URDF is told with its place, all of it at once, and nothing is written."""

from __future__ import annotations

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.importers.spec_text import format_spec
from tests.shared.imported import described, imported

FINE = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
BODY = f'<inertial><mass value="1"/>{FINE}</inertial>'


def robot(*lines: str) -> str:
    """A robot whose parts stand from line 2 on."""
    return "\n".join(["<robot name='r'>", *lines, "</robot>"])


def link(name: str, inner: str = BODY) -> str:
    return f'<link name="{name}">{inner}</link>'


def inertia(mass: str, *moments: float) -> str:
    named = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), (*moments, 0, 0, 0), strict=False)
    return f'<inertial><mass value="{mass}"/><inertia {" ".join(f"{k}={str(v)!r}" for k, v in named)}/></inertial>'


def joint(name: str, parent: str, child: str, inner: str = "", kind: str = "revolute") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inner}</joint>'


TWO = (link("a"), link("b"))
MIMIC = '<mimic joint="{}" multiplier="2"/>'
REFUSED = {  # the lines, and of each problem its line, code, and words of message or hint
    "no links": ([], [(1, "import-tree", "no links")]),
    "unknown link": ([*TWO, joint("j", "aa", "b")], [(4, "import-tree", "its parent 'aa' is not a link")]),
    "two parents": (
        [*TWO, link("c"), joint("j", "a", "b"), joint("k", "c", "b")],
        [(6, "import-tree", "two parents: it is also the child of joint j")],
    ),
    "two roots": ([*TWO], [(3, "import-tree", "2 links have no parent, but only one may be the root: a, b")]),
    "no root": ([*TWO, joint("j", "a", "b"), joint("k", "b", "a")], [(5, "import-tree", "the links form a loop")]),
    "circle beside a root": (
        [*TWO, link("c"), joint("j", "b", "c"), joint("k", "c", "b")],
        [(6, "import-tree", "the links form a loop: b, c, b")],
    ),
    "own child": ([link("a"), joint("j", "a", "a")], [(3, "import-tree", "the links form a loop: a, a")]),
    "name twice": ([link("a"), link("a")], [(3, "import-twice", "first in line 2")]),
    "joint twice": (
        [*TWO, joint("j", "a", "b"), joint("j", "a", "b")], [(5, "import-twice", "first in line 4")],
    ),
    "no name": (["<link/>", '<link name=" "/>'], [(2, "import-missing", "name"), (3, "import-missing", "empty")]),
    "no type": ([*TWO, '<joint name="j"><parent link="a"/><child link="b"/></joint>'], [(4, "import-missing", "type")]),
    "no ends": (
        [*TWO, '<joint name="j" type="fixed"/>'],
        [(4, "import-missing", "<parent> is missing"), (4, "import-missing", "<child> is missing")],
    ),
    "unknown type": ([*TWO, joint("j", "a", "b", kind="ball")], [(4, "import-joint", "three revolute")]),
    "axis of nothing": ([*TWO, joint("j", "a", "b", '<axis xyz="0 0 0"/>')], [(4, "import-joint", "axis is 0 0 0")]),
    "axis of two": ([*TWO, joint("j", "a", "b", '<axis xyz="0 1"/>')], [(4, "import-number", "found 2")]),
    "comma": ([*TWO, joint("j", "a", "b", '<origin xyz="0,1,2"/>')], [(4, "import-number", "numbers by spaces")]),
    "macro": ([*TWO, joint("j", "a", "b", '<origin xyz="${x} 0 0"/>')], [(4, "import-number", "xacro")]),
    "xacro": (["<xacro:arm/>"], [(2, "import-xacro", "<xacro:arm> is a xacro macro")]),
    "unknown part": ([*TWO, joint("j", "a", "b"), "<loop_joint/>"], [(5, "import-part", "<loop_joint>")]),
    "quaternion": (
        [*TWO, joint("j", "a", "b", '<origin quat_xyzw="0 0 0 1"/>')], [(4, "import-attribute", "quat_xyzw")],
    ),
    "unknown part of a joint": (
        [*TWO, joint("j", "a", "b", '<axes xyz="0 1 0"/>')], [(4, "import-part", "mean axis?")],
    ),
    "unknown part of an inertial": (
        [link("a", f'<inertial><mass value="1"/><pose/>{FINE}</inertial>')], [(2, "import-part", "<pose>")],
    ),
    "misspelt part of a link": (
        [link("a"), link("b", BODY.replace("inertial", "inertail")), joint("j", "a", "b", kind="fixed")],
        [(3, "import-part", "did you mean inertial?")],
    ),
    "misspelt part": ([*TWO, joint("j", "a", "b").replace("joint", "jiont")], [(4, "import-part", "mean joint?")]),
    "axis without a direction": ([*TWO, joint("j", "a", "b", "<axis/>")], [(4, "import-missing", "xyz")]),
    "misspelt limit": (
        [*TWO, joint("j", "a", "b", '<limit lower="0" uppr="1"/>')], [(4, "import-attribute", "upper?")],
    ),
    "misspelt damping": ([*TWO, joint("j", "a", "b", '<dynamics dampng="1"/>')], [(4, "import-attribute", "damping?")]),
    "origin twice": ([*TWO, joint("j", "a", "b", "<origin/><origin/>")], [(4, "import-twice", "2 times")]),
    "no numbers": (
        [link("a", inertia("heavy", 1, 1, 1)), link("b", inertia("nan", 1, 1, 1)), joint("j", "a", "b")],
        [(2, "import-number", "heavy is not a number"), (3, "import-number", "nan is not a finite number")],
    ),
    "beyond numbers": (
        [link("a", inertia("1e999", 1, 1, 1)), link("b", inertia("1e-70", 1, 1, 1)), joint("j", "a", "b")],
        [(2, "import-number", "too large"), (3, "import-number", "too small")],
    ),
    "other digits": ([link("a", inertia("1_0", 1, 1, 1))], [(2, "import-number", "1_0 is not a number")]),
    "half an inertial": (
        [
            link("a", '<inertial><mass value="1"/></inertial>'), link("b", f"<inertial>{FINE}</inertial>"),
            joint("j", "a", "b"),
        ],
        [(2, "import-missing", "no <inertia>"), (3, "import-missing", "no <mass>")],
    ),
    "half a tensor": (
        [link("a", '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"/></inertial>')],
        [(2, "import-missing", "iyz")],
    ),
    "masses": (
        [link("a", inertia("-1", 1, 1, 1)), link("b", inertia("0", 1, 1, 1)), joint("j", "a", "b")],
        [(2, "import-mass", "the mass is -1 kg"), (3, "import-mass", "the mass is 0, the inertia is not")],
    ),
    "inertias": (
        [
            link("a", inertia("1", 0, 0, 0)), link("b", inertia("1", -1, 1, 1)), link("c", inertia("1", 1, 1, 3)),
            joint("j", "a", "b"), joint("k", "b", "c"),
        ],
        [
            (2, "import-inertia", "all moments of inertia are 0"), (3, "import-inertia", "negative: -1, 1, 1"),
            (4, "import-inertia", "principal moments 1, 1, 3"),
        ],
    ),
    "negative by its products": (
        [link("a", inertia("1", 1, 1, 1, 2))], [(2, "import-inertia", "negative: -1, 1, 3")],
    ),
    "massless before what floats": (
        [link("a"), link("b", ""), link("c"), joint("j", "a", "b"), joint("k", "b", "c", kind="floating")],
        [(3, "import-massless", "moved by the joint j")],
    ),
    "massless at the end": ([link("a"), link("b", ""), joint("j", "a", "b")], [(3, "import-massless", "the joint j")]),
    "no mass at all": (
        [link("a", ""), link("b", ""), joint("j", "a", "b", kind="fixed")], [(1, "import-mass", "no link")],
    ),
    "mimic of nothing": ([*TWO, joint("j", "a", "b", MIMIC.format("jj"))], [(4, "import-mimic", "not a joint")]),
    "mimic of itself": ([*TWO, joint("j", "a", "b", MIMIC.format("j"))], [(4, "import-mimic", "follows itself")]),
    "mimics in a circle": (
        [*TWO, link("c"), joint("j", "a", "b", MIMIC.format("k")), joint("k", "b", "c", MIMIC.format("j"))],
        [(5, "import-mimic", "follows itself, through j, k")],
    ),
    "mimic of a weld": (
        [*TWO, link("c"), joint("j", "a", "b", kind="fixed"), joint("k", "b", "c", MIMIC.format("j"))],
        [(6, "import-mimic", "j is fixed")],
    ),
    "negative damping": (
        [*TWO, joint("j", "a", "b", '<dynamics damping="-1"/>')], [(4, "import-joint", "damping is -1")],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_wrong_is_told_with_its_line(name):
    lines, wanted = REFUSED[name]
    with pytest.raises(SpecError) as refused:
        imported(robot(*lines))
    found = [(each.location.line, each.code) for each in refused.value.problems]
    for problem, (line, code, words) in zip(refused.value.problems, wanted, strict=False):
        assert words in f"{problem.message} {problem.hint}", str(problem)
        assert (problem.location.line, problem.code) == (line, code)
        assert problem.hint
    assert len(found) == len(wanted), found


ASKED = {  # what goes with no file, with some options
    "limits without room": (
        [*TWO, joint("j", "a", "b", '<limit lower="1" upper="1"/>')], {"free": True, "limits": True}, "import-limits",
    ),
    "limits that no position of a leader meets": (
        [
            *TWO, link("c"), joint("j", "a", "b", '<limit lower="0" upper="1"/>'),
            joint("k", "b", "c", f'<limit lower="-3" upper="-2"/>{MIMIC.format("j")}'),
        ],
        {"free": True, "limits": True}, "import-limits",
    ),
    "the world let go": ([link("world"), link("b"), joint("j", "world", "b")], {"base_free": True}, "import-tree"),
    "a root without mass let go": (
        [link("a", ""), link("b"), joint("j", "a", "b")], {"base_free": True}, "import-massless",
    ),
    "a mesh": (
        [link("a", '<visual><geometry><mesh filename="a.stl"/></geometry></visual>')],
        {"density": 1000.0}, "import-shape",
    ),
    "a box of nothing": (
        [link("a", '<visual><geometry><box size="1 0 1"/></geometry></visual>')], {"density": 1000.0}, "import-shape",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ASKED)
def test_what_does_not_go_with_the_options_is_told(name):
    lines, asked, code = ASKED[name]
    with pytest.raises(SpecError) as refused:
        imported(robot(*lines), **asked)
    assert [problem.code for problem in refused.value.problems] == [code]


def test_what_other_programs_say_is_left_out_and_listed():
    """Parts and attributes that no number hangs on; what a fixed joint is to follow. What cancelled out is 0."""
    inner = '<origin xyz="5.8e-66 0 1"/><dynamics D="1" mu_coulomb="0"/><limit gear_velocity="2" effort="1"/>'
    lines = [
        link("a", f"{BODY}<contact/><collision_checking/>"), link("b"), link("c"),
        joint("j", "a", "b", inner),
        joint("k", "b", "c", MIMIC.format("j"), kind="fixed"),
    ]  # fmt: skip
    machine = described(robot(*lines))
    assert [(problem.location.line, problem.code) for problem in machine.left_out] == [(6, "import-left-out")]
    text = format_spec(machine, "r.yaml")
    assert "1 contact in links, 1 collision_checking in links" in text
    assert "j: [0, 0, 1]" in text


def test_moments_of_no_mass_are_left_out_where_that_is_asked_for():
    """A frame stays one; what a joint moves gets a mass."""
    lines = [
        link("a"), link("b", inertia("0", 1, 1, 1)), link("c", inertia("0", 1, 1, 1)),
        joint("j", "a", "b", kind="fixed"), joint("k", "b", "c"),
    ]  # fmt: skip
    text = imported(robot(*lines), repair=frozenset({"massless"}))
    for name in ("b", "c"):
        assert f'Repaired (massless): the link "{name}" has mass 0; its inertia is left out.' in text
    assert "mass: 1e-06 # repaired (massless): the link has mass 0 in the file" in text
    assert "  b:" not in text
