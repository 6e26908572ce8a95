"""The start of a scene with couplings: assembled by its joints, then changed as little as couplings ask for.

A coupling of coordinates starts as it is assembled, and asks for rates alone; where it tells a pose (a rope's length, a
sum of coordinates) it moves what nothing holds. What carries the coupled bodies moves only where these cannot meet
their couplings by themselves.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.multibody.coupled_start.errors import poses_do_not_fit, rates_do_not_fit, too_many
from heuncli.multibody.coupled_start.fit import AskedRows, CoupledFit
from heuncli.multibody.coupled_start.freedoms import Freedoms, concerned
from heuncli.multibody.coupled_start.released import ReleasedBodies
from heuncli.multibody.coupled_start.told import told, unasked
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, arranged
from heuncli.multibody.tree.starts import JointStart, joint_start
from heuncli.results.results import Array, Indices

TOGETHER = 2000  # freedoms that are fitted at once: dense matrices of them must fit into memory and patience


def asked_of(scene: PreparedScene) -> AskedRows:
    """The rows that a start has to meet: of the joints those that always hold, of the couplings all that bear.

    A rope that may go slack asks for its length where its points are too far apart, and for its rate where it is taut.
    """
    layout, joints = scene.layout, len(scene.mechanism.joints)
    slack = {contact.row for contact in layout.contacts}
    own = [r for r, k in enumerate(layout.rows) if k < joints and r not in slack]
    coupled = [row for coupling in scene.mechanism.couplings for row in coupling.rows]
    numbered = dict(zip((r for r, k in enumerate(layout.rows) if k >= joints), coupled, strict=True))
    taut = np.zeros(0)
    if slack & numbered.keys():
        freedoms = Freedoms(layout, 0.0, ())
        taut = freedoms.measured(layout.y0).gaps
    near = tolerances.OPEN_GAP * layout.size
    poses = [r for r, row in numbered.items() if row.length is not None and (r not in slack or taut[r] > near)]
    rates = [r for r in numbered if r not in slack or taut[r] >= -near]
    return AskedRows(*(np.array(rows, dtype=int) for rows in (own, poses, rates)))


def fitted(scene: PreparedScene, t: float, asked: AskedRows) -> PreparedScene:
    """The scene from a start that meets the rows asked for, laid out anew where that is another one.

    Raises SolveError: does-not-fit, rates-do-not-fit, too-many-together.
    """
    rows = np.concatenate([asked.poses, asked.rates]).tolist()
    fit = CoupledFit(scene, t, asked, concerned(scene.layout, rows))
    moved = _posed(scene, fit, asked)
    hurried, started = _hurried(scene, fit, asked)
    if not moved and not hurried:
        return scene
    start = fit.now()[1]
    start = replace(start, chosen=(*start.chosen, *told(scene, start)), started=(*start.started, *started))
    if not moved:
        return arranged(scene.mechanism, start)
    starts = _counted(scene, fit.state, start)
    return arranged(scene.mechanism, start, spanning=scene.layout.spanning, starts=starts)


def _posed(scene: PreparedScene, fit: CoupledFit, asked: AskedRows) -> bool:
    """Whether poses had to change for the rows; they have."""
    limit = tolerances.OPEN_GAP
    if not len(asked.poses) or fit.gap() <= limit:
        return False
    released, before = ReleasedBodies(scene.layout, asked.poses), fit.state
    while True:
        _release(scene, fit, released, asked.poses)
        left = fit.fit_poses()
        if fit.gap() <= limit:
            break
        if not released.widen(asked.poses[np.abs(left) > limit * scene.layout.size]):
            raise poses_do_not_fit(scene.layout, asked.poses, left)
        fit.state = before
    fit.polish(limit)
    return True


def _hurried(scene: PreparedScene, fit: CoupledFit, asked: AskedRows) -> tuple[bool, tuple[str, ...]]:
    """Whether rates had to change for the rows; they have. And sentences on what moves though no rate asks for it."""
    limit = tolerances.OPEN_RATE * fit.speed()
    before = fit.now()[0].rates[asked.rates] * fit.lengths(asked.rates)
    if not np.any(np.abs(before) > limit):
        return False, ()
    released, state = ReleasedBodies(scene.layout, asked.rates), fit.state
    while True:
        _release(scene, fit, released, asked.rates)
        left = fit.fit_rates()
        is_open = np.abs(left) > tolerances.OPEN_RATE * max(fit.speed(), limit / tolerances.OPEN_RATE)
        if not np.any(is_open):
            break
        if not released.widen(asked.rates[is_open]):
            raise rates_do_not_fit(scene.layout, asked.rates, left)
        fit.state = state
    fitted_state, fit.state = fit.state, state
    started = unasked(scene, fit, fitted_state, released)
    fit.state = fitted_state
    return True, started


def _release(scene: PreparedScene, fit: CoupledFit, released: ReleasedBodies, rows: Indices) -> None:
    """Let the released bodies move. Raises SolveError: too-many-together."""
    fit.release(released.places)
    if len(fit.freedoms.answers) > TOGETHER:
        raise too_many(scene.layout, int(rows[0]), len(released.places))


def _counted(scene: PreparedScene, state: Array, start: Assembly) -> tuple[JointStart, ...]:
    """Where the joints stand at a start that coordinates have moved to, angles counted on from where they were zero."""
    mechanism, layout = scene.mechanism, scene.layout
    found = []
    for k, joint in enumerate(mechanism.joints):
        at = joint_start(mechanism, start, joint)
        near = _angle(layout, k, state)
        found.append(at if near is None else replace(at, R_ref=layout.starts[k].R_ref, angle=near))
    return tuple(found)


def _angle(layout: Layout, joint: int, state: Array) -> float | None:
    """The angle of a joint of the tree in a state; None where it is driven, cut or has none."""
    for freedom in layout.freedoms:
        if freedom.joint == joint and freedom.quantity == "angle" and freedom.q >= 0:
            return float(state[freedom.q])
    return None
