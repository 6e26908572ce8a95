"""Which bodies are merged, taken for immobile or spun slower; which are not, though they look so at the start."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.motion.integration.run.request import MotionTask
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.shared.reduced import pair, same
from tests.shared.scenes import study

HEAD = "heun: 1\ntitle: t\ngravity: [0, 0, -9.81]\nground: {points: {O: [0, 0, 0]}}\n"
BAR = "mass: 1, center: [0.5, 0, 0], inertia: [0.002, 0.084, 0.084], points: {a: [0, 0, 0], b: [1, 0, 0]}"
RUN = "analysis: {duration: 0.2, samples: 5}\n"


def told(text: str) -> str:
    """What is left out, and what is not, of a scene whose numbers are the same in full."""
    both = pair(load("scene.yaml", text))
    same(both)
    reduced = both.small.setup.reduction
    return "\n".join((*reduced.explanations, *reduced.exceptions)) if reduced is not None else ""


def bodies(*lines: str) -> str:
    return "bodies:\n" + "".join(f"  {line}\n" for line in lines)


def joints(*lines: str) -> str:
    return "joints:\n" + "".join(f"  {line}\n" for line in lines)


SWING = "swing: {type: ball, from: ground.O, to: x.a}"
OVER = (
    f"x: {{{BAR}, orientation: {{axis: [0, 0, 1], angle: 0}}}}",
    f"y: {{{BAR}, position: [1, 0, 0], orientation: {{axis: [0, 0, 1], angle: 90 deg}}}}",
)
WELD = "weld: {type: weld, from: x.b, to: y.a}"


def welded(more: str = "", extra: tuple[str, ...] = ()) -> str:
    return HEAD + bodies(*OVER) + joints(SWING, WELD, *extra) + more + RUN


def test_welded_bodies_are_one() -> None:
    assert "bodies.x and y are welded together" in told(welded())


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_load_in_axes_that_are_not_those_of_the_whole(frame: str) -> None:
    """In time and fixed in the axes of a body that is turned against the one it is welded to."""
    load = f'forces:\n  f: {{type: force, on: y.b, vector: ["sin(9*t)", 1, 0], frame: {frame}}}\n'
    found = told(welded(load))
    assert ("stays a separate body" in found) == (frame == "body")
    assert ("welded together" in found) == (frame == "world")


def test_a_rope_between_bodies_that_are_welded() -> None:
    """The run ends where it would push: as it is slack of itself here, at once."""
    rope = "rope: {type: rod, from: x.a, to: y.b, tension_only: true, restitution: 0.2}"
    assert "joints.rope to a body welded to it" in told(welded("", (rope,)))


FRAME = (
    "k: {mass: 2, center: [0, 0, 1], inertia: [0.1, 0.1, 0.1], points: {a: [-1, 0, 0], b: [1, 0, 0], top: [0, 0, 1]}}",
    f"x: {{{BAR}, position: [0, 0, 1]}}",
)
CARRIES = "swing: {type: pin, axis: [0, 1, 0], from: k.top, to: x.a}"


def carried(*held: str, more: str = "") -> str:
    return HEAD + bodies(*FRAME) + joints(CARRIES, *held) + more + RUN


BALL = "b1: {type: ball, from: ground.O, to: {body: k, at: [0, 0, 0]}}"
ENDS = ("[0, 2, 1]", "top"), ("[2, 0, 2]", "top"), ("[-1, 2, 0]", "a"), ("[1, -2, 0]", "b")
RODS = tuple(f"r{i}: {{type: rod, from: {{body: ground, at: {at}}}, to: k.{end}}}" for i, (at, end) in enumerate(ENDS))


@pytest.mark.parametrize(("count", "held"), [(2, False), (3, True), (4, True)])
def test_a_frame_that_carries_a_bar(count: int, held: bool) -> None:
    """On a ball and rods: three hold it, four hold it twice."""
    found = told(carried(BALL, *RODS[:count]))
    assert ("bodies.k is fixed to the ground by joints" in found) == held


def test_what_a_rope_holds_may_be_let_go() -> None:
    rope = RODS[2].replace("}}", "}").replace("to: k.a}", "to: k.a, tension_only: true}")
    assert "bodies.k is held" not in told(carried(BALL, *RODS[:2], rope))


def test_a_rope_beside_what_is_held() -> None:
    """It would not be looked at any more when it pushes."""
    rope = "rope: {type: rod, from: {body: ground, at: [0, 0, 3]}, to: k.top, tension_only: true, restitution: 0.1}"
    assert "stays a body: joints.rope may go slack" in told(carried(BALL, *RODS, rope))


def test_a_frame_that_is_driven_in_time() -> None:
    """One of its rods changes its length, another one keeps a length that is given as a drive."""
    drive = 'drives: {{d: {{joint: r2, length: "{}"}}}}\n'
    length = float(np.sqrt(4.0))
    assert "is fixed to the ground by joints" in told(carried(BALL, *RODS[:3], more=drive.format(length)))
    assert "is fixed to the ground by joints" not in told(
        carried(BALL, *RODS[:3], more=drive.format(f"{length} + 0.01*t**2"))
    )


def test_a_slider_at_its_dead_centre_is_not_held() -> None:
    """It does not move at first, as the crank stands in line with the rod."""
    piston = "mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}, position: [2, 0, 0]"
    text = HEAD + bodies(
        f"crank: {{{BAR}, angular_velocity: [0, 3, 0]}}",
        f"link: {{{BAR}, position: [1, 0, 0]}}",
        f"piston: {{{piston}}}",
    )
    text += joints("main: {type: pin, axis: [0, 1, 0], from: ground.O, to: crank.a}",
                   "pin: {type: pin, axis: [0, 1, 0], from: crank.b, to: link.a}",
                   "guide: {type: slide, axis: [1, 0, 0], from: ground.O, to: piston.c}",
                   "wrist: {type: pin, axis: [0, 1, 0], from: piston.c, to: link.b}") + RUN  # fmt: skip
    assert "held" not in told(text)


TOP = "x: {mass: 1, center: [0, 0, 1], inertia: [0.1, 0.1, 0.01], "
TOP += "points: {a: [0, 0, 0], c: [0, 0, 1], off: [0.1, 0, 1]}, "
TOP += "orientation: {axis: [1, 0, 0], angle: 60 deg}, angular_velocity: {vector: [0, 0, 100], frame: body}}"


@pytest.mark.parametrize(
    ("load", "slower"),
    [
        ("", True),
        ("forces:\n  f: {type: force, on: x.c, vector: [1, 0, 0]}\n", True),
        ("forces:\n  f: {type: force, on: x.c, vector: [1, 0, 0], frame: body}\n", False),
        ("forces:\n  f: {type: force, on: x.off, vector: [1, 0, 0]}\n", False),
        ("forces:\n  f: {type: couple, on: x, vector: [1, 0, 0], frame: body}\n", False),
        ("forces:\n  f: {type: damper, joint: swing, coefficient: 0.01}\n", False),
        ("impulses:\n  f: {on: x.c, vector: [0.3, 0, 0], frame: body, time: 0.1}\n", True),
        ("impulses:\n  f: {on: x.off, vector: [0.3, 0, 0], time: 0.1}\n", False),
        ("impulses:\n  f: {body: x, couple: [0, 0, 0.1], time: 0.1}\n", False),
    ],
)
def test_a_top_spins_slower_where_nothing_turns_it(load: str, slower: bool) -> None:
    found = told(HEAD + bodies(TOP) + joints(SWING) + load + RUN)
    assert ("its spin of 100 rad/s is constant" in found) == slower


WIRE = HEAD + bodies(
    "x: {shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 0.01 mm, density: 7850}], "
    "points: {a: [0, 0, 0]}, orientation: {axis: [1, 0, 0], angle: 60 deg}, angular_velocity: [0.3, 0.2, 1]}"
)


def test_a_wire_costs_as_many_steps_as_a_rod() -> None:
    """A hundredth of a millimetre thick; in full half a million steps follow rounding over its inertia."""
    setup = set_up(load("scene.yaml", WIRE + joints(SWING) + "analysis: {duration: 1, samples: 3}\n"))
    assert setup.runner.run(MotionTask(np.array([0.0, 0.5, 1.0]), 1e-10)).steps < 60


def test_the_spin_of_a_wire_does_not_change() -> None:
    """Rounding of the moments over the inertia about its axis, which is next to none, is no angular acceleration."""
    wire = study(WIRE + joints(SWING) + "analysis: {duration: 1, samples: 11}\n").results.bodies["x"]
    alpha, axis = wire["angular_acceleration"], wire["rotation"][:, :, 2]
    assert np.abs(np.sum(alpha * axis, axis=1)).max() <= 1e-15 * np.abs(alpha).max()


@pytest.mark.parametrize(
    "more",
    [
        "stops: {s: {joint: hinge, angle: [null, 0.3], restitution: 0.5}}\n",
        'forces:\n  f: {type: torque, joint: hinge, value: "2 - 3*hinge.rate + step(hinge.angle - 0.2)"}\n',
        "drives: {d: {joint: hinge, angle: 3*t}}\n",
    ],
)
def test_welded_bodies_that_strike_and_are_named_or_driven(more: str) -> None:
    """The stop, the expression and the drive mean the joint between what is left."""
    hinge = "hinge: {type: pin, axis: [0, 1, 0], from: ground.O, to: x.a, initial: {angle: 0}}"
    rope = "rope: {type: rod, from: {body: ground, at: [1, 2, 1]}, to: y.b, length: 1.6, tension_only: true, "
    rope += "restitution: 0.1}"
    moves = "x: {" if "drives" in more else "x: {angular_velocity: [0, 4, 0], "
    text = HEAD + bodies(*OVER).replace("x: {", moves)
    assert "welded together" in told(text + joints(hinge, WELD, *((rope,) if "stops" in more else ())) + more + RUN)


def truss(height: float, spin: float = 0.0) -> str:
    """Three bars on balls, a tripod, with a swinging bar at its tip; nothing but their ends holds the bars' spins."""
    feet = [(np.cos(a), np.sin(a), 0.0) for a in (0.0, 2.1, 4.2)]
    lines, held = [], []
    for i, foot in enumerate(feet):
        along = np.array([0.0, 0.0, height]) - np.array(foot)
        ends = f"points: {{a: {list(map(float, foot))}, b: [0, 0, {height}]}}"
        shape = f"{{type: cylinder, from: {list(map(float, foot))}, to: [0, 0, {height}], radius: 0.02, mass: 2}}"
        turn = f", angular_velocity: {(spin * along).tolist()}" if spin else ""
        lines.append(f"k{i}: {{shapes: [{shape}], {ends}{turn}}}")
        held.append(f"f{i}: {{type: ball, from: {{body: ground, at: {list(map(float, foot))}}}, to: k{i}.a}}")
        held += [f"t{i}: {{type: ball, from: k0.b, to: k{i}.b}}"] if i else []
    x = f"x: {{{BAR}, position: [0, 0, {height}]}}"
    return HEAD + bodies(*lines, x) + joints(*held, "swing: {type: ball, from: k0.b, to: x.a}") + RUN


def test_a_tripod_of_bars_that_could_spin() -> None:
    """At rest they do not, for nothing turns them; if one spins the others and it are still where they are."""
    assert "bodies.k0, k1 and k2 are fixed to the ground" in told(truss(1.0))


@pytest.mark.parametrize(("height", "held"), [(1e-3, True), (1e-7, False)])
def test_a_tripod_that_is_almost_flat(height: float, held: bool) -> None:
    """Its tip is held by a lever of the height: reactions err by rounding over it, and what is nearly loose is kept."""
    text = truss(height)
    setup = set_up(load("scene.yaml", text))
    found = (
        "\n".join((*setup.reduction.explanations, *setup.reduction.exceptions)) if setup.reduction is not None else ""
    )
    assert ("are fixed to the ground by joints" in found) == held
    assert ("can hardly move" in found) != held
