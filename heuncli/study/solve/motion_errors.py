"""Collect the differences of a motion and its energy between runs: of bodies, momenta, attitudes, travels.

load_errors.py adds those of loads. Momenta and energies have no error in common with positions. A small body in a large
scene may turn by far more than its position errors suggest; orbital and spin moments of momentum may have opposite
errors.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, reduce

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.loads.kinetostatics.balance import energy_block, system_vector
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.loads.kinetostatics.foundation import find_momenta
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Mechanism, extent_points
from heuncli.results.path_words import TRAVELS
from heuncli.results.results import Array
from heuncli.study.model.setup import Setup
from heuncli.study.solve.error_estimates import ESTIMATED, ErrorEstimates, Weights, compute_norms


class MotionErrors(ErrorEstimates):
    """The differences of a motion and its energy between runs.

    is_requested, is_claimed (n,): which of the instants that are being added are requested, and which are before the
    horizon
    """

    def __init__(self, setup: Setup, weights: Weights = ESTIMATED) -> None:
        super().__init__(setup, weights)
        self.is_requested = self.is_claimed = np.zeros(0, dtype=bool)

    def add_values(
        self, name: tuple[str, str], values: Array, rounding: Array, terms: Array, extra_difference: Array | None = None
    ) -> None:
        """Add instants of a quantity: see `Extent.add`."""
        self.find_extent(*name).add(values, rounding, terms, (self.is_requested, self.is_claimed), extra_difference)

    def add_motion(self, solutions: Evaluation, states: BodyStates) -> None:
        """Add velocities and accelerations of the bodies, and of points as far from their centres as they reach.

        Also the momenta, system vectors and attitudes, if the motion is requested.
        """
        count = len(states.omega) // len(self.is_requested)

        def find_differences(values: Array) -> Array:
            """Return the largest difference of the first run's vectors from those of the other runs, (n, b)."""
            own = values[0::count]
            return reduce(np.maximum, [compute_norms(own - values[k::count]) for k in range(1, count)])

        omega_difference, alpha_difference = find_differences(states.omega), find_differences(states.alpha)
        centripetal = 2.0 * compute_norms(states.omega[0::count]) * omega_difference
        for unit, difference in (
            ("rad/s", omega_difference),
            ("rad/s²", alpha_difference),
            ("m/s", find_differences(states.v_centre) + omega_difference * self.reaches),
            ("m/s²", find_differences(states.a_centre) + (alpha_difference + centripetal) * self.reaches),
        ):
            self.find_extent("motion", unit).add_difference(difference.max(axis=1), self.is_claimed)
        if any(JOINTS[joint.kind].follows_path for joint in self.setup.scene.mechanism.joints):
            self.add_travels(solutions, states)
        if "motion" in self.setup.selection.reports:
            turned, vectors = compare_attitudes(states.R, count)
            self.find_extent("attitudes", "1").add_difference(turned, self.is_claimed)
            self.find_extent("rodrigues", "1").add_difference(
                vectors[self.is_requested], self.is_claimed[self.is_requested]
            )
            zeros = np.zeros(len(states.R))
            for unit, values, rounding in iter_momentum_quantities(
                self.setup.scene.mechanism, states, self.setup.moment_point
            ):
                self.add_values(("motion", unit), values, rounding, zeros)

    def add_travels(self, solutions: Evaluation, states: BodyStates) -> None:
        """Add travels, some of them along paths: in the parameter of the path's table, which need not be its length."""
        zeros = np.zeros(len(solutions.times))
        for own in evaluate_joint_coordinates(self.setup.scene.layout, solutions, states).values():
            if "travel" in own:
                for name, unit in zip(TRAVELS, ("m", "m/s", "m/s²"), strict=True):
                    self.add_values(("travels", unit), own[name], zeros, zeros)

    @cached_property
    def reaches(self) -> Array:
        """The largest distance of each body's marks from its centre of mass, (b,) [m]."""
        bodies = self.setup.scene.mechanism.bodies
        far = [max(float(np.sum(np.square(p - body.center))) for p in extent_points(body)) for body in bodies]
        return np.asarray(np.sqrt(far))

    def add_energy(self, solutions: Evaluation, states: BodyStates) -> None:
        """Add kinetic and potential energy, and work."""
        block = energy_block(self.setup.scene.layout, solutions, states)
        m = np.array([b.mass for b in self.setup.scene.mechanism.bodies])
        speed = np.abs(states.v_centre).max(axis=(1, 2))
        lift = np.abs(states.centre @ self.setup.scene.mechanism.gravity) @ m
        rounding = tolerances.SUM_ROUNDING * (block["kinetic"] + m.sum() * speed**2)
        zeros = np.zeros(len(solutions.times))
        self.add_values(("energy", "kinetic"), block["kinetic"], rounding, zeros)
        self.add_values(("energy", "potential"), block["potential"], tolerances.SUM_ROUNDING * lift, zeros)
        self.add_values(("energy", "work"), block["work"], zeros, zeros)


def iter_momentum_quantities(
    mechanism: Mechanism, states: BodyStates, moment_point: Array
) -> Iterator[tuple[str, Array, Array]]:
    """Yield by unit the values of the bodies and the sums over them (n_t, m, 3), and the rounding (n_t,)."""
    body_momenta, vector = find_momenta(mechanism, states, moment_point), system_vector(mechanism, states)
    body_vectors = [np.stack([*own.values()], axis=1) for own in vector.values() if isinstance(own, dict)]
    for unit, parts, totals in (
        ("N·s", (body_momenta.linear,), ()),
        ("N·m·s", (body_momenta.orbital, body_momenta.spin), (body_momenta.orbital + body_momenta.spin,)),
        ("N·m/s", body_vectors, ()),
    ):
        sums = [part.sum(axis=1, keepdims=True) for part in parts]
        rounding = tolerances.SUM_ROUNDING * sum(compute_norms(part).sum(axis=1) for part in parts)
        yield unit, np.concatenate([*(totals or parts), *sums], axis=1), np.asarray(rounding)


def compare_attitudes(R: Array, count: int) -> tuple[Array, Array]:
    """Return how far the attitudes of `count` runs, instant by instant, lie from the first's, and their Rodrigues'
    vectors, (n,).

    Columns of two attitudes an angle d apart differ by at most 2 sin(d/2), 1/√2 of the root of squares of all elements.
    For rho = tan(half the turn) that makes (1 + rho^2) d/2, where 1 + rho^2 = 4 / (1 + tr R); near half a turn no
    vector is compared.
    """
    first_run = R[0::count]
    others = [np.sqrt(0.5 * np.square(first_run - R[k::count]).sum(axis=(2, 3))) for k in range(1, count)]
    distances = reduce(np.maximum, others)
    trace = 1.0 + np.trace(first_run, axis1=2, axis2=3)
    is_defined = trace > 4.0 * tolerances.HALF_TURN**2
    vectors = 2.0 * distances / np.where(is_defined, trace, 1.0) * is_defined
    return distances.max(axis=1), vectors.max(axis=1)
