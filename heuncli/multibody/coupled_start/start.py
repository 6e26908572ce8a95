"""Find the start of a scene with couplings: assembled by its joints, then changed as little as the couplings need.

A coupling of coordinates starts as it is assembled and constrains rates only; where it determines a pose (a rope's
length, a sum of coordinates) it moves bodies that nothing holds. The bodies that carry the coupled ones move only where
these cannot satisfy their couplings by themselves.

Bodies around the coupled loops are released first, their parents later. A placed body is not moved to spare the ones
that it carries (manual/format.md, "Where bodies start"): of two geared shafts the one without a given rate turns, and
not the frame that carries both. Only where the loop by itself cannot satisfy its rows is its parent released, too, one
body further in at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.multibody.assembly.start_choices import StartChoice, format_choices
from heuncli.multibody.coupled_start.fit import CoupledFit, StartRows
from heuncli.multibody.coupled_start.freedoms import Freedoms, find_coupled_bodies
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from heuncli.multibody.tree.islands import loop_bodies
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.multibody.tree.starts import JointStart, compute_joint_start
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows, vector_from_rotation

# Body release


class ReleasedBodies:
    """The tree indices of bodies that may move, in groups that share closure rows.

    coupled: closure rows of couplings

    `first` contains only the bodies around their loops.
    """

    def __init__(self, layout: Layout, coupled_rows: Iterable[int]) -> None:
        self.parents: list[int] = layout.bodies["parent"].tolist()
        loops = {owner: loop_bodies(layout, owner) for owner in dict.fromkeys(layout.rows)}
        self.loops = [loops[owner] for owner in layout.rows]
        rows = layout.tables["closures"][: len(layout.rows)]
        paths = [layout.indices[row["path"] : row["path"] + row["path_count"]] for row in rows]
        self.moved_by = [({*path, *loop}, loop) for path, loop in zip(paths, self.loops, strict=True)]
        self.first: set[int] = self._close_under_rows({i for r in coupled_rows for i in self.loops[r]})
        self.places = set(self.first)

    def widen(self, rows: Sequence[int] | Indices) -> bool:
        """Release the parents of the loops of some closure rows; return whether there is any."""
        within = self._close_under_rows({i for r in rows for i in self.loops[int(r)]})
        while True:
            grown = within | {self.parents[i] for i in within if self.parents[i] >= 0}
            if grown == within:
                return False
            within = self._close_under_rows(grown)
            if not within <= self.places:
                self.places |= within
                return True

    def find_carried(self) -> set[int]:
        """Return the bodies (tree indices) released beyond the first ones, and all bodies on them."""
        bodies = self.places - self.first
        for i, parent in enumerate(self.parents):  # a parent stands before what it carries
            if parent in bodies:
                bodies.add(i)
        return bodies

    def _close_under_rows(self, places: set[int]) -> set[int]:
        """Add all bodies around closure rows that these bodies move: a cv joint turns what its shaft carries."""
        bodies, grown = set(places), True
        while grown:
            reached = {i for movers, loop in self.moved_by if not bodies.isdisjoint(movers) for i in loop}
            grown = not reached <= bodies
            bodies |= reached
        return bodies


# Errors


def poses_do_not_fit(layout: Layout, rows: Indices, gaps: Array) -> SolveError:
    """Make the error for the worst of some closure rows; gaps: of each row [m]."""
    name, entry_path, bodies = _describe_owner(layout, rows, gaps)
    largest = _format_largest(layout, rows, gaps)
    message = f"{name} cannot be satisfied at the start: an error of {largest} remains between {bodies}"
    hint = "prescribe fewer start values (initial, position, orientation), or change its values"
    return SolveError(Problem("does-not-fit", message, hint=hint, entry_path=entry_path))


def rates_do_not_fit(layout: Layout, rows: Indices, residuals: Array) -> SolveError:
    """Make the error for the worst of some closure rows; residuals: of the rate of each row [m/s]."""
    name, entry_path, bodies = _describe_owner(layout, rows, residuals)
    largest = _format_largest(layout, rows, residuals)
    message = f"{name}: the start velocities of {bodies} are incompatible by {largest}/s"
    hint = "prescribe fewer velocities, or drive fewer coordinates; heun computes the others from the couplings"
    return SolveError(Problem("rates-do-not-fit", message, hint=hint, entry_path=entry_path))


def too_many(layout: Layout, row: int, bodies: int) -> SolveError:
    """Make the error for a coupling row that ties more bodies together than are fitted at once."""
    name, entry_path, _ = _describe_owner(layout, np.array([row]), np.ones(1))
    message = f"{name} connects {bodies:,} bodies whose start does not fit: too many to fit at once"
    return SolveError(Problem("too-many-together", message, hint="give more of its velocities", entry_path=entry_path))


def _describe_owner(layout: Layout, rows: Indices, residuals: Array) -> tuple[str, str, str]:
    """Describe the owner of the row with the largest residual: in words, as the path of its entry, and its bodies."""
    mechanism = layout.mechanism
    k = layout.rows[int(rows[int(np.argmax(np.abs(residuals)))])]
    joints = len(mechanism.joints)
    if k < joints:
        joint = mechanism.joints[k]
        what, bodies = f"joint {joint.name} ({joint.kind})", {joint.a, joint.b}
    else:
        coupling = mechanism.couplings[k - joints]
        what, bodies = f"coupling {coupling.name} ({coupling.entry.type})", set(coupling.bodies)
    if len(bodies) == 1:  # a coupling lists no ground
        bodies.add(GROUND)
    names = [_name(mechanism, i) for i in sorted(bodies, reverse=True)]
    return what, mechanism.owner_path(k), " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _format_largest(layout: Layout, rows: Indices, residuals: Array) -> str:
    """Format the largest residual in its unit: rad for a row of angles, whose gaps count by the scene's size."""
    k = int(np.argmax(np.abs(residuals)))
    r, joints = int(rows[k]), len(layout.mechanism.joints)
    coupling = layout.mechanism.couplings[layout.rows[r] - joints] if layout.rows[r] >= joints else None
    if coupling is None or coupling.rows[r - layout.rows.index(layout.rows[r])].weight:
        return f"{abs(residuals[k]):.3g} m"
    return f"{abs(residuals[k]) / layout.size:.3g} rad"


def _name(mechanism: Mechanism, body: int) -> str:
    return "ground" if body == GROUND else mechanism.bodies[body].name


# Start sentences

COUPLING_ORIGIN = "adjusted to satisfy the couplings"


def format_coupling_changes(scene: PreparedScene, start: Assembly) -> tuple[str, ...]:
    """Return one sentence for each body whose start the couplings have changed."""
    return format_choices(_iter_changes(scene, start))


def format_unprescribed_motions(
    scene: PreparedScene, fit: CoupledFit, state: Array, released_bodies: ReleasedBodies
) -> tuple[str, ...]:
    """Return sentences on bodies that are set in motion though no rate is given for them; state: with the fitted rates.

    Such a body carries the coupled ones, which cannot satisfy their couplings without it; or it could have stayed
    unchanged if another one had moved. fit: before the rates are fitted.
    """
    before, after = fit.measure_present()[1], fit.start_at(state)
    arms = np.array([b.center for b in scene.mechanism.bodies])
    v0, v1 = (_centre_velocities(assembly, arms) for assembly in (before, after))
    spins, speeds = after.angular_velocity - before.angular_velocity, v1 - v0
    scale = float(np.max(np.abs(v1)) + scene.layout.size * np.max(np.abs(after.angular_velocity)))
    size = np.maximum(np.abs(speeds).max(axis=1), scene.layout.size * np.abs(spins).max(axis=1))
    moving = [i for i in fit.bodies if size[i] > tolerances.OPEN_GAP * scale]
    hangs = scene.layout.spanning.links
    carriers = {hangs[k].body for k in released_bodies.places - released_bodies.first}
    carried = {hangs[k].body for k in released_bodies.find_carried()} - carriers
    names: dict[bool, list[str]] = {True: [], False: []}
    for i in moving:
        if i in carriers or (i not in carried and fit.could_stay(i)):
            names[i in carriers].append(
                _format_motion(scene.mechanism.bodies[i].name, spins[i], speeds[i], scale, scene)
            )
    return tuple(
        f"the couplings set in motion {', '.join(names[is_carrier])}: {reason}"
        for is_carrier, reason in REASONS.items()
        if names[is_carrier]
    )


REASONS = {
    False: "other rates also satisfy them, these are the smallest; give rates to choose",
    True: "the coupled bodies mounted on it cannot satisfy them alone",
}


def _format_motion(name: str, spin: Array, speed: Array, scale: float, scene: PreparedScene) -> str:
    """Format a body's name and how fast it is set in motion."""
    turn, shift = float(np.sqrt(spin @ spin)), float(np.sqrt(speed @ speed))
    parts = [f"{turn:.4g} rad/s"] if turn * scene.layout.size > tolerances.OPEN_GAP * scale else []
    parts += [f"{shift:.4g} m/s"] if shift > tolerances.OPEN_GAP * scale else []
    return f"{name} ({', '.join(parts)})"


def _iter_changes(scene: PreparedScene, start: Assembly) -> Iterator[StartChoice]:
    size, before = scene.layout.size, scene.start
    arms = np.array([b.center for b in scene.mechanism.bodies])
    v0, v1 = (_centre_velocities(assembly, arms) for assembly in (before, start))
    scale = float(np.max(np.abs(v1)) + size * np.max(np.abs(start.angular_velocity)))
    for i, body in enumerate(scene.mechanism.bodies):
        turn = np.degrees(vector_from_rotation(start.rotation[i] @ before.rotation[i].T))
        rows = (
            ("position", start.position[i], start.position[i] - before.position[i], size),
            ("orientation", turn, turn, 1.0),
            ("velocity", v1[i], v1[i] - v0[i], scale),
            ("angular velocity", start.angular_velocity[i], start.angular_velocity[i] - before.angular_velocity[i],
             scale / size),
        )  # fmt: skip
        for what, value, change, unit in rows:
            if np.max(np.abs(change)) > tolerances.OPEN_GAP * unit:
                yield StartChoice(body.name, what, COUPLING_ORIGIN, "", value, unit)


def _centre_velocities(assembly: Assembly, arms: Array) -> Array:
    """Velocities of the centres of mass."""
    return assembly.velocity + cross_rows(assembly.angular_velocity, np.einsum("nij,nj->ni", assembly.rotation, arms))


# Start

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
    frictions = {contact.row for contact in layout.contacts if contact.load_row >= 0}
    numbers = (r for r, k in enumerate(layout.rows) if k >= joints and r not in frictions)
    coupled_rows = dict(zip(numbers, row_definitions, strict=True))
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
