"""Turn the equalities and fixed tendons of a model into joints of a spec (connects, welds, rods) and couplings of two
joints.

They are soft in MuJoCo, by the nature of its solver; in a spec they hold exactly. Their ends are points of bodies, or
sites.

    connect   the two points coincide: a ball
    weld      the same, and R_W2 = R_W1 R(relquat): a weld, where that is so at the zero of all joints
    tendon    its length stays: a rod, where it runs straight from a site to a site
    joint     q1 - q1(zero) = a0 + a1 x + a2 x^2 + ..., x = q2 - q2(zero): a drive's law, where joint 2 is driven
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.attitudes import compose_rotations
from heuncli.scene.importers.description import LEFT_OUT_CODE, DescribedEntry
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.tree import GROUND, BodyFrames, BodyPoints, JointTree, exact_rotation_from_quaternion
from heuncli.scene.importers.spec_text import format_decimal

ROTATION_TOLERANCE = 1e-6  # deviation of a rotation matrix: people write quaternions to about six digits
STRAIGHT_TENDON_SITES = 2  # of a tendon that runs straight


class JointEquality(NamedTuple):
    """Couples joint `follower` to joint `leader` (None: it stands still) by a polynomial; both are numbers of MuJoCo's
    joints.
    """

    equality: int
    follower: int
    leader: int | None
    polynomial: tuple[float, ...]


class LoopClosures(NamedTuple):
    """The loop closures of a model.

    imported_equalities: numbers of the equalities that the spec holds
    left_out: why the others are not in the spec
    """

    joints: tuple[DescribedEntry, ...]
    couplings: tuple[JointEquality, ...]
    imported_equalities: frozenset[int]
    rods: frozenset[int]  # the tendons that are rods
    left_out: tuple[Problem, ...]
    header_lines: tuple[str, ...]


class ClosureEnd(NamedTuple):
    """An end of an equality: MuJoCo's body; place [m] and attitude with all joints at zero, in the spec's body."""

    body: int
    place: Vec
    attitude: Matrix


def make_left_out_problem(c: CompiledModel, kind: str, number: int, reason: str, hint: str) -> Problem:
    """Make the problem for a part that has no counterpart in a spec."""
    location, name = c.location(kind, number), c.describe_part(kind, number)
    where = "" if location else f"{c.file}: "
    return Problem(LEFT_OUT_CODE, f"{where}{name}: {reason}", location, hint)


class ClosureBuilder:
    """Builds the loop closures of one model; entries are added as they are found."""

    def __init__(
        self, c: CompiledModel, frames: BodyFrames, tree: JointTree, points: BodyPoints, name: Callable[[str], str]
    ) -> None:
        self.c, self.frames, self.tree, self.points, self.assign_name = c, frames, tree, points, name
        self.joints: list[DescribedEntry] = []
        self.couplings: list[JointEquality] = []
        self.imported_equalities: set[int] = set()
        self.rods: set[int] = set()
        self.left_out: list[Problem] = []
        self.header_lines: list[str] = []

    def build(self) -> LoopClosures:
        """Build all loop closures of the model."""
        c = self.c
        rows = {
            "CONNECT": self.add_connect,
            "WELD": self.add_weld,
            "JOINT": self.add_coupling,
            "TENDON": self.add_tendon,
        }
        handler_by_type = {int(c.mujoco.mjtEq.__members__[f"mjEQ_{word}"]): row for word, row in rows.items()}
        names = {int(value): word[5:].lower() for word, value in c.mujoco.mjtEq.__members__.items()}
        for number in range(c.count("equality")):
            kind = int(c.model.eq_type[number])
            if not c.model.eq_active0[number] or c.is_disabled("EQUALITY", "CONSTRAINT"):
                self.header_lines.append(
                    f"{c.describe_part('equality', number)} is not active at the start and is left out"
                )
            elif kind not in handler_by_type:
                self.leave_out(number, f"a spec has no equality of type {names[kind]}")
            else:
                handler_by_type[kind](number)
        joints, couplings = tuple(self.joints), tuple(self.couplings)
        sets = frozenset(self.imported_equalities), frozenset(self.rods)
        return LoopClosures(joints, couplings, *sets, tuple(self.left_out), tuple(self.header_lines))

    def leave_out(
        self, number: int, reason: str, hint: str = "what it constrains is free in the spec: add a constraint there"
    ) -> None:
        """Report that an equality is left out."""
        self.left_out.append(make_left_out_problem(self.c, "equality", number, reason, hint))

    def add_equality(self, number: int, kind: str, ends: tuple[ClosureEnd, ClosureEnd], **keys: Any) -> None:
        """Add an equality as a joint between two ends."""
        original = self.c.name("equality", number) or f"{kind}_{number + 1}"
        self.imported_equalities.add(number)
        self.add_joint(original, self.c.describe_part("equality", number), kind, ends, **keys)

    def add_joint(
        self, original: str, remark: str, kind: str, ends: tuple[ClosureEnd, ClosureEnd], **keys: Any
    ) -> None:
        """Add a joint between two ends, unless both are on the same body."""
        bodies = [self.body_name(end) for end in ends]
        if bodies[0] == bodies[1]:
            self.header_lines.append(f"{remark} connects {bodies[0]} to itself and is left out")
            return
        name = self.assign_name(original)
        points = [self.add_point(end, name) for end in ends]
        if bodies[1] == GROUND:  # the load is reported ON `to`, which should be the moving body
            points.reverse()
        self.joints.append(DescribedEntry(name, {"type": kind, "from": points[0], "to": points[1], **keys}, remark))

    def find_ends(self, number: int, points: tuple[Any, Any]) -> tuple[ClosureEnd, ClosureEnd]:
        """Find the ends of an equality of two bodies with these points, or of two sites."""
        c = self.c
        ids = int(c.model.eq_obj1id[number]), int(c.model.eq_obj2id[number])
        if int(c.model.eq_objtype[number]) == int(c.mujoco.mjtObj.mjOBJ_SITE):
            return self.find_site_end(ids[0]), self.find_site_end(ids[1])
        one, other = (
            ClosureEnd(body, self.frames.transform_point(body, point), self.frames.attitudes[body])
            for body, point in zip(ids, points, strict=True)
        )
        return one, other

    def find_site_end(self, site: int) -> ClosureEnd:
        """Find the end at a site."""
        model = self.c.model
        body = int(model.site_bodyid[site])
        attitude = compose_rotations(self.frames.attitudes[body], exact_rotation_from_quaternion(model.site_quat[site]))
        return ClosureEnd(body, self.frames.transform_point(body, model.site_pos[site]), attitude)

    def add_point(self, end: ClosureEnd, original: str) -> str:
        """Add a named point at an end to the body of the spec. Returns `body.point`."""
        return self.points.add(self.body_name(end), original, end.place)

    def body_name(self, end: ClosureEnd) -> str:
        """Return the name of the spec's body to which an end belongs."""
        return self.tree.names[self.frames.owners[end.body]]

    def add_connect(self, number: int) -> None:
        data = self.c.model.eq_data[number]
        self.add_equality(number, "ball", self.find_ends(number, (data[0:3], data[3:6])))

    def add_weld(self, number: int) -> None:
        """Add a weld. A spec's weld keeps the axes of its bodies parallel, as they are with all joints at zero."""
        data = self.c.model.eq_data[number]
        one, other = self.find_ends(number, (data[3:6], data[0:3]))
        between_sites = int(self.c.model.eq_objtype[number]) == int(self.c.mujoco.mjtObj.mjOBJ_SITE)
        attitude = (
            one.attitude
            if between_sites
            else compose_rotations(one.attitude, exact_rotation_from_quaternion(data[6:10]))
        )
        if float(data[10]) == 0.0:  # torquescale: it holds no rotation
            self.add_equality(number, "ball", (one, other))
        elif np.abs(np.array(attitude) - np.array(other.attitude)).max() > ROTATION_TOLERANCE:
            cosine = (np.trace(np.array(attitude).T @ np.array(other.attitude)) - 1.0) / 2.0
            angle = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
            reason = f"a spec has no weld that rotates its bodies by {angle:.3g} degrees from their given start"
            self.leave_out(
                number, reason, "in the model, give the bodies their welded orientation with all joints at zero"
            )
        else:
            self.add_equality(number, "weld", (one, other))

    def add_coupling(self, number: int) -> None:
        model = self.c.model
        follower, leader = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        polynomial = tuple(float(x) for x in model.eq_data[number][:5])
        self.couplings.append(JointEquality(number, follower, leader if leader >= 0 else None, polynomial))

    def add_tendon(self, number: int) -> None:
        model = self.c.model
        tendon, other = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        sites = find_straight_tendon_sites(self.c, tendon)
        if other >= 0:
            self.leave_out(number, "a spec cannot couple the lengths of two tendons")
        elif sites is None:
            self.leave_out(
                number, f"{self.c.describe_part('tendon', tendon)} does not run straight from one site to another"
            )
        else:
            length = float(model.tendon_length0[tendon]) + float(model.eq_data[number][0])
            self.rods.add(tendon)
            self.imported_equalities.add(number)
            original = self.c.name("tendon", tendon) or f"tendon_{tendon + 1}"
            ends = self.find_site_end(sites[0]), self.find_site_end(sites[1])
            self.add_joint(original, self.c.describe_part("tendon", tendon), "rod", ends, length=length)


def find_straight_tendon_sites(c: CompiledModel, tendon: int) -> tuple[int, int] | None:
    """Return the two sites of a tendon that runs straight from one to the other, or None for any other tendon."""
    model = c.model
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    site = int(c.mujoco.mjtWrap.mjWRAP_SITE)
    if count != STRAIGHT_TENDON_SITES or any(int(model.wrap_type[k]) != site for k in range(first, first + count)):
        return None
    return int(model.wrap_objid[first]), int(model.wrap_objid[first + 1])


def format_polynomial(polynomial: tuple[float, ...], argument: str) -> str:
    """Format a polynomial of an argument as an expression."""
    return " + ".join(_format_terms(polynomial, argument)) or "0"


def _format_terms(polynomial: tuple[float, ...], argument: str) -> Iterator[str]:
    for power, factor in enumerate(polynomial):
        if factor:
            yield (
                format_decimal(factor)
                if power == 0
                else f"{format_decimal(factor)}*{argument}" + (f"**{power}" if power > 1 else "")
            )
