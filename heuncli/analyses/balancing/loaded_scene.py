"""A scene with its loads over a cycle: its results at any place, its torque's orders, its loads with counterweights.

The gas force of a four-stroke engine has half orders. The scene is solved at the cycle's rate, as loads may depend on
it.

With counterweights and without, it compares the force and moment on the foundation, the drive, and the force in every
joint (across its axis, if it has one): root mean square over the cycle and largest magnitude. Values that redundant
joints leave indeterminate are None. All are computed from their squares, which are smooth where a magnitude is not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from heuncli.analyses.balancing.angle_laws import find_deviations, iter_angle_laws
from heuncli.analyses.balancing.cycle import drop_rates, make_driven_mechanism, require_determined
from heuncli.analyses.balancing.cycle_nodes import PieceNodes
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.followed_run import FollowedRun, describe_nonperiodic_loads
from heuncli.analyses.balancing.order_selection import MAX_ORDERS, OrderSelection, bound_higher_orders
from heuncli.analyses.balancing.orders import CycleRotation, magnitudes, make_order_rows
from heuncli.analyses.balancing.piece_resolver import CycleResolver, make_scales
from heuncli.analyses.balancing.results import CycleLoad, OrderRow
from heuncli.analyses.balancing.sampling import compute_square_root_magnitudes
from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.base.tolerances import ORDERS_SETTLED, SUM_ROUNDING
from heuncli.loads.kinetostatics.balance import find_rope_power
from heuncli.loads.kinetostatics.foundation import find_inertia_loads
from heuncli.loads.redundancy.count import count_redundancy
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED
from heuncli.motion.integration.run.runner import make_runner
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.prepare import PreparedScene, lay_out_scene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.rotations import cross_rows
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.recovery import Recovery
from heuncli.study.model.model_note import make_model_block
from heuncli.study.model.setup import Setup, reduce_scene

SHORT_STEP = 1e-2  # of a turn: shorter steps occur only where a load changes quickly
FIRST_SAMPLES = 8
MAX_SEARCHES = 24  # searches for missed events; each finds at most one per piece


class CycleNumbers(NamedTuple):
    """Numbers over a cycle, (n, columns), at the nodes of its pieces.

    notes: events that may have been missed
    is_resolved: whether the nodes resolve the numbers everywhere
    """

    nodes: PieceNodes
    values: Array
    notes: tuple[str, ...]
    is_resolved: bool


@record
class LoadedScene:
    """A scene with its loads.

    joint: the joint whose angle counts the cycle
    """

    setup: Setup
    followed_run: FollowedRun
    joint: str

    def recover(self, x: Array) -> Recovery:
        """Recover the results at ascending places of the cycle (n,)."""
        return Recovery(self.setup, self.followed_run.recover(x), False)

    def recover_samples(self) -> Recovery:
        """Recover the results at a few equally spaced places, to learn how many numbers there are and how large."""
        return self.recover(self.followed_run.length * np.arange(FIRST_SAMPLES) / FIRST_SAMPLES)

    def resolve_numbers(
        self, compute_columns: Callable[[Recovery], Array], group_sizes: Sequence[int], rounding: Sequence[float]
    ) -> CycleNumbers:
        """Compute columns over the cycle, on as many pieces as are needed to resolve them.

        group_sizes: numbers of adjacent columns that are of one kind
        rounding: rounding level of each kind
        """
        run, mechanism = self.followed_run, self.setup.scene.mechanism
        resolver = CycleResolver(
            lambda x: compute_columns(self.recover(x)), run.cycle, make_scales(group_sizes, rounding)
        )
        resolver.resolve(run.breaks)
        resolved = resolver.probe(
            np.union1d(run.find_short_steps(SHORT_STEP * run.length / run.turns), run.find_time_law_places())
        )
        values = [value for load in mechanism.loads for value in load.values]
        laws = list(iter_angle_laws(values, self.joint, run.rate))
        has_other_laws = depends_on_other_joints(values, self.joint)
        undecided: tuple[str, ...] = ()
        for _ in range(MAX_SEARCHES):
            places, undecided = find_deviations(laws, resolved.nodes)
            if has_other_laws:
                places = np.union1d(places, run.find_extra_step_ends(resolved.nodes))
            count = len(resolved.nodes.begins)
            resolved = resolver.probe(places)
            if len(resolved.nodes.begins) == count:
                break
        else:
            undecided += ("the loads",)
        notes = [f"{law_source}: no bounds found between the sampled angles" for law_source in undecided]
        if run.run.uncertain_count:
            steps = "one step" if run.run.uncertain_count == 1 else f"{run.run.uncertain_count} steps"
            notes.append(f"no bounds on the loads found in {steps}: short events may be missing")
        if not resolved.is_resolved:
            notes.append("loads vary too much for full accuracy: results are as uncertain as their stated errors")
        settled = resolved.is_resolved and not notes
        notes += describe_nonperiodic_loads(run, resolved.nodes)
        return CycleNumbers(resolved.nodes, resolved.values, tuple(dict.fromkeys(notes)), settled)


def depends_on_other_joints(values: Sequence[Expression], joint: str) -> bool:
    """Return whether laws depend on coordinates other than this joint's."""
    return any(name != joint for value in values for name, _ in value.uses)


def make_loaded_scene(
    spec: Spec, scene: PreparedScene, mechanism: Mechanism, plan: CyclePlan, rate: float
) -> LoadedScene:
    """Return a mechanism in the place of the scene's own, with its loads, followed along the cycle."""
    driven = lay_out_scene(make_driven_mechanism(mechanism, plan, rate, with_loads=True), drop_rates(scene))
    prepared, runner = make_runner(driven)
    reduced, runner = reduce_scene(prepared, runner)
    require_determined(runner, plan)
    note = make_model_block(prepared, runner, DRIVE_DETERMINED.name, count_redundancy(prepared, runner))
    setup = Setup(spec, prepared, (), runner, DRIVE_DETERMINED, note, reduced)
    return LoadedScene(setup, FollowedRun(prepared.layout, runner, plan.begin, rate, plan.turns), plan.joint)


@record
class LoadTorque:
    """Orders of the load torque, its mean [N m] and the error of the mean.

    notes: results that are missing, and why
    """

    rows: tuple[OrderRow, ...] = ()
    mean: float = 0.0
    error: float = 0.0
    notes: tuple[str, ...] = ()


def compute_load_torque(
    spec: Spec, scene: PreparedScene, plan: CyclePlan, requested_orders: tuple[float, ...] | None
) -> LoadTorque:
    """Compute the torque of loads and weight over a cycle; empty if the scene has none, or if loads depend on time.

    requested_orders: orders listed in addition to the significant ones
    """
    mechanism = scene.mechanism
    if not mechanism.loads and not mechanism.gravity.any():
        return LoadTorque()
    time_loads = [load.path for load in mechanism.loads if any(value.time_dependent for value in load.values)]
    if time_loads:
        return LoadTorque(notes=(f"no orders of the loads: {time_loads[0]} depends on t",))
    rate = plan.rate or 1.0
    try:
        powers = compute_load_powers(make_loaded_scene(spec, scene, mechanism, plan, rate))
    except SolveError as error:
        return LoadTorque(notes=(f"no orders of the loads: {error.problems[0].message}",))
    nodes, values = powers.nodes, powers.values[:, :, None] / rate
    total = values.sum(axis=1)
    threshold = ORDERS_SETTLED * float(np.abs(values).max())
    turning = CycleRotation(plan.turns, None, plan.rate)
    rows = make_order_rows(values, nodes, turning, threshold, selection=OrderSelection(requested_orders))
    mean, mean_error = float(nodes.weights @ total[:, 0]), float(magnitudes(nodes.estimate_errors(total).order))
    notes = powers.notes
    last_order = max((row.order for row in rows), default=0.0) if requested_orders is None else 0.0
    if last_order >= MAX_ORDERS:
        order_bound = bound_higher_orders(nodes, total, last_order)
        notes += (
            f"orders of the loads above {last_order:g} are not listed, each at most {order_bound:.2g} N·m: "
            "set --orders",
        )
    return LoadTorque(rows, mean, mean_error, notes)


def compute_load_powers(scene: LoadedScene) -> CycleNumbers:
    """Compute the power of each load, and of the weight, over the cycle (n, loads + 1) [W]."""
    recovery = scene.recover_samples()
    return scene.resolve_numbers(
        sum_load_powers, [sum_load_powers(recovery).shape[1]], [estimate_power_rounding(recovery)]
    )


def estimate_power_rounding(recovery: Recovery) -> float:
    """Estimate the rounding of these powers from the largest power of the loads at the speeds of their points [W]."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    masses = np.array([body.mass for body in mechanism.bodies])
    weights = masses * float(magnitudes(mechanism.gravity))
    largest_power = float((magnitudes(states.v_centre) @ weights).max())
    for load in recovery.loads:
        for end, force, moment in load.action.iter_ends():
            if end.body != GROUND:
                speed, turning = (
                    magnitudes(states.point_velocity(end.body, end.position)),
                    magnitudes(states.omega[:, end.body]),
                )
                largest_power += float((magnitudes(force) * speed + magnitudes(moment) * turning).max())
    return SUM_ROUNDING * largest_power


def sum_load_powers(recovery: Recovery) -> Array:
    """Return the power of each load, and of the weight, at several instants, (n, loads + 1) [W]."""
    mechanism = recovery.setup.scene.mechanism
    masses = np.array([body.mass for body in mechanism.bodies])
    weight = np.einsum("n,tni,i->t", masses, recovery.states.v_centre, mechanism.gravity)
    ropes = [
        find_rope_power(recovery.states, coupling)
        for coupling in recovery.couplings
        if coupling.coupling.stretched_row is not None
    ]
    return np.stack([*(load.power for load in recovery.loads), *ropes, weight], axis=1)


MOMENTS = ("moment", "drive")


def compute_cycle_loads(
    scene: LoadedScene, plan: CyclePlan, reference_point: Array
) -> tuple[dict[str, CycleLoad], tuple[str, ...]]:
    """Return rms and peak over the cycle of force, moment, drive and joint forces, by name, and the notes of the
    run.
    """
    first_recovery = scene.recover_samples()
    names = [*compute_squares(first_recovery, plan, reference_point)]
    indeterminate: set[str] = set()

    def compute_columns(recovery: Recovery) -> Array:
        """Compute the squares of the loads, (n, loads), and note which are indeterminate."""
        squares = compute_squares(recovery, plan, reference_point)
        indeterminate.update(name for name, values in squares.items() if np.isnan(values).any())
        return np.nan_to_num(np.stack([squares[name] for name in names], axis=1))

    numbers = scene.resolve_numbers(
        compute_columns,
        [1] * len(names),
        compute_rounding(compute_columns(first_recovery), names, scene.setup.scene.layout.size),
    )
    residuals = compute_square_root_magnitudes(
        {name: numbers.values[:, k] for k, name in enumerate(names)}, numbers.nodes
    )
    loads = {
        name: CycleLoad(None, None) if name in indeterminate else CycleLoad(residual.rms, residual.peak, residual.error)
        for name, residual in residuals.items()
    }
    return loads, numbers.notes


def compute_squares(recovery: Recovery, plan: CyclePlan, reference_point: Array) -> dict[str, Array]:
    """Return the squares of force, moment, drive and joint forces by name, (n,) each; nan means indeterminate."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    ma, spin = find_inertia_loads(mechanism, states)
    moment = -(cross_rows(states.centre - reference_point, ma) + spin).sum(axis=1)
    if mechanism.planar:
        moment = moment * np.array([0.0, 0.0, 1.0])
    squared = {"force": np.sum(ma.sum(axis=1) ** 2, axis=1), "moment": np.sum(moment**2, axis=1)}
    joints: Mapping[str, Mapping[str, Array]] = make_blocks(recovery, frozenset({"joints"}))["joints"]
    squared["drive"] = joints[plan.joint]["drive"] ** 2
    for name, joint in joints.items():
        squared[f"joints.{name}"] = joint["radial"] ** 2 if "radial" in joint else np.sum(joint["force"] ** 2, axis=1)
    return squared


def compute_rounding(values: Array, names: Sequence[str], size: float) -> list[float]:
    """Return the rounding level of the squares (n, m), per column, from the largest force; a moment is compared with
    that force times the size [m] too.
    """
    force = max(float(values[:, k].max()) for k, name in enumerate(names) if name not in MOMENTS)
    moment = max(force * size**2, *(float(values[:, k].max()) for k, name in enumerate(names) if name in MOMENTS))
    return [tolerances.ORDERS_SETTLED * tolerances.NO_SQUARE * (moment if name in MOMENTS else force) for name in names]


def compare_loads(
    spec: Spec, scene: PreparedScene, heavier: Mechanism, plan: CyclePlan, reference_point: Array
) -> tuple[dict[str, CycleLoad], dict[str, CycleLoad], tuple[str, ...]]:
    """Return the loads without and with the counterweights, and the notes of both runs.

    heavier: the mechanism that includes them
    """
    rate = plan.rate or 1.0
    mechanisms: Sequence[Mechanism] = (scene.mechanism, heavier)
    (before, notes), (after, more) = (
        compute_cycle_loads(make_loaded_scene(spec, scene, mechanism, plan, rate), plan, reference_point)
        for mechanism in mechanisms
    )
    return before, after, (*notes, *more)
