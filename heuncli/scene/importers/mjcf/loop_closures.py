"""Turn the equalities and fixed tendons of a model into joints of a spec (connects, welds, rods) and couplings of two
joints.

They are soft in MuJoCo, by the nature of its solver; in a spec they hold exactly. Their ends are points of bodies, or
sites.

    connect   the two points coincide: a ball
    weld      the same, and R_W2 = R_W1 R(relquat): a weld, where that is so at the zero of all joints; else a pin about
              the axis of R(relquat), which a drive holds at its angle
    tendon    its length stays: a rod, where it runs straight from a site to a site; of fixed tendons a coupling
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
from heuncli.scene.importers.attitudes import compose_rotations, round_vector
from heuncli.scene.importers.description import LEFT_OUT_CODE, DescribedEntry
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.tree import (
    GROUND,
    BodyFrames,
    BodyPoints,
    JointTree,
    make_exact_rotation,
    to_vec,
)
from heuncli.scene.importers.spec_text import format_decimal
from heuncli.scene.shapes.rotations import quaternion_from_matrix, vector_from_quaternion

ROTATION_TOLERANCE = 1e-6  # deviation of a rotation matrix: people write quaternions to about six digits
STRAIGHT_TENDON_SITES = 2  # a tendon through two sites runs straight

AssignName = Callable[[str], str]


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

    drives: those that hold the angle of a weld
    ratios: linear relations of fixed tendons
    imported_equalities: numbers of the equalities that the spec holds by joints and ratios
    rods: the tendons whose length is constant
    left_out: why the others are not in the spec
    """

    joints: tuple[DescribedEntry, ...]
    drives: tuple[DescribedEntry, ...]
    ratios: tuple[DescribedEntry, ...]
    couplings: tuple[JointEquality, ...]
    imported_equalities: frozenset[int]
    rods: frozenset[int]
    left_out: tuple[Problem, ...]
    header_lines: tuple[str, ...]


class ClosureEnd(NamedTuple):
    """An end of an equality: MuJoCo's body; place [m] and attitude with all joints at zero, in the spec's body."""

    body: int
    place: Vec
    attitude: Matrix


def make_left_out_problem(compiled: CompiledModel, kind: str, number: int, reason: str, hint: str) -> Problem:
    """Make the problem for a part that has no counterpart in a spec."""
    location, name = compiled.location(kind, number), compiled.describe_part(kind, number)
    where = "" if location else f"{compiled.file}: "
    return Problem(LEFT_OUT_CODE, f"{where}{name}: {reason}", location, hint)


class ClosureBuilder:
    """Builds the loop closures of one model; entries are added as they are found."""

    def __init__(
        self, compiled: CompiledModel, frames: BodyFrames, tree: JointTree, points: BodyPoints, name: AssignName
    ) -> None:
        self.compiled, self.frames, self.tree, self.points, self.assign_name = compiled, frames, tree, points, name
        self.joints: list[DescribedEntry] = []
        self.drives: list[DescribedEntry] = []
        self.ratios: list[DescribedEntry] = []
        self.couplings: list[JointEquality] = []
        self.imported_equalities: set[int] = set()
        self.rods: set[int] = set()
        self.left_out: list[Problem] = []
        self.header_lines: list[str] = []

    def build(self) -> LoopClosures:
        """Build all loop closures of the model."""
        compiled = self.compiled
        rows = {
            "CONNECT": self.add_connect,
            "WELD": self.add_weld,
            "JOINT": self.add_coupling,
            "TENDON": self.add_tendon,
        }
        handler_by_type = {int(compiled.mujoco.mjtEq.__members__[f"mjEQ_{word}"]): row for word, row in rows.items()}
        names = {int(value): word[5:].lower() for word, value in compiled.mujoco.mjtEq.__members__.items()}
        for number in range(compiled.count("equality")):
            kind = int(compiled.model.eq_type[number])
            if not compiled.model.eq_active0[number] or compiled.is_disabled("EQUALITY", "CONSTRAINT"):
                self.header_lines.append(
                    f"{compiled.describe_part('equality', number)} is not active at the start and is left out"
                )
            elif kind not in handler_by_type:
                self.leave_out(number, f"a spec has no equality of type {names[kind]}")
            else:
                handler_by_type[kind](number)
        entries = tuple(self.joints), tuple(self.drives), tuple(self.ratios), tuple(self.couplings)
        sets = frozenset(self.imported_equalities), frozenset(self.rods)
        return LoopClosures(*entries, *sets, tuple(self.left_out), tuple(self.header_lines))

    def leave_out(
        self, number: int, reason: str, hint: str = "what it constrains is free in the spec: add a constraint there"
    ) -> None:
        """Report that an equality is left out."""
        self.left_out.append(make_left_out_problem(self.compiled, "equality", number, reason, hint))

    def add_equality(self, number: int, kind: str, ends: tuple[ClosureEnd, ClosureEnd], **keys: Any) -> str:
        """Add an equality as a joint between two ends. Returns its name."""
        original = self.compiled.name("equality", number) or f"{kind}_{number + 1}"
        self.imported_equalities.add(number)
        return self.add_joint(original, self.compiled.describe_part("equality", number), kind, ends, **keys)

    def add_joint(self, original: str, remark: str, kind: str, ends: tuple[ClosureEnd, ClosureEnd], **keys: Any) -> str:
        """Add a joint between two ends, unless both are on the same body. Returns its name, or an empty text."""
        bodies = [self.body_name(end) for end in ends]
        if bodies[0] == bodies[1]:
            self.header_lines.append(f"{remark} connects {bodies[0]} to itself and is left out")
            return ""
        name = self.assign_name(original)
        points = [self.add_point(end, name) for end in ends]
        if bodies[1] == GROUND:  # the load is reported ON `to`, which should be the moving body
            points.reverse()
            if "axis" in keys:  # the angle is counted from the other body
                keys["axis"] = tuple(-component for component in keys["axis"])
        self.joints.append(DescribedEntry(name, {"type": kind, "from": points[0], "to": points[1], **keys}, remark))
        return name

    def find_ends(self, number: int, points: tuple[Any, Any]) -> tuple[ClosureEnd, ClosureEnd]:
        """Find the ends of an equality of two bodies with these points, or of two sites."""
        compiled = self.compiled
        ids = int(compiled.model.eq_obj1id[number]), int(compiled.model.eq_obj2id[number])
        if int(compiled.model.eq_objtype[number]) == int(compiled.mujoco.mjtObj.mjOBJ_SITE):
            return self.find_site_end(ids[0]), self.find_site_end(ids[1])
        one, other = (
            ClosureEnd(body, self.frames.transform_point(body, point), self.frames.attitudes[body])
            for body, point in zip(ids, points, strict=True)
        )
        return one, other

    def find_site_end(self, site: int) -> ClosureEnd:
        """Find the end at a site."""
        model = self.compiled.model
        body = int(model.site_bodyid[site])
        attitude = compose_rotations(self.frames.attitudes[body], make_exact_rotation(model.site_quat[site]))
        return ClosureEnd(body, self.frames.transform_point(body, model.site_pos[site]), attitude)

    def add_point(self, end: ClosureEnd, original: str) -> str:
        """Add a named point at an end to the body of the spec. Returns `body.point`."""
        return self.points.add(self.body_name(end), original, end.place)

    def body_name(self, end: ClosureEnd) -> str:
        """Return the name of the spec's body to which an end belongs."""
        return self.tree.names[self.frames.owners[end.body]]

    def add_connect(self, number: int) -> None:
        data = self.compiled.model.eq_data[number]
        self.add_equality(number, "ball", self.find_ends(number, (data[0:3], data[3:6])))

    def add_weld(self, number: int) -> None:
        """Add a weld. A spec's weld keeps the axes of its bodies parallel, as they are with all joints at zero."""
        data = self.compiled.model.eq_data[number]
        one, other = self.find_ends(number, (data[3:6], data[0:3]))
        between_sites = int(self.compiled.model.eq_objtype[number]) == int(self.compiled.mujoco.mjtObj.mjOBJ_SITE)
        attitude = one.attitude if between_sites else compose_rotations(one.attitude, make_exact_rotation(data[6:10]))
        if float(data[10]) == 0.0:  # torquescale: it holds no rotation
            self.add_equality(number, "ball", (one, other))
        elif np.abs(np.array(attitude) - np.array(other.attitude)).max() > ROTATION_TOLERANCE:
            self.add_turned_weld(number, (one, other), np.array(attitude) @ np.array(other.attitude).T)
        else:
            self.add_equality(number, "weld", (one, other))

    def add_turned_weld(self, number: int, ends: tuple[ClosureEnd, ClosureEnd], R: Any) -> None:
        """Add a weld that turns its second body by R (3, 3): a pin about the axis of R, held at its angle."""
        vector = vector_from_quaternion(quaternion_from_matrix(R))
        angle = float(np.linalg.norm(vector))
        axis = round_vector(to_vec(vector / angle))
        name = self.add_equality(number, "pin", ends, axis=axis)
        if name:
            remark = f"a weld turned by {np.degrees(angle):.6g} degrees against the drawn pose"
            entry = DescribedEntry(self.assign_name(f"hold_{name}"), {"joint": name, "angle": angle}, remark)
            self.drives.append(entry)

    def add_coupling(self, number: int) -> None:
        model = self.compiled.model
        follower, leader = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        polynomial = tuple(float(x) for x in model.eq_data[number][:5])
        self.couplings.append(JointEquality(number, follower, leader if leader >= 0 else None, polynomial))

    def add_tendon(self, number: int) -> None:
        model = self.compiled.model
        tendon, other = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        sites = find_straight_tendon_sites(self.compiled, tendon)
        terms = find_fixed_tendon_terms(self.compiled, tendon)
        if terms is not None:
            self.add_fixed_tendon(number, terms)
        elif other >= 0:
            self.leave_out(number, "a spec can couple the lengths of fixed tendons only")
        elif sites is None:
            self.leave_out(
                number,
                f"{self.compiled.describe_part('tendon', tendon)} does not run straight from one site to another",
            )
        else:
            length = float(model.tendon_length0[tendon]) + float(model.eq_data[number][0])
            self.rods.add(tendon)
            self.imported_equalities.add(number)
            original = self.compiled.name("tendon", tendon) or f"tendon_{tendon + 1}"
            ends = self.find_site_end(sites[0]), self.find_site_end(sites[1])
            self.add_joint(original, self.compiled.describe_part("tendon", tendon), "rod", ends, length=length)

    def add_fixed_tendon(self, number: int, terms: dict[int, float]) -> None:
        """Add the relation sum of c_j (q_j - q_j(zero)) = a0 + a1 (the same of the second tendon)."""
        model = self.compiled.model
        tendon, other = int(model.eq_obj1id[number]), int(model.eq_obj2id[number])
        start, slope, *higher_terms = (float(x) for x in model.eq_data[number][:5])
        if other >= 0:
            other_terms = find_fixed_tendon_terms(self.compiled, other)
            if other_terms is None or any(higher_terms):
                reason = "a spec can couple fixed tendons only, and in a fixed ratio"
                self.leave_out(number, reason, "couple the joints by a ratio, or make one a drive's law of time")
                return
            for joint, factor in other_terms.items():
                terms[joint] = terms.get(joint, 0.0) - slope * factor
            terms = {joint: factor for joint, factor in terms.items() if factor}
        else:
            self.rods.add(tendon)
        if len(terms) <= 1:  # it holds one joint
            self.couplings += [JointEquality(number, joint, None, (start / terms[joint],)) for joint in terms]
            if not terms:
                self.leave_out(number, "it constrains no joint")
            return
        self.imported_equalities.add(number)
        original = (
            self.compiled.name("equality", number) or self.compiled.name("tendon", tendon) or f"tendon_{tendon + 1}"
        )
        names = tuple(self.tree.step_by_joint[joint].name for joint in terms)
        keys = {"type": "ratio", "of": names, "factors": tuple(terms.values()), "is": start}
        self.ratios.append(
            DescribedEntry(self.assign_name(original), keys, self.compiled.describe_part("equality", number))
        )


def find_fixed_tendon_terms(compiled: CompiledModel, tendon: int) -> dict[int, float] | None:
    """Return the joints of a fixed tendon with their coefficients, or None for any other tendon."""
    model = compiled.model
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    if int(model.wrap_type[first]) != int(compiled.mujoco.mjtWrap.mjWRAP_JOINT):
        return None
    terms: dict[int, float] = {}
    for k in range(first, first + count):
        joint = int(model.wrap_objid[k])
        terms[joint] = terms.get(joint, 0.0) + float(model.wrap_prm[k])
    return {joint: factor for joint, factor in terms.items() if factor}


def find_straight_tendon_sites(compiled: CompiledModel, tendon: int) -> tuple[int, int] | None:
    """Return the two sites of a tendon that runs straight from one to the other, or None for any other tendon."""
    model = compiled.model
    first, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    site = int(compiled.mujoco.mjtWrap.mjWRAP_SITE)
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
