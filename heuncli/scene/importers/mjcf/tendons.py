"""Turn the springs and dampers of tendons into forces, and couplings of fixed tendons into couplings of joints.

spatial    straight from one site to another: a spring between two points
fixed      L = sum of c_j q_j over hinges and slides: on each of them the torque or thrust c_j T

    T = k (low - L) below the slack range low to high, k (high - L) above it, 0 within; and less d L'

An equality L - L(zero) = a0 + a1 (L2 - L2(zero)) of fixed tendons is a linear relation of coordinates: a coupling of
type ratio. The damping of an actuator, d times its gear squared, is added to that of its joint or tendon.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.base.joint_kinds import RATES
from heuncli.scene.importers.description import DescribedEntry
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel
from heuncli.scene.importers.mjcf.loop_closures import (
    AssignName,
    ClosureBuilder,
    find_fixed_tendon_terms,
    find_straight_tendon_sites,
)
from heuncli.scene.importers.mjcf.tree import COORDINATE_KEYS, JointTree
from heuncli.scene.importers.spec_text import format_decimal

JOINT_TRANSMISSIONS = ("mjTRN_JOINT", "mjTRN_JOINTINPARENT")


def sum_actuator_damping(compiled: CompiledModel, transmissions: tuple[str, ...], part: int) -> float:
    """Return the damping that the actuators on a joint or tendon add to it, by these transmissions."""
    damping = getattr(compiled.model, "actuator_damping", None)
    if damping is None:  # versions before 3.5
        return 0.0
    kinds = {int(compiled.mujoco.mjtTrn.__members__[word]) for word in transmissions}
    return sum(
        float(damping[k]) * float(compiled.model.actuator_gear[k][0]) ** 2
        for k in range(int(compiled.model.nu))
        if int(compiled.model.actuator_trntype[k]) in kinds and int(compiled.model.actuator_trnid[k][0]) == part
    )


def sum_joint_damping(compiled: CompiledModel, joint: int) -> float:
    """Return the linear damping coefficient of a joint, with that of its actuators."""
    return float(compiled.model.dof_damping[compiled.model.jnt_dofadr[joint]]) + sum_actuator_damping(
        compiled, JOINT_TRANSMISSIONS, joint
    )


class TendonSpring:
    """The spring and damper of a tendon: stiffness, damping, and the slack range of its length."""

    def __init__(self, compiled: CompiledModel, tendon: int) -> None:
        self.stiffness = float(compiled.model.tendon_stiffness[tendon])
        self.damping = float(compiled.model.tendon_damping[tendon]) + sum_actuator_damping(
            compiled, ("mjTRN_TENDON",), tendon
        )
        self.low, self.high = (float(length) for length in compiled.model.tendon_lengthspring[tendon])
        if compiled.is_disabled("PASSIVE", "SPRING"):
            self.stiffness = 0.0
        if compiled.is_disabled("PASSIVE", "DAMPER"):
            self.damping = 0.0

    def __bool__(self) -> bool:
        return bool(self.stiffness or self.damping)

    @property
    def is_plain(self) -> bool:
        """Whether a stiffness, a length and a damping of a spec say it: no slack range, nothing negative."""
        return self.low == self.high and min(self.stiffness, self.damping) >= 0.0

    def format_force(self, length: str, rate: str, factor: float = 1.0) -> str:
        """Format the force along the tendon's growth, times a factor. length is a sum, rate a product."""
        terms = []
        if self.stiffness:
            k = factor * self.stiffness
            if self.low == self.high:
                terms.append((-k, f"({length}{_format_offset(self.low)})"))
            else:
                terms.append((-k, f"max({length}{_format_offset(self.high)}, 0)"))
                terms.append((-k, f"min({length}{_format_offset(self.low)}, 0)"))
        if self.damping:
            terms.append((-factor * self.damping, rate))
        return format_sum(terms)


def is_imported_tendon(compiled: CompiledModel, tendon: int) -> bool:
    """Return whether the spring and the damper of a tendon can be in a spec."""
    return (
        find_straight_tendon_sites(compiled, tendon) is not None
        or find_fixed_tendon_terms(compiled, tendon) is not None
    )


def iter_tendon_springs(
    compiled: CompiledModel, closer: ClosureBuilder, tree: JointTree, assign_name: AssignName
) -> Iterator[DescribedEntry]:
    """Yield the springs and dampers of straight and fixed tendons."""
    for tendon in range(compiled.count("tendon")):
        spring = TendonSpring(compiled, tendon)
        if not spring:
            continue
        name = compiled.name("tendon", tendon) or f"tendon_{tendon + 1}"
        terms = find_fixed_tendon_terms(compiled, tendon)
        if terms is not None:
            yield from _iter_fixed_torques(compiled, tendon, terms, spring, tree, name, assign_name)
        sites = find_straight_tendon_sites(compiled, tendon)
        if sites is None:
            continue
        site_ends = [closer.find_site_end(site) for site in sites]
        if closer.body_name(site_ends[0]) == closer.body_name(site_ends[1]):
            continue  # its length is constant: both ends are on one body
        entry_name = assign_name(name)
        ends = [closer.add_point(end, entry_name) for end in site_ends]
        keys: dict[str, Any] = {"type": "spring", "from": ends[0], "to": ends[1], "stiffness": spring.stiffness}
        keys["length"] = spring.low
        if spring.damping:
            keys["damping"] = spring.damping
        if not spring.is_plain:
            keys = {"type": "spring", "from": ends[0], "to": ends[1], "force": spring.format_force("length", "rate")}
        yield DescribedEntry(entry_name, keys, compiled.describe_part("tendon", tendon))


def _iter_fixed_torques(
    compiled: CompiledModel,
    tendon: int,
    terms: dict[int, float],
    spring: TendonSpring,
    tree: JointTree,
    name: str,
    assign_name: AssignName,
) -> Iterator[DescribedEntry]:
    """Yield what a fixed tendon exerts in each of its joints."""
    steps = tree.step_by_joint
    # the spec counts coordinates from the drawn pose, so the length there is a summand
    drawn = sum(
        factor * float(compiled.model.qpos0[compiled.model.jnt_qposadr[joint]]) for joint, factor in terms.items()
    )
    coordinates = [
        (factor, f"{steps[joint].name}.{COORDINATE_KEYS[steps[joint].kind]}") for joint, factor in terms.items()
    ]
    rates = [
        (factor, f"{steps[joint].name}.{RATES[COORDINATE_KEYS[steps[joint].kind]]}") for joint, factor in terms.items()
    ]
    length = format_sum(coordinates) + (_format_offset(-drawn) if drawn else "")
    rate = f"({format_sum(rates)})"
    for joint, factor in terms.items():
        law = spring.format_force(length, rate, factor)
        keys = {"type": "torque", "joint": steps[joint].name, "value": law}
        yield DescribedEntry(assign_name(f"{name}_{steps[joint].name}"), keys, compiled.describe_part("tendon", tendon))


def _format_offset(value: float) -> str:
    """Format the subtraction of a number; empty for 0."""
    return f" {'-' if value > 0.0 else '+'} {format_decimal(abs(value))}" if value else ""


def format_sum(terms: list[tuple[float, str]]) -> str:
    """Format a sum of products as an expression."""
    text = ""
    for factor, word in terms:
        size = f"{format_decimal(abs(factor))}*"  # also 1.0: a sum of angles and travels needs it
        sign = ("-" if factor < 0.0 else "") if not text else (" - " if factor < 0.0 else " + ")
        text += f"{sign}{size}{word}"
    return text
