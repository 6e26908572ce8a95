"""Rules about scenes declared planar: everything lies in the world's xy plane, or turns about z."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_AXIS, TYPES
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.resolve_loads import is_matrix
from heuncli.scene.file_format.rotations import IDENTITY, unit_vector
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import orientation_matrix

SPATIAL_HINT = "for a spatial model declare space: spatial"
# Vectors of bodies and of loads with the components that they cannot have in the plane.
FORBIDDEN_VELOCITY = {"velocity": ("z",), "angular_velocity": ("x", "y")}
FORBIDDEN_LOAD = {"N": ("z",), "N·m": ("x", "y")}  # by its unit
FORBIDDEN_IMPULSE = {"vector": ("z",), "couple": ("x", "y")}
# Matrices of bushings: which of their rows and of their columns lie in the plane.
SHIFTS, TURNS = (True, True, False), (False, False, True)
IN_PLANE = {
    "stiffness": (SHIFTS, SHIFTS), "turning": (TURNS, TURNS), "coupling": (SHIFTS, TURNS),
    "damping": (SHIFTS, SHIFTS), "turning_damping": (TURNS, TURNS), "coupling_damping": (SHIFTS, TURNS),
}  # fmt: skip


@rule("not-planar")
def check_planar(draft: DraftDocument) -> Iterator[Violation]:
    """In a scene declared planar everything turns about z and moves in the xy plane."""
    if draft.document.head.space != "planar":
        return
    if draft.document.head.gravity[2] != 0.0:
        yield Violation(
            ("gravity", 2), "gravity points out of the xy plane of a planar model", "use x and y, or space: spatial"
        )
    yield from _check_joints(draft)
    for name, body in draft.document.bodies.items():
        if body.orientation is not None and abs(z_axis_cosine(body.orientation) - 1.0) > tolerances.UPRIGHT:
            yield Violation(
                ("bodies", name, "orientation"), "in a planar model bodies rotate about z only", SPATIAL_HINT
            )
        for key, forbidden in FORBIDDEN_VELOCITY.items():
            value = getattr(body, key)
            path: Path_ = ("bodies", name, key)
            if value is not None:
                has_frame = not isinstance(value, tuple)
                yield from _check_components(
                    (*path, "vector") if has_frame else path, value.vector if has_frame else value, forbidden
                )
    for name, load in draft.document.forces.items():
        kind = LOAD_KINDS[load.type]
        if kind.is_external:
            for key in ("vector", "to_vector"):
                value = getattr(load, key, None)
                vector = tuple(x.constant for x in value or ())
                yield from _check_components(("forces", name, key), vector, FORBIDDEN_LOAD[kind.unit or "N"])
        elif isinstance(load, fl.BushingEntry):
            yield from _check_bushing(("forces", name), load)
    for name, impulse in draft.document.impulses.items():
        for key, forbidden in FORBIDDEN_IMPULSE.items():
            value = getattr(impulse, key)
            if value is not None:
                yield from _check_components(("impulses", name, key), value, forbidden)


def _check_components(path: Path_, vector: tuple[float | None, ...], forbidden: tuple[str, ...]) -> Iterator[Violation]:
    """Yield forbidden components that are not zero; None stands for one that changes with time."""
    for i, (letter, value) in enumerate(zip("xyz", vector, strict=False)):
        if letter in forbidden and value != 0.0:
            yield Violation((*path, i), f"in a planar model {path[2]} has no {letter} component", SPATIAL_HINT)


def _check_bushing(path: Path_, load: fl.BushingEntry) -> Iterator[Violation]:
    """One axis of a bushing is the z axis, and its preload lies in the plane."""
    for key in ("orientation", "to_orientation"):
        orientation = getattr(load, key)
        if orientation is not None and abs(z_axis_cosine(orientation) - 1.0) > tolerances.UPRIGHT:
            yield Violation((*path, key), "in a planar model the axes of a bushing rotate about z only", SPATIAL_HINT)
    for key, (rows, columns) in IN_PLANE.items():
        matrix = getattr(load, key)
        for i, j in product(range(3), range(3)) if is_matrix(matrix) else ():
            if matrix[i][j] != 0.0 and rows[i] != columns[j]:
                message = f"in a planar model {key} does not couple the plane with other directions"
                yield Violation((*path, key, i, j), message, SPATIAL_HINT)
    for key, forbidden in (("preload", ("z",)), ("turning_preload", ("x", "y"))):
        if getattr(load, key) is not None:
            yield from _check_components((*path, key), getattr(load, key), forbidden)


def _check_joints(draft: DraftDocument) -> Iterator[Violation]:
    for name, joint in draft.document.joints.items():
        path: Path_ = ("joints", name)
        kind = TYPES[joint.type]
        if kind.planar is None:
            yield Violation(
                (*path, "type"), f"a joint of type {joint.type} is not possible in a planar model", SPATIAL_HINT
            )
            continue
        along_z = kind.turn is ABOUT_AXIS or kind.follows_path
        for key in ("axis", "to_axis", "normal"):
            direction = getattr(joint, key, None)
            if direction is None or direction == (0.0, 0.0, 0.0):
                continue
            x, y, z = unit_vector(direction)
            if (math.hypot(x, y) if along_z else abs(z)) > tolerances.PARALLEL:
                requirement = "must be the z axis" if along_z else "must lie in the xy plane"
                yield Violation(
                    (*path, key), f"in a planar model the {key} of a {joint.type} {requirement}", SPATIAL_HINT
                )


def z_axis_cosine(orientation: fs.Orientation) -> float:
    """Return the cosine between the body's z axis and the world's; 1 if the orientation is not valid."""
    try:
        return orientation_matrix(orientation)[2][2]
    except ValueError:
        return IDENTITY[2][2]
