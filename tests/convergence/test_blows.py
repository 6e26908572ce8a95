"""Motions with blows: what is told just before, at and after them, energy throughout, and the estimate of the error."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.output.tables import measure
from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.oracle.blows import with_blows
from tests.oracle.impulses import state_after, struck
from tests.oracle.read import Placed, state_at
from tests.shared.bars import rods
from tests.shared.loops import loop_scene
from tests.shared.measured import measured
from tests.shared.scenes import near, solved, study
from tests.shared.trees import tree_scene, weighed
from tests.shared.truth import KNOWN as KNOWN_TRUTH
from tests.shared.truth import SECOND, TRUTH, off

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits

AT, END = 0.25, 0.6
MAKERS: dict[str, Any] = {
    **{f"tree {s}": (tree_scene, s) for s in (1, 4, 6, 9, 12)},
    **{f"loop {s}": (loop_scene, s) for s in (1, 3, 4, 1004, 1009)},
}
KNOWN = 3e-11  # of the size: what two runs at 1e-13 and rounding of the state between them leave


@cache
def scene(name: str) -> dict[str, Any]:
    """Struck once, on two places."""
    make, seed = MAKERS[name]
    return with_blows(make(seed)[0], seed, AT, count=2)


@cache
def run_of(name: str, tolerance: float = 1e-9, samples: tuple[float, ...] = (0.0, END)) -> Study:
    return study({**scene(name), "analysis": {"times": list(samples), "tolerance": tolerance}})


def without(measured: dict[str, Any]) -> dict[str, Any]:
    return {k: v for k, v in measured.items() if k != "impulses"}


def as_started(measured: dict[str, Any], state: dict[str, Placed]) -> dict[str, Any]:
    """The scene with these poses and rates held at its start."""
    bodies = {}
    for name, body in measured["bodies"].items():
        s = state[name]
        bodies[name] = {**body, "position": s.position.tolist(), "orientation": {"matrix": s.rotation.tolist()},
                        "velocity": s.velocity.tolist(), "angular_velocity": s.angular_velocity.tolist()}  # fmt: skip
    return {**measured, "bodies": bodies}


# ---- replays
@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.third
def test_just_before_at_and_after(name: str) -> None:
    """At its own instant all is as after the blow; one double before as before it; poses do not jump."""
    run = run_of(name)
    times = np.array([math.nextafter(AT, 0.0), AT, math.nextafter(AT, 1.0)])
    found = run.resample(times)
    (block,) = run.results.impulses
    assert block["time"] == AT
    for body, jump in block["bodies"].items():
        b = found.bodies[body]
        speed = max(1.0, *(float(np.abs(b[k]).max()) for k in ("center_velocity", "angular_velocity")))
        size = max(1.0, float(np.abs(b["center_acceleration"]).max()), float(np.abs(b["angular_acceleration"]).max()))
        for what, of in (("center_velocity", "center_velocity_jump"), ("angular_velocity", "angular_velocity_jump")):
            near(b[what][1] - b[what][0], jump[of], speed, 1e-13)
            near(b[what][2], b[what][1], speed, 1e-13)
        near(b["position"], b["position"][[1, 1, 1]], 10.0, 1e-13)
        near(b["center_acceleration"][2], b["center_acceleration"][1], size, 1e-10)
    for asked in (AT, times[0]):  # asked by itself: the same bits
        alone = run.resample(np.array([asked]))
        k = int(np.searchsorted(times, asked))
        for body, b in alone.bodies.items():
            for what, value in b.items():
                assert np.array_equal(value[0], found.bodies[body][what][k]), (body, what)


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.parametrize("samples", [(0.0, AT, END), (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, END)])
@pytest.mark.third
def test_samples_do_not_change_the_run(name: str, samples: tuple[float, ...]) -> None:
    """The blow stands where it stands, asked for or not; the blocks have the same bits."""
    few, many = run_of(name), run_of(name, 1e-9, samples)
    one, other = few.results.impulses[0], many.results.impulses[0]
    for body, jump in one["bodies"].items():
        for what, value in jump.items():
            assert np.array_equal(value, other["bodies"][body][what])
    if AT in samples:
        k = samples.index(AT)
        after = few.resample(np.array([AT]))
        for body, b in after.bodies.items():
            assert np.array_equal(b["angular_velocity"][0], many.results.bodies[body]["angular_velocity"][k])


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.third
def test_energy_goes_on_through_it(name: str) -> None:
    """Kinetic + potential − work stays, the work of the blow and of the drives in it included."""
    run = run_of(name, 1e-11)
    times = np.unique(np.concatenate([np.linspace(0, END, 61), [math.nextafter(AT, 0.0), AT]]))
    e = run.resample(times).energy
    total = e["kinetic"] + e["potential"] - e["work"]
    near(total, total[0], max(1.0, float(e["kinetic"].max())), 1e-8)
    (block,) = run.results.impulses
    k = int(np.searchsorted(times, AT))
    near(e["kinetic"][k] - e["kinetic"][k - 1], block["energy_jump"], max(1.0, float(e["kinetic"].max())), 1e-12)
    near([e["kinetic"][k - 1], e["kinetic"][k]], [block["energy_before"], block["energy_after"]],
         max(1.0, float(e["kinetic"].max())), 1e-12)  # fmt: skip


# ---- against a run begun anew by hand
@cache
def by_hand(name: str) -> tuple[Array, Array]:
    """Centres at two instants behind the blow: the motion up to it, the oracle's jump, and a motion from there."""
    plain = weighed(scene(name))
    first = solved({**without(scene(name)), "analysis": {"times": [0.0, AT], "tolerance": 1e-13}})
    state = state_at(first.bodies, 1)
    after = state_after(plain, state, struck(plain, state, AT))
    shifted = later(as_started(without(scene(name)), after))
    second = solved({**shifted, "analysis": {"times": [0.0, (END - AT) / 2, END - AT], "tolerance": 1e-13}})
    centers = np.stack([b["center"] for b in second.bodies.values()], axis=1)
    return centers[1], centers[2]


def later(measured: dict[str, Any]) -> dict[str, Any]:
    """The scene with its clock put on by the blow's instant."""

    def put(value: Any) -> Any:
        if hasattr(value, "source"):
            return Later(value)
        if isinstance(value, dict):
            return {k: put(v) for k, v in value.items()}
        if isinstance(value, tuple) and value and callable(value[0]):
            return Later(value[0])
        return [put(v) for v in value] if isinstance(value, list) else value

    return {**measured, **{k: put(measured[k]) for k in ("forces", "drives") if k in measured}}


class Later:
    """A value in time, AT later."""

    def __init__(self, value: Any) -> None:
        self.source = re.sub(r"\bt\b", f"(t + {AT!r})", value.source)

    def __call__(self, t: float) -> float:
        raise NotImplementedError(self.source)


@pytest.mark.parametrize("tolerance", [1e-5, 1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.sixth
def test_the_estimate_covers_what_comes_behind_a_blow(name: str, tolerance: float) -> None:
    run = run_of(name, tolerance)
    found = run.resample(np.array([(AT + END) / 2, END]))
    centers = np.stack([b["center"] for b in found.bodies.values()], axis=1)
    wanted = by_hand(name)
    size = run.setup.scene.layout.size
    error = max(float(np.linalg.norm(centers[k] - wanted[k], axis=1).max()) for k in range(2)) / size
    estimate = run.results.accuracy["estimate"]["motion"]
    assert error <= estimate + KNOWN, f"{error:.3g} where {estimate:.3g} is stated"
    assert estimate <= tolerance or any("tolerance" in w for w in run.results.warnings)


# ---- extremes
BOUNCE = """
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{w: {{mass: 2, center: [0.3, 0, 0], inertia: [0.1, 0.1, 0.2], points: {{o: [0, 0, 0], p: [0.5, 0, 0]}}}}}}
joints: {{shaft: {{type: pin, from: ground.O, to: w.o, axis: [0, 0, 1], initial: {{angle: 0, rate: 6}}}}}}
impulses: {impulses}
analysis: {{duration: 1, samples: 2}}
"""


def test_extremes_know_the_limit_from_before() -> None:
    """A wheel going at 6 rad/s is stopped dead: what its bearing carried just before is not lost between samples."""
    J = 0.2 + 2 * 0.09
    run = study(BOUNCE.format(impulses=f'{{stop: {{body: w, couple: [0, 0, "-6*{J}"], time: 0}}}}')
                .replace("gravity: [0, -9.81, 0]\n", ""))  # fmt: skip
    assert measured(run, "max coordinates.shaft.rate")["value"] == pytest.approx(0.0, abs=1e-14)
    later = study(BOUNCE.format(impulses=f'{{stop: {{body: w, couple: [0, 0, "-6*{J}"], time: 0.437}}}}')
                  .replace("gravity: [0, -9.81, 0]\n", ""))  # fmt: skip
    assert measured(later, "max coordinates.shaft.rate")["value"] == pytest.approx(6.0, rel=1e-12)
    assert measured(later, "max joints.shaft.force")["value"] == pytest.approx(2 * 0.3 * 36, rel=1e-12)
    assert measured(later, "min joints.shaft.force")["value"] == pytest.approx(0.0, abs=1e-12)
    assert measured(later, "min coordinates.shaft.rate")["value"] == pytest.approx(0.0, abs=1e-12)
    assert measured(later, "max coordinates.shaft.angle")["value"] == pytest.approx(6 * 0.437, rel=1e-12)


def test_the_highest_just_after_a_blow() -> None:
    """The greatest rate of a pendulum that a blow speeds up and weight slows at once: at the blow itself."""
    J = 0.2 + 2 * 0.09
    text = BOUNCE.format(impulses="{kick: {on: w.p, vector: [0, 5, 0], frame: body, time: 0.0317}}")
    run = study(text.replace("duration: 1", "duration: 0.2"))
    block = run.results.impulses[0]
    found = measured(run, "max coordinates.shaft.rate")
    after = run.resample(np.array([0.0317])).coordinates["shaft"]["rate"][0]
    assert found["value"] == pytest.approx(after, rel=1e-12) and found["at"] == pytest.approx(0.0317, abs=1e-12)
    near(block["bodies"]["w"]["angular_velocity_jump"][2], 5 * 0.5 / J, 10.0, 1e-12)
    assert float(
        measure.format_measures([measure.parse_measure("impulses.0.energy_jump")], run, "table")
    ) == pytest.approx(float(block["energy_jump"]), rel=1e-14)


# ---- chaos
def chaotic(duration: float) -> str:
    text = rods([2.5, 2.5], [0.0, 0.0], f"{{duration: {duration}, samples: 3, tolerance: 1e-12}}")
    return text + "impulses: {kick: {on: rod1.b, vector: [1.5, -0.7, 0], time: 1.3}}\n"


def test_a_chaotic_pendulum_keeps_an_honest_horizon() -> None:
    """Double precision forgets it within some 15 s; what is told before the horizon is right to 1e-3."""
    run = study(chaotic(40.0))
    horizon = run.results.accuracy["horizon"]
    assert horizon is not None and 5.0 < horizon < 30.0
    times = np.linspace(0, horizon, 301)[:-1]
    shown = run.resample(times)
    worst, other = (float(off(run, shown, times, t, (1.3,))[-1]) for t in (TRUTH, SECOND))
    assert abs(worst - other) <= KNOWN_TRUTH * tolerances.CLAIMED  # the truth is known so well
    assert worst <= tolerances.CLAIMED


def test_a_blow_behind_the_horizon_is_not_told_as_a_number() -> None:
    """What is struck after its motion is forgotten: its block is told as unknown, or the run says so."""
    text = chaotic(40.0).replace("time: 1.3", "time: 38.0")
    run = study(text)
    horizon = run.results.accuracy["horizon"]
    assert horizon is not None and horizon < 38.0
    assert measure.format_measures([measure.parse_measure("impulses.0.energy_jump")], run, "table").strip() == "?"


# ---- the errors of impulses
KINDS = {"foundation": "foundation", "reactions": "joints", "sections": "sections"}


def numbers(block: dict[str, Any], names: tuple[str, ...]) -> Array:
    """All numbers of these names below a block."""
    found = []
    for name, value in block.items():
        if isinstance(value, dict):
            found.append(numbers(value, names))
        elif name in names:
            found.append(np.ravel(np.asarray(value, dtype=float)))
    return np.concatenate(found) if found else np.zeros(0)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.third
def test_impulses_are_as_exact_as_is_said(name: str, tolerance: float) -> None:
    """The errors that decide the digits of the tables, by kind and unit, against a run at 1e-13."""
    run, fine = run_of(name, tolerance), run_of(name, 1e-13)
    (block,), (exact,) = run.results.impulses, fine.results.impulses
    errors = run.magnitudes.errors
    for kind, part in KINDS.items():
        for unit, names in (("N·s", ("force",)), ("N·m·s", ("moment",))):
            off = np.abs(numbers(block.get(part, {}), names) - numbers(exact.get(part, {}), names))
            if len(off):
                worst, size = float(np.nan_to_num(off).max()), float(np.nanmax(np.abs(numbers(exact[part], names))))
                assert worst <= errors[kind, unit] + 1e-11 * max(1.0, size), (kind, unit, worst, errors[kind, unit])
    for what in ("energy_before", "energy_after", "energy_jump"):
        worst = abs(float(block[what]) - float(exact[what]))
        assert worst <= errors["energy", "J"] + 1e-11 * max(1.0, float(exact["energy_after"])), (what, worst)


def test_a_sample_of_an_even_row_is_the_instant_that_is_written() -> None:
    """Of 0, 0.1, 0.2, 0.3 the second is the instant of a blow at 0.1, told behind it; 0.3 * 1 / 3 would lie before."""
    text = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
impulses: {blow: {on: b.c, vector: [2, 0, 0], time: 0.1}}
analysis: {duration: 0.3, samples: 4}
"""
    found = solved(text)
    assert found.time.tolist() == [0.0, 0.1, 0.2, 0.3]
    assert found.bodies["b"]["velocity"][:, 0].tolist() == [0.0, 1.0, 1.0, 1.0]
