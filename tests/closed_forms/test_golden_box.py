"""manual/theory.md, "Closed cases" 16, golden box: section, reduction line, system vector of a box on a ball."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.scenes import near, solved

EXACT = 1e-14  # the digits printed, relative to values of the order of 1


def box(reduce_to: str, normal: int = 1, more: str = "") -> Results:
    """Density 1, 2 × 1 × .6, σ = (1, 2, −.5), gravity (−3, 2, −9) in body axes, cut at x = .7."""
    return solved(f"""
heun: 1
gravity: [-3, 2, -9]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  box:
    shapes: [{{type: box, center: [1, 0, 0], size: [2, 1, 0.6], density: 1}}]
    points: {{face: [0, 0, 0]}}
    angular_velocity: [1, 2, -0.5]
joints: {{pivot: {{type: ball, from: ground.O, to: box.face}}}}
sections: {{cut: {{body: box, at: [0.7, 0, 0], normal: [{normal}, 0, 0], reduce_to: {reduce_to}{more}}}}}
""")


def test_motion_and_force() -> None:
    found = box("at")
    alpha = [0.470588235294116, 6.123471882640587, -0.352941176470588]
    near(found.bodies["box"]["angular_acceleration"][0], alpha, 1.0, EXACT)
    cut = found.sections["cut"]
    force = [2.13525, -0.174352941176471, -0.045484107579461]
    near(cut["force"][0], force, 1.0, EXACT)
    near([cut[name][0] for name in ("N", "Q1", "Q2")], force, 1.0, EXACT)  # e1 is body y, the plane's first


def test_moments() -> None:
    """About the fixed point (the P and Q of (58)), and about the section's centroid."""
    near(box("ground.O").sections["cut"]["moment"][0], [0.0, -0.7977740831295842, -0.2633647058823527], 1.0, EXACT)
    central = [0.0, -0.829612958435207, -0.141317647058823]
    for where in ("at", "centroid", "line"):
        cut = box(where).sections["cut"]
        near(cut["moment"][0], central, 1.0, EXACT)
        near([cut[name][0] for name in ("T", "M1", "M2")], central, 1.0, EXACT)


def test_reduction_line() -> None:
    line = box("line").sections["cut"]["line"]
    center = np.array([0.7, 0.0, 0.0])
    near(line["point"][0] - center, [0.0, -0.032933337141966, -0.008591443536359], 1.0, EXACT)
    near(line["direction"][0], [0.0, 0.252425698749344, -0.967616280666518], 1.0, EXACT)
    near(line["pressure_centre"][0] - center, [0.0, 0.066183185603008, -0.388532002545466], 1.0, EXACT)


def test_system_vector() -> None:
    """B = Σ m ẋ × ẍ of the whole box."""
    found = box("at").system_vector
    vector = [10.874365741406585, 14.221764705882352, -3.365937365166115]
    near(found["total"][0], vector, 10.0, EXACT)
    near(found["bodies"]["box"][0], vector, 10.0, EXACT)


def test_momenta() -> None:
    """(16), (17) about the fixed point: m σ × x_s, and Jσ with J of a box about the centre of a face."""
    found = box("at")
    m, sigma = 2.0 * 1.0 * 0.6, np.array([1.0, 2.0, -0.5])
    J = m / 12.0 * np.array([1.0 + 0.36, 16.0 + 0.36, 16.0 + 1.0])  # 4 · 2² / 12 about an end
    near(found.momentum["total"][0], m * np.array([0.0, -0.5, -2.0]), 1.0, EXACT)
    near(found.bodies["box"]["momentum"][0], m * np.array([0.0, -0.5, -2.0]), 1.0, EXACT)
    near(found.bodies["box"]["moment_of_momentum"][0], J * sigma, 1.0, EXACT)
    near(found.momentum["moment_orbital"][0] + found.momentum["moment_spin"][0], J * sigma, 1.0, EXACT)


def test_a_scene_declared_planar_has_no_momenta_out_of_its_plane() -> None:
    """Its centre above the foundation's point, and a deviation moment: what of M_v lies in the plane is not there."""
    found = solved("""
heun: 1
space: planar
ground: {points: {O: [0, 0, 0]}}
bodies:
  crank: {mass: 2, center: [0.1, 0, 0.3], inertia: [2, 2, 3], deviation: [0.2, 0.1, 0], points: {hub: [0, 0, 0]}}
joints: {shaft: {type: pin, from: ground.O, to: crank.hub, initial: {rate: 5}}}
foundation: {about: [0, 0, 0]}
""")
    near(found.bodies["crank"]["moment_of_momentum"][0], [0.0, 0.0, (3.0 + 2.0 * 0.1**2) * 5.0], 15.1, EXACT)
    near(found.momentum["total"][0], [0.0, 2.0 * 0.1 * 5.0, 0.0], 1.0, EXACT)


def test_parts_of_the_system_vector() -> None:
    """2E σ and G = T σ × σ̇ about the centre of mass, T = Σ m x xᵀ."""
    found = box("at")
    m, sigma = 1.2, np.array([1.0, 2.0, -0.5])
    own = m / 12.0 * np.array([1.36, 4.36, 5.0])
    T = m / 12.0 * np.array([4.0, 1.0, 0.36])
    near(found.system_vector["energy_part"]["box"][0], float(own @ sigma**2) * sigma, 10.0, EXACT)
    across = T * np.cross(sigma, found.bodies["box"]["angular_acceleration"][0])
    near(found.system_vector["deviation_part"]["box"][0], across, 10.0, EXACT)


def test_on_the_momentary_axis() -> None:
    """Where σ̇ is along σ there is no G, and B of a body whose centre stays is along σ."""
    found = solved("""
heun: 1
bodies: {wheel: {mass: 2, center: [0, 0, 0], inertia: [1, 2, 3], angular_velocity: [0, 0, 4]}}
forces: {motor: {type: couple, on: wheel, vector: [0, 0, 5]}}
""").system_vector
    near(found["energy_part"]["wheel"][0], [0.0, 0.0, 3.0 * 4.0**3], 192.0, EXACT)
    assert not found["deviation_part"]["wheel"].any()
    near(found["total"][0], found["energy_part"]["wheel"][0], 192.0, EXACT)


@pytest.mark.parametrize("turn", [0.0, 1.1])
def test_turned_round(turn: float) -> None:
    """The same with the plane's other side and another first axis: −s', and components in the other frame."""
    e1 = [0.0, float(np.cos(turn)), float(np.sin(turn))]
    cut, other = box("at").sections["cut"], box("at", -1, f", first_axis: {e1}").sections["cut"]
    near(other["force"][0], -cut["force"][0], 1.0, EXACT)
    near(other["N"][0], cut["N"][0], 1.0, EXACT)
    near(other["Q1"][0], -cut["force"][0] @ e1, 1.0, EXACT)
    near(other["Q2"][0], -cut["force"][0] @ np.cross([-1.0, 0.0, 0.0], e1), 1.0, EXACT)
