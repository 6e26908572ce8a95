"""Threads that stick: self-locking, the torques that raise and lower a load, and how it runs down."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.motion.integration.contacts.latches import measure_coordinate_rate
from heuncli.multibody.response import kernel_numbers
from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.values import to_yaml
from tests.shared.plain_kernel import plain_module
from tests.shared.scenes import solved
from tests.shared.screw_jack import LEAD, SLOPE, R, W, jack

P = LEAD / math.tau
SENSES = list(itertools.product([(1, 1), (1, -1)], [(1, 1), (-1, 1), (1, -1), (-1, -1)], (1, -1)))


def sticking_jack(
    mu: float, senses: tuple[tuple[float, float], tuple[int, int], int] = SENSES[0], **friction: Any
) -> dict[str, Any]:
    """The jack at rest, its friction as it is; senses: of the axes, of the sides, of the thread's hand."""
    axes, sides, hand = senses
    scene = jack(mu, axes, sides, hand * LEAD, **friction)
    del scene["couplings"]["thread"]["friction"]["speed"]
    scene["analysis"] = {"duration": 1, "samples": 11}
    return scene


def up_sign(senses: tuple[tuple[float, float], tuple[int, int], int]) -> float:
    """The sign of the spindle's angle that raises the nut: of both travels upwards, times the hand."""
    axes, sides, hand = senses
    return hand * axes[1] * sides[1]


@pytest.mark.parametrize("excess", [-1e-6, 1e-6])
@pytest.mark.parametrize("senses", SENSES)
@pytest.mark.third
def test_a_thread_holds_its_load_up_to_the_angle_of_friction(senses: Any, excess: float) -> None:
    """It sticks if tan(lambda) <= mu; else the nut falls with (W - friction) of its inertia and the spindle's."""
    mu = SLOPE * (1 + excess)
    r = solved(to_yaml(sticking_jack(mu, senses)))
    speed = r.bodies["nut"]["velocity"][:, 2]
    if excess > 0:
        assert speed == pytest.approx(np.zeros(11), abs=1e-15)
        # N (1 + tan^2) = W, the torque N p
        left = (mu - SLOPE) * R * W / (1 + SLOPE**2)
        assert r.couplings["thread"]["reserve"] == pytest.approx(np.full(11, left), rel=1e-6)
        assert not r.couplings["thread"]["efficiency"].any()
        assert r.couplings["thread"]["torque"] == pytest.approx(np.zeros(11), abs=1e-12)
        return
    assert speed == pytest.approx(-fall(mu) * r.time, rel=1e-7, abs=1e-9)
    assert not r.couplings["thread"]["reserve"].any()


def fall(mu: float) -> float:
    """Acceleration of the falling nut: m g - F = m a, F r tan(lambda - rho) = J a / p."""
    return 100 * 9.81 / (100 + 0.05 / P / (R * math.tan(math.atan(SLOPE) - math.atan(mu))))


@pytest.mark.parametrize("mu", [0.02, 0.1])
def test_a_thread_that_is_too_steep_runs_down(mu: float) -> None:
    r = solved(to_yaml(sticking_jack(mu)))
    assert r.bodies["nut"]["velocity"][:, 2] == pytest.approx(-fall(mu) * r.time, rel=1e-8, abs=1e-10)


@pytest.mark.parametrize(
    ("mu", "static", "flank"), [(0.15, 0.15, 0.0), (0.1, 0.2, 0.0), (0.12, 0.16, math.radians(15))]
)
@pytest.mark.parametrize("senses", SENSES[::3])
@pytest.mark.parametrize("raises", [True, False])
@pytest.mark.third
def test_a_jack_starts_at_the_torque_of_the_static_friction(
    mu: float, static: float, flank: float, senses: Any, raises: bool
) -> None:
    """W r tan(rho_s + lambda) raises the load, W r tan(rho_s - lambda) lowers it."""
    friction = {"flank_angle": flank} if flank else {}
    scene = sticking_jack(mu, senses, static=static, **friction)
    rho = math.atan(static / math.cos(flank))
    torque = W * R * math.tan(rho + (1 if raises else -1) * math.atan(SLOPE))
    sign = up_sign(senses) * (1 if raises else -1)
    start = 0.637
    scene["forces"] = {"handle": {"type": "torque", "joint": "spin", "value": f"{sign * torque / start}*t"}}
    scene["analysis"]["samples"] = 201
    r = solved(to_yaml(scene))
    speed = r.bodies["nut"]["velocity"][:, 2]
    assert speed[r.time < start - 1e-9] == pytest.approx(0.0, abs=1e-14)
    later = speed[r.time > start + 1e-9]
    assert (later > 0).all() if raises else (later < 0).all()
    assert r.couplings["thread"]["reserve"][r.time > start + 1e-9] == pytest.approx(0.0, abs=1e-15)
    assert thread_power(r).max() <= 1e-12


def thread_power(r: Results) -> Any:
    """The power of the thread on the nut and on the spindle: what friction takes."""
    own = r.couplings["thread"]["on"]
    return sum(
        np.sum(own[name]["force"] * r.bodies[name]["velocity"], axis=1)
        + np.sum(own[name]["moment"] * r.bodies[name]["angular_velocity"], axis=1)
        for name in ("nut", "spindle")
    )


def test_a_cylinder_holds_its_load() -> None:
    """The same in a screw whose spindle slides: N (1 + tan^2) = W."""
    text = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0]}}
bodies: {screw: {mass: 100, center: [0, 0, 0], inertia: [1, 1, 0.05], points: {o: [0, 0, 0]}}}
joints: {spin: {type: cylinder, from: ground.A, to: screw.o, axis: [0, 0, 1]}}
couplings: {thread: {type: screw, of: [spin], lead: 0.01, friction: {coefficient: MU, radius: 0.014}}}
analysis: {duration: 1, samples: 11}
"""
    r = solved(text.replace("MU", "0.13"))
    assert r.couplings["thread"]["reserve"] == pytest.approx(np.full(11, (0.13 - SLOPE) * R * W / (1 + SLOPE**2)))
    r = solved(text.replace("MU", "0.09"))
    assert r.bodies["screw"]["velocity"][:, 2] == pytest.approx(-fall(0.09) * r.time, rel=1e-8, abs=1e-10)


def test_a_rest_position_is_the_start_where_the_thread_holds() -> None:
    scene = sticking_jack(0.2)
    scene["analysis"] = {"type": "rest"}
    assert solved(to_yaml(scene)).couplings["thread"]["reserve"][0] > 0.0


@pytest.mark.parametrize("change", [{"static": 0.05}, {"static": 0.2, "speed": 0.1}])
def test_what_contradicts_itself_is_refused(change: dict[str, float]) -> None:
    scene = sticking_jack(0.1)
    scene["couplings"]["thread"]["friction"] |= change
    with pytest.raises(SpecError) as caught:
        solved(to_yaml(scene))
    assert caught.value.problems[0].code == "thread-friction"


def test_a_thread_rests_below_one_rate_in_both_places() -> None:
    """The kernel takes it to rest below the rate by which its state is decided: all parts of its sum count."""
    scene = sticking_jack(0.5)
    scene["joints"]["spin"]["type"] = "cylinder"  # a spindle that slides, too: the coordinates fill two parts
    setup = set_up(load("scene.yaml", to_yaml(scene)))
    layout = setup.runner.layout
    (contact,) = (layout.contacts[i] for i in layout.friction_contacts)
    opened = setup.runner.evaluate(np.zeros(1), layout.y0[None, :], holding=layout.open_contacts)
    pack = layout.pack
    programs = plain_module("expressions").Expressions(
        pack.code, pack.constants, len(pack.variables), pack.branch_count, pack.starts, pack.tables
    )
    workspace = plain_module("workspace").Workspace(layout.tables, layout.indices, programs, kernel_numbers(layout))
    workspace.measure_at(0.0, layout.y0.tolist())
    row = workspace.scene.closures[contact.row]
    assert row.part_count == 2
    for end_time in (1e-3, 10.0):
        rounding = plain_module("sticking").find_rate_rounding(workspace.scene, row, end_time)
        assert rounding == pytest.approx(measure_coordinate_rate(layout, opened, contact, end_time)[1], rel=1e-12)
