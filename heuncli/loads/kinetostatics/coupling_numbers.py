"""The numbers reported for a coupling, besides its load on each body; one entry for each type with numbers of its own.

Each depends on the multipliers of some of its conditions: where one of these is indeterminate, so is the number.

Cams:
    cos a = 1 / |f| |w|        f . w = 1, w the velocity of the follower at the contact, or at its roller's centre,
                               per unit of its rate; a is the pressure angle

Gears, belts and screws:

    radial = |F| tan(alpha_n) / cos(beta)    axial = |F| tan(beta)    normal = along the line of action
    torque = F lead / (2 pi)                 tight, slack = T_0 +- |F| / 2

F: the load carried. In an impulse it is an impulse, and the strands have no pretension.

Screws with friction:

    force = N - friction along the axis        torque = N lead / (2 pi) + friction about it

N is the axial component of the flank pressure.

    force rise - torque = -loss / rate       rise = lead / (2 pi), the travel per unit of rotation

Of the two powers, force rise rate INTO what slides and -torque rate INTO what turns, the positive one is the output.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.multibody.mechanism.couplings import CouplingPart
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint
from heuncli.results.results import Array
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format.couplings import RollingWheel, Screw
from heuncli.scene.shapes.rotations import cross_rows

# Coupling numbers


@record
class CouplingNumber:
    """A number of a coupling, (..., n_t).

    rows: the conditions that it depends on, by their numbers in the coupling
    factor: the number divided by the multiplier of its single condition; 0 if it is no such multiple
    is_linear: linear in the multipliers with a factor that changes in time
    """

    name: str
    values: Array
    rows: tuple[int, ...]
    is_moment: bool = False
    factor: float = 0.0
    is_linear: bool = False

    @property
    def is_sum(self) -> bool:
        """Whether the shares of causes add up to it."""
        return self.is_linear or self.factor != 0.0


def list_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the numbers of a coupling; for most types, the load that it carries."""
    return NUMBERS.get(loads.coupling.entry.type, list_carried_load)(loads)


def list_multiples(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the numbers that are a multiple of one condition's multiplier, of which sums may be determinate."""
    return [number for number in list_numbers(loads) if number.factor != 0.0]


def make_coupling_block(
    loads: CouplingLoads, names: Sequence[str], extra_actions: Sequence[Action] = ()
) -> dict[str, object]:
    """Return a coupling's block of the results; names: of the bodies; extra_actions: such as a pretension."""
    body_loads = {
        "ground" if body == GROUND else names[body]: {"point": place, "force": force, "moment": moment}
        for body, (place, force, moment) in loads.body_loads(extra_actions).items()
    }
    return {number.name: number.values for number in list_numbers(loads)} | {"on": body_loads, "open": []}


def list_carried_load(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the multiplier of its first condition: the force or the moment that the coupling transmits."""
    name = loads.load_name
    return [
        CouplingNumber(
            name, loads.carried_load, (0,), name == "moment", float(name in ("force", "moment")), is_linear=True
        )
    ]


def list_wheel_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return the normal force of a wheel, the forces that prevent slip, and both together; and the remaining grip.

    friction = sqrt(along^2 + aside^2),  force = sqrt(normal^2 + friction^2),  grip = coefficient normal - friction
    """
    wheel = loads.coupling.entry
    assert isinstance(wheel, RollingWheel)
    (_, *rolling), all_rows = loads.coupling.rows, tuple(range(len(loads.multipliers)))
    normal = loads.multipliers[0]
    tangential = {row.parts[0].kind: values for row, values in zip(rolling, loads.multipliers[1:], strict=True)}
    tangential_names = [("along", "rolls"), ("aside", "rolls_aside")]
    numbers = [CouplingNumber("normal", normal, all_rows[:1], factor=1.0)]
    numbers += [
        CouplingNumber(name, tangential[kind], (1 + list(tangential).index(kind),), factor=1.0)
        for name, kind in tangential_names
        if kind in tangential
    ]
    squared_friction = np.sum(np.square(np.array(loads.multipliers[1:])), axis=0)
    numbers.append(CouplingNumber("friction", np.sqrt(squared_friction), all_rows[1:]))
    numbers.append(CouplingNumber("force", np.sqrt(squared_friction + np.square(normal)), all_rows))
    if wheel.friction is not None:
        numbers.append(CouplingNumber("grip", wheel.friction * normal - np.sqrt(squared_friction), all_rows))
    return numbers


def list_rope_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return a rope's tension; with fixed sheaves, that before the first of them, and that after the last."""
    rows = (0,) if loads.rows else ()  # the tension of a stretching rope depends on no condition
    numbers = [
        CouplingNumber("tension", 0.0 - loads.multipliers[0], rows, factor=-1.0 if rows else 0.0, is_linear=True)
    ]
    if len(loads.multipliers) > 1:
        numbers.append(
            CouplingNumber("last_tension", 0.0 - loads.multipliers[-1], (len(loads.multipliers) - 1,), factor=-1.0)
        )
    return numbers


def list_screw_numbers(loads: CouplingLoads) -> list[CouplingNumber]:
    """Return a screw's thrust; with friction, the total thrust and the torque that it takes."""
    if loads.friction is None:
        return list_carried_load(loads)

    force, torque = find_total_screw_load(loads)
    return [
        CouplingNumber("force", force, (0,), is_linear=True),
        CouplingNumber("torque", torque, (0,), is_moment=True, is_linear=True),
    ]


NUMBERS: dict[str, Callable[[CouplingLoads], list[CouplingNumber]]] = {
    "wheel": list_wheel_numbers, "rope": list_rope_numbers, "screw": list_screw_numbers,
}  # fmt: skip


# Cams


def pressure_angle(loads: CouplingLoads, joints: Sequence[Joint], states: BodyStates) -> Array:
    """Return the angle between the load of a cam and the motion of the follower there, (n_t,) [rad]."""
    (load,) = loads.parts
    size = np.sqrt(np.sum(load.f * load.f, axis=1))
    speed = find_follower_speed(load.part, joints[load.part.coordinates[1].joint], load.place, states)
    return np.asarray(np.arccos(np.clip(1.0 / (size * speed), 0.0, 1.0)))


def find_follower_speed(part: CouplingPart, joint: Joint, place: Array, states: BodyStates) -> Array:
    """Return |w|, (n_t,) [m or 1]: 1 if it slides, else the distance from the axis about which the follower swings."""
    assert part.cam is not None
    if not part.cam.swings:
        return np.ones(len(place))
    if part.cam.face is None:
        place = states.point_position(part.b, np.asarray(part.q))
    axis = states.world_direction(joint.a, joint.axis)
    arm = cross_rows(axis, place - states.point_position(joint.a, joint.p))
    return np.asarray(np.sqrt(np.sum(arm * arm, axis=1)))


# Drive element numbers


def gear_numbers(gear: c.Gear, F: Array, is_impulse: bool) -> dict[str, Array]:
    """Return the components of a tooth force [N]."""
    radial = np.abs(F) * (math.tan(gear.pressure_angle) / math.cos(gear.helix))
    axial = np.abs(F) * abs(math.tan(gear.helix))
    return {"radial": radial, "axial": axial, "normal": np.sqrt(F * F + radial * radial + axial * axial)}


def screw_numbers(screw: c.Screw, F: Array, is_impulse: bool) -> dict[str, Array]:
    """Return the torque that a thrust takes [N m]."""
    return {"torque": F * (screw.lead / math.tau)}


def belt_numbers(belt: c.Belt, F: Array, is_impulse: bool) -> dict[str, Array]:
    """Return the pulls of both strands [N]."""
    pretension = 0.0 if is_impulse else belt.pretension
    return {"tight": pretension + 0.5 * np.abs(F), "slack": pretension - 0.5 * np.abs(F)}


DRIVE_ELEMENT_NUMBERS: dict[str, Callable[..., dict[str, Array]]] = {
    "gear": gear_numbers,
    "screw": screw_numbers,
    "belt": belt_numbers,
}


def collect_by_quantity(loads: CouplingLoads, joints: Sequence[Joint], states: BodyStates) -> dict[str, list[Array]]:
    """Collect the numbers shown for a coupling by what they are: `force`, `moment` or `angle`."""
    by_quantity: dict[str, list[Array]] = {}
    for number in list_numbers(loads):
        by_quantity.setdefault("moment" if number.is_moment else "force", []).append(number.values)
    coupling = loads.coupling.entry
    if coupling.type in DRIVE_ELEMENT_NUMBERS:
        numbers = DRIVE_ELEMENT_NUMBERS[coupling.type](coupling, loads.carried_load, is_impulse=False)
        for name, values in numbers.items():
            by_quantity.setdefault("moment" if name == "torque" else "force", []).append(values)
    if coupling.type == "cam":
        by_quantity["angle"] = [pressure_angle(loads, joints, states)]
    return by_quantity


# Thread friction


def find_total_screw_load(loads: CouplingLoads) -> tuple[Array, Array]:
    """Return thrust along the axis and the torque about it that it takes, (..., n_t), including friction."""
    screw, part, friction = loads.coupling.entry, loads.parts[0], loads.friction
    assert isinstance(screw, Screw)
    rise = screw.lead / math.tau
    force, torque = loads.multipliers[0], loads.multipliers[0] * rise
    if friction is None:
        return force, torque
    sense = 1.0 if friction.to_end.body == part.part.b else -1.0  # its opposite acts on the other body
    axial_friction = np.sum(friction.force * part.f, axis=-1)
    friction_torque = np.sum(friction.moment * part.m, axis=-1) / rise
    return force + sense * axial_friction, torque + sense * friction_torque


def efficiency(loads: CouplingLoads, zero_thrust: float) -> Array:
    """Return output power over input power, (n_t,); 1 at rest, because nothing slides, and 0 without a load.

    zero_thrust: a thrust that counts as zero compared with the loads of the scene [N]
    """
    screw = loads.coupling.entry
    assert isinstance(screw, Screw)
    force, torque = find_total_screw_load(loads)
    is_loaded = np.abs(force) > zero_thrust
    force = force * (screw.lead / math.tau)
    direction = np.where(torque < force, -1.0, 1.0)  # direction of rotation, because friction takes power
    powers = np.stack([direction * force, -direction * torque])
    output, input_power = np.maximum(powers.max(axis=0), 0.0), -powers.min(axis=0)
    return np.where(is_loaded & (input_power > 0.0), output / np.where(input_power > 0.0, input_power, 1.0), 0.0)
