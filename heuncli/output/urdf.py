"""Write a scene as URDF: a tree of pins, slides and welds, so that other programs show and move the same machine.

    link frame        of a body that a joint holds at the joint's point of the body; of a free one at its origin; its
                      axes are the body's
    world             the ground: the root

What URDF has no words for changes the motion and is refused; what is not part of a robot is left out, and noted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

from heuncli.base.errors import SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words
from heuncli.multibody.mechanism.loads import GROUND, JointLoad
from heuncli.multibody.mechanism.model import Body, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.robot_tree import (
    PIN_KINDS,
    WORLD,
    PlacedJoint,
    choose_name,
    clean_rotation,
    find_attitude,
    find_axis,
    find_limits,
    format_line,
    format_numbers,
    grow_forest,
    is_linear_damper,
    list_free_points,
    list_left_out,
    list_start_notes,
    make_coupling_problems,
    make_joint_problems,
    place_shape,
)
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Spec
from heuncli.scene.importers.attitudes import compute_roll_pitch_yaw

CODE = "export-urdf"
KINDS = {**dict.fromkeys(PIN_KINDS, "continuous"), "slide": "prismatic", "weld": "fixed"}
UNLIMITED = 1e16  # [m] limit of a slide without stops: URDF takes a missing limit for 0; heun reads it as none
STRONG = 1e9  # effort and velocity, which URDF wants to have limits
STANDARD_GRAVITY_TEXT = "0 0 -9.81"


class UrdfText(NamedTuple):
    """A scene as URDF. text: the file; notes: what it does not say"""

    text: str
    notes: tuple[str, ...]


def write_urdf(spec: Spec, scene: PreparedScene) -> UrdfText:
    """Write a scene as URDF. Raises SpecError [export-urdf] for all that it cannot say."""
    mechanism = scene.mechanism
    tree = require_tree(spec, mechanism)
    origins = [np.zeros(3) for _ in mechanism.bodies]
    for placed in tree:
        origins[placed.child] = placed.child_point
    notes = [*list_urdf_notes(spec, mechanism, tree), *list_start_notes(scene, tree)]
    held = {placed.child for placed in tree}
    lines = ['<?xml version="1.0"?>', f"<robot name={quoteattr(format_line(spec.title) or 'robot')}>"]
    lines += [f"  <!-- {format_line(note).replace('--', '- -')} -->" for note in notes]
    world = choose_name(WORLD, spec.bodies)
    lines.append(f'  <link name="{world}"/>')
    for i, body in enumerate(mechanism.bodies):
        lines += iter_link(body, origins[i], spec.bodies[body.name].shapes or ())
    for placed in tree:
        lines += iter_joint(placed, origins, scene, world)
    for i in sorted(set(range(len(mechanism.bodies))) - held):
        pose = format_pose(scene.start.position[i], scene.start.rotation[i])
        name = choose_name(f"free_{mechanism.bodies[i].name}", spec.joints)
        ends = f'<parent link="{world}"/><child link="{mechanism.bodies[i].name}"/>'
        lines.append(f'  <joint name="{name}" type="floating">{ends}{pose}</joint>')
    lines += iter_points(spec, mechanism, origins)
    return UrdfText("\n".join([*lines, "</robot>", ""]), tuple(notes))


def require_tree(spec: Spec, mechanism: Mechanism) -> tuple[PlacedJoint, ...]:
    """Return the joints from the ground outward, then those of free machines. Raises SpecError [export-urdf]."""
    forest = grow_forest(mechanism)
    unknown = [joint for joint in mechanism.joints if joint.kind not in KINDS]
    problems = [
        *make_joint_problems(spec, unknown, CODE, "a joint of type {kind} has no counterpart in URDF",
                             "URDF knows pin, slide and weld; of a ball make three pins"),
        *make_coupling_problems(spec, spec.couplings, "URDF", CODE),
        *make_joint_problems(spec, forest.closures, CODE,
                             "the joint {name} closes a loop, and a robot of URDF is a tree",
                             "leave it out of the exported spec, or export mjcf"),
    ]  # fmt: skip
    if problems:
        raise SpecError(*problems)
    return forest.tree


def list_urdf_notes(spec: Spec, mechanism: Mechanism, tree: Sequence[PlacedJoint]) -> Iterator[str]:
    """Yield sentences on what the file does not hold."""
    gravity = " ".join(f"{component:g}" for component in spec.gravity)
    if gravity != STANDARD_GRAVITY_TEXT:
        yield f"gravity is {gravity} m/s^2; URDF has none"
    limits = find_limits(mechanism)
    yield from list_left_out(spec, mechanism, {load.name for load in mechanism.loads if is_linear_damper(load)}, limits)
    endless = [
        placed.joint.name
        for placed in tree
        if placed.joint.kind == "slide" and (placed.joint.name, "travel") not in limits
    ]
    if endless:
        yield f"URDF needs limits of slides: {UNLIMITED:g} m stands for none: {list_words(endless)}"


# Parts


def iter_link(body: Body, origin: Array, shapes: Sequence[Shape]) -> Iterator[str]:
    """Yield the lines of a link. origin (3,): of its frame, body axes [m]"""
    yield f'  <link name="{body.name}">'
    if body.mass > 0.0:
        center = format_numbers(body.center - origin)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = (map(float, row) for row in body.inertia)
        moments = " ".join(
            f'{name}="{value!r}"'
            for name, value in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), (xx, xy, xz, yy, yz, zz), strict=True)
        )
        mass = f'<mass value="{float(body.mass)!r}"/><inertia {moments}/>'
        yield f'    <inertial><origin xyz="{center}" rpy="0 0 0"/>{mass}</inertial>'
    for shape in shapes:
        placed = place_shape(shape)
        if placed is not None:
            place, R, sizes = placed
            form = format_geometry(shape, sizes)
            yield f"    <visual>{format_pose(place - origin, R)}<geometry>{form}</geometry></visual>"
    yield "  </link>"


def format_geometry(shape: Shape, sizes: tuple[float, ...]) -> str:
    """Format a shape of these sizes."""
    if shape.type == "box":
        return f'<box size="{format_numbers(sizes)}"/>'
    if shape.type == "sphere":
        return f'<sphere radius="{sizes[0]!r}"/>'
    return f'<cylinder radius="{sizes[0]!r}" length="{sizes[1]!r}"/>'


def iter_joint(placed: PlacedJoint, origins: Sequence[Array], scene: PreparedScene, world: str) -> Iterator[str]:
    """Yield the lines of a joint. world: the name of the root link"""
    joint, mechanism = placed.joint, scene.mechanism
    attitude = find_attitude(placed, scene)
    kind, parts = KINDS[joint.kind], ""
    if kind != "fixed":
        quantity = "travel" if kind == "prismatic" else "angle"
        parts = f'<axis xyz="{format_numbers(find_axis(placed, attitude))}"/>'
        damping = sum(
            load.turning if quantity == "angle" else load.sliding
            for load in mechanism.loads
            if isinstance(load, JointLoad) and is_linear_damper(load) and mechanism.joints[load.joint] is joint
        )
        parts += f'<dynamics damping="{float(damping)!r}"/>' if damping else ""
        stop = find_limits(mechanism).get((joint.name, quantity))
        low, high = (-UNLIMITED, UNLIMITED) if stop is None else (stop.low, stop.high)
        if stop is not None or kind == "prismatic":
            kind = "revolute" if kind == "continuous" else kind
            parts += f'<limit lower="{low!r}" upper="{high!r}" effort="{STRONG!r}" velocity="{STRONG!r}"/>'
    parent = world if placed.parent == GROUND else mechanism.bodies[placed.parent].name
    yield f'  <joint name="{joint.name}" type="{kind}">'
    yield f'    <parent link="{parent}"/><child link="{mechanism.bodies[placed.child].name}"/>'
    base = np.zeros(3) if placed.parent == GROUND else origins[placed.parent]
    yield f"    {format_pose(placed.parent_point - base, attitude)}{parts}"
    yield "  </joint>"


def iter_points(spec: Spec, mechanism: Mechanism, origins: Sequence[Array]) -> Iterator[str]:
    """Yield the named points that are no joint's, as links without mass that are fixed to their bodies."""
    for i, name, place in list_free_points(spec, mechanism):
        body = mechanism.bodies[i].name
        link = f"{body}.{name}"
        pose = format_pose(place - origins[i], np.eye(3))
        yield f'  <link name="{link}"/>'
        yield f'  <joint name="{link}.fixed" type="fixed"><parent link="{body}"/><child link="{link}"/>{pose}</joint>'


def format_pose(place: Array, R: Array) -> str:
    """Format an <origin>; rounding of the rotation is taken out."""
    rows = [tuple(map(float, row)) for row in clean_rotation(R)]
    angles = compute_roll_pitch_yaw(tuple(rows))  # type: ignore[arg-type]
    return f'<origin xyz="{format_numbers(place)}" rpy="{format_numbers(angles)}"/>'
