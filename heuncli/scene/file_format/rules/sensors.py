"""Rules about sensors, which read a reaction that exists, and about the two bearings of a joint."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, format_kind_names
from heuncli.base.spelling import suggest
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.rules.sections import is_cut_series


@rule("sensor-of")
def check_sensor_source(draft: DraftDocument) -> Iterator[Violation]:
    """A sensor reads the reaction of a joint, or the load of a single cut."""
    entries = draft.names.entries
    for name, sensor in draft.document.sensors.items():
        path = ("sensors", name, "of")
        block, _, source = sensor.of.partition(".")
        if block not in ("joints", "sections") or not source:
            owner = next((own for own in ("joints", "sections") if sensor.of in entries[own]), None)
            hint = f"write {owner}.{sensor.of}" if owner else "write joints.NAME or sections.NAME"
            yield Violation(path, f"'{sensor.of}' is not a reaction", hint)
        elif source not in entries[block]:
            yield Violation(path, f"'{source}' is not a {block[:-1]}", suggest(source, entries[block], block) or "")
        elif (
            block == "sections" and source in draft.document.sections and is_cut_series(draft.document.sections[source])
        ):
            hint = "give the section one cut: at and normal"
            yield Violation(path, f"'{source}' is a series of cuts, and a sensor has one place", hint)


@rule("bearings-form")
def check_bearing_pairs(draft: DraftDocument) -> Iterator[Violation]:
    """Two bearings are apart, on a joint that holds its axis; one of them carries the axial load if the joint does."""
    for name, joint in draft.document.joints.items():
        pair, kind, path = joint.bearings, TYPES[joint.type], ("joints", name, "bearings")
        if pair is None:
            continue
        first, second = pair.at
        if not kind.carries_tilting:
            known = format_kind_names([kind for kind in TYPES.values() if kind.carries_tilting], "or")
            message = f"a {joint.type} carries no tilting moment about an axis, so it cannot stand for two bearings"
            yield Violation(path, message, f"two bearings make a {known}", key=True)
        elif pair.axial is not None and kind.shifts:
            message = f"a {joint.type} slides along its axis, so no bearing carries an axial load"
            yield Violation((*path, "axial"), message, "leave it out", key=True)
        if abs(second - first) <= tolerances.SAME_VALUE * max(abs(first), abs(second)):
            message = f"both bearings are at {first:g} m, where they cannot carry a tilting moment"
            yield Violation((*path, "at"), message, "give two places along the axis, from the `to` point")
