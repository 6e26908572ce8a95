"""Find the requested counterweights of a scene: mass times radius and angle for the least force and moment.

The effect of a weight is linear in its moments and depends on the angles of the cycle only; counterweight_fit.py solves
for the products U, which lie across the axis that the body turns about.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.analyses.balancing.counterweight_fit import Candidate, WeightPlace, solve_products
from heuncli.analyses.balancing.cycle import Cycle, compute_mass_effects, find_cycle_axis, make_followed_scene
from heuncli.analyses.balancing.cycle_plan import CyclePlan
from heuncli.analyses.balancing.loaded_scene import compare_loads
from heuncli.analyses.balancing.orders import CycleRotation, compute_rounding, format_remaining_orders, make_all_rows
from heuncli.analyses.balancing.results import BalanceOptions, Counterbalance, CounterweightResult, WeightRequest
from heuncli.analyses.balancing.sampling import sample_cycle
from heuncli.analyses.balancing.series import make_plane_directions
from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.linear_algebra import solve_least_squares
from heuncli.base.records import record, replace
from heuncli.base.spelling import suggest
from heuncli.multibody.mechanism.model import Body, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.shapes.inertia import assemble_pseudo_inertia, pseudo_inertia, split_pseudo_inertia
from heuncli.scene.shapes.rotations import cross_rows


@record
class Counterweight:
    """A counterweight in the axes of its body.

    weight_place: the point from which it is measured
    product (3,) [kg m]: mass · radius, across the axis
    reference_direction (3,): the direction from which `angle` is counted
    """

    weight_place: WeightPlace
    product: Array
    mass: float
    radius: float
    angle: float
    reference_direction: Array

    @property
    def position(self) -> Array:
        """The position of the weight's mass, body axes (3,) [m]."""
        size = float(np.sqrt(self.product @ self.product))
        return self.weight_place.point + (self.radius / size) * self.product if size > 0.0 else self.weight_place.point


@record
class CounterweightSolution:
    """The counterweights of a solution.

    several: whether other weights would serve as well; these are the smallest
    linear: whether one linear system determined them
    """

    weights: tuple[Counterweight, ...]
    several: bool
    linear: bool


def find_least_weights(
    cycle: Cycle, places: Sequence[WeightPlace], reference_point: Array, force: float, moment: float
) -> CounterweightSolution:
    """Find the weights with the least mean of |force F|² + |moment M|² over the cycle.

    force, moment [1/m]: the factors of force and moment in that sum
    """
    effects = compute_mass_effects(cycle, reference_point)
    row_factors = np.repeat([force, moment], 3)
    # weighted mean of squares as a mean over rows
    mean_factors = np.sqrt(cycle.nodes.weights * len(cycle.nodes.weights))
    row_factors = mean_factors[:, None] * row_factors
    unbalanced = -np.concatenate([effects.force.sum(axis=1), effects.moment.sum(axis=1)], axis=1) * row_factors
    largest_effect = max(force, moment * (cycle.size + float(np.abs(reference_point - cycle.states.centre).max())))
    candidates = [make_candidate(cycle, place, reference_point, row_factors) for place in places]
    linear = [one.is_linear(largest_effect) for one in candidates]
    require_radii([one for one, is_linear in zip(candidates, linear, strict=True) if not is_linear])
    U, several = solve_products(unbalanced, candidates, linear, largest_effect)
    weights = tuple(make_weight(candidate, product) for candidate, product in zip(candidates, U, strict=True))
    return CounterweightSolution(weights, several, all(linear))


def require_radii(candidates: Sequence[Candidate]) -> None:
    """Raise SolveError [radius-needed] if a weight's own mass matters and its radius was not given."""
    missing = [one.weight_place.name for one in candidates if one.weight_place.radius is None]
    if missing:
        raise SolveError(*(
            Problem("radius-needed", f"{name}: the effect of a weight there also depends on its radius",
                    hint=f"give its radius: --counterweight {name}:radius=50mm")
            for name in missing
        ))  # fmt: skip


def make_candidate(cycle: Cycle, weight_place: WeightPlace, reference_point: Array, factors: Array) -> Candidate:
    """Return a place with the responses to a weight there. Raises SolveError if its body has no single axis of
    rotation.
    """
    states = cycle.states
    axis = find_rotation_axis(cycle, weight_place)
    first_direction, second_direction = make_plane_directions(axis)
    plane_directions = np.stack([first_direction, second_direction], axis=1)
    radius = (
        weight_place.radius
        if weight_place.radius is not None
        else find_default_radius(cycle.mechanism, weight_place, axis)
    )
    R, w, al = (getattr(states, name)[:, weight_place.body] for name in ("R", "omega", "alpha"))
    place = project_on_axis(cycle, weight_place, axis)
    x = states.x[:, weight_place.body] + R @ place - reference_point
    arm = R @ place
    a = states.a[:, weight_place.body] + cross_rows(al, arm) + cross_rows(w, cross_rows(w, arm))
    world_directions = np.einsum("tij,jk->tki", R, plane_directions)  # (n, 2, 3): the directions in the world
    direction_accelerations = np.stack(
        [cross_rows(al, e) + cross_rows(w, cross_rows(w, e)) for e in np.moveaxis(world_directions, 1, 0)], axis=1
    )
    by_mass = -np.concatenate([a, cross_rows(x, a)], axis=1)
    moment = cross_rows(world_directions, np.broadcast_to(a[:, None], world_directions.shape)) + cross_rows(
        np.broadcast_to(x[:, None], direction_accelerations.shape), direction_accelerations
    )
    by_product = -np.moveaxis(np.concatenate([direction_accelerations, moment], axis=2), 1, 2)
    square = np.zeros((len(x), 6, 2, 2))
    for i in range(2):
        for j in range(2):
            pair_moments = cross_rows(world_directions[:, i], direction_accelerations[:, j]) + cross_rows(
                world_directions[:, j], direction_accelerations[:, i]
            )
            square[:, 3:, i, j] = -0.5 * pair_moments
    return Candidate(
        replace(weight_place, point=place), radius, plane_directions,
        (by_mass * factors).ravel(), (by_product * factors[:, :, None]).reshape(-1, 2),
        (square * factors[:, :, None, None]).reshape(-1, 2, 2),
    )  # fmt: skip


def find_rotation_axis(cycle: Cycle, weight_place: WeightPlace) -> Array:
    """Return the direction, body axes (3,), about which a body turns at all times. Raises SolveError [no-counterweight]
    if there is none.
    """
    rotations = np.einsum("tji,tj->ti", cycle.states.R[:, weight_place.body], cycle.states.omega[:, weight_place.body])
    _, sizes, directions = np.linalg.svd(rotations, full_matrices=False)
    name = cycle.mechanism.bodies[weight_place.body].name
    if sizes[0] <= tolerances.SAME_VALUE * math.sqrt(len(rotations)):
        message = f"bodies.{name} does not rotate: a weight on it only adds to the reciprocating mass"
        raise SolveError(Problem("no-counterweight", message, hint="name a point of a crank or a coupler"))
    if sizes[1] > tolerances.PARALLEL * sizes[0]:
        message = f"bodies.{name} does not rotate about one body-fixed axis: the plane of its weight is undefined"
        raise SolveError(
            Problem("no-counterweight", message, hint="name a point of a body that rotates about one axis")
        )
    axis = directions[0]
    return np.asarray(axis if axis[np.argmax(np.abs(axis))] > 0.0 else -axis)


def project_on_axis(cycle: Cycle, weight_place: WeightPlace, axis: Array) -> Array:
    """Return the point from which a weight is measured: for a body with a fixed axis the axis point level with the
    place, else the place.
    """
    axis_point = find_fixed_point(cycle, weight_place.body)
    return weight_place.point if axis_point is None else axis_point + (axis @ (weight_place.point - axis_point)) * axis


def find_fixed_point(cycle: Cycle, body: int) -> Array | None:
    """Return a point of the body, body axes (3,), that does not move; None if there is none."""
    states = cycle.states
    R, w = states.R[:, body], states.omega[:, body]
    local = np.einsum("tji,tj->ti", R, w)
    cross_matrices = np.zeros((len(local), 3, 3))
    cross_matrices[:, 0, 1], cross_matrices[:, 0, 2], cross_matrices[:, 1, 2] = -local[:, 2], local[:, 1], -local[:, 0]
    cross_matrices -= np.swapaxes(cross_matrices, 1, 2)
    v = np.einsum("tji,tj->ti", R, states.v[:, body])
    point = solve_least_squares(cross_matrices.reshape(-1, 3), -v.ravel(), tolerances.PARALLEL)
    residual = np.abs(v + cross_matrices @ point).max()
    scale = np.abs(states.v).max() + np.abs(v).max()
    return point if residual <= tolerances.SAME_VALUE * scale else None


def find_default_radius(mechanism: Mechanism, weight_place: WeightPlace, axis: Array) -> float:
    """Return the radius of a weight for which none was given: the distance of the body's farthest joint from its axis
    [m].

    Raises SolveError [radius-needed] if all joints lie on the axis.
    """
    body = mechanism.bodies[weight_place.body]
    ends = [joint.p for joint in mechanism.joints if joint.a == weight_place.body]
    ends += [joint.q for joint in mechanism.joints if joint.b == weight_place.body]
    arms = [end - weight_place.point for end in [*ends, body.center]]
    distance = max((float(np.linalg.norm(arm - (axis @ arm) * axis)) for arm in arms), default=0.0)
    if distance <= tolerances.PARALLEL:
        hint = f"for example --counterweight {weight_place.name}:radius=50mm"
        raise SolveError(
            Problem("radius-needed", f"{weight_place.name}: the radius of the weight is not known", hint=hint)
        )
    return distance


def make_weight(place_candidate: Candidate, U: Array) -> Counterweight:
    """Return a counterweight of product U (2,) along the two directions of the place."""
    product = place_candidate.plane_directions @ U
    size = math.sqrt(float(U @ U))
    angle = math.atan2(U[1], U[0])
    angle = abs(angle) if math.pi - abs(angle) <= tolerances.WRITTEN else angle  # and not minus a half turn
    return Counterweight(
        place_candidate.weight_place,
        product,
        size / place_candidate.radius,
        place_candidate.radius,
        angle,
        place_candidate.plane_directions[:, 0],
    )


def add_weights(mechanism: Mechanism, weights: Sequence[Counterweight]) -> Mechanism:
    """Return the mechanism with the weights as point masses of their bodies."""
    bodies = list(mechanism.bodies)
    for weight in weights:
        bodies[weight.weight_place.body] = add_point_mass(bodies[weight.weight_place.body], weight)
    return replace(mechanism, bodies=tuple(bodies))


def add_point_mass(body: Body, weight: Counterweight) -> Body:
    """Return a body with a weight added as a point mass."""
    p = weight.position
    P = pseudo_inertia(body.mass, body.center, body.inertia)
    P = P + assemble_pseudo_inertia(np.array(weight.mass), weight.mass * p, weight.mass * np.outer(p, p))
    mass, center, inertia = split_pseudo_inertia(P)
    heavier: Body = replace(body, mass=mass, center=center, inertia=inertia)
    return heavier


def find_counterbalance(
    spec: Spec, scene: PreparedScene, plan: CyclePlan, cycle: Cycle, reference_point: Array, options: BalanceOptions
) -> Counterbalance:
    """Find the requested counterweights. Raises SolveError [no-counterweight, radius-needed]."""
    places = [find_place(scene.mechanism, weight) for weight in options.weights]
    objective = options.minimise or ("mix" if len({place.body for place in places}) < len(places) else "force")
    lever = options.lever if options.lever is not None else scene.layout.size
    parts = {"force": (1.0, 0.0), "moment": (0.0, 1.0), "mix": (1.0, 1.0 / lever)}[objective]
    solution = find_least_weights(cycle, places, reference_point, *parts)
    heavier = add_weights(scene.mechanism, solution.weights)
    heavier_cycle = sample_cycle(make_followed_scene(replace(scene, mechanism=heavier), plan), reference_point)[0]
    effects, rotation = (
        compute_mass_effects(heavier_cycle, reference_point),
        CycleRotation(plan.turns, find_cycle_axis(cycle, plan.joint), plan.rate),
    )
    rows = make_all_rows(effects, rotation, compute_rounding(effects, rotation.scale))
    before, after, notes = compare_loads(spec, scene, heavier, plan, reference_point)
    return Counterbalance(
        weights=tuple(to_result(weight) for weight in solution.weights),
        objective=objective,
        lever=lever if objective == "mix" else None,
        several=solution.several,
        orders=rows,
        summaries={name: format_remaining_orders(of_kind) for name, of_kind in rows.items()},
        loads_without=before,
        loads_with=after,
        notes=notes,
    )


def find_place(mechanism: Mechanism, weight: WeightRequest) -> WeightPlace:
    """Find a place by the names of its body and point. Raises SolveError [no-counterweight]."""
    names = [body.name for body in mechanism.bodies]
    option = f"--counterweight {weight.body}.{weight.point}"
    if weight.body not in names:
        hint = suggest(weight.body, names, "bodies")
        raise SolveError(Problem("no-counterweight", f"{option}: no body has this name", hint=hint))
    k = names.index(weight.body)
    points = mechanism.bodies[k].points
    if weight.point not in points:
        hint = suggest(weight.point, [*points], f"points of {weight.body}")
        raise SolveError(Problem("no-counterweight", f"{option}: the body has no such point", hint=hint))
    return WeightPlace(k, f"{weight.body}.{weight.point}", np.array(points[weight.point]), weight.radius)


def to_result(weight: Counterweight) -> CounterweightResult:
    """Convert a counterweight to its result, with the names of body and point."""
    body, _, place = weight.weight_place.name.partition(".")
    product = math.sqrt(float(weight.product @ weight.product))
    return CounterweightResult(
        body=body, place=place, product=product, angle=weight.angle, mass=weight.mass, radius=weight.radius,
        vector=weight.product, reference_direction=weight.reference_direction, position=weight.position,
    )  # fmt: skip
