"""Find the start of a scene with couplings: assembled by its joints, then changed as little as the couplings need.

A coupling of coordinates starts as it is assembled and constrains rates only; where it determines a pose (a rope's
length, a sum of coordinates) it moves bodies that nothing holds. The bodies that carry the coupled ones move only where
these cannot satisfy their couplings by themselves.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.multibody.coupled_start.body_release import ReleasedBodies
from heuncli.multibody.coupled_start.errors import poses_do_not_fit, rates_do_not_fit, too_many
from heuncli.multibody.coupled_start.fit import CoupledFit, StartRows
from heuncli.multibody.coupled_start.freedoms import Freedoms, find_coupled_bodies
from heuncli.multibody.coupled_start.start_sentences import format_coupling_changes, format_unprescribed_motions
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.multibody.tree.starts import JointStart, compute_joint_start
from heuncli.results.results import Array, Indices

MAX_FREEDOMS = 2000  # freedoms that are fitted at once: their dense matrices must fit into memory, and be fast enough


def find_start_rows(scene: PreparedScene) -> StartRows:
    """Find the rows that a start has to satisfy: of the joints those that always hold, of the couplings all that are
    active.

    A rope that may go slack sets its length where its points are too far apart, and its rate where it is taut.
    """
    layout, joints = scene.layout, len(scene.mechanism.joints)
    slack = {contact.row for contact in layout.contacts}
    joint_rows = [r for r, k in enumerate(layout.rows) if k < joints and r not in slack]
    row_definitions = [row for coupling in scene.mechanism.couplings for row in coupling.rows]
    coupled_rows = dict(zip((r for r, k in enumerate(layout.rows) if k >= joints), row_definitions, strict=True))
    taut = np.zeros(0)
    if slack & coupled_rows.keys():
        freedoms = Freedoms(layout, 0.0, ())
        taut = freedoms.measure(layout.y0).gaps
    tolerance = tolerances.OPEN_GAP * layout.size
    poses = [r for r, row in coupled_rows.items() if row.length is not None and (r not in slack or taut[r] > tolerance)]
    rates = [r for r in coupled_rows if r not in slack or taut[r] >= -tolerance]
    return StartRows(*(np.array(rows, dtype=int) for rows in (joint_rows, poses, rates)))


def fit_start(scene: PreparedScene, t: float, start_rows: StartRows) -> PreparedScene:
    """Return the scene with a start that satisfies these rows; it is laid out again if the start has changed.

    Raises SolveError: does-not-fit, rates-do-not-fit, too-many-together.
    """
    rows = np.concatenate([start_rows.poses, start_rows.rates]).tolist()
    fit = CoupledFit(scene, t, start_rows, find_coupled_bodies(scene.layout, rows))
    poses_changed = _fit_poses(scene, fit, start_rows)
    rates_changed, motion_sentences = _fit_rates(scene, fit, start_rows)
    if not poses_changed and not rates_changed:
        return scene
    start = fit.measure_present()[1]
    start = replace(
        start,
        start_choices=(*start.start_choices, *format_coupling_changes(scene, start)),
        start_motions=(*start.start_motions, *motion_sentences),
    )
    if not poses_changed:
        return lay_out_scene(scene.mechanism, start)
    starts = _joint_starts(scene, fit.state, start)
    return lay_out_scene(scene.mechanism, start, spanning=scene.layout.spanning, starts=starts)


def _fit_poses(scene: PreparedScene, fit: CoupledFit, start_rows: StartRows) -> bool:
    """Fit the poses to the rows; return whether they had to change."""
    limit = tolerances.OPEN_GAP
    if not len(start_rows.poses) or fit.largest_gap() <= limit:
        return False
    released, before = ReleasedBodies(scene.layout, start_rows.poses), fit.state
    while True:
        _release_bodies(scene, fit, released, start_rows.poses)
        gaps = fit.fit_poses()
        if fit.largest_gap() <= limit:
            break
        if not released.widen(start_rows.poses[np.abs(gaps) > limit * scene.layout.size]):
            raise poses_do_not_fit(scene.layout, start_rows.poses, gaps)
        fit.state = before
    fit.polish(limit)
    return True


def _fit_rates(scene: PreparedScene, fit: CoupledFit, start_rows: StartRows) -> tuple[bool, tuple[str, ...]]:
    """Fit the rates to the rows; return whether they had to change, and sentences on bodies that move unprescribed."""
    limit = tolerances.OPEN_RATE * fit.scene_speed()
    before = fit.measure_present()[0].rates[start_rows.rates] * fit.length_factors(start_rows.rates)
    if not np.any(np.abs(before) > limit):
        return False, ()
    released, state = ReleasedBodies(scene.layout, start_rows.rates), fit.state
    while True:
        _release_bodies(scene, fit, released, start_rows.rates)
        residuals = fit.fit_rates()
        is_open = np.abs(residuals) > tolerances.OPEN_RATE * max(fit.scene_speed(), limit / tolerances.OPEN_RATE)
        if not np.any(is_open):
            break
        if not released.widen(start_rows.rates[is_open]):
            raise rates_do_not_fit(scene.layout, start_rows.rates, residuals)
        fit.state = state
    fitted_state, fit.state = fit.state, state
    motion_sentences = format_unprescribed_motions(scene, fit, fitted_state, released)
    fit.state = fitted_state
    return True, motion_sentences


def _release_bodies(scene: PreparedScene, fit: CoupledFit, released_bodies: ReleasedBodies, rows: Indices) -> None:
    """Let the released bodies move. Raises SolveError: too-many-together."""
    fit.release_bodies(released_bodies.places)
    if len(fit.freedoms.answers) > MAX_FREEDOMS:
        raise too_many(scene.layout, int(rows[0]), len(released_bodies.places))


def _joint_starts(scene: PreparedScene, state: Array, start: Assembly) -> tuple[JointStart, ...]:
    """Return the starts of the joints after the coordinates have moved, with angles counted on continuously from their
    zero.
    """
    mechanism, layout = scene.mechanism, scene.layout
    starts = []
    for k, joint in enumerate(mechanism.joints):
        joint_start_values = compute_joint_start(mechanism, start, joint)
        angle = _tree_angle(layout, k, state)
        starts.append(
            joint_start_values
            if angle is None
            else replace(joint_start_values, R_ref=layout.starts[k].R_ref, angle=angle)
        )
    return tuple(starts)


def _tree_angle(layout: Layout, joint: int, state: Array) -> float | None:
    """Return the angle of a joint of the tree in a state; None where it is driven, cut or has none."""
    for freedom in layout.freedoms:
        if freedom.joint == joint and freedom.quantity == "angle" and freedom.q >= 0:
            return float(state[freedom.q])
    return None
