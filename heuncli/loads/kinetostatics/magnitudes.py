"""How large that is what the numbers of a run are summed from: their rounding is relative to it.

The inertia loads of a body's pieces may be large where their resultant vanishes, as in a rotor that spins about its
centre. Over the mass points m at r from the centre of mass, by Cauchy and Schwarz,

    Σ m |σ × (σ × r)| ≤ |σ| √(m σ·I σ),   Σ m |σ̇ × r| ≤ √(m σ̇·I σ̇)

Their moments are at most so much times the radius of gyration.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.results.results import Array, Block, Magnitudes
from heuncli.scene.shapes.by_component import form, instants_first, squares


def inertia_scale(mechanism: Mechanism, states: BodyStates) -> Array:
    """Largest inertia load or weight of each body, its pieces' included, (n_t, n) [N]."""
    m = np.array([body.mass for body in mechanism.bodies])
    w, u = states.turning
    spinning, turning = (_energy_like(mechanism, x) for x in (w, u))
    pieces = np.sqrt(m)[:, None] * (np.sqrt(squares(w)) * spinning + turning)
    whole = m[:, None] * np.sqrt(squares(states.rows_of("a_centre")))
    weight = m * float(np.sqrt(np.sum(np.square(mechanism.gravity))))
    return instants_first(np.maximum(np.maximum(pieces, whole), weight[:, None]))


def _energy_like(mechanism: Mechanism, x: Array) -> Array:
    """√(x·I x) of every body, (n, n_t), x in body axes by component."""
    inertia = np.array([body.inertia for body in mechanism.bodies])
    return np.asarray(np.sqrt(np.maximum(form(x, inertia), 0.0)))


def magnitudes(
    mechanism: Mechanism, states: BodyStates, inertia: Array, actions: Sequence[Action], energy: Block, size: float
) -> Magnitudes:
    """The magnitudes at these instants; actions: of applied loads and of joints with their drives.

    inertia: the largest inertia load of each body (`inertia_scale`).
    energy: kinetic, potential, work; empty where nobody asks for it.
    """
    g = float(np.sqrt(np.sum(np.square(mechanism.gravity))))
    mass = [body.mass for body in mechanism.bodies]
    own = magnitudes_of_loads(states, inertia, actions, size)
    force = own.by_unit["N"]
    pushed = 0.0  # acceleration that an applied load alone would give
    for action in actions:
        if action.kind == "load" and (action.from_ is None or action.from_.body != action.to.body):
            acting = max(_largest(action.force), _largest(action.moment) / size)
            pushed = max(
                pushed, *(acting / mass[end.body] for end, *_ in action.on_bodies() if end.body != GROUND), 0.0
            )
    spin, v = _largest(states.omega), max(_largest(states.v_centre), size * _largest(states.omega))
    a = max(_largest(states.a_centre), size * spin**2, size * _largest(states.alpha))
    acceleration = max(g, pushed, a)
    turning = acceleration / _least_gyration(mechanism, size)
    speed = max(v, float(np.sqrt(size * acceleration)))
    by_unit = {
        **own.by_unit,
        "m/s": speed, "m/s²": acceleration,
        "rad": 1.0, "rad/s": max(spin, float(np.sqrt(turning))), "rad/s²": turning,
        "W": force * speed,
        "J": max([sum(mass) * g * size, *map(_largest, energy.values())]),
    }  # fmt: skip
    return own._replace(by_unit=by_unit)


def magnitudes_of_loads(states: BodyStates, inertia: Array, actions: Sequence[Action], size: float) -> Magnitudes:
    """As much of the magnitudes as errors of loads hang on: lengths, forces, moments."""
    acting = (max(_largest(action.force), _largest(action.moment) / size) for action in actions)
    force = max(_largest(inertia), *acting, 0.0)
    return Magnitudes({"m": size, "N": force, "N·m": force * size}, size, _largest(states.x), {})


def _least_gyration(mechanism: Mechanism, size: float) -> float:
    """The smallest radius of gyration of a body that is no point mass; the scene's size where there is none [m]."""
    squares = [float(np.trace(body.inertia)) / (2.0 * body.mass) for body in mechanism.bodies]
    return min((x**0.5 for x in squares if x > tolerances.POINT_MASS * size**2), default=size)


def _largest(values: Array) -> float:
    """The largest magnitude; what is open has none."""
    found = float(np.abs(values).max(initial=0.0))
    return found if found == found else float(np.nanmax(np.abs(values), initial=0.0))
