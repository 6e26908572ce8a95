"""Scenes declared planar: all that is given lies in the world's xy plane, or turns about z."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_AXIS, TYPES
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import body_axes
from heuncli.scene.file_format.turns import IDENTITY, unit

OR_ELSE = "or declare space: spatial"
# Vectors of bodies and of loads with the components that they cannot have in the plane.
MOTIONS = {"velocity": ("z",), "angular_velocity": ("x", "y")}
LOADS = {"force": ("z",), "distributed": ("z",), "couple": ("x", "y")}
BLOWS = {"vector": ("z",), "couple": ("x", "y")}


@rule("not-planar")
def not_planar(draft: DraftDocument) -> Iterator[Violation]:
    """In a scene declared planar everything turns about z and moves in the xy plane."""
    if draft.document.head.space != "planar":
        return
    if draft.document.head.gravity[2] != 0.0:
        yield Violation(
            ("gravity", 2), "gravity points out of the xy plane of a planar scene", "use x and y, or space: spatial"
        )
    yield from _joints(draft)
    for name, body in draft.document.bodies.items():
        if body.orientation is not None and abs(upright(body.orientation) - 1.0) > tolerances.UPRIGHT:
            yield Violation(("bodies", name, "orientation"), "in a planar scene a body is turned about z only", OR_ELSE)
        for key, forbidden in MOTIONS.items():
            given = getattr(body, key)
            path: Path_ = ("bodies", name, key)
            if given is not None:
                framed = not isinstance(given, tuple)
                yield from _out_of_plane(
                    (*path, "vector") if framed else path, given.vector if framed else given, forbidden
                )
    for name, load in draft.document.forces.items():
        if isinstance(load, f.ForceEntry | f.CoupleEntry | f.DistributedEntry):
            for key in ("vector", "to_vector"):
                given = getattr(load, key, None)
                vector = tuple(x.constant for x in given or ())
                yield from _out_of_plane(("forces", name, key), vector, LOADS[load.type])
        elif isinstance(load, fe.BushingEntry):
            yield from _bushing(("forces", name), load)
    for name, blow in draft.document.impulses.items():
        for key, forbidden in BLOWS.items():
            given = getattr(blow, key)
            if given is not None:
                yield from _out_of_plane(("impulses", name, key), given, forbidden)


def _out_of_plane(path: Path_, vector: tuple[float | None, ...], forbidden: tuple[str, ...]) -> Iterator[Violation]:
    """Forbidden components that are not zero; None is one that changes with time."""
    for i, (letter, value) in enumerate(zip("xyz", vector, strict=False)):
        if letter in forbidden and value != 0.0:
            yield Violation((*path, i), f"in a planar scene {path[2]} has no {letter} component", OR_ELSE)


def _bushing(path: Path_, load: fe.BushingEntry) -> Iterator[Violation]:
    """One of its axes is the z axis, and what it is preloaded by lies in the plane."""
    for key in ("orientation", "to_orientation"):
        given = getattr(load, key)
        if given is not None and abs(upright(given) - 1.0) > tolerances.UPRIGHT:
            yield Violation((*path, key), "in a planar scene the axes of a bushing are turned about z only", OR_ELSE)
    for key, forbidden in (("preload", ("z",)), ("turning_preload", ("x", "y"))):
        if getattr(load, key) is not None:
            yield from _out_of_plane((*path, key), getattr(load, key), forbidden)


def _joints(draft: DraftDocument) -> Iterator[Violation]:
    for name, joint in draft.document.joints.items():
        path: Path_ = ("joints", name)
        kind = TYPES[joint.type]
        if kind.planar is None:
            yield Violation((*path, "type"), f"a joint of type {joint.type} has no place in a planar scene", OR_ELSE)
            continue
        along_z = kind.turn is ABOUT_AXIS or kind.follows_path
        for key in ("axis", "to_axis", "normal"):
            direction = getattr(joint, key, None)
            if direction is None or direction == (0.0, 0.0, 0.0):
                continue
            x, y, z = unit(direction)
            if (math.hypot(x, y) if along_z else abs(z)) > tolerances.PARALLEL:
                wants = "is the z axis" if along_z else "lies in the xy plane"
                yield Violation((*path, key), f"in a planar scene {key} of a {joint.type} {wants}", OR_ELSE)


def upright(orientation: fs.Orientation) -> float:
    """The cosine between the body's z axis and the world's; 1 where the orientation is in error."""
    try:
        return body_axes(orientation)[2][2]
    except ValueError:
        return IDENTITY[2][2]
