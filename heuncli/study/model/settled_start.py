"""Start a motion from rest: `analysis: {start: rest}`, or from a steady state: `{start: steady}`.

The start is the pose at which the scene rests under the loads at t = 0, found as for `type: rest`:

    rest      drives hold their coordinates as they are at t = 0
    steady    drives, and joints with a given start rate, go on at their rates at t = 0; nothing else accelerates

Only the state at the start changes. Angles, lengths and reference attitudes stay those of the drawing.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.motion.integration.run.runner import make_runner
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.stage_cache import Stages
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.results.results import Array
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.models import Drive
from heuncli.study.model.rest_pose import start_at_rest

StartKind = Literal["rest", "steady"]
RATE_KEYS = (("angle", "rate"), ("travel", "speed"))


class SettledStart(NamedTuple):
    """A scene that starts at rest or in a steady state, with sentences and warnings about that state."""

    scene: PreparedScene
    sentences: tuple[str, ...]
    warnings: tuple[str, ...]


def settle_start(scene: PreparedScene, kind: StartKind, stages: Stages) -> SettledStart:
    """Find the state from which the scene starts, and make it the start.

    Raises SolveError [no-rest-pose] where there is none, or where a drive moves at the start that is to be at rest.
    """
    require_startable_laws(scene.mechanism, kind)
    held = hold_scene(scene, kind)
    at_rest = start_at_rest(*make_runner(held, stages), with_time=True)
    if held.layout.spanning != scene.layout.spanning:  # a joint whose rate is given must not be cut
        scene = lay_out_scene(
            scene.mechanism, scene.start, spanning=held.layout.spanning, starts=scene.layout.starts, stages=stages
        )
    layout = replace(scene.layout, y0=transfer_state(at_rest.scene.layout, scene.layout))
    name = "at rest" if kind == "rest" else "steady"
    sentences = tuple(f"{name} under the loads at t = 0; {sentence}" for sentence in at_rest.rest.sentences)
    return SettledStart(replace(scene, layout=layout), sentences, at_rest.rest.warnings)


def require_startable_laws(mechanism: Mechanism, kind: StartKind) -> None:
    """Raise SolveError [no-rest-pose] for drives that move at a start at rest, and for ropes driven at a rate."""
    problems: list[Problem] = []
    for law in mechanism.laws:
        if law.value.derivatives(0.0)[1] == 0.0:
            continue
        if kind == "rest":
            hint = "start: steady goes on at the rates of t = 0; or begin the drive at rest"
            problems.append(Problem("no-rest-pose", f"start: rest, but {law.path} moves at t = 0", hint=hint))
        elif law.is_rope:
            hint = "begin the rope's length at rest"
            problems.append(Problem("no-rest-pose", f"start: steady, but {law.path} changes at t = 0", hint=hint))
    if problems:
        raise SolveError(*problems)


def hold_scene(scene: PreparedScene, kind: StartKind) -> PreparedScene:
    """Lay out the scene with its drives as at t = 0, and for `steady` with its given rates as drives."""
    joints = tuple(hold_joint(joint, scene.layout, k, kind) for k, joint in enumerate(scene.mechanism.joints))
    couplings = tuple(hold_length(coupling) for coupling in scene.mechanism.couplings)
    mechanism = replace(scene.mechanism, joints=joints, couplings=couplings)
    if len(mechanism.laws) > len(scene.mechanism.laws):
        return lay_out_scene(mechanism, scene.start)
    return lay_out_scene(
        mechanism, scene.start, spanning=scene.layout.spanning, size=scene.layout.size, starts=scene.layout.starts
    )


def hold_joint(joint: Joint, layout: Layout, k: int, kind: StartKind) -> Joint:
    """Return a joint whose drive goes on as at t = 0; a given rate becomes a drive."""
    if joint.drive is not None:
        position, rate, _ = joint.drive.value.derivatives(0.0)
        return replace(joint, drive=replace(joint.drive, value=make_line(position, rate), by_rate=False))
    for quantity, key in RATE_KEYS:
        rate = getattr(joint, key)
        if kind == "steady" and rate is not None and rate != 0.0:
            law = make_line(getattr(layout.starts[k], quantity), rate)
            return replace(joint, drive=Drive(joint.name, joint.name, quantity, law))  # type: ignore[arg-type]
    return joint


def hold_length(coupling: Coupling) -> Coupling:
    """Return a coupling whose driven length stays as at t = 0."""
    return coupling if coupling.law is None else replace(coupling, law=make_line(coupling.law.derivatives(0.0)[0], 0.0))


def make_line(position: float, rate: float) -> Expression:
    """Make the law position + rate t."""
    if rate == 0.0:
        return Expression.from_number(position)
    return compile_expression(f"({position!r}) + ({rate!r})*t", Scope(in_time=True))


def transfer_state(settled: Layout, layout: Layout) -> Array:
    """Return the state (n_state,) of the settled scene at its start as one of the scene itself.

    What is held keeps its start position; its rate is that of its law.
    """
    state = layout.y0.copy()
    for there, here in zip(settled.freedoms, layout.freedoms, strict=True):
        if here.q >= 0 and there.q >= 0:
            state[here.q], state[here.u] = settled.y0[there.q], settled.y0[there.u]
        elif here.q >= 0:
            joint = settled.mechanism.joints[there.joint]
            assert joint.drive is not None
            state[here.u] = joint.drive.value.derivatives(0.0)[1]
    for there_row, row in zip(settled.bodies, layout.bodies, strict=True):
        if row["ball"]:
            for key, count in (("attitude_at", 4), ("rate_at", 3)):
                state[row[key] : row[key] + count] = settled.y0[there_row[key] : there_row[key] + count]
    for k, place in layout.counters.items():
        state[place] = settled.y0[settled.counters[k]]
    return state
