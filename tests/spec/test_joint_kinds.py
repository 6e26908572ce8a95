"""The table of joints against the file format, and against what mechanics says of every row."""

from __future__ import annotations

from types import NoneType
from typing import get_args

import pytest

from heuncli.base.joint_kinds import ABOUT_AXIS, FLAT, FREE, JOINTS, LINE, POINT, RATES, SYNONYMS, TYPES, JointKind
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format.entries import fields_of, keys_of

IN_PLANE = {kind.name: kind for kind in FLAT.values()}
IN_SPACE = {name: kind for name, kind in JOINTS.items() if name not in IN_PLANE}
ROWS = pytest.mark.parametrize("kind", IN_SPACE.values(), ids=IN_SPACE)
WRITTEN = pytest.mark.parametrize("kind", TYPES.values(), ids=TYPES)


def test_the_format_and_the_table_know_the_same_kinds() -> None:
    assert list(fj.JOINTS) == list(TYPES)


@WRITTEN
def test_keys(kind: JointKind) -> None:
    """The format takes the keys that the row has a use for, and no other."""
    keys = {"type", "from", "to", "stiffness", "bearings"}  # a rule says with its reason where these cannot be
    keys |= {kind.axis_key} if kind.axis_key else set()
    keys |= {"to_axis"} if kind.to_axis != "never" else set()
    keys |= {"initial"} if kind.coordinates else set()
    keys |= {"length", "tension_only", "restitution"} if kind.keeps_distance else set()
    own = {"x", "y", "z", "radius", "normal", "one_sided", "restitution", "bearing"}
    keys |= own if kind.follows_path else set()  # in place of an axis
    keys |= {"bearing"} if kind.hold in (POINT, LINE) and kind.turn in (FREE, ABOUT_AXIS) else set()  # a journal turns
    assert set(keys_of(fj.JOINTS[kind.name])) == keys


@WRITTEN
def test_what_must_be_given(kind: JointKind) -> None:
    fields = fields_of(fj.JOINTS[kind.name])
    must = {key for key in ("axis", "normal", "to_axis") if key in fields and fields[key].is_required}
    wanted = {kind.axis_key, "to_axis" if kind.to_axis == "required" else None}
    assert must == wanted - {None}


@WRITTEN
def test_start_values(kind: JointKind) -> None:
    """Each coordinate and its rate may be held at the start."""
    fields = fields_of(fj.JOINTS[kind.name])
    parts = get_args(fields["initial"].annotation) if "initial" in fields else ()
    models = [part for part in parts if part is not NoneType]
    held = {key for model in models for key in keys_of(model)}
    assert held == {*kind.coordinates, *(RATES[quantity] for quantity in kind.coordinates)}


def test_drives_have_keys() -> None:
    assert {quantity for kind in TYPES.values() for quantity in kind.drives} < set(keys_of(f.DriveEntry))


def test_loads_have_types() -> None:
    assert {load for kind in TYPES.values() for load in kind.loads} < set(fl.LOADS)


@ROWS
def test_what_is_not_held_is_free(kind: JointKind) -> None:
    """Six freedoms of one body against another: held ones are rows, the others freedoms; a rod's are not told apart."""
    bends = 2 if kind.turn.condition == "alike" else 0  # of shafts that turn alike the bend is free, either way
    free = len(kind.shifts) + (3 if kind.is_ball else bends + len(kind.turns))
    assert kind.row_count + free == 6 or (kind.keeps_distance and kind.row_count == 1)


@pytest.mark.parametrize("kind", IN_PLANE.values(), ids=IN_PLANE)
def test_what_is_not_held_in_the_plane_is_free(kind: JointKind) -> None:
    """Three freedoms of one body against another in a plane: held ones are rows; no condition across it is left."""
    assert kind.row_count + len(kind.shifts) + len(kind.turns) == 3 or (kind.keeps_distance and kind.row_count == 1)
    assert set(kind.coordinates) <= {*["angle"] * bool(kind.turns), *["travel"] * bool(kind.shifts)}


@pytest.mark.parametrize("kind", TYPES.values(), ids=TYPES)
def test_every_kind_has_its_forms_in_the_plane(kind: JointKind) -> None:
    """With its axis along the normal and across it; without an axis one."""
    if kind.turn.condition == "alike":
        assert not {(kind.name, True), (kind.name, False)} & FLAT.keys()  # shafts that bend need space
        return
    assert (kind.name, True) in FLAT
    assert not kind.has_axis or (kind.name, False) in FLAT


@ROWS
def test_loads_act_on_what_is_free(kind: JointKind) -> None:
    assert "turning" not in kind.motions or kind.is_ball or kind.turns or kind.turn.condition == "alike"
    assert "sliding" not in kind.motions or kind.shifts
    assert bool(kind.loads) <= bool(kind.motions)
    assert set(kind.coordinates) <= {*["angle"] * bool(kind.turns), *["travel"] * bool(kind.shifts)}


@ROWS
def test_looser_joints_hold_less(kind: JointKind) -> None:
    assert all(JOINTS[other].row_count < kind.row_count for other in kind.weaker_kinds)
    assert all(JOINTS[other].planar_row_count < kind.planar_row_count for other in kind.weaker_planar_kinds)


@WRITTEN
def test_the_planar_form_holds_no_less_of_the_plane(kind: JointKind) -> None:
    """A planar scene may add what holds the plane, and take nothing away."""
    if kind.planar is not None:
        flat = JOINTS[kind.planar]
        assert flat.row_count >= kind.row_count
        assert 1 <= flat.planar_row_count <= 3


def test_a_word_means_one_kind() -> None:
    words = [word for kind in TYPES.values() for word in kind.synonyms]
    assert len(words) == len(set(words)) == len(SYNONYMS)
    assert not set(words) & set(TYPES)
