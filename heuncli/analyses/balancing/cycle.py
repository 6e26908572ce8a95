"""The motion over a cycle at unit rate: the scene is followed along one of its angles, nothing is integrated.

A drive that turns the angle φ at 1 rad/s takes the place of the scene's own (or is added where one freedom is free):
    x' = dx/dφ,   x'' = d²x/dφ²       are then velocities and accelerations; at any motion  ẋ = x' ω,  ẍ = x'' ω² + x' ω̇
Where several drives turn the scene in step it is followed in time as it stands, and the angle's own rate divided out.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from heuncli.analyses.balancing.choice import CyclePlan
from heuncli.analyses.balancing.followed import FollowedRun
from heuncli.analyses.balancing.nodes import CycleNodes, EvenNodes, PieceNodes
from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.records import fields, record, replace
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.motion.integration.determined_motion import determined
from heuncli.motion.integration.run.runner import Runner, ready
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import GROUND, Assembly, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene, arranged
from heuncli.results.results import Array
from heuncli.scene.expressions.grammar import Scope, compile_expression
from heuncli.scene.file_format.models import Drive
from heuncli.study.model.setup import reduced_runner

MOST_SAMPLES = 1024  # even angles of a turn, at most of what is smooth
DRIVE = "cycle"
TOLD = ("path-ends", "no-value")  # codes of errors that say why a scene cannot be followed on


@record
class FollowedScene:
    """A scene that turns along its angle, ready to be followed: what the instants of its run mean.

    begin [rad]: the angle at t = 0; rate [rad/s]: at which it turns in the run.
    """

    scene: PreparedScene
    runner: Runner
    begin: float
    rate: float
    turns: int

    @cached_property
    def followed(self) -> FollowedRun:
        """Its run. Raises SolveError where the scene does not go round, or comes round elsewhere."""
        own = FollowedRun(self.scene.layout, self.runner, self.begin, self.rate, self.turns)
        try:
            run = own.run
        except (SolveError, LimitError) as error:
            if isinstance(error, LimitError) and error.problems[0].code != "step-limit":
                raise
            raise SolveError(self.not_round(error)) from None
        there = body_states(self.scene.layout, self.runner.recovered(run.times[[0, -1]], run.states[[0, -1]]))
        require_closed(self.scene, there, self.turns)
        return own

    def at(self, nodes: CycleNodes) -> Cycle:
        """The cycle at the angles of nodes."""
        if isinstance(nodes, EvenNodes):
            order = np.arange(nodes.count) if self.rate > 0.0 else (-np.arange(nodes.count)) % nodes.count
            x = nodes.grid[:-1]
        else:
            assert isinstance(nodes, PieceNodes)
            order, x = np.arange(len(nodes.places)), nodes.places
        states = self.states(x)
        own = BodyStates(**{name: values[order] for name, values in fields(states).items()})
        return Cycle(self.scene.mechanism, nodes, own, self.scene.layout.size)

    def states(self, x: Array) -> BodyStates:
        """The bodies at places of the run (n,), ascending [rad], moved at unit rate."""
        return at_unit_rate(body_states(self.scene.layout, self.followed.recovered(x)), self.rate)

    def even(self, count: int) -> EvenNodes:
        """So many equal angles of its cycle."""
        return EvenNodes(self.begin, self.turns, count)

    def not_round(self, error: SolveError | LimitError) -> Problem:
        """What is told of a scene that cannot be followed over its cycle."""
        reached = error.reached if isinstance(error, SolveError) else None
        where = "" if reached is None else f", it ends at {math.degrees(self.begin + self.rate * reached):.6g}°"
        own = error.problems[0]
        why = own.message if own.code in TOLD else "it locks there, or passes a dead centre"
        message = f"the scene does not go round its cycle{where}: {why}"
        hint = "--cycle names an angle that turns all the way; heun probe tells what a motion of it comes near to"
        return Problem("no-cycle", message, hint=hint, about=error.problems[0].about)


@record
class Cycle:
    """A scene of a size [m] at the nodes of a cycle, moved at unit rate; behind it as at first."""

    mechanism: Mechanism
    nodes: CycleNodes
    states: BodyStates
    size: float

    @property
    def angles(self) -> Array:
        """Those of the nodes, (n,)."""
        return self.nodes.angles


def turning(scene: PreparedScene, plan: CyclePlan) -> FollowedScene:
    """The scene driven along the cycle's angle, loads left out. Raises SolveError where that does not determine it."""
    driven = arranged(driven_mechanism(scene.mechanism, plan, 1.0), still(scene))
    rate = plan.rate if plan.in_time and plan.rate is not None else 1.0
    own, runner = ready(driven)
    _, runner = reduced_runner(own, runner)
    require_determined(runner, plan)
    return FollowedScene(own, runner, plan.begin, rate, plan.turns)


def driven_mechanism(mechanism: Mechanism, plan: CyclePlan, rate: float, loaded: bool = False) -> Mechanism:
    """The mechanism with its angle driven at a rate; of several drives in time all as they stand.

    loaded: with its loads and weight; else it only moves.
    """
    joints = mechanism.joints
    if not plan.in_time:
        angle = compile_expression(f"{plan.begin!r} + ({rate!r})*t", Scope(in_time=True))
        drive = Drive(DRIVE, plan.joint, "angle", angle, zero_assembled=True)
        joints = tuple(replace(j, drive=drive if j.name == plan.joint else None) for j in joints)
    couplings = tuple(pressed(own) for own in mechanism.couplings)
    moved = replace(mechanism, joints=joints, couplings=couplings, blows=(), conditions=())
    return moved if loaded else replace(moved, loads=(), gravity=np.zeros(3), points={})


def pressed(coupling: Coupling) -> Coupling:
    """A cam that keeps its follower, whatever presses the follower on; any other coupling as it is."""
    if coupling.given.type != "cam":
        return coupling
    return replace(coupling, rows=tuple(replace(row, tension_only=False) for row in coupling.rows))


def still(scene: PreparedScene) -> Assembly:
    """The assembled start without its rates: those of the new drive take their place."""
    start = scene.start
    none = np.zeros_like(start.velocity)
    return replace(start, velocity=none, angular_velocity=none)


def require_determined(runner: Runner, plan: CyclePlan) -> None:
    """Raise SolveError where the cycle's angle does not tell where everything is."""
    layout = runner.moving.layout
    if determined(runner.moving).is_so:
        return
    chosen = runner.moving.workspace.chosen_count(0.0, layout.y0) if layout.rows else 0
    left = layout.tree_freedoms - chosen
    if left > 0:
        also = "another freedom is" if left == 1 else f"{left} other freedoms are"
        message = f"joints.{plan.joint}: with its angle driven {also} left: how they move is not told by the cycle"
        hint = "drive them, too, or hold them (a rod on two balls: one `universal`); or --period T, orders of time"
        raise SolveError(Problem("several-freedoms", message, hint=hint, about=f"joints.{plan.joint}"))
    message = f"joints.{plan.joint}: its angle does not determine the motion"
    raise SolveError(Problem("no-cycle", message, hint="--cycle names another angle", about=f"joints.{plan.joint}"))


def at_unit_rate(states: BodyStates, rate: float) -> BodyStates:
    """Velocities and accelerations of a run at a constant rate by the angle."""
    if rate == 1.0:
        return states
    first = {name: getattr(states, name) / rate for name in ("v", "omega", "v_centre")}
    return replace(states, **first, **{name: getattr(states, name) / rate**2 for name in ("a", "alpha", "a_centre")})


def require_closed(scene: PreparedScene, states: BodyStates, turns: int) -> None:
    """Raise SolveError where a body is elsewhere after the cycle than before it."""
    size, bodies = scene.layout.size, scene.mechanism.bodies
    shift = np.abs(states.x[-1] - states.x[0]).max(axis=1) / size
    turn = np.abs(states.R[-1] - states.R[0]).max(axis=(1, 2))
    off = np.maximum(shift, turn)
    worst = int(np.argmax(off))
    if off[worst] > tolerances.SAME_VALUE:
        name = bodies[worst].name
        message = f"bodies.{name}: after {'a turn' if turns == 1 else 'two turns'} it is not back where it was"
        hint = (
            "--turns 2, if the scene takes two; --cycle names another angle" if turns == 1 else "--cycle names another"
        )
        raise SolveError(Problem("no-cycle", message, hint=hint, about=f"bodies.{name}"))


def axis_of(cycle: Cycle, joint_name: str) -> Array | None:
    """The direction of the cycle's axis, (3,), world axes; None where it turns about no fixed one."""
    joint = next(j for j in cycle.mechanism.joints if j.name == joint_name)
    if joint.a == GROUND:
        return joint.axis
    along = cycle.states.R[:, joint.a] @ joint.axis
    return along[0] if np.abs(along - along[0]).max() <= tolerances.PARALLEL else None
