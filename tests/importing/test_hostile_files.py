"""Files that mean harm, or are none: refused at once with a place, and no text of theirs becomes anything in a spec."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.names import is_name
from heuncli.scene.file_format.source import read_source
from heuncli.scene.importers import xml_elements
from heuncli.scene.importers.description import assign_names, clean_name
from heuncli.scene.importers.xml_elements import MAX_ATTRIBUTE_LENGTH, MAX_DEPTH
from tests.shared.imported import described, imported

LAUGHS = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))
BODY = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
REFUSED = {
    "laughs": (f'<!DOCTYPE r [<!ENTITY l0 "ha">{LAUGHS}]><robot>&l9;</robot>', "xml-entities"),
    "external": ('<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot>&x;</robot>', "xml-entities"),
    "parameter entity": ('<!DOCTYPE r [<!ENTITY % x SYSTEM "http://x.invalid/">%x;]><robot/>', "xml-entities"),
    "outer dtd": ('<!DOCTYPE robot SYSTEM "http://x.invalid/a.dtd"><robot/>', "xml-entities"),
    "unknown entity": ("<robot>&x;</robot>", "not-xml"),
    "deep": ("<a>" * (MAX_DEPTH + 10), "too-deep"),
    "long": (f'<robot name="{"x" * (MAX_ATTRIBUTE_LENGTH + 1)}"/>', "too-large"),
    "empty": (" \n", "not-xml"),
    "cut off": ('<robot name="a"><link', "not-xml"),
    "two roots": ("<robot/><robot/>", "not-xml"),
    "attribute twice": ('<robot name="a" name="b"/>', "not-xml"),
    "yaml": ("heun: 1\n", "not-xml"),
    "zeros": ("\0\0\0", "not-xml"),
    "unknown encoding": ('<?xml version="1.0" encoding="klingon"?><robot/>', "not-xml"),
    "no text encoding": ('<?xml version="1.0" encoding="rot13"?><robot/>', "not-xml"),
    "several bytes": ('<?xml version="1.0" encoding="utf-7"?><robot/>', "not-xml"),
    "sdf": ("<sdf/>", "import-tree"),
    "xacro": ('<xacro:robot xmlns:xacro="x"/>', "import-format"),
    "misspelt": ("<Robot/>", "import-format"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_with_a_place(name):
    text, code = REFUSED[name]
    with pytest.raises(SpecError) as refused:
        imported(text)
    (problem,) = refused.value.problems
    assert problem.code == code
    assert problem.location.line >= 1 and problem.location.column >= 1
    assert problem.hint and len(str(problem)) < 1000


@pytest.mark.parametrize("name", ["yaml", "empty", "zeros"])
def test_of_what_is_no_xml_at_all_is_said_what_is_read(name):
    with pytest.raises(SpecError) as refused:
        imported(REFUSED[name][0])
    assert refused.value.problems[0].hint.startswith("a URDF file begins with <robot")


def test_more_elements_than_are_read_are_refused_while_they_come(monkeypatch):
    monkeypatch.setattr(xml_elements, "MAX_ELEMENTS", 1000)
    with pytest.raises(SpecError, match="more than 1,000 elements") as refused:
        imported("<robot>\n" + "<link name='x'/>\n" * 5000)  # which is cut off, too: so far nobody reads
    assert refused.value.problems[0].location.line == 1001


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_encodings(encoding):
    head = '<?xml version="1.0" encoding="iso-8859-1"?>' if encoding == "latin-1" else ""
    text = f'{head}<robot name="Bär"><link name="Fuß">{BODY}</link></robot>'
    assert described(text.encode(encoding)).bodies[0].name == "Fuß"


NASTY = [
    "a: b", "a\n  mass: 5", "{}", "[1]", "#", "- x", "!!python/object", "&a", "*a", "%", "@", "`", '"', "'", "\\", "|",
    "</script><script>alert(1)</script>", "\x85", "\u2028", "\u202e", "\ufeff", "\x7f", "\u200b", "\ud7ff", "\ufffd",
    "true", "null", "~", "on", "1e3", "0x10", ".inf", "NaN", "inf", "t", "pi", "sin", "if", "and", "ground", "gravity",
    "drives", "motion", "step", "table", "_", "__init__", "9lives", "a b", "a-b", "a.b", "a_b", "a__b", "关节",
    "сустав", "مفصل", "संधि", "\ufb01", "fi", "ſ", "Ⅷ", "½", "💪", "x" * 300, "\xa0", "é", "e\u0301", "\u212a", "\u212b",
    "\xc5",
]  # fmt: skip


def test_names_of_any_script_and_of_none_make_a_spec_that_means_the_same():
    """Links and joints by these names: bodies, joints, parameters, drives and points are named apart."""
    texts = [re.sub("[\x00-\x08\x0b\x0c\x0e-\x1f]", "", text) for text in NASTY]

    def escaped(text: str) -> str:
        return "".join(f"&#{ord(letter)};" for letter in text)

    texts = [text for text in texts if text.strip()]
    links = "".join(f'<link name="{escaped(text)}">{BODY}</link>' for text in texts)
    joints = "".join(
        f'<joint name="{escaped(b)}" type="revolute"><parent link="{escaped(a)}"/><child link="{escaped(b)}"/>'
        + (f'<mimic joint="{escaped(texts[1])}" multiplier="3"/>' if number == 5 else "")
        + "</joint>"
        for number, (a, b) in enumerate(pairwise(texts))
    )
    text = imported(f'<robot name="{escaped(texts[1])}">{links}{joints}</robot>')
    spec = load("r.yaml", text)
    assert len(spec.bodies) == len(texts) and len(spec.joints) == len(texts)
    assert [body.mass for body in spec.bodies.values()] == [1.0] * len(texts)
    assert not spec.warnings
    data = read_source("r.yaml", text).data
    assert sorted(data) == sorted(["heun", "title", "parameters", "gravity", "ground", "bodies", "joints", "drives"])
    assert all(set(body) == {"mass", "center", "inertia", "points"} for body in data["bodies"].values())


def test_names_that_are_names_keep_themselves():
    """Whatever others are made into, and whichever stands first."""
    assert assign_names("link", ["a-b", "a_b", "a b", "a_b_2"]) == ["a_b_3", "a_b", "a_b_4", "a_b_2"]
    assert assign_names("joint", ["x", "x", "x"]) == ["x", "x_2", "x_3"]
    assert all(is_name(clean_name(text, "link")) for text in NASTY)
    many = assign_names("link", ["!"] * 20_000)
    assert len(set(many)) == 20_000
