"""Write a scene as MJCF, MuJoCo's format: trees of bodies, closed by equalities, with springs, dampers and a start.

    body frame        the body's own, so that all numbers of the spec stay; with all joints at 0
    qpos              heun's angles and travels; a ball's quaternion is 1 in the assembled pose, as in a universal joint
    keyframe "start"  the assembled start, with its rates

Bodies without mass between two joints, which MuJoCo does not know, put both joints on the body beyond. Loops are closed
by equalities: MuJoCo holds them softly. What MJCF has no words for changes the motion and is refused, or is noted.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

from heuncli.base.errors import Problem, SpecError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, PairLoad
from heuncli.multibody.mechanism.model import Body, Joint, scene_size
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.mjcf_joints import LOOSE_KINDS, SCALAR_PARTS, JointElement, JointElements, find_drawn_pose
from heuncli.output.mjcf_parts import MjcfConnections, format_inertial, format_place, iter_geom
from heuncli.output.robot_tree import (
    PIN_KINDS,
    WORLD,
    PlacedJoint,
    choose_name,
    find_limits,
    format_line,
    format_numbers,
    grow_forest,
    list_free_points,
    list_left_out,
    make_coupling_problems,
    make_joint_problems,
)
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Ratio
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import quaternion_from_matrix

CODE = "export-mjcf"
# of the joints that can close a loop, how late they go into the tree; None: never
CLOSING_RANKS = {"weld": 1, **dict.fromkeys(PIN_KINDS, 1), "ball": 2, "rod": None}
MIN_MASS = 1e-15  # [kg] MuJoCo's own mjMINVAL, which also moments of inertia have to exceed
NEGLIGIBLE_MASS = 1e-15  # of a body between two joints, to that of the body beyond
SMALL_MOMENT = 1e-12  # least moment of inertia, to mass times size squared: MuJoCo refuses 0
JOINT_HINT = "MJCF has no cv, curve, rope or driven rod, and closes loops by rod, ball, weld and pin"


class MjcfText(NamedTuple):
    """A scene as MJCF. text: the file; notes: what it does not say"""

    text: str
    notes: tuple[str, ...]


def write_mjcf(spec: Spec, scene: PreparedScene) -> MjcfText:
    """Write a scene as MJCF. Raises SpecError [export-mjcf] for all that it cannot say."""
    return _MjcfWriter(spec, scene).write()


class _MjcfWriter:
    """Writes one scene; elements, q and v grow as its bodies are written."""

    def __init__(self, spec: Spec, scene: PreparedScene) -> None:
        self.spec, self.scene, self.mechanism = spec, scene, scene.mechanism
        loads = self.mechanism.loads
        self.springs = [load for load in loads if isinstance(load, PairLoad) and load.kind == "spring"]
        loads_of_joints = [load for load in loads if isinstance(load, JointLoad) and self.is_written(load)]
        self.tree, self.closures = grow_forest(self.mechanism, self.make_ranking(loads_of_joints))
        self.children: dict[int, list[PlacedJoint]] = {}
        for placed in self.tree:
            self.children.setdefault(placed.parent, []).append(placed)
        held = {placed.child for placed in self.tree}
        self.roots = [i for i in range(len(self.mechanism.bodies)) if i not in held]
        self.connections = MjcfConnections(scene, self.tree)
        self.names = [choose_name(WORLD, spec.bodies) if body.name == WORLD else body.name
                      for body in self.mechanism.bodies]  # fmt: skip
        self.elements: list[JointElement] = []  # in the order of the file, which is that of qpos
        self.joint_elements = JointElements(scene, set(spec.joints))
        self.q: list[float] = []
        self.v: list[float] = []
        closed = {joint.name for joint in self.closures}  # nothing can act in their coordinates
        self.joint_loads = [load for load in loads_of_joints if self.mechanism.joints[load.joint].name not in closed]
        self.limits = {key: stop for key, stop in find_limits(self.mechanism).items() if key[0] not in closed}

    def is_written(self, load: JointLoad) -> bool:
        """Return whether a load in a joint becomes the stiffness or damping of an element."""
        kind = self.mechanism.joints[load.joint].kind
        return (load.kind == "damper" and kind in (*PIN_KINDS, "slide", "cylinder", "ball")) or (
            load.kind == "turn_spring" and kind in (*PIN_KINDS, "cylinder")
        )

    def make_ranking(self, loads_of_joints: Sequence[JointLoad]) -> Callable[[Joint], int | None]:
        """Return the ranks of joints for the tree: first those that cannot close a loop, or in which something acts."""
        joints = self.mechanism.joints
        active = {joints[load.joint].name for load in loads_of_joints}
        active |= {name for name, _ in find_limits(self.mechanism)}
        active |= {name for coupling in self.mechanism.couplings for name in coupling.entry.joints}

        def rank(joint: Joint) -> int | None:
            is_first = joint.kind not in CLOSING_RANKS or (joint.name in active and joint.kind != "rod")
            return 0 if is_first else CLOSING_RANKS[joint.kind]

        return rank

    def write(self) -> MjcfText:
        """Write the file."""
        self.require_words()
        for i, name, place in list_free_points(self.spec, self.mechanism):
            self.connections.add_site(i, f"{self.mechanism.bodies[i].name}.{name}", place)
        for spring in self.springs:
            self.connections.add_spring(spring)
        for joint in self.closures:
            self.connections.add_closure(joint)
        bodies = [*self.connections.iter_sites(GROUND, 2), *self.iter_children(GROUND, 2)]
        bodies += [line for root in self.roots for line in self.iter_free_body(root)]
        self.connections.add_ratios(self.elements)
        notes = self.list_notes()
        lines = ['<?xml version="1.0"?>', f"<mujoco model={quoteattr(format_line(self.spec.title) or 'machine')}>"]
        lines += [f"  <!-- {format_line(note).replace('--', '- -')} -->" for note in notes]
        lines += ['  <compiler angle="radian"/>', f'  <option gravity="{format_numbers(self.spec.gravity)}"/>']
        lines += [
            '  <default><geom contype="0" conaffinity="0"/></default>',
            "  <worldbody>",
            *bodies,
            "  </worldbody>",
        ]
        for tag, parts in (("tendon", self.connections.tendons), ("equality", self.connections.equalities)):
            if parts:
                lines += [f"  <{tag}>", *(f"    {part}" for part in parts), f"  </{tag}>"]
        if self.q:
            key = f'<key name="start" qpos="{format_numbers(self.q)}" qvel="{format_numbers(self.v)}"/>'
            lines.append(f"  <keyframe>{key}</keyframe>")
        return MjcfText("\n".join([*lines, "</mujoco>", ""]), tuple(notes))

    def list_notes(self) -> list[str]:
        """Say in sentences what the file does not hold, or holds otherwise."""
        written = {load.name for load in (*self.joint_loads, *self.springs)}
        notes = list_left_out(self.spec, self.mechanism, written, self.limits)
        thin = self.list_small_moments()
        if thin:
            notes.append(f"moments of inertia of 0 are small ones in the file, as MuJoCo refuses 0: {list_words(thin)}")
        if self.limits:
            notes.append("MuJoCo's limits are soft, without the restitution of stops")
        if self.connections.equalities:
            notes.append("MuJoCo holds equalities softly; its motion differs by that")
        if any(joint.kind in PIN_KINDS for joint in self.closures) and not self.mechanism.planar:
            notes.append("pins that close loops are two points of their axes each: the load of a pin is the sum of two")
        return notes

    # Refusals

    def require_words(self) -> None:
        """Raise SpecError [export-mjcf] for all that MJCF cannot say."""
        spec, mechanism = self.spec, self.mechanism
        unknown = [placed.joint for placed in self.tree if placed.joint.kind not in (*SCALAR_PARTS, *LOOSE_KINDS)]
        unknown += [joint for joint in self.closures if joint.kind not in CLOSING_RANKS or joint.can_open]
        driven = [joint for joint in self.closures if joint.drive is not None and joint.kind == "rod"]
        closed = {joint.name for joint in self.closures}
        couplings = [
            one.name
            for one in mechanism.couplings
            if not isinstance(one.entry, Ratio) or not closed.isdisjoint(one.entry.joints)
        ]
        problems = [
            *make_joint_problems(spec, unknown, CODE, "joint {name} ({kind}) has no counterpart in MJCF", JOINT_HINT),
            *make_joint_problems(spec, driven, CODE, "the rod {name} has a driven length, which MJCF does not know",
                                 "leave its drive out of the exported spec"),
            *make_coupling_problems(spec, couplings, "MJCF", CODE),
            *self.iter_mass_problems(),
        ]  # fmt: skip
        if problems:
            raise SpecError(*problems)

    def iter_mass_problems(self) -> Iterator[Problem]:
        """Yield a problem for each moving body without mass that is not between two joints."""
        for i, body in enumerate(self.mechanism.bodies):
            if body.mass <= MIN_MASS and not self.is_carrier(i):
                message = f"body {body.name} has no mass, which MuJoCo refuses for moving bodies"
                location = self.spec.location(f"bodies.{body.name}")
                yield Problem(CODE, message, location, f"give it a mass above {MIN_MASS:g} kg")

    def is_carrier(self, i: int) -> bool:
        """Return whether a body is only between two joints of the tree, without mass beside the body beyond."""
        body, beyond = self.mechanism.bodies[i], self.children.get(i, [])
        if i in self.roots or len(beyond) != 1 or beyond[0].joint.kind == "weld":
            return False
        end = beyond[0].child
        while self.mechanism.bodies[end].mass <= body.mass and len(self.children.get(end, ())) == 1:
            end = self.children[end][0].child
        used = {end for joint in self.closures for end in (joint.a, joint.b)}
        used |= {end for spring in self.springs for end in (spring.a, spring.b)}
        is_light = body.mass <= NEGLIGIBLE_MASS * self.mechanism.bodies[end].mass and not np.any(body.inertia)
        return is_light and i not in used

    # Bodies

    def get_inertia(self, body: Body) -> Array:
        """Return the inertia of a body (3, 3), without moments of 0; of a planar one the moments in the plane are made
        equal to that about its normal.
        """
        inertia = body.inertia[2, 2] * np.eye(3) if self.mechanism.planar else body.inertia
        least = self.find_least_moment(body)
        moments, axes = np.linalg.eigh(inertia)
        if moments[0] >= least:
            return inertia
        return np.asarray((axes * np.maximum(moments, least)) @ axes.T)

    def find_least_moment(self, body: Body) -> float:
        """Return the least moment of inertia of a body in the file [kg m^2]."""
        size = scene_size(self.mechanism, self.scene.start)
        return max(2.0 * MIN_MASS, SMALL_MOMENT * body.mass * size * size)

    def list_small_moments(self) -> list[str]:
        """Return the names of the bodies with a moment of inertia that the file has otherwise."""
        bodies = (body for i, body in enumerate(self.mechanism.bodies) if not self.is_carrier(i))
        index = slice(2, 3) if self.mechanism.planar else slice(0, 3)
        return [
            body.name
            for body in bodies
            if np.linalg.eigvalsh(body.inertia[index, index])[0] < self.find_least_moment(body)
        ]

    def iter_children(self, parent: int, depth: int) -> Iterator[str]:
        """Yield the bodies on the joints of a body."""
        for placed in self.children.get(parent, ()):
            chain = [placed]
            while self.is_carrier(chain[-1].child):
                chain.append(self.children[chain[-1].child][0])
            yield from self.iter_chain(chain, depth)

    def iter_chain(self, chain: list[PlacedJoint], depth: int) -> Iterator[str]:
        """Yield the body at the end of a chain of joints, whose other bodies have no mass."""
        R, p = np.eye(3), np.zeros(3)  # of a body of the chain in the parent, with all joints at 0
        places: list[tuple[PlacedJoint, Array, Array]] = []  # joint, point in the parent, attitude after it
        for placed in chain:
            point, p, R = find_drawn_pose(placed, self.scene, p, R)
            places.append((placed, point, R))
        elements: list[JointElement] = []
        for placed, point, attitude in places:
            pos = placed.child_point if placed is chain[-1] else R.T @ (point - p)
            elements += self.joint_elements.make_elements(placed, pos, R.T @ attitude, chain[-1].child)
        for element in elements:
            self.q += element.q
            self.v += element.v
        yield from self.iter_body(chain[-1].child, p, R, [self.format_joint(element) for element in elements], depth)

    def iter_free_body(self, i: int) -> Iterator[str]:
        """Yield a free body and what hangs on it."""
        start = self.scene.start
        p, R = start.position[i], start.rotation[i]
        self.q += [*p, *quaternion_from_matrix(R)]
        self.v += [*start.velocity[i], *(R.T @ start.angular_velocity[i])]
        name = choose_name(f"free_{self.mechanism.bodies[i].name}", self.spec.joints)
        yield from self.iter_body(i, p, R, [f'<freejoint name="{name}"/>'], 2)

    def iter_body(self, i: int, p: Array, R: Array, joints: list[str], depth: int) -> Iterator[str]:
        """Yield a body with what hangs on it. p, R: of its frame in that of the parent"""
        pad, body = "  " * depth, self.mechanism.bodies[i]
        yield f'{pad}<body name="{self.names[i]}"{format_place(p, R)}>'
        yield from (f"{pad}  {joint}" for joint in joints)
        yield f"{pad}  {format_inertial(body, self.get_inertia(body))}"
        for shape in self.spec.bodies[body.name].shapes or ():
            yield from (f"{pad}  {geom}" for geom in iter_geom(shape))
        yield from self.connections.iter_sites(i, depth + 1)
        yield from self.iter_children(i, depth + 1)
        yield f"{pad}</body>"

    # Joints

    def format_joint(self, element: JointElement) -> str:
        """Format a joint with its springs, dampers and limits."""
        axis = "" if element.type == "ball" else f' axis="{format_numbers(element.axis)}"'
        loads = [load for load in self.joint_loads if self.mechanism.joints[load.joint] is element.joint]
        is_turning = element.type != "slide"
        damping = math.fsum(
            load.turning if is_turning else load.sliding for load in loads if is_turning or load.kind == "damper"
        )
        springs = [load for load in loads if load.kind == "turn_spring" and is_turning]
        stiffness = math.fsum(load.stiffness for load in springs)
        parts = f' damping="{damping!r}"' if damping else ""
        if stiffness:
            angle = math.fsum(load.stiffness * load.angle for load in springs) / stiffness
            parts += f' stiffness="{stiffness!r}" springref="{angle!r}"'
        stop = self.limits.get((element.joint.name, element.quantity))
        if stop is not None:
            limits = [limit for limit in (stop.low, stop.high) if limit is not None]
            parts += f' limited="true" range="{format_numbers(limits)}"'
        self.elements.append(element)
        return f'<joint name="{element.name}" type="{element.type}" pos="{format_numbers(element.pos)}"{axis}{parts}/>'
