"""Published mechanisms assemble: Andrews (A03) and Bricard (A04) of manual/references.md."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.model import Mechanism
from tests.oracle.published import START, andrews_angles
from tests.shared.drafted_mechanisms import X, Y, Z, body, joint, largest_gap, largest_rate_gap, point, scene, turned
from tests.shared.published import printed_values

ANGLES = andrews_angles(START)
B = ANGLES["K1"]
CENTRES = {
    "K1": (0.00092, 0, 0),
    "K2": (-0.0115, 0, 0),
    "K3": (0.01043, -0.01874, 0),
    "K4": (0, -0.00579, 0),
    "K5": (0.02308, 0.00916, 0),
    "K6": (0.00579, 0, 0),
    "K7": (-0.00449, -0.01228, 0),
}
O, A3, B3 = (0, 0, 0), (-0.06934, -0.00227, 0), (-0.03635, 0.03273, 0)
PINS = [
    ("O", "ground", O, "K1", O),
    ("F", "K1", (0.007, 0, 0), "K2", O),
    ("E2", "K2", (-0.028, 0, 0), "K3", (0, -0.035, 0)),
    ("B", "ground", B3, "K3", O),
    ("E4", "K4", (0, -0.02, 0), "K3", (0, -0.035, 0)),
    ("G", "K5", (0.04, 0, 0), "K4", O),
    ("A5", "ground", A3, "K5", O),
    ("E6", "K6", (0.02, 0, 0), "K3", (0, -0.035, 0)),
    ("H", "K7", (0, -0.04, 0), "K6", O),
    ("A7", "ground", A3, "K7", O),
]


def andrews(near: float | None, **crank: Any) -> Mechanism:
    """near: how far (rad) the drawn attitudes are from the true ones; None: all drawn along the world's axes."""
    off = np.random.default_rng(7).normal(size=len(ANGLES))
    bodies = [
        body(name, CENTRES[name], near_rotation=None if near is None else turned(Z, np.degrees(angle + near * d)))
        for (name, angle), d in zip(ANGLES.items(), off, strict=True)
    ]
    return scene(bodies, [joint(n, "pin", a, p, b, q, **(crank if n == "O" else {})) for n, a, p, b, q in PINS])


@pytest.mark.parametrize("near", [0.0, 1e-6, 0.01, 0.1, 0.3, None])
def test_andrews_mechanism_from_its_crank_angle(near: float | None) -> None:
    s = andrews(near, angle=B)
    a = assemble(s)
    found = np.arctan2(a.rotation[:, 1, 0], a.rotation[:, 0, 0])
    assert found == pytest.approx(list(ANGLES.values()), abs=1e-14)  # to the digits printed
    assert largest_gap(s, a) < 1e-15


def test_andrews_mechanism_turning() -> None:
    """At the start only F moves: K2 turns about E as the lengths 0.007 and 0.028 tell, all others rest."""
    s = andrews(0.0, angle=B, rate=100.0)
    a = assemble(s)
    assert a.angular_velocity[:2, 2] == pytest.approx([100.0, 25.0], abs=1e-9)
    assert a.angular_velocity[2:] == pytest.approx(0.0, abs=1e-9)
    assert largest_rate_gap(s, a) < 1e-5


POINTS = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)]


def bricard(**crank: Any) -> Mechanism:
    """Drawn in world coordinates at the published start."""
    ends = ["ground", "r0", "r1", "r2", "r3", "r4", "ground"]
    axes = [Y, Z, X, Y, Z, X]
    bodies = [body(f"r{i}", np.add(POINTS[i], POINTS[i + 1]) / 2.0) for i in range(5)]
    pins = [joint(f"P{i}", "pin", ends[i], POINTS[i], ends[i + 1], POINTS[i], axes[i]) for i in range(6)]
    return scene(bodies, [pins[0] | crank, *pins[1:]])


def test_bricard_is_drawn_closed() -> None:
    a = assemble(bricard())
    assert np.all(a.position == 0.0)
    assert np.all(a.rotation == np.eye(3))


TURNING = (0.2, 0.4, 0.6, 0.8, 1.0, 1.2)


@pytest.mark.heavy
@pytest.mark.parametrize("time", TURNING)
@pytest.mark.third
def test_bricard_set_by_its_crank(time: float) -> None:
    """The crank angle that brings the hinge's x where it was printed brings y and z there too; rates fit."""
    printed = printed_values("bricard")
    hinge = [printed[f"points.r2.P2.position.{axis}", time] for axis in "xyz"]
    rate = printed["coordinates.P0.rate", time]
    low, high = 0.0, 2.0  # x falls while the crank turns
    for _ in range(32):
        middle = 0.5 * (low + high)
        s = bricard(angle=middle)
        if point(s, assemble(s), "r1", (1, -1, 0))[0] > hinge[0]:
            low = middle
        else:
            high = middle
    s = bricard(angle=low, rate=rate)
    a = assemble(s)
    assert point(s, a, "r1", (1, -1, 0)) == pytest.approx(hinge, abs=3e-9)  # nine digits printed
    assert largest_gap(s, a) < 1e-14
    assert a.angular_velocity[0] == pytest.approx([0, rate, 0], abs=1e-14)
    assert largest_rate_gap(s, a) < 1e-8
