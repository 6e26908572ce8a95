"""Wheels and balls that roll, against closed forms: slopes, steady circles, the turntable, the sleigh, carts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from tests.shared.scenes import near, solved

G = 9.81
DISC = "{mass: 2, center: [0, 0, 0], inertia: [0.0225, 0.045, 0.0225]"  # radius 0.3
DIGITS = 1e-8  # of runs at the default tolerance


def scene(bodies: str, rolling: str, rest: str = "", gravity: str = "[0, 0, -9.81]") -> str:
    """A scene on the ground's plane through O."""
    return f"""
heun: 1
gravity: {gravity}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  {bodies}
rolling:
  {rolling}
{rest}
"""


def disc(placed: str) -> str:
    """A homogeneous disc about its body's y axis."""
    return f"disc: {DISC}, points: {{c: [0, 0, 0]}}, {placed}}}"


RIM = "rim: {wheel: disc.c, axis: [0, 1, 0], radius: 0.3, on: ground.O, normal: [0, 0, 1]}"


def test_a_disc_rolls_down_a_slope() -> None:
    """a = g sin / (1 + J / m R^2); the plane presses with m g cos, and holds with m g sin - m a."""
    slope = 0.2
    gravity = f"[{G * np.sin(slope)}, 0, {-G * np.cos(slope)}]"
    r = solved(scene(disc("position: [0, 0, 0.3]"), RIM, "analysis: {duration: 2, samples: 5}", gravity))
    a = G * np.sin(slope) / 1.25
    assert r.bodies["disc"]["center"][:, 0] == pytest.approx(0.5 * a * r.time**2, abs=DIGITS)
    assert r.bodies["disc"]["angular_velocity"][:, 1] == pytest.approx(a * r.time / 0.3, abs=DIGITS)
    on = r.couplings["rim"]["on"]["disc"]
    wanted = [2 * a - 2 * G * np.sin(slope), 0.0, 2 * G * np.cos(slope)]
    near(on["force"], np.broadcast_to(wanted, (5, 3)), 20.0)
    near(on["point"][:, 2], 0.0, 1.0)


def steady_circle(tilt: float, precession: float) -> tuple[str, Array, float]:
    """Euler's: a disc that rolls on a circle at a constant tilt; the scene, the circle's centre and radius.

    About the centre of mass dL/dt = W z x L of the spin w that makes it equal to the moment of the contact's force.
    """
    m, R, A, C = 2.0, 0.3, 0.0225, 0.045
    s, c = np.sin(tilt), np.cos(tilt)
    k, u, z = np.array([0, c, s]), np.array([0, -s, c]), np.array([0.0, 0, 1])
    t = np.cross(k, u)

    def left(w: float) -> float:
        force = m * np.cross(precession * z, w * R * t) + m * G * z
        momentum = C * w * k + A * precession * c * u
        return float(t @ (np.cross(precession * z, momentum) - np.cross(-R * u, force)))

    w = -left(0.0) / (left(1.0) - left(0.0))
    v, omega = w * R * t, w * k + precession * c * u
    attitude = np.column_stack([t, k, np.cross(t, k)]).tolist()
    placed = f"position: {(R * u).tolist()}, orientation: {{matrix: {attitude}}}"
    placed += f", velocity: {v.tolist()}, angular_velocity: {omega.tolist()}"
    centre = R * u + np.cross(z, v) / precession
    return scene(disc(placed), RIM, "analysis: {duration: 4, samples: 9}"), centre, float(np.sqrt(v @ v) / precession)


@pytest.mark.parametrize(("tilt", "precession"), [(0.4, 3.0), (1.2, 4.0)])
def test_euler_steady_circles(tilt: float, precession: float) -> None:
    """The tilt stays, the centre goes round a circle, the plane presses with the weight and holds it on the circle."""
    text, centre, radius = steady_circle(tilt, precession)
    r = solved(text)
    body = r.bodies["disc"]
    assert body["rotation"][:, 2, 1] == pytest.approx(np.full(9, np.sin(tilt)), abs=DIGITS)
    away = body["center"] - centre
    assert np.sqrt(np.sum(away**2, axis=1)) == pytest.approx(np.full(9, radius), abs=DIGITS)
    force = r.couplings["rim"]["on"]["disc"]["force"]
    near(force, -2.0 * precession**2 * away * [1, 1, 0] + [0, 0, 2.0 * G], 20.0, DIGITS)
    assert r.accuracy["energy_drift"] < 1e-9


BALL = "ball: {{mass: 3, center: [0, 0, 0], inertia: [0.012, 0.012, 0.012], points: {{c: [0, 0, 0]}}, {}}}"


def test_a_ball_on_a_turntable_goes_round_slower() -> None:
    """A homogeneous ball, J = 2/5 m r^2, circles at 2/7 of the table's speed, wherever it starts."""
    turns, r0, v0 = 4.0, np.array([0.5, 0.2]), np.array([0.3, -0.1])
    # at the contact v_x - omega_y-part: v + omega x (-r z) = Omega z x x
    table = np.array([-turns * r0[1], turns * r0[0]])
    slip = v0 - table
    omega = [float(-slip[1] / 0.1), float(slip[0] / 0.1), 0.0]
    placed = f"position: [{r0[0]}, {r0[1]}, 0.1], velocity: [{v0[0]}, {v0[1]}, 0], angular_velocity: {omega}"
    text = scene(
        BALL.format(placed) + "\n  table: {mass: 5, center: [0, 0, 0], inertia: [1, 1, 2], points: {O: [0, 0, 0]}}",
        "foot: {wheel: ball.c, shape: sphere, radius: 0.1, on: table.O, normal: [0, 0, 1]}",
        f"joints: {{spindle: {{type: pin, from: ground.O, to: table.O, axis: [0, 0, 1]}}}}\n"
        f"drives: {{motor: {{joint: spindle, rate: {turns}}}}}\nanalysis: {{duration: 3, samples: 7}}",
    )
    r = solved(text)
    orbit = turns * 2.0 / 7.0
    centre = r0 - np.array([v0[1], -v0[0]]) / orbit
    arm = r0 - centre
    cos, sin = np.cos(orbit * r.time), np.sin(orbit * r.time)
    found = r.bodies["ball"]["center"][:, :2]
    wanted = centre + np.stack([cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]], axis=1)
    near(found, wanted, 1.0, 1e-8)


def test_a_ball_rolls_straight_down_a_slope() -> None:
    """a = 5/7 g sin: friction 2/7 m g sin."""
    gravity = f"[{G * np.sin(0.3)}, 0, {-G * np.cos(0.3)}]"
    foot = "foot: {wheel: ball.c, shape: sphere, radius: 0.1, on: ground.O, normal: [0, 0, 1]}"
    r = solved(scene(BALL.format("position: [0, 0, 0.1]"), foot, "analysis: {duration: 1, samples: 3}", gravity))
    assert r.bodies["ball"]["center"][-1, 0] == pytest.approx(0.5 * 5 / 7 * G * np.sin(0.3), abs=DIGITS)
    near(r.couplings["foot"]["on"]["ball"]["force"][:, 0], -2 / 7 * 3 * G * np.sin(0.3), 10.0)


SLEIGH = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  sleigh:
    mass: 4
    center: [0.5, 0, 0]
    inertia: [0.7, 0.7, 1.2]
    points: {knife: [0, 0, 0.2], a: [1, 0.5, 0], b: [1, -0.5, 0]}
    velocity: [0.6, 0, 0]
    angular_velocity: [0, 0, 1.5]
rolling:
  edge: {wheel: sleigh.knife, axis: [0, 1, 0], radius: 0.2, on: ground.O, normal: [0, 0, 1], slides: along, held: true}
joints:
  left: {type: plane, from: ground.O, to: sleigh.a, normal: [0, 0, 1]}
  right: {type: plane, from: ground.O, to: sleigh.b, normal: [0, 0, 1]}
analysis: {duration: 3, samples: 13, tolerance: 1e-11}
"""


def test_the_sleigh_turns_until_it_follows_its_knife() -> None:
    """Chaplygin's sleigh, the centre of mass at a = 0.5 before the edge:  v' = a w^2,  w' = -a v w m / (J + m a^2).

    On the ellipse of its energy, v = V tanh, w = V / (q a) ... sech; the force aside is m (a w' + v w).
    """
    r = solved(SLEIGH)
    m, a, J = 4.0, 0.5, 1.2
    I = J + m * a * a
    # v^2 + (I/m) w^2 = V^2; with w = V sqrt(m/I) sech(s), v = V tanh(s), s' = V a m / I
    V = np.sqrt(0.6**2 + I / m * 1.5**2)
    s = np.arctanh(0.6 / V) + V * a * m / I * r.time
    w, v = V * np.sqrt(m / I) / np.cosh(s), V * np.tanh(s)
    assert r.bodies["sleigh"]["angular_velocity"][:, 2] == pytest.approx(w, abs=1e-9)
    forward = np.einsum("ti,ti->t", r.bodies["sleigh"]["rotation"][:, :, 0], r.bodies["sleigh"]["velocity"])
    assert forward == pytest.approx(v, abs=1e-9)
    side = r.bodies["sleigh"]["rotation"][:, :, 1]
    aside = np.einsum("ti,ti->t", side, r.couplings["edge"]["on"]["sleigh"]["force"])
    assert aside == pytest.approx(m * (-a * a * v * w * m / I + v * w), abs=1e-7)


def planar(text: str) -> Results:
    """A planar scene solved."""
    return solved(text.replace("heun: 1", "heun: 1\nspace: planar"))


def test_a_cylinder_on_a_plank_in_the_plane() -> None:
    """Pulled from under it at A, a homogeneous cylinder follows with A / 3."""
    text = """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  plank: {mass: 5, center: [0, 0, 0], inertia: 1, points: {top: [0, 0.1, 0], o: [0, 0, 0]}}
  roll: {mass: 2, center: [0, 0, 0], inertia: 0.01, points: {c: [0, 0, 0]}, position: [0, 0.2, 0]}
joints: {way: {type: slide, from: ground.O, to: plank.o, axis: [1, 0, 0]}}
drives: {pull: {joint: way, travel: "0.5*3*t**2"}}
rolling: {rim: {wheel: roll.c, radius: 0.1, on: plank.top, normal: [0, 1, 0]}}
analysis: {duration: 1, samples: 3}
"""
    r = planar(text)
    assert r.bodies["roll"]["center"][-1, 0] == pytest.approx(0.5, abs=DIGITS)
    near(r.couplings["rim"]["on"]["roll"]["force"], np.broadcast_to([2.0, 2 * G, 0], (3, 3)), 20.0)


def cart(torque: float, **other: Any) -> str:
    """A cart on two wheels in the plane: mass 10 at 0.5 m over the axles, which are 1 m apart, wheels 1 kg, 0.1 m."""
    wheel = "{{mass: 1, center: [0, 0, 0], inertia: 0.005, points: {{c: [0, 0, 0]}}, position: [{}, 0.1, 0]}}"
    return f"""
heun: 1
gravity: {other.get("gravity", "[0, -9.81, 0]")}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  frame: {{mass: 10, center: [0, 0.5, 0], inertia: 1, position: [0, 0.1, 0], {other.get("start", "")}
          points: {{r: [-0.5, 0, 0], f: [0.5, 0, 0]}}}}
  rear: {wheel.format(-0.5)}
  front: {wheel.format(0.5)}
joints:
  axle_r: {{type: pin, from: frame.r, to: rear.c, axis: [0, 0, 1]}}
  axle_f: {{type: pin, from: frame.f, to: front.c, axis: [0, 0, 1]}}
forces: {{brake: {{type: torque, joint: axle_f, value: {torque}}}}}
rolling:
  tyre_r: {{wheel: rear.c, radius: 0.1, on: ground.O, normal: [0, 1, 0]}}
  tyre_f: {{wheel: front.c, radius: 0.1, on: ground.O, normal: [0, 1, 0], friction: 0.8}}
analysis: {{duration: 1, samples: 3}}
"""


def test_a_cart_on_a_slope_has_its_wheels_to_turn() -> None:
    """a = M g sin / (M + 2 J / R^2), M all its mass."""
    slope = 0.1
    r = planar(cart(0.0, gravity=f"[{G * np.sin(slope)}, {-G * np.cos(slope)}, 0]"))
    a = 12 * G * np.sin(slope) / (12 + 2 * 0.005 / 0.01)
    assert r.bodies["frame"]["center"][-1, 0] == pytest.approx(0.5 * a, abs=DIGITS)


@pytest.mark.parametrize("torque", [-2.0, 3.0])
def test_torque_on_an_axle_moves_the_load_between_the_axles(torque: float) -> None:
    """(M + 2 J / R^2) a = -torque / R; moments about the rear contact give what the front wheel bears."""
    r = planar(cart(torque))
    a = -torque / 0.1 / (12 + 2 * 0.005 / 0.01)
    assert r.bodies["frame"]["center_acceleration"][:, 0] == pytest.approx(np.full(3, a), abs=1e-9)
    # about the rear contact: sum M = dL/dt, all wheels turn by -a / R
    momentum = -(10 * 0.6 * a + 2 * 1 * 0.1 * a) - 2 * 0.005 * a / 0.1
    front = (momentum + G * (10 * 0.5 + 1 * 1.0)) / 1.0
    near(r.couplings["tyre_f"]["on"]["front"]["force"][:, 1], np.full(3, front), 100.0)
    near(r.couplings["tyre_r"]["on"]["rear"]["force"][:, 1], np.full(3, 12 * G - front), 100.0)


ROBOT = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  frame: {mass: 5, center: [0.1, 0, 0], inertia: [0.1, 0.2, 0.2], position: [0, 0, 0.1],
          points: {l: [0, 0.25, 0], r: [0, -0.25, 0], castor: [0.4, 0, -0.1]}}
  left: {mass: 1, center: [0, 0, 0], inertia: [0.003, 0.005, 0.003], points: {c: [0, 0, 0]}}
  right: {mass: 1, center: [0, 0, 0], inertia: [0.003, 0.005, 0.003], points: {c: [0, 0, 0]}}
joints:
  axle_l: {type: pin, from: frame.l, to: left.c, axis: [0, 1, 0]}
  axle_r: {type: pin, from: frame.r, to: right.c, axis: [0, 1, 0]}
  castor: {type: plane, from: ground.O, to: frame.castor, normal: [0, 0, 1]}
drives:
  motor_l: {joint: axle_l, angle: 3*t}
  motor_r: {joint: axle_r, angle: 5*t}
rolling:
  tyre_l: {wheel: left.c, axis: [0, 1, 0], radius: 0.1, on: ground.O, normal: [0, 0, 1]}
  tyre_r: {wheel: right.c, axis: [0, 1, 0], radius: 0.1, on: ground.O, normal: [0, 0, 1]}
analysis: {duration: 6, samples: 7}
"""


def test_two_driven_wheels_steer_round_a_circle() -> None:
    """Drives leave no freedom, and yet no pose follows from them: v = R (w_r + w_l) / 2, turning R (w_r - w_l) / b."""
    r = solved(ROBOT)
    v, turning = 0.1 * 4.0, 0.1 * 2.0 / 0.5
    angle = turning * r.time
    wanted = np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.1 * turning / v + 0.0 * angle], axis=1) * v / turning
    near(r.bodies["frame"]["position"], wanted, 1.0, 1e-8)
    assert r.model["method"] != "none"
    assert [sentence for sentence in r.model["not_reduced"] if "rolling" in sentence]
