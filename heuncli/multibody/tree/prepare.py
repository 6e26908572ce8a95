"""Prepare a mechanism to run: assemble it and lay it out within its stops; rotations without inertia are set aside.

No law determines the spins of thin rods and point masses that are held and loaded on their own axis only. A ball joint
leaves the spin about such an axis free, and so does any joint that turns about it. If a joint measures that angle,
however, the spin must be determined, and is not idle. An idle spin is harmless: accelerations and reactions do not
depend on it (manual/theory.md, "Thin rods"). For the motion the body gets an artificial inertia about the axis and no
spin. A moment about the axis would leave no solution; that is checked afterwards.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.loads import PointLoad
from heuncli.multibody.mechanism.model import Assembly, Body, Mechanism, Stop, scene_size
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.layout import Layout, LayoutFrame
from heuncli.multibody.tree.load_rows import find_used_names, lay_out_loads, make_programs
from heuncli.multibody.tree.pack import build_frame
from heuncli.multibody.tree.spanning import SpanningTree
from heuncli.multibody.tree.starts import JointStart, PresetTree, point_distance
from heuncli.multibody.tree.tables import Program
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_rows

Z = np.array([0.0, 0.0, 1.0])


@record
class IdleSpin:
    """A body's axes (body components, (k, 3), k = 1 or 3) of undetermined spin, and its artificial inertia."""

    body: int
    axes: Array
    artificial_inertia: Array


def find_idle_spins(mechanism: Mechanism, size: float) -> list[IdleSpin]:
    """Find the bodies with an undetermined spin."""
    points, free = find_attachments(mechanism)
    spins = []
    for i, axes in free.items():
        body = mechanism.bodies[i]
        null, largest = find_massless_axes(body, size)
        for axis in axes:
            along = len(null) and float(np.sum(np.square(null @ axis))) >= tolerances.ALONG_SQUARED
            null = axis[None, :] if along else null[:0]
        if not len(null):
            continue
        arms = [p - body.center for p in points[i]]
        farthest = max(arms, key=lambda d: float(d @ d), default=np.zeros(3))
        reach = float(np.sqrt(farthest @ farthest))
        if reach > tolerances.ON_AXIS * size:
            n = farthest / reach
            distance = max(float(np.sqrt(np.sum(np.square(d - (d @ n) * n)))) for d in arms)
            if distance > tolerances.ON_AXIS * size or np.sum(np.square(null @ n)) < tolerances.ALONG_SQUARED:
                continue
            null = n[None, :]
        moment = max(largest, body.mass * max(reach, tolerances.ARTIFICIAL_RADIUS * size) ** 2)
        spins.append(IdleSpin(i, null, moment * null.T @ null))
    return spins


def find_attachments(mechanism: Mechanism) -> tuple[dict[int, list[Array]], dict[int, list[Array]]]:
    """Return for each body the points where joints and forces act, and the only axes about which its joints let it
    turn.

    A body whose rotation a joint holds has no entry among the axes, one on balls alone an empty entry. Body axes.
    """
    points: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    free: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}
    for joint in mechanism.joints:
        kind = JOINTS[joint.kind]
        for end, point, axis in ((joint.a, joint.p, joint.axis), (joint.b, joint.q, joint.to_axis)):
            if end < 0:
                continue
            points[end].append(point)
            if kind.has_moving_contact and end == joint.a:
                free.pop(end, None)
            elif kind.turns and "angle" not in kind.coordinates and end in free:
                free[end].append(Z if kind.turns == ("z",) else axis)
            elif not kind.is_ball:
                free.pop(end, None)
    for load in mechanism.loads:
        if isinstance(load, PointLoad) and load.is_couple:
            continue
        for end, point in load.points:
            if end >= 0:
                points[end].append(point)
    for coupling in mechanism.couplings:
        for part in (part for row in coupling.loading_rows for part in row.parts if part.constrains_rotation):
            free.pop(part.a, None)
            free.pop(part.b, None)
    for named_point in mechanism.points.values():
        if named_point.body >= 0:
            points[named_point.body].append(named_point.place)
    return points, free


def find_massless_axes(body: Body, size: float) -> tuple[Array, float]:
    """Return the principal axes about which a body has no inertia (body components, (k, 3)), and its largest moment of
    inertia.
    """
    scale = max(float(np.trace(body.inertia)), tolerances.POINT_MASS * body.mass * size * size)
    moments, axes = np.linalg.eigh(body.inertia)
    return axes[:, moments <= tolerances.NO_INERTIA * scale].T, float(moments[-1])


@record
class PreparedScene:
    """A mechanism with its start and its layout for the kernel."""

    mechanism: Mechanism
    start: Assembly
    idle_spins: tuple[IdleSpin, ...]
    layout: Layout

    @property
    def undetermined_count(self) -> int:
        """The number of freedoms that are undetermined spins; none of them moves anything else."""
        if not self.mechanism.planar:
            return sum(len(spin.axes) for spin in self.idle_spins)
        return sum(float(np.sum(spin.axes[:, 2] ** 2)) >= tolerances.ALONG_SQUARED for spin in self.idle_spins)


def prepare(
    mechanism: Mechanism,
    t0: float = 0.0,
    stages: Stages = NO_CACHE,
    fit: Callable[[PreparedScene], PreparedScene] | None = None,
) -> PreparedScene:
    """Assemble at t0 and lay out. Raises SolveError where the scene does not close, or starts outside the limits of a
    stop.

    fit: changes a scene that its joints close to one that satisfies further conditions at its start
    """
    start = assemble(mechanism, t0, stages)
    if any(j.drive is not None and j.drive.adds_to_start for j in mechanism.joints):
        from heuncli.multibody.tree.starts import prescribe_coordinates  # few scenes have drives by a rate

        mechanism = prescribe_coordinates(mechanism, start)
    if mechanism.couplings:
        from heuncli.multibody.tree.rope_routes import add_start_couplings  # few scenes have them

        mechanism = add_start_couplings(mechanism, start, t0)
    scene = lay_out_scene(mechanism, start, stages=stages)
    if fit is not None:
        scene = fit(scene)
    if mechanism.stops:
        require_within_limits(scene.layout, scene.start)
        resting = zero_inward_rates(mechanism, scene.layout, scene.start)
        if resting is not None:
            with suppress(SolveError):  # what is held makes it strike
                at_rest = lay_out_scene(mechanism, assemble(resting, t0))
                scene = at_rest if fit is None else fit(at_rest)
    return scene


def lay_out_scene(
    mechanism: Mechanism,
    start: Assembly,
    *,
    spanning: SpanningTree | None = None,
    size: float | None = None,
    starts: tuple[JointStart, ...] | None = None,
    stages: Stages = NO_CACHE,
) -> PreparedScene:
    """Lay out an assembled mechanism; bodies with an undetermined spin get an artificial inertia about its axis and no
    spin.

    spanning, size, starts: of the tree, the scene [m] and its joints, where they are those of another scene
    stages: all except the loads is one stage
    """
    programs, used_names = make_programs(mechanism), find_used_names(mechanism)
    tree = None if spanning is None else PresetTree(spanning, starts)
    arrangement_found = stages.run(lay_out_without_loads, mechanism, start, used_names, programs.drives, size, tree)
    start = replace(start, angular_velocity=arrangement_found.omega)
    return PreparedScene(
        mechanism,
        start,
        arrangement_found.idle_spins,
        lay_out_loads(arrangement_found.frame, mechanism, programs, stages),
    )


@record
class LayoutWithoutLoads:
    """A laid-out scene without its loads, which scenes that differ only in loads share.

    idle_spins: the undetermined spins, with their artificial inertia
    omega (n, 3): angular velocities at the start, without these spins
    """

    idle_spins: tuple[IdleSpin, ...]
    omega: Array
    frame: LayoutFrame


def lay_out_without_loads(
    mechanism: Mechanism,
    start: Assembly,
    used_names: frozenset[str],
    drives: tuple[Program, ...],
    size: float | None,
    tree: PresetTree | None,
) -> LayoutWithoutLoads:
    """Find the undetermined spins, remove them from the velocities, and build the frame.

    used_names, drives: as in `build_frame`
    """
    size = scene_size(mechanism, start) if size is None else size
    idle = tuple(find_idle_spins(mechanism, size))
    inertias = np.array([b.inertia for b in mechanism.bodies])
    omega = start.angular_velocity.copy()
    for spin in idle:
        inertias[spin.body] += spin.artificial_inertia
        axes = spin.axes @ start.rotation[spin.body].T
        omega[spin.body] -= axes.T @ (axes @ omega[spin.body])
    start = replace(start, angular_velocity=omega)
    has_work = any(not load.is_conservative for load in mechanism.loads)
    has_work = has_work or bool(mechanism.laws) or bool(mechanism.impulses or mechanism.stops)
    has_work = has_work or any(j.restitution is not None for j in mechanism.joints)
    has_work = has_work or any(row.restitution is not None for coupling in mechanism.couplings for row in coupling.rows)
    return LayoutWithoutLoads(
        idle, omega, build_frame(mechanism, start, inertias, size, has_work, used_names, drives, tree)
    )


def find_missing_inertia(scene: PreparedScene, stages: Stages = NO_CACHE) -> dict[int, Array]:
    """Return the axes about which a body has neither own nor artificial inertia, body axes (k, 3), by tree index.

    In a planar scene those of bodies that have none about z.
    """
    layout = scene.layout
    return stages.run(compute_missing_inertia, scene.mechanism, scene.idle_spins, layout.spanning, layout.size)


def compute_missing_inertia(
    mechanism: Mechanism, idle: tuple[IdleSpin, ...], spanning: SpanningTree, size: float
) -> dict[int, Array]:
    """Compute the same for the scene's tree and size."""
    order = [h.body for h in spanning.links]
    inertia = np.array([body.inertia for body in mechanism.bodies]).reshape(-1, 3, 3)
    for spin in idle:
        inertia[spin.body] += spin.artificial_inertia
    inertia = inertia[order]
    # most bodies have full inertia, which the determinant shows faster than the moments
    volume = np.einsum("ni,ni->n", inertia[:, 0], cross_rows(inertia[:, 1], inertia[:, 2]))
    missing = {}
    for i in np.flatnonzero(volume <= tolerances.SLENDER * np.trace(inertia, axis1=1, axis2=2) ** 3).tolist():
        axes, _ = find_massless_axes(replace(mechanism.bodies[order[i]], inertia=inertia[i]), size)
        if len(axes) and not (mechanism.planar and np.sum(axes[:, 2] ** 2) < tolerances.ALONG_SQUARED):
            missing[i] = axes
    return missing


def require_within_limits(layout: Layout, start: Assembly) -> None:
    """Raise SolveError [beyond-stop] with all stops whose limits the start exceeds."""
    mechanism = layout.mechanism
    problems = []
    for stop in mechanism.stops:
        value = stop_coordinate(layout, start, stop)
        slack = tolerances.AT_LIMIT * (1.0 if stop.quantity == "angle" else layout.size)
        if stop.low is not None and value < stop.low - slack:
            problems.append(_limit_problem(mechanism, stop, value, stop.low, "below"))
        if stop.high is not None and value > stop.high + slack:
            problems.append(_limit_problem(mechanism, stop, value, stop.high, "above"))
    if problems:
        raise SolveError(*problems)


def stop_coordinate(layout: Layout, start: Assembly, stop: Stop) -> float:
    """Return the angle [rad], travel [m] or length [m] that a stop limits, at the start."""
    joint = layout.mechanism.joints[stop.joint]
    if stop.quantity == "length":
        return point_distance(start, joint)
    start_values = layout.starts[stop.joint]
    return start_values.angle if stop.quantity == "angle" else start_values.travel


def zero_inward_rates(mechanism: Mechanism, layout: Layout, start: Assembly) -> Mechanism | None:
    """Set the rates to zero that were chosen, not given, and would drive a body at a stop into it; None if there are
    none.

    Rates that are given, or follow from given ones, cause an impact instead.
    """
    joints, has_changed = list(mechanism.joints), False
    for stop in mechanism.stops:
        joint, start_values = mechanism.joints[stop.joint], layout.starts[stop.joint]
        tolerance = tolerances.AT_LIMIT * (1.0 if stop.quantity == "angle" else layout.size)
        rate, held = (start_values.rate, joint.rate) if stop.quantity == "angle" else (start_values.speed, joint.speed)
        value = stop_coordinate(layout, start, stop)
        low = stop.low is not None and value <= stop.low + tolerance and rate < 0.0
        high = stop.high is not None and value >= stop.high - tolerance and rate > 0.0
        if stop.quantity != "length" and held is None and (low or high):
            has_changed = True
            joints[stop.joint] = replace(joint, **{"rate" if stop.quantity == "angle" else "speed": 0.0})
    return replace(mechanism, joints=tuple(joints)) if has_changed else None


def _limit_problem(mechanism: Mechanism, stop: Stop, value: float, limit: float, side: str) -> Problem:
    joint = mechanism.joints[stop.joint].name
    unit = "rad" if stop.quantity == "angle" else "m"
    starts = f"{joint}.{stop.quantity} starts at {value:.9g} {unit}"
    message = f"{starts}, {side} the limit {limit:.9g} {unit} of stop {stop.name}"
    return Problem("beyond-stop", message, hint=f"start the joint {joint} within its limits, or change the limits",
                   entry_path=f"stops.{stop.name}")  # fmt: skip
