"""Write a scene as URDF: a tree of pins, slides and welds, so that other programs show and move the same machine.

    link frame        of a body that a joint holds at the joint's point of the body; of a free one at its origin; its
                      axes are the body's
    joint position    0 where heun's angle or travel is 0; a joint that heun counts from the child to the parent has the
                      opposite axis
    world             the ground: the root

What URDF has no words for changes the motion and is refused; what is not part of a robot is left out, and noted.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

from heuncli.base.errors import Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words
from heuncli.base.text_safety import escape
from heuncli.multibody.mechanism.loads import GROUND, JointLoad
from heuncli.multibody.mechanism.model import Body, Joint, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Spec
from heuncli.scene.importers.attitudes import compute_roll_pitch_yaw

CODE = "export-urdf"
WORLD = "world"
KINDS = {"pin": "continuous", "slide": "prismatic", "weld": "fixed"}
FAR = 1e6  # [m] limit of a slide without stops: URDF takes a missing limit for 0
START_ROUNDING = 1e-9  # of start coordinates and velocities [rad, m, rad/s, m/s]
STRONG = 1e9  # effort and velocity, which URDF wants to have limits
ATTITUDE_ROUNDING = 1e-14  # of the elements of a rotation
STANDARD_GRAVITY_TEXT = "0 0 -9.81"
LEFT_OUT_BLOCKS = ("drives", "impulses", "stops", "latches", "sections", "forces")


class PlacedJoint(NamedTuple):
    """A joint of the tree, with its parent and child; number GROUND is the ground."""

    joint: Joint
    parent: int
    child: int

    @property
    def is_reversed(self) -> bool:
        """Whether the child is the `from` body."""
        return self.child == self.joint.a


class UrdfText(NamedTuple):
    """text: the file; notes: what it does not say"""

    text: str
    notes: tuple[str, ...]


def write_urdf(spec: Spec, scene: PreparedScene) -> UrdfText:
    """Write a scene as URDF. Raises SpecError [export-urdf] for all that it cannot say."""
    mechanism = scene.mechanism
    tree = grow_tree(spec, mechanism)
    origins = [np.zeros(3) for _ in mechanism.bodies]
    for placed in tree:
        origins[placed.child] = placed.joint.p if placed.is_reversed else placed.joint.q
    notes = [*list_notes(spec, mechanism), *list_start_notes(scene, tree)]
    held = {placed.child for placed in tree}
    lines = ['<?xml version="1.0"?>', f"<robot name={quoteattr(plain(spec.title) or 'robot')}>"]
    lines += [f"  <!-- {plain(note).replace('--', '- -')} -->" for note in notes]
    world = choose_name(WORLD, spec.bodies)
    lines.append(f'  <link name="{world}"/>')
    for i, body in enumerate(mechanism.bodies):
        lines += iter_link(body, origins[i], spec.bodies[body.name].shapes or ())
    for placed in tree:
        lines += iter_joint(placed, origins, scene, spec, world)
    for i in sorted(set(range(len(mechanism.bodies))) - held):
        pose = format_pose(scene.start.position[i], scene.start.rotation[i])
        name = choose_name(f"free_{mechanism.bodies[i].name}", spec.joints)
        ends = f'<parent link="{world}"/><child link="{mechanism.bodies[i].name}"/>'
        lines.append(f'  <joint name="{name}" type="floating">{ends}{pose}</joint>')
    lines += iter_points(spec, mechanism, origins)
    return UrdfText("\n".join([*lines, "</robot>", ""]), tuple(notes))


def grow_tree(spec: Spec, mechanism: Mechanism) -> list[PlacedJoint]:
    """Return the joints from the ground outward, then those of free machines. Raises SpecError [export-urdf]."""
    problems = [
        Problem(CODE, f"a joint of type {joint.kind} has no counterpart in URDF", spec.location(f"joints.{joint.name}"),
                "URDF knows pin, slide and weld; of a ball make three pins")
        for joint in mechanism.joints if joint.kind not in KINDS
    ]  # fmt: skip
    for name, coupling in spec.couplings.items():
        block = "rolling" if name in spec.rolling else "couplings"
        message = (
            f"a {'wheel' if block == 'rolling' else f'coupling of type {coupling.type}'} has no counterpart in URDF"
        )
        problems.append(Problem(CODE, message, spec.location(f"{block}.{name}"), "leave it out of the exported spec"))
    tree: list[PlacedJoint] = []
    joints_at: dict[int, list[int]] = {}
    for k, joint in enumerate(mechanism.joints):
        joints_at.setdefault(joint.a, []).append(k)
        joints_at.setdefault(joint.b, []).append(k)
    reached, used = {GROUND}, set[int]()
    for root in (GROUND, *range(len(mechanism.bodies))):
        if root != GROUND and root in reached:
            continue
        reached.add(root)
        front = [root]
        for parent in front:
            for k in joints_at.get(parent, ()):
                if k in used:
                    continue
                used.add(k)
                joint = mechanism.joints[k]
                child = joint.b if parent == joint.a else joint.a
                if child in reached:
                    location = spec.location(f"joints.{joint.name}")
                    message = f"the joint {joint.name} closes a loop, and a robot of URDF is a tree"
                    problems.append(Problem(CODE, message, location, "leave it out of the exported spec"))
                    continue
                reached.add(child)
                front.append(child)
                tree.append(PlacedJoint(joint, parent, child))
    if problems:
        raise SpecError(*problems)
    return tree


def list_notes(spec: Spec, mechanism: Mechanism) -> list[str]:
    """Say in sentences what the file does not hold."""
    notes = []
    gravity = " ".join(f"{component:g}" for component in spec.gravity)
    if gravity != STANDARD_GRAVITY_TEXT:
        notes.append(f"gravity is {gravity} m/s^2; URDF has none")
    if mechanism.planar:
        notes.append("the model is planar: of each inertia the moments about x and y have no meaning")
    dampers = {load.name for load in mechanism.loads if is_written_damper(load)}
    for block in LEFT_OUT_BLOCKS:
        names = [name for name in getattr(spec, block) if name not in dampers or block != "forces"]
        names = [name for name in names if block != "stops" or not is_limit(spec.stops[name])]
        if names:
            notes.append(f"{block} left out: {list_words(names)}")
    return notes


def list_start_notes(scene: PreparedScene, tree: Sequence[PlacedJoint]) -> Iterator[str]:
    """Yield sentences on start values, for which URDF has no words: it starts at rest with all coordinates at 0."""
    start, moved = scene.start, []
    for placed in tree:
        joint = placed.joint
        x, y = (place + get_rotation(scene, body) @ point
                for body, point, place in ((joint.a, joint.p, get_position(scene, joint.a)),
                                           (joint.b, joint.q, get_position(scene, joint.b))))  # fmt: skip
        turn = get_rotation(scene, placed.parent).T @ get_rotation(scene, placed.child) - find_attitude(placed, scene)
        reach = 1.0 + float(np.abs(x).max())
        if np.abs(turn).max() > START_ROUNDING or np.abs(y - x).max() > START_ROUNDING * reach:
            moved.append(joint.name)
    if moved:
        yield f"start coordinates left out: {list_words(moved)}"
    rates = np.abs(np.hstack([start.velocity, start.angular_velocity])).max(axis=1, initial=0.0)
    moving = [body.name for body, rate in zip(scene.mechanism.bodies, rates, strict=True) if rate > START_ROUNDING]
    if moving:
        yield f"start velocities left out: {list_words(moving)}"


def is_limit(stop: object) -> bool:
    """Whether a stop has both limits, as the limits of a joint of URDF."""
    return getattr(stop, "low", None) is not None and getattr(stop, "high", None) is not None


def is_written_damper(load: object) -> bool:
    """Whether a load is a damper in a joint, which URDF has as <dynamics>."""
    return isinstance(load, JointLoad) and load.kind == "damper"


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
        geometry = format_geometry(shape)
        if geometry is not None:
            place, R, form = geometry
            yield f"    <visual>{format_pose(place - origin, R)}<geometry>{form}</geometry></visual>"
    yield "  </link>"


def format_geometry(shape: Shape) -> tuple[Array, Array, str] | None:
    """Return the centre [m] and the axes of a shape, and its form; None for what URDF does not know."""
    R = np.eye(3) if shape.rotation is None else np.array(shape.rotation)
    if shape.type == "box" and shape.center is not None and shape.size is not None:
        return np.array(shape.center), R, f'<box size="{format_numbers(shape.size)}"/>'
    if shape.type == "sphere" and shape.center is not None and shape.radius is not None:
        return np.array(shape.center), np.eye(3), f'<sphere radius="{shape.radius!r}"/>'
    if shape.type == "cylinder" and shape.from_ is not None and shape.to is not None and shape.radius is not None:
        along = np.array(shape.to) - np.array(shape.from_)
        length = float(np.linalg.norm(along))
        form = f'<cylinder radius="{shape.radius!r}" length="{length!r}"/>'
        return 0.5 * (np.array(shape.from_) + np.array(shape.to)), turn_z_to(along / length), form
    return None


def turn_z_to(direction: Array) -> Array:
    """Return a rotation (3, 3) that takes the z axis to a direction (3,) of length 1."""
    first = np.cross(np.eye(3)[int(np.argmin(np.abs(direction)))], direction)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(direction, first), direction])


def iter_joint(
    placed: PlacedJoint, origins: Sequence[Array], scene: PreparedScene, spec: Spec, world: str
) -> Iterator[str]:
    """Yield the lines of a joint. world: the name of the root link"""
    joint, mechanism = placed.joint, scene.mechanism
    in_parent = joint.q if placed.is_reversed else joint.p
    attitude = find_attitude(placed, scene)
    in_child = joint.to_axis if joint.kind == "pin" else attitude.T @ joint.axis
    axis = -joint.axis if placed.is_reversed else in_child
    kind, parts = KINDS[joint.kind], ""
    if kind != "fixed":
        parts = f'<axis xyz="{format_numbers(axis)}"/>'
        damping = sum(
            load.turning if joint.kind == "pin" else load.sliding
            for load in mechanism.loads
            if isinstance(load, JointLoad) and is_written_damper(load) and mechanism.joints[load.joint] is joint
        )
        parts += f'<dynamics damping="{float(damping)!r}"/>' if damping else ""
        stop = next((one for one in spec.stops.values() if one.joint == joint.name and is_limit(one)), None)
        low, high = (-FAR, FAR) if stop is None else (stop.low, stop.high)
        if stop is not None or kind == "prismatic":
            kind = "revolute" if kind == "continuous" else kind
            parts += f'<limit lower="{low!r}" upper="{high!r}" effort="{STRONG!r}" velocity="{STRONG!r}"/>'
    parent = world if placed.parent == GROUND else mechanism.bodies[placed.parent].name
    yield f'  <joint name="{joint.name}" type="{kind}">'
    yield f'    <parent link="{parent}"/><child link="{mechanism.bodies[placed.child].name}"/>'
    base = np.zeros(3) if placed.parent == GROUND else origins[placed.parent]
    yield f"    {format_pose(in_parent - base, attitude)}{parts}"
    yield "  </joint>"


def find_attitude(placed: PlacedJoint, scene: PreparedScene) -> Array:
    """Return the axes of the child in those of the parent (3, 3) with the joint at 0."""
    if placed.joint.kind == "pin" and not placed.joint.to_axis_given:  # at 0 where the axes agree
        return np.eye(3)
    return get_rotation(scene, placed.parent).T @ get_rotation(scene, placed.child)  # as assembled


def get_position(scene: PreparedScene, body: int) -> Array:
    """Return the place (3,) of a body's origin, or of the ground's, at the start."""
    return np.zeros(3) if body == GROUND else scene.start.position[body]


def get_rotation(scene: PreparedScene, body: int) -> Array:
    """Return the attitude (3, 3) of a body, or of the ground, at the start."""
    return np.eye(3) if body == GROUND else scene.start.rotation[body]


def iter_points(spec: Spec, mechanism: Mechanism, origins: Sequence[Array]) -> Iterator[str]:
    """Yield the named points that are no joint's, as links without mass that are fixed to their bodies."""
    used = {(joint.a, joint.p_name) for joint in mechanism.joints} | {
        (joint.b, joint.q_name) for joint in mechanism.joints
    }
    for i, body in enumerate(mechanism.bodies):
        for name, place in spec.bodies[body.name].points.items():
            if (i, name) not in used:
                link = f"{body.name}.{name}"
                links = f'<parent link="{body.name}"/><child link="{link}"/>'
                pose = format_pose(np.array(place) - origins[i], np.eye(3))
                yield f'  <link name="{link}"/>'
                yield f'  <joint name="{link}.fixed" type="fixed">{links}{pose}</joint>'


# Numbers and texts


def format_pose(place: Array, R: Array) -> str:
    """Format an <origin>; rounding of the rotation is taken out."""
    exact = np.where(np.abs(R - np.round(R)) < ATTITUDE_ROUNDING, np.round(R), R)
    rows = [tuple(map(float, row)) for row in exact]
    angles = compute_roll_pitch_yaw(tuple(rows))  # type: ignore[arg-type]
    return f'<origin xyz="{format_numbers(place)}" rpy="{format_numbers(angles)}"/>'


def choose_name(name: str, others: Collection[str]) -> str:
    """Return a name that no other has, with as many underscores behind it as that needs."""
    while name in others:
        name += "_"
    return name


def format_numbers(values: Sequence[float] | Array) -> str:
    """Format numbers with all their digits."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def plain(text: str) -> str:
    """Return a text of the spec on one line of XML."""
    return escape(text).replace("<", "(").replace(">", ")").replace("&", "+")
