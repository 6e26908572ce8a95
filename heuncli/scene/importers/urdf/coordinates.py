"""Set the coordinates of a robot's joints: parameters of the drives that hold them, or start values of free joints.

A joint that follows another (mimic) is driven by the leader's parameter: position = multiplier * parameter + offset. If
the joints are free, a coupling holds it there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words
from heuncli.scene.importers.description import (
    LEFT_OUT_CODE,
    DescribedEntry,
    DescribedParameter,
    ImportOptions,
    Namer,
    explain_motion,
    format_original_name,
)
from heuncli.scene.importers.spec_text import format_decimal, format_number
from heuncli.scene.importers.urdf.carriers import SpecJoint
from heuncli.scene.importers.urdf.document import UrdfJoint
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.tree import MimicRelation


class JointQuantity(NamedTuple):
    """The coordinate of a joint type: its key, its zero, an example of another value, its unit, and the key of its
    friction.
    """

    key: str
    zero: str
    example_value: str
    unit: str
    friction: str


QUANTITIES = {
    "pin": JointQuantity("angle", "0 deg", "30 deg", "rad", "torque"),
    "slide": JointQuantity("travel", "0 m", "10 mm", "m", "force"),
}
LIMITS_HINT = "leave out --limits, or correct them"
UNLIMITED = (-math.inf, math.inf)
MAX_PLAIN_FACTOR = 9  # whole numbers up to this are factors without dimension (manual/format.md, "Parameters")


class RobotCoordinates:
    """Builds the parameters, drives, start values, stops and dampers of the joints with one coordinate."""

    def __init__(
        self,
        joints: Sequence[SpecJoint],
        names: Sequence[str],
        leaders: dict[str, MimicRelation],
        options: ImportOptions,
        fields: UrdfFields,
    ) -> None:
        """names: of the joints in the spec. Contradictions are added to the problems of `fields`."""
        self.leaders, self.options, self.fields = leaders, options, fields
        self.namer = Namer("joint")
        self.namer.used_names.update(names)  # stops and joints have different names
        self.parameters: list[DescribedParameter] = []
        self.drives: list[DescribedEntry] = []
        self.dampers: list[DescribedEntry] = []
        self.stops: list[DescribedEntry] = []
        self.couplings: list[DescribedEntry] = []
        self.initial: dict[str, dict[str, Any]] = {}
        self.left_out: list[Problem] = []
        pairs = [(spec_joint, spec_joint.joint, name) for spec_joint, name in zip(joints, names, strict=True)]
        self.single_coordinate_joints = [
            (spec_joint, joint, name)
            for spec_joint, joint, name in pairs
            if joint is not None and spec_joint.type in QUANTITIES
        ]
        self.names = {joint.name: name for _, joint, name in self.single_coordinate_joints}
        self.types = {joint.name: spec_joint.type for spec_joint, joint, _ in self.single_coordinate_joints}
        self.names_in_loops = {joint.name: name for one, joint, name in self.single_coordinate_joints if one.in_loop}
        self.followers: dict[str, list[tuple[UrdfJoint, MimicRelation]]] = {}  # by the name of the leader
        for _, joint, _ in self.single_coordinate_joints:
            if joint.name in leaders:
                self.followers.setdefault(leaders[joint.name].leader.name, []).append((joint, leaders[joint.name]))
        for spec_joint, joint, name in self.single_coordinate_joints:
            self._add_joint(joint, name, QUANTITIES[spec_joint.type])

    @property
    def header_lines(self) -> tuple[str, ...]:
        """Explain how to move the joints."""
        lines: tuple[str, ...] = ()
        if self.names_in_loops:
            names = list_words([*self.names_in_loops.values()])
            lines = (f"Joints of closed loops are free, and start as drawn: {names}. Add a drive for each freedom.",)
        if not self.parameters:
            return lines
        first = self.parameters[0].name
        joint = next(joint for _, joint, name in self.single_coordinate_joints if name == first)
        example_value = QUANTITIES[self.types[joint.name]].example_value
        return (*lines, *explain_motion(first, example_value, free=self.options.free, at_rest=True))

    def _add_joint(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        leader = self.leaders.get(joint.name)
        leader_name = "" if leader is None else leader.leader.name
        if joint.mimic is not None and not self.names_in_loops.keys().isdisjoint({joint.name, leader_name}):
            message = "a joint of a closed loop follows another, or is followed"
            hint = "delete the <mimic>, import, and add a coupling of type ratio to the spec"
            self.fields.report("import-mimic", joint.mimic.element, joint.path, message, hint)
        elif leader is not None:
            self._add_follower(joint, name, quantity, leader)
        elif joint.name not in self.names_in_loops:
            value = self._find_start_value(joint, quantity)
            remark = "; ".join(
                filter(None, (format_original_name("joint", name, joint.name), self._format_limits(joint, quantity)))
            )
            self.parameters.append(DescribedParameter(name, value, remark))
            if self.options.free:
                self.initial[name] = {quantity.key: name}
            else:
                self._add_drive(name, quantity, name, "")
        if joint.damping:
            keys = {"type": "damper", "joint": name, "coefficient": joint.damping}
            self.dampers.append(DescribedEntry(self.namer.assign(f"damping_{name}"), keys))
        if joint.stiffness:
            self._add_spring(joint, name, quantity)
        if joint.friction:
            self._leave_out_friction(joint, name, quantity)
        if self.options.limits:
            self._add_stop(joint, name, quantity)

    def _add_drive(self, name: str, quantity: JointQuantity, value: str, remark: str) -> None:
        keys = {"joint": name, quantity.key: value}
        self.drives.append(DescribedEntry(self.namer.assign(f"hold_{name}"), keys, remark))

    def _add_follower(self, joint: UrdfJoint, name: str, quantity: JointQuantity, relation: MimicRelation) -> None:
        leader = self.names[relation.leader.name]
        same_quantity = QUANTITIES[self.types[relation.leader.name]] == quantity
        if self.options.free:
            if relation.multiplier == 0.0:
                self._add_drive(
                    name, quantity, format_decimal(relation.offset), f"mimic: fixed, independent of {leader}"
                )
                return
            keys = {
                "type": "ratio", "of": (name, leader), "factors": (1.0, -relation.multiplier), "is": relation.offset,
            }  # fmt: skip
            self.couplings.append(DescribedEntry(self.namer.assign(f"follow_{name}"), keys, f"mimic: follows {leader}"))
            self.initial[name] = {
                quantity.key: format_mimic(leader, relation.multiplier, relation.offset, same_quantity)
            }
            return
        remark = f"mimic: follows {leader}; for a motion, use the function of hold_{leader} here as well"
        self._add_drive(
            name, quantity, format_mimic(leader, relation.multiplier, relation.offset, same_quantity), remark
        )

    def _format_limits(self, joint: UrdfJoint, quantity: JointQuantity) -> str:
        limits = find_range(joint)
        if limits is None:
            return ""
        lower, upper = limits
        outside = "" if lower <= 0.0 <= upper else "; 0 is outside"
        return f"limits {format_number(lower)} to {format_number(upper)} {quantity.unit}{outside}"

    def _find_start_value(self, joint: UrdfJoint, quantity: JointQuantity) -> str:
        """Return the start value: 0, or the nearest to it that stops allow, if they are imported.

        Stops that allow no motion together are added to the problems.
        """
        if not self.options.limits:
            return quantity.zero
        lower, upper = find_range(joint) or UNLIMITED
        limited_followers = []
        for follower, relation in self.followers.get(joint.name, ()):
            limits = find_range(follower)
            if limits is None or relation.multiplier == 0.0:
                continue
            ends = sorted((limit - relation.offset) / relation.multiplier for limit in limits)
            lower, upper = max(lower, ends[0]), min(upper, ends[1])
            limited_followers.append(follower.name)
        if limited_followers and lower >= upper:
            names = list_words(limited_followers)
            message = f"its limits and those of {names}, which follow it, leave no range of motion"
            self.fields.report("import-limits", joint.element, joint.path, message, LIMITS_HINT)
        start = min(max(0.0, lower), upper)
        return f"{format_number(start)} {quantity.unit}" if start else quantity.zero

    def _add_stop(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        limits, relation = find_range(joint), self.leaders.get(joint.name)
        if limits is None or (relation is not None and relation.multiplier == 0.0):  # a drive holds such a follower
            return
        lower, upper = limits
        if lower >= upper:
            message = f"its limits, {lower:g} to {upper:g}, leave no range of motion"
            self.fields.report("import-limits", joint.element, joint.path, message, LIMITS_HINT)
            return
        keys = {"joint": name, quantity.key: (lower, upper)}
        self.stops.append(DescribedEntry(self.namer.assign(f"limits_{name}"), keys))

    def _add_spring(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        keys: dict[str, Any] = {"type": "turn_spring", "joint": name, "stiffness": joint.stiffness}
        if quantity.key == "angle":
            keys |= {"angle": joint.reference} if joint.reference else {}
        else:
            travel = f"{name}.travel"
            if joint.reference:
                sign = "-" if joint.reference > 0.0 else "+"
                travel = f"({travel} {sign} {format_number(abs(joint.reference))})"
            keys = {"type": "torque", "joint": name, "value": f"{format_number(-joint.stiffness)}*{travel}"}
        self.dampers.append(DescribedEntry(self.namer.assign(f"spring_{name}"), keys))

    def _leave_out_friction(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        law = f"{{type: friction, joint: {name}, {quantity.friction}: {format_number(joint.friction)}, speed: 0.01}}"
        message = f'friction="{joint.friction:g}" is left out'
        hint = f"add it with the speed at which it is fully developed: forces: {{friction_{name}: {law}}}"
        self.left_out.append(self.fields.make_problem(LEFT_OUT_CODE, joint.element, joint.path, message, hint))


def find_range(joint: UrdfJoint) -> tuple[float, float] | None:
    """Return the lower and upper limit of a joint, or None if it has none; a continuous joint has none."""
    return None if joint.kind == "continuous" else joint.limits


def format_mimic(leader: str, multiplier: float, offset: float, same_quantity: bool) -> str:
    """Format multiplier * leader + offset as an expression.

    same_quantity: both are angles or both travels, so that a plain factor keeps the dimension. A number with a decimal
    point may stand for one with a unit, such as metres per radian.
    """
    is_plain = same_quantity and multiplier == int(multiplier) and abs(multiplier) <= MAX_PLAIN_FACTOR
    factor = format_number(multiplier) if is_plain and offset == 0.0 else format_decimal(multiplier)
    product = leader if factor == "1" else f"-{leader}" if factor == "-1" else f"{factor}*{leader}"
    if offset == 0.0:
        return product
    return f"{product} {'-' if offset < 0.0 else '+'} {format_decimal(abs(offset))}"
