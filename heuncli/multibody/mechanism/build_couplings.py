"""Build the couplings of the spec as conditions between bodies; only this module depends on their kinds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from heuncli.base.errors import Finding, Problem, SpecError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.couplings import CamShape, Coordinate, CoupledRow, Coupling, CouplingPart
from heuncli.multibody.mechanism.directions import unit_vector
from heuncli.multibody.mechanism.gearing import gear_row
from heuncli.multibody.mechanism.model import GROUND, Body, Joint, Load
from heuncli.multibody.mechanism.strands import belt_row, pretension_load
from heuncli.multibody.mechanism.threads import screw_row, thread_friction
from heuncli.multibody.mechanism.wheels import WheelEnds, ball_rows, disc_rows
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import make_path
from heuncli.scene.file_format import couplings as c
from heuncli.scene.file_format.models import End, Spec

SCENE_SIZE = 0.0  # weight of gaps that are angles: the scene's size


def build_couplings(
    spec: Spec, joints: Sequence[Joint], bodies: Sequence[Body], number: Mapping[str, int]
) -> tuple[Coupling, ...]:
    """Build all couplings, in the order of the spec; number: of joints by name. Raises SpecError with all misfits."""
    drawing = CoupledDrawing(spec, joints, bodies, number)
    couplings, problems = [], []
    for name, entry in spec.couplings.items():
        try:
            couplings.append(Coupling(name, BUILDERS[entry.type](entry, drawing), entry))
        except Finding as misfit:
            path = f"{'rolling' if entry.type == 'wheel' else 'couplings'}.{name}"
            problems.append(Problem(misfit.code, misfit.message, spec.location(path), misfit.hint))
    if problems:
        raise SpecError(*problems)
    return tuple(couplings)


def build_coupling_loads(
    spec: Spec, joints: Sequence[Joint], bodies: Sequence[Body], number: Mapping[str, int]
) -> tuple[Load, ...]:
    """Build the loads that couplings have besides their conditions, under their names.

    Belts pull their pulleys together; threads have friction.
    """
    drawing = CoupledDrawing(spec, joints, bodies, number)
    loads: list[Load] = []
    for k, (name, entry) in enumerate(spec.couplings.items()):
        joint_pair = tuple(drawing.joint_numbers(entry.terms)) if isinstance(entry, c.Belt | c.Screw) else ()
        if isinstance(entry, c.Belt) and entry.pretension > 0.0:
            loads.append(pretension_load(name, entry, joints, bodies, (joint_pair[0], joint_pair[1])))
        elif isinstance(entry, c.Screw) and entry.friction is not None:
            loads.append(
                thread_friction(name, k, entry, entry.friction, joints, bodies, (joint_pair[0], joint_pair[1]))
            )
    return tuple(loads)


@record
class CoupledDrawing:
    """The joints and bodies that couplings refer to; number: of the joints by name."""

    spec: Spec
    joints: Sequence[Joint]
    bodies: Sequence[Body]
    number: Mapping[str, int]

    def joint_numbers(self, terms: Sequence[c.Term]) -> list[int]:
        """Return the joints of terms."""
        return [self.number[x.joint] for x in terms]

    def locate(self, end: End) -> tuple[int, Array]:
        """Return the number of a body, or of the ground, and the point on it."""
        names = [body.name for body in self.bodies]
        return (names.index(end.body) if end.body in names else GROUND), np.array(end.point)


def build_ratio(entry: c.Ratio, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a ratio: the sum of coordinates, each times its factor; a couple about each axis, a force along each
    guide.
    """
    parts = tuple(coordinate_part(drawing, x, x.factor) for x in entry.terms)
    turning = all(x.quantity == "angle" for x in entry.terms)
    return (CoupledRow(parts, entry.is_, SCENE_SIZE if turning else 1.0),)


def build_differential(entry: c.Differential, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a differential: first - ratio second - (1 - ratio) carrier stays constant."""
    factors = (1.0, -entry.ratio, entry.ratio - 1.0)
    parts = tuple(coordinate_part(drawing, x, factor) for x, factor in zip(entry.terms, factors, strict=True))
    return (CoupledRow(parts, None, SCENE_SIZE),)


def build_gear(entry: c.Gear, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a pair of gears: the tooth force at the pitch point."""
    one, other = drawing.joint_numbers(entry.terms)
    pitch_point = None if entry.at is None else drawing.locate(entry.at)
    return (gear_row(entry, drawing.joints, drawing.bodies, (one, other), pitch_point),)


def build_screw(entry: c.Screw, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a screw: the thrust along the axis, and the torque about it."""
    one, other = drawing.joint_numbers(entry.terms)
    return (screw_row(entry, drawing.joints, drawing.bodies, (one, other)),)


def build_belt(entry: c.Belt, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a belt: the pulls of both strands."""
    one, other = drawing.joint_numbers(entry.terms)
    return (belt_row(entry, drawing.joints, drawing.bodies, (one, other)),)


def coordinate_part(drawing: CoupledDrawing, term: c.Term, factor: float) -> CouplingPart:
    """Make the condition on a joint's coordinate: a couple for an angle, a force for a travel."""
    k = drawing.number[term.joint]
    joint = drawing.joints[k]
    if term.quantity == "travel":
        return CouplingPart("guide", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor)
    coordinates = (Coordinate(k, "angle", 1.0),)
    return CouplingPart(
        "turn", joint.a, joint.b, joint.p, joint.q, joint.axis, factor=factor, coordinates=coordinates
    )  # fmt: skip


def build_cam(entry: c.Cam, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a cam: a disc and its follower."""
    k, n = drawing.number[entry.shaft], drawing.number[entry.follower]
    return cam_rows(entry, k, drawing.joints[k], n, drawing.joints[n])


def cam_rows(entry: c.Cam, k: int, shaft: Joint, n: int, follower: Joint) -> tuple[CoupledRow, ...]:
    """Make the row of a cam: the follower's coordinate equals the lift. A one-sided cam has the opposite row, which
    only pulls.
    """
    swings = JOINTS[follower.kind].coordinates[0] == "angle"
    shape = CamShape(
        make_path((entry.lift, 0.0, 0.0)).shift_parameter(entry.phase), swings, follower.p, entry.radius,
        None if entry.normal is None else unit_vector(entry.normal),
    )  # fmt: skip
    coordinates = Coordinate(k, "angle", 1.0), Coordinate(n, "angle" if swings else "travel", 1.0)
    part = CouplingPart(
        "cam", shaft.b, follower.b, shaft.p, np.array(entry.at), shaft.axis, follower.axis,
        1.0 if entry.is_two_sided else -1.0, shaft.a, coordinates, cam=shape,
    )  # fmt: skip
    return (CoupledRow((part,), 0.0, SCENE_SIZE if swings else 1.0, not entry.is_two_sided, entry.restitution),)


def build_wheel(entry: c.RollingWheel, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Build a wheel on its plane."""
    (b, q), (a, p) = drawing.locate(entry.wheel), drawing.locate(entry.on)
    ends: WheelEnds = {"a": a, "b": b, "p": p, "q": q, "e": unit_vector(entry.normal)}
    if entry.axis is None:
        return ball_rows(ends, entry.radius)
    no_slip = {"along": not entry.slides, "aside": drawing.spec.space != "planar"}  # in the plane nothing goes aside
    return disc_rows(ends, unit_vector(entry.axis), entry.radius, no_slip)


def build_rope(entry: c.Rope, drawing: CoupledDrawing) -> tuple[CoupledRow, ...]:
    """Return no rows yet: those of ropes depend on the start (multibody/tree/couplings_at_start.py)."""
    return ()


BUILDERS: dict[str, Callable[..., tuple[CoupledRow, ...]]] = {
    "ratio": build_ratio,
    "gear": build_gear,
    "screw": build_screw,
    "belt": build_belt,
    "differential": build_differential,
    "cam": build_cam,
    "wheel": build_wheel,
    "rope": build_rope,
}
