"""The scene without its drives, each driven coordinate as free as the others, and its state at an instant.

It keeps the tree, the reference attitudes and the inertias of the original scene, so that states can be converted: a
driven coordinate of the original is a state variable here.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.runner import Runner, make_runner
from heuncli.motion.linearisation.linearise import LinearisedEquations, linearise
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, Load, PairLoad, PointLoad
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.layout import Layout, find_speed_rows
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery, recover
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.workflow import solve

NO_EFFORTS: Mapping[str, float] = MappingProxyType({})


@record
class FreedScene:
    """A scene without drives.

    original: the scene it was made of, with its drives
    """

    scene: PreparedScene
    runner: Runner
    original: PreparedScene

    @property
    def layout(self) -> Layout:
        """The layout of the scene."""
        return self.scene.layout

    @property
    def driven_coordinates(self) -> dict[str, str]:
        """The coordinates that the original drives, with the joint of each."""
        joints = (joint for joint in self.original.mechanism.joints if joint.drive is not None)
        return {f"{joint.name}.{joint.drive.quantity}": joint.name for joint in joints if joint.drive is not None}

    def convert_holding(self, holding: Array) -> Array:
        """Convert the original's closed contacts to those of this scene, (contacts,); rods released from a driven
        length are open.
        """
        values_by_contact = {
            key: float(value) for key, value in zip(list_contact_keys(self.original.layout), holding, strict=True)
        }
        converted = np.array([values_by_contact.get(key, 0.0) for key in list_contact_keys(self.layout)])
        original_contacts = list_contact_keys(self.original.layout)
        contacts = list_contact_keys(self.layout)[: len(self.layout.contacts)]
        for n in range(len(converted) - 2 * len(self.layout.friction_contacts), len(converted), 2):
            if converted[n]:  # the leader of frictions that stick as one, by its number
                converted[n] = 1 + contacts.index(original_contacts[int(converted[n]) - 1])
        return converted

    def convert_states(self, recovered: Evaluation) -> Array:
        """Convert the states at the recovered instants of the original to states of this scene, (n_t, n)."""
        layout, original_layout = self.layout, self.original.layout
        states = np.zeros((len(recovered.times), layout.n_state))
        free = layout.tables["freedoms"]
        states[:, free["q_at"]] = recovered.freedoms["q"]
        states[:, free["u_at"]] = recovered.freedoms["u"]
        for ball, original_ball in zip(layout.bodies, original_layout.bodies, strict=True):
            if ball["ball"]:
                for name, count in (("attitude_at", 4), ("rate_at", 3)):
                    a, b = int(ball[name]), int(original_ball[name])
                    states[:, a : a + count] = recovered.states[:, b : b + count]
        for joint, at in layout.counters.items():
            states[:, at] = recovered.states[:, original_layout.counters[joint]]
        return states


def free_drives(original: PreparedScene, efforts: Mapping[str, float] = NO_EFFORTS) -> FreedScene:
    """Return a scene without its drives.

    efforts: loads applied instead, by the names of the driven coordinates
    """
    mechanism = replace(original.mechanism, joints=tuple(map(release_drive, original.mechanism.joints)))
    loads = (load for name, value in efforts.items() if value for load in make_effort_loads(mechanism, name, value))
    mechanism = replace(mechanism, loads=(*mechanism.loads, *loads))
    scene = lay_out_scene(
        mechanism,
        original.start,
        spanning=original.layout.spanning,
        size=original.layout.size,
        starts=original.layout.starts,
    )
    scene, runner = make_runner(scene)
    return FreedScene(scene, runner, original)


def release_drive(joint: Joint) -> Joint:
    """Return a joint without its drive; a rod whose length was driven becomes a slack rope."""
    if joint.drive is None:
        return joint
    if JOINTS[joint.kind].keeps_distance:
        return replace(joint, drive=None, tension_only=True, restitution=0.0)
    return replace(joint, drive=None)


def make_effort_loads(mechanism: Mechanism, coordinate: str, value: float) -> tuple[Load, ...]:
    """Return the constant torque [N m] or thrust [N] of a drive along its coordinate, on `to`, and the opposite on
    `from`.
    """
    joint_name, _, quantity = coordinate.rpartition(".")
    k = next(i for i, joint in enumerate(mechanism.joints) if joint.name == joint_name)
    joint, name = mechanism.joints[k], f"drive of {coordinate}"
    if quantity == "length":
        return (PairLoad(name, "actuator", joint.a, joint.p, joint.b, joint.q, Expression.from_number(value)),)
    if JOINTS[joint.kind].coordinates == (quantity,):
        return (JointLoad(name, "torque", k, Expression.from_number(value)),)
    # a cylinder slides along the axis that both bodies have
    ends = ((joint.b, joint.q, joint.to_axis, value), (joint.a, joint.p, joint.axis, -value))
    return tuple(
        PointLoad(name, "force", body, point, (x, y, z), True)
        for body, point, axis, signed_value in ends
        if body != GROUND
        for x, y, z in [[Expression.from_number(float(component)) for component in signed_value * axis]]
    )


def list_contact_keys(layout: Layout) -> list[tuple[str, bool, int | str | None]]:
    """Return keys that identify the numbers of contact states: of the contacts, the latches, and the frictions."""
    contacts = [(contact.name, contact.is_rope, contact.sense) for contact in layout.contacts]
    frictions = [layout.contacts[i].name for i in layout.friction_contacts]
    return [
        *contacts,
        *((layout.contacts[i].name, False, None) for i in layout.latches),
        *((name, False, "coordinate") for name in frictions),
        *((name, False, number) for name in frictions for number in ("leader", "transmission")),
    ]


@record
class Instant:
    """A scene at an instant.

    heading: when it is
    setup, driven_recovered: the scene as it is, with its solution
    freed_scene: the scene without drives
    state, holding, freed_recovered, linear_equations: its state, closed contacts, solution and linearised equations
    """

    heading: str
    t: float
    setup: Setup
    driven_recovered: Evaluation
    freed_scene: FreedScene
    state: Array
    holding: Array
    freed_recovered: Evaluation
    linear_equations: LinearisedEquations

    @property
    def recovery(self) -> Recovery:
        """The solution of the scene before its drives are removed."""
        return recover(self.setup, self.driven_recovered, False)


def get_start_time(spec: Spec) -> float:
    """Return the instant of a state, or 0, where all else starts [s]."""
    return float(spec.analysis.times[0]) if spec.analysis.type == "state" else 0.0


def make_start_state(spec: Spec) -> Spec:
    """Return the spec of the state in which a spec starts."""
    times = (get_start_time(spec),)
    return spec._replace(analysis=spec.analysis._replace(type="state", times=times, duration=None, conditions=()))


def make_instant(spec: Spec, time: float | None, time_limit: float | None) -> Instant:
    """Return the start of a state or motion, an equilibrium, or an instant of a motion."""
    kind = spec.analysis.type
    t = get_start_time(spec)
    if time is not None and kind == "motion" and time > 0.0:
        setup, recovered = solve_until(spec, time, time_limit)
        heading, t = f"at t = {time:.6g} s", time
    else:
        if kind != "rest":
            spec = make_start_state(spec)
        setup = set_up(spec, reduce=False)
        runner, layout = setup.runner, setup.scene.layout
        recovered = runner.evaluate(np.array([t]), layout.y0[None, :])
        heading = "at the rest position" if kind == "rest" else f"at t = {t:.6g} s"
    require_holonomic(setup)
    scene = free_drives(setup.scene)
    state, holding = scene.convert_states(recovered)[0], scene.convert_holding(recovered.holding[0])
    freed_recovered = scene.runner.evaluate(np.array([t]), state[None, :], holding=holding)
    return Instant(
        heading,
        t,
        setup,
        recovered,
        scene,
        freed_recovered.states[0],
        holding,
        freed_recovered,
        linearise(scene.layout, t, freed_recovered.states[0], holding),
    )


def require_holonomic(setup: Setup) -> None:
    """Raise SolveError [no-coordinate] if wheels roll in space: their speeds are not rates of any coordinates."""
    layout = setup.scene.layout
    if layout.mechanism.planar or not find_speed_rows(layout).any():
        return
    message = "rolling contact is nonholonomic: no coordinates have its speeds as their rates"
    hint = "heun run gives motion and loads, heun modes small motions; in a planar model wheels roll along lines"
    raise SolveError(Problem("no-coordinate", message, hint=hint))


def solve_until(spec: Spec, time: float, time_limit: float | None) -> tuple[Setup, Evaluation]:
    """Solve a motion up to a time and return its results there. Raises SolveError [bad-option] if it ends before."""
    analysis = spec.analysis._replace(times=(0.0, time), duration=time)
    study = solve(spec._replace(analysis=analysis), Options(time_limit=time_limit, reduce=False))
    recovered = study.history.solutions
    if float(recovered.times[-1]) < time:
        message = f"--at {time:g}: the motion ends at t = {recovered.times[-1]:.6g} s"
        raise SolveError(Problem("bad-option", message, hint="use an earlier instant"))
    return study.setup, recovered.select(np.array([len(recovered.times) - 1]))
