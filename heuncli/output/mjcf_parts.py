"""The connections of a scene in MJCF: sites, tendons and equalities; and the forms of its elements."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.multibody.mechanism.loads import GROUND, PairLoad
from heuncli.multibody.mechanism.model import Body, Joint, scene_size
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import body_state, point_distance
from heuncli.output.mjcf_joints import JointElement, find_drawn_pose
from heuncli.output.robot_tree import (
    PIN_KINDS,
    PlacedJoint,
    choose_name,
    clean_rotation,
    format_numbers,
    place_shape,
)
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Ratio
from heuncli.scene.file_format.models import Shape
from heuncli.scene.shapes.rotations import quaternion_from_matrix

TRIANGLE_ROUNDING = 1e-12  # excess of a moment over the sum of the others that is rounding


class MjcfConnections:
    """Collects the sites, tendons and equalities of one scene."""

    def __init__(self, scene: PreparedScene, tree: Sequence[PlacedJoint]) -> None:
        self.scene, self.mechanism, self.tree = scene, scene.mechanism, tree
        self.sites: dict[int, list[tuple[str, Array, Array]]] = {}
        self.tendons: list[str] = []
        self.equalities: list[str] = []
        self.site_names: set[str] = set()

    def add_site(self, body: int, name: str, place: Array, R: Array | None = None) -> str:
        """Add a named point of a body, with axes R (3, 3). Returns its name in the file."""
        name = choose_name(name, self.site_names)
        self.site_names.add(name)
        self.sites.setdefault(body, []).append((name, place, np.eye(3) if R is None else R))
        return name

    def iter_sites(self, body: int, depth: int) -> Iterator[str]:
        """Yield the sites of a body."""
        for name, place, R in self.sites.get(body, ()):
            yield f'{"  " * depth}<site name="{name}"{format_place(place, R)}/>'

    def add_ends(self, name: str, joint: Joint, shift: Array, suffix: str = "") -> str:
        """Add the sites at the ends of a joint that closes a loop, and return the attributes that name them.

        shift: along its axis, at the start, from both points [m]
        """
        (_, Ra, _, _), (_, Rb, _, _) = body_state(self.scene.start, joint.a), body_state(self.scene.start, joint.b)
        start = self.add_site(joint.a, f"{name}.from{suffix}", joint.p + shift)
        end = self.add_site(joint.b, f"{name}.to{suffix}", joint.q + Rb.T @ Ra @ shift, Rb.T @ Ra)
        return f'site1="{start}" site2="{end}"'

    def add_closure(self, joint: Joint) -> None:
        """Add a joint that closes a loop, as equalities."""
        zero = np.zeros(3)
        if joint.kind == "rod":
            ends = self.add_ends(joint.name, joint, zero)
            sites = ends.replace('site1="', '<site site="').replace(' site2="', '/><site site="')
            length = joint.length if joint.length is not None else point_distance(self.scene.start, joint)
            change = length - self.find_drawn_distance(joint)
            self.tendons.append(f'<spatial name="{joint.name}">{sites}/></spatial>')
            self.equalities.append(
                f'<tendon name="{joint.name}" tendon1="{joint.name}" polycoef="{change!r} 0 0 0 0"/>'
            )
        elif joint.kind in PIN_KINDS and not self.mechanism.planar:
            reach = 0.5 * scene_size(self.mechanism, self.scene.start)
            for suffix, shift in (("", zero), ("_2", reach * joint.axis)):
                ends = self.add_ends(joint.name, joint, shift, suffix)
                self.equalities.append(f'<connect name="{joint.name}{suffix}" {ends}/>')
        else:
            tag = "weld" if joint.kind == "weld" else "connect"
            self.equalities.append(f'<{tag} name="{joint.name}" {self.add_ends(joint.name, joint, zero)}/>')

    def find_drawn_distance(self, joint: Joint) -> float:
        """Return the distance of a joint's points with all joints of the tree at 0, as MuJoCo computes it."""
        (pa, Ra), (pb, Rb) = self.find_world_pose(joint.a), self.find_world_pose(joint.b)
        return float(np.linalg.norm(pb + Rb @ joint.q - pa - Ra @ joint.p))

    def find_world_pose(self, body: int) -> tuple[Array, Array]:
        """Return the origin and the axes of a body with all joints of the tree at 0."""
        if body == GROUND:
            return np.zeros(3), np.eye(3)
        placed = next((placed for placed in self.tree if placed.child == body), None)
        if placed is None:
            return self.scene.start.position[body], self.scene.start.rotation[body]
        drawn = find_drawn_pose(placed, self.scene, *self.find_world_pose(placed.parent))
        return drawn.origin, drawn.axes

    def add_ratios(self, joint_elements: Sequence[JointElement]) -> None:
        """Add the linear relations of coordinates, as fixed tendons of constant length."""
        elements = {(element.joint.name, element.quantity): element for element in joint_elements}
        for coupling in self.mechanism.couplings:
            assert isinstance(coupling.entry, Ratio)
            terms = [(elements[term.joint, term.quantity], term.factor) for term in coupling.entry.terms]
            value = coupling.entry.is_
            if value is None:  # as at the start
                value = math.fsum(factor * element.q[0] for element, factor in terms)
            joints = "".join(f'<joint joint="{element.name}" coef="{factor!r}"/>' for element, factor in terms)
            name = coupling.name
            self.tendons.append(f'<fixed name="{name}">{joints}</fixed>')
            self.equalities.append(f'<tendon name="{name}" tendon1="{name}" polycoef="{value!r} 0 0 0 0"/>')

    def add_spring(self, spring: PairLoad) -> None:
        """Add a spring between two points, as a tendon."""
        ends = (
            self.add_site(spring.a, f"{spring.name}.from", spring.p),
            self.add_site(spring.b, f"{spring.name}.to", spring.q),
        )
        sites = "".join(f'<site site="{end}"/>' for end in ends)
        numbers = f'stiffness="{spring.stiffness!r}" damping="{spring.damping!r}" springlength="{spring.length!r}"'
        self.tendons.append(f'<spatial name="{spring.name}" {numbers}>{sites}</spatial>')


# Elements


def format_place(p: Array, R: Array) -> str:
    """Format a place and axes as attributes; empty for zero and the parent's axes."""
    exact = clean_rotation(R)
    quat = "" if np.array_equal(exact, np.eye(3)) else f' quat="{format_numbers(quaternion_from_matrix(exact))}"'
    pos = f' pos="{format_numbers(p)}"' if np.any(p) else ""
    return pos + quat


def format_inertial(body: Body, inertia: Array) -> str:
    """Format the mass of a body, with its principal moments. Raises SpecError for moments that no body can have."""
    if np.array_equal(inertia, np.diag(np.diagonal(inertia))):
        moments, axes = np.diagonal(inertia).copy(), np.eye(3)
    else:
        moments, axes = np.linalg.eigh(inertia)
        axes = axes * np.sign(np.linalg.det(axes))
    largest = int(np.argmax(moments))
    others = float(moments.sum() - moments[largest])
    if others < moments[largest] <= others * (1.0 + TRIANGLE_ROUNDING):
        moments[largest] = others * (1.0 - 1e-15)  # MuJoCo refuses it by rounding
    place = format_place(body.center, axes)
    place = place if "pos=" in place else f' pos="0 0 0"{place}'
    return f'<inertial{place} mass="{float(body.mass)!r}" diaginertia="{format_numbers(moments)}"/>'


def iter_geom(shape: Shape) -> Iterator[str]:
    """Yield a shape as a visible form without mass; nothing for what MJCF does not know."""
    placed = place_shape(shape)
    if placed is None:
        return
    place, R, sizes = placed
    # MuJoCo wants half lengths
    halves = {"box": [0.5 * size for size in sizes], "sphere": sizes, "cylinder": [sizes[0], 0.5 * sizes[-1]]}
    yield f'<geom type="{shape.type}"{format_place(place, R)} size="{format_numbers(halves[shape.type])}" mass="0"/>'
