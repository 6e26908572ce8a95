"""The coordinates of a robot's joints: parameters that hold them by drives, or at which they start where they are free.

A joint that follows another (mimic) is driven by the parameter of that one: position = multiplier * parameter + offset;
where joints are free a coupling holds it there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.described import LEFT_OUT, DescribedEntry, DescribedParameter
from heuncli.scene.importers.names import Namer, called
from heuncli.scene.importers.spec_text import number_text, pointed
from heuncli.scene.importers.told_moving import told_moving
from heuncli.scene.importers.urdf.document import UrdfJoint
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.links import Linked
from heuncli.scene.importers.urdf.tree import Followed


class JointQuantity(NamedTuple):
    """The coordinate of a type of joint: key, 0 and another value, unit, and the key of a friction in it."""

    key: str
    zero: str
    another: str
    unit: str
    friction: str


QUANTITIES = {
    "pin": JointQuantity("angle", "0 deg", "30 deg", "rad", "torque"),
    "slide": JointQuantity("travel", "0 m", "10 mm", "m", "force"),
}
MOST_PLAIN = 9  # whole numbers up to it are factors without a dimension (manual/format.md, "Parameters")


class RobotCoordinates:
    """Parameters, drives, initial values, stops and dampers of the joints of one coordinate."""

    def __init__(
        self,
        linked: Sequence[Linked],
        names: Sequence[str],
        followed: dict[str, Followed],
        asked: ImportAsked,
        fields: UrdfFields,
    ) -> None:
        """names: of the joints in the spec. What does not go together is added to the problems of the fields."""
        self.followed, self.asked, self.fields = followed, asked, fields
        self.namer = Namer("joint")
        self.namer.given.update(names)  # a stop shares its name with no joint
        self.parameters: list[DescribedParameter] = []
        self.drives: list[DescribedEntry] = []
        self.dampers: list[DescribedEntry] = []
        self.stops: list[DescribedEntry] = []
        self.couplings: list[DescribedEntry] = []
        self.initial: dict[str, dict[str, Any]] = {}
        self.left_out: list[Problem] = []
        pairs = [(one, one.joint, name) for one, name in zip(linked, names, strict=True)]
        self.single = [(one, joint, name) for one, joint, name in pairs if joint is not None and one.type in QUANTITIES]
        self.names = {joint.name: name for _, joint, name in self.single}
        self.types = {joint.name: one.type for one, joint, _ in self.single}
        for one, joint, name in self.single:
            self._take(joint, name, QUANTITIES[one.type])

    @property
    def told(self) -> tuple[str, ...]:
        """How the joints are moved."""
        if not self.parameters:
            return ()
        first = self.parameters[0].name
        joint = next(joint for _, joint, name in self.single if name == first)
        return told_moving(first, QUANTITIES[self.types[joint.name]].another, free=self.asked.free, at_rest=True)

    def _take(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        follows = self.followed.get(joint.name)
        if follows is not None:
            self._follow(joint, name, quantity, follows)
        else:
            value = self._start(joint, quantity)
            remark = "; ".join(filter(None, (called("joint", name, joint.name), self._limits(joint, quantity))))
            self.parameters.append(DescribedParameter(name, value, remark))
            if self.asked.free:
                self.initial[name] = {quantity.key: name}
            else:
                self._drive(name, quantity, name, "")
        if joint.damping:
            keys = {"type": "damper", "joint": name, "coefficient": joint.damping}
            self.dampers.append(DescribedEntry(self.namer.name(f"damping_{name}"), keys))
        if joint.friction:
            self._leave_friction(joint, name, quantity)
        if self.asked.limits:
            self._stop(joint, name, quantity)

    def _drive(self, name: str, quantity: JointQuantity, value: str, remark: str) -> None:
        keys = {"joint": name, quantity.key: value}
        self.drives.append(DescribedEntry(self.namer.name(f"hold_{name}"), keys, remark))

    def _follow(self, joint: UrdfJoint, name: str, quantity: JointQuantity, follows: Followed) -> None:
        leader = self.names[follows.leader.name]
        alike = QUANTITIES[self.types[follows.leader.name]] == quantity
        if self.asked.free:
            if follows.multiplier == 0.0:
                self._drive(name, quantity, pointed(follows.offset), f"mimic: stands, whatever {leader} does")
                return
            keys = {
                "type": "ratio", "of": (name, leader), "factors": (1.0, -follows.multiplier), "is": follows.offset,
            }  # fmt: skip
            self.couplings.append(DescribedEntry(self.namer.name(f"follow_{name}"), keys, f"mimic: follows {leader}"))
            self.initial[name] = {quantity.key: ratio(leader, follows.multiplier, follows.offset, alike)}
            return
        remark = f"mimic: follows {leader} by this rule; of a motion the law of hold_{leader} stands here, too"
        self._drive(name, quantity, ratio(leader, follows.multiplier, follows.offset, alike), remark)

    def _limits(self, joint: UrdfJoint, quantity: JointQuantity) -> str:
        if joint.limits is None or joint.kind == "continuous":
            return ""
        lower, upper = joint.limits
        outside = "" if lower <= 0.0 <= upper else "; 0 lies outside"
        return f"limits {number_text(lower)} to {number_text(upper)} {quantity.unit}{outside}"

    def _start(self, joint: UrdfJoint, quantity: JointQuantity) -> str:
        """Where it stands: at 0, or at the nearest limit where stops hold it."""
        if not self.asked.limits or joint.limits is None or joint.limits[0] <= 0.0 <= joint.limits[1]:
            return quantity.zero
        return f"{number_text(min(joint.limits, key=abs))} {quantity.unit}"

    def _stop(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        if joint.limits is None or joint.kind == "continuous":
            return
        lower, upper = joint.limits
        if lower >= upper:
            message = f"its limits, {lower:g} to {upper:g}, leave no room"
            self.fields.report("import-limits", joint.element, joint.path, message, "leave --limits out, or mend them")
            return
        keys = {"joint": name, quantity.key: (lower, upper)}
        self.stops.append(DescribedEntry(self.namer.name(f"limits_{name}"), keys))

    def _leave_friction(self, joint: UrdfJoint, name: str, quantity: JointQuantity) -> None:
        law = f"{{type: friction, joint: {name}, {quantity.friction}: {number_text(joint.friction)}, speed: 0.01}}"
        message = f'friction="{joint.friction:g}" is not taken over'
        hint = f"a friction has a rate at which it is full: forces: {{friction_{name}: {law}}}"
        self.left_out.append(self.fields.problem(LEFT_OUT, joint.element, joint.path, message, hint))


def ratio(leader: str, multiplier: float, offset: float, alike: bool) -> str:
    """multiplier * leader + offset; alike: both are angles or both travels, so that a plain factor keeps what it is.

    A number with a point in it may stand for one with a unit: metres a radian.
    """
    plain = alike and multiplier == int(multiplier) and abs(multiplier) <= MOST_PLAIN
    factor = number_text(multiplier) if plain and offset == 0.0 else pointed(multiplier)
    product = leader if factor == "1" else f"-{leader}" if factor == "-1" else f"{factor}*{leader}"
    if offset == 0.0:
        return product
    return f"{product} {'-' if offset < 0.0 else '+'} {pointed(abs(offset))}"
