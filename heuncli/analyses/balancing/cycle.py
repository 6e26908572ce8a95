"""Motion over a cycle at unit rate: the scene is followed along one of its angles, nothing is integrated.

A drive that turns the angle φ at 1 rad/s replaces the scene's own drive (or is added where one freedom is free):
    x' = dx/dφ,   x'' = d²x/dφ²       are then velocities and accelerations; at any motion  ẋ = x' ω,  ẍ = x'' ω² + x' ω̇
If several drives turn the scene in step, it is followed in time as it is, and results are divided by the rate of the
angle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from heuncli.analyses.balancing.cycle_nodes import CycleNodes, EvenNodes, PieceNodes
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.followed_run import FollowedRun
from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.records import fields, record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.foundation import find_inertia_loads
from heuncli.loads.kinetostatics.reactions import project_to_plane
from heuncli.motion.integration.integrated_scene import find_determined_motion
from heuncli.motion.integration.run.runner import Runner, make_runner
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.results.results import Array
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.models import Drive
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.study.model.setup import reduce_scene

MAX_SAMPLES = 1024  # equally spaced angles per turn, at most, for a smooth cycle
DRIVE = "cycle"
EXPLAINED_CODES = ("path-ends", "no-value")  # codes of errors whose message explains why the scene cannot be followed


@record
class FollowedScene:
    """A scene that turns along its angle, ready to be followed.

    begin [rad]: the angle at t = 0
    rate [rad/s]: rate of the angle in the run
    """

    scene: PreparedScene
    runner: Runner
    begin: float
    rate: float
    turns: int

    @cached_property
    def followed_run(self) -> FollowedRun:
        """Its run. Raises SolveError [no-cycle] if the scene cannot complete the cycle, or does not return to its
        start.
        """
        followed = FollowedRun(self.scene.layout, self.runner, self.begin, self.rate, self.turns)
        try:
            run = followed.run
        except (SolveError, LimitError) as error:
            if isinstance(error, LimitError) and error.problems[0].code != "step-limit":
                raise
            raise SolveError(self.describe_incomplete_cycle(error)) from None
        end_states = make_body_states(self.scene.layout, self.runner.evaluate(run.times[[0, -1]], run.states[[0, -1]]))
        require_closed(self.scene, end_states, self.turns)
        return followed

    def evaluate_cycle(self, nodes: CycleNodes) -> Cycle:
        """Return the cycle at the angles of nodes."""
        if isinstance(nodes, EvenNodes):
            order = np.arange(nodes.count) if self.rate > 0.0 else (-np.arange(nodes.count)) % nodes.count
            x = nodes.grid[:-1]
        else:
            assert isinstance(nodes, PieceNodes)
            order, x = np.arange(len(nodes.places)), nodes.places
        states = self.compute_states(x)
        ordered_states = BodyStates(**{name: values[order] for name, values in fields(states).items()})
        return Cycle(self.scene.mechanism, nodes, ordered_states, self.scene.layout.size)

    def compute_states(self, x: Array) -> BodyStates:
        """Return the body states at places of the run (n,), ascending [rad], at unit rate."""
        return scale_to_unit_rate(make_body_states(self.scene.layout, self.followed_run.recover(x)), self.rate)

    def make_even_nodes(self, count: int) -> EvenNodes:
        """Return `count` equally spaced angles of the cycle."""
        return EvenNodes(self.begin, self.turns, count)

    def describe_incomplete_cycle(self, error: SolveError | LimitError) -> Problem:
        """Return the problem for a scene that cannot be followed over its cycle."""
        reached = error.reached if isinstance(error, SolveError) else None
        where = "" if reached is None else f", it stops at {math.degrees(self.begin + self.rate * reached):.6g}°"
        problem = error.problems[0]
        why = problem.message if problem.code in EXPLAINED_CODES else "it locks there, or passes a dead centre"
        message = f"the mechanism does not complete its cycle{where}: {why}"
        hint = "name an angle that makes full revolutions with --cycle; heun probe lists the critical positions"
        return Problem("no-cycle", message, hint=hint, entry_path=error.problems[0].entry_path)


@record
class Cycle:
    """A scene at the nodes of a cycle, at unit rate; size [m] is the scene's size."""

    mechanism: Mechanism
    nodes: CycleNodes
    states: BodyStates
    size: float

    @property
    def angles(self) -> Array:
        """Angles of the nodes, (n,)."""
        return self.nodes.angles


def make_followed_scene(scene: PreparedScene, plan: CyclePlan) -> FollowedScene:
    """Return the scene driven along the cycle's angle, without loads. Raises SolveError if the angle does not determine
    the motion.
    """
    driven = lay_out_scene(make_driven_mechanism(scene.mechanism, plan, 1.0), drop_rates(scene))
    rate = plan.rate if plan.in_time and plan.rate is not None else 1.0
    prepared, runner = make_runner(driven)
    _, runner = reduce_scene(prepared, runner)
    require_determined(runner, plan)
    return FollowedScene(prepared, runner, plan.begin, rate, plan.turns)


def make_driven_mechanism(mechanism: Mechanism, plan: CyclePlan, rate: float, with_loads: bool = False) -> Mechanism:
    """Return the mechanism with its angle driven at a constant rate; several drives in time stay as they are.

    with_loads: keep loads and weight; otherwise the mechanism only moves
    """
    joints = mechanism.joints
    if not plan.in_time:
        angle = compile_expression(f"{plan.begin!r} + ({rate!r})*t", Scope(in_time=True))
        drive = Drive(DRIVE, plan.joint, "angle", angle, zero_assembled=True)
        joints = tuple(replace(j, drive=drive if j.name == plan.joint else None) for j in joints)
    couplings = tuple(make_cam_two_sided(coupling) for coupling in mechanism.couplings)
    driven = replace(mechanism, joints=joints, couplings=couplings, impulses=(), conditions=())
    return driven if with_loads else replace(driven, loads=(), gravity=np.zeros(3), points={})


def make_cam_two_sided(coupling: Coupling) -> Coupling:
    """Return a cam that keeps its follower even under tension; any other coupling is returned unchanged."""
    if coupling.entry.type != "cam":
        return coupling
    return replace(coupling, rows=tuple(replace(row, tension_only=False) for row in coupling.rows))


def drop_rates(scene: PreparedScene) -> Assembly:
    """Return the assembled start with zero rates; those of the new drive replace them."""
    start = scene.start
    zero = np.zeros_like(start.velocity)
    return replace(start, velocity=zero, angular_velocity=zero)


def require_determined(runner: Runner, plan: CyclePlan) -> None:
    """Raise SolveError [several-freedoms, no-cycle] if the cycle's angle does not determine the pose."""
    layout = runner.integrated_scene.layout
    if find_determined_motion(runner.integrated_scene).is_determined:
        return
    dependent_count = runner.integrated_scene.workspace.count_independent_rows(0.0, layout.y0) if layout.rows else 0
    free_count = layout.tree_freedoms - dependent_count
    if free_count > 0:
        phrase = "1 degree of freedom remains" if free_count == 1 else f"{free_count} degrees of freedom remain"
        message = f"joints.{plan.joint}: with its angle driven, {phrase} that the cycle does not determine"
        hint = "drive or constrain them too (rod on two balls: make one a `universal`); or use --period T"
        raise SolveError(Problem("several-freedoms", message, hint=hint, entry_path=f"joints.{plan.joint}"))
    message = f"joints.{plan.joint}: its angle does not determine the motion"
    raise SolveError(
        Problem("no-cycle", message, hint="name another angle with --cycle", entry_path=f"joints.{plan.joint}")
    )


def scale_to_unit_rate(states: BodyStates, rate: float) -> BodyStates:
    """Scale velocities and accelerations of a run at a constant rate to unit rate."""
    if rate == 1.0:
        return states
    first = {name: getattr(states, name) / rate for name in ("v", "omega", "v_centre")}
    return replace(states, **first, **{name: getattr(states, name) / rate**2 for name in ("a", "alpha", "a_centre")})


def require_closed(scene: PreparedScene, states: BodyStates, turns: int) -> None:
    """Raise SolveError [no-cycle] if a body is not back in its initial pose after the cycle."""
    size, bodies = scene.layout.size, scene.mechanism.bodies
    shift = np.abs(states.x[-1] - states.x[0]).max(axis=1) / size
    turn = np.abs(states.R[-1] - states.R[0]).max(axis=(1, 2))
    deviation = np.maximum(shift, turn)
    worst = int(np.argmax(deviation))
    if deviation[worst] > tolerances.SAME_VALUE:
        name = bodies[worst].name
        message = f"bodies.{name}: not back at its start after {'one revolution' if turns == 1 else 'two revolutions'}"
        hint = (
            "--turns 2 if the cycle takes two revolutions; or another angle with --cycle"
            if turns == 1
            else "name another angle with --cycle"
        )
        raise SolveError(Problem("no-cycle", message, hint=hint, entry_path=f"bodies.{name}"))


def find_cycle_axis(cycle: Cycle, joint_name: str) -> Array | None:
    """Return the direction of the cycle's axis (3,), world axes; None if the axis is not fixed in direction."""
    joint = next(j for j in cycle.mechanism.joints if j.name == joint_name)
    if joint.a == GROUND:
        return joint.axis
    along = cycle.states.R[:, joint.a] @ joint.axis
    return along[0] if np.abs(along - along[0]).max() <= tolerances.PARALLEL else None


@record
class MassEffects:
    """Mass effects of a cycle at unit rate, for every body: (n, bodies, 3), world axes.

    The `first_...` fields are the factors of ω̇, the others those of ω².
    eps, half_slope (n, bodies): the bodies' parts of the reduced inertia [kg m2] and of ½ dε/dφ
    terms: size of the terms that make up force, moment and torque, for estimates of rounding
    """

    nodes: CycleNodes
    force: Array
    orbital: Array
    spin: Array
    first_force: Array
    first_orbital: Array
    first_spin: Array
    eps: Array
    half_slope: Array
    terms: Mapping[str, float]

    @property
    def angles(self) -> Array:
        """Angles of the nodes, (n,)."""
        return self.nodes.angles

    @property
    def moment(self) -> Array:
        """The sum of the orbital and spin moments."""
        return self.orbital + self.spin


def compute_mass_effects(cycle: Cycle, reference_point: Array) -> MassEffects:
    """Compute the mass effects of a cycle.

    reference_point (3,): where moments are taken [m], world axes
    """
    mechanism, states = cycle.mechanism, cycle.states
    masses = np.array([body.mass for body in mechanism.bodies])
    inertia = np.array([body.inertia for body in mechanism.bodies])
    ma, spin = find_inertia_loads(mechanism, states)
    arms = states.centre - reference_point
    momentum = masses[:, None] * states.v_centre
    angular_momentum = np.einsum("tnij,njk,tnlk,tnl->tni", states.R, inertia, states.R, states.omega)
    orbital, first_orbital = cross_rows(arms, ma), cross_rows(arms, momentum)
    if mechanism.planar:
        momentum, angular_momentum = project_to_plane(momentum, angular_momentum)
        _, orbital = project_to_plane(ma, orbital)
        _, first_orbital = project_to_plane(momentum, first_orbital)
    eps = np.einsum("tni,tni->tn", momentum, states.v_centre) + np.einsum("tni,tni->tn", angular_momentum, states.omega)
    slope = np.einsum("tni,tni->tn", ma, states.v_centre) + np.einsum("tni,tni->tn", spin, states.omega)
    return MassEffects(
        cycle.nodes,
        ma,
        orbital,
        spin,
        momentum,
        first_orbital,
        angular_momentum,
        eps,
        slope,
        estimate_term_sizes(cycle, masses, arms),
    )


def estimate_term_sizes(cycle: Cycle, masses: Array, arms: Array) -> dict[str, float]:
    """Estimate the size of the terms of force, moment and torque at unit rate: all masses, moved by the scene's
    size.
    """
    force = float(masses.sum()) * cycle.size
    return {"force": force, "moment": force * (cycle.size + float(np.abs(arms).max())), "torque": force * cycle.size}
