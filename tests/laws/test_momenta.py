"""Momenta of random trees and their rates, parts of the system vector, energies of pieces, Rodrigues' vectors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.scene.shapes.rotations import cross_matrix
from tests.oracle.masses import mass_of
from tests.shared.scenes import solved
from tests.shared.trees import ABOUT, SOME, tree

SMALL = 1e-3  # [s] of central differences: their error is its square, of motions of about 1/s


@pytest.mark.parametrize("seed", SOME)
def test_momenta_are_those_of_the_bodies(seed: int) -> None:
    """(16), (17) by the velocities that are told and the masses as the oracle weighs them."""
    case = tree(seed)
    found = case.found
    total, orbital, spin = (np.zeros((len(found.time), 3)) for _ in range(3))
    for name, body in found.bodies.items():
        mass = mass_of(case.plain["bodies"][name])
        p = mass.mass * body["center_velocity"]
        R = body["rotation"]
        own = np.einsum("tij,jk,tlk,tl->ti", R, np.asarray(mass.inertia), R, body["angular_velocity"])
        about = np.cross(body["center"] - ABOUT, p)
        size = np.abs(p).max() + 1e-12
        assert np.abs(body["momentum"] - p).max() <= 1e-12 * size
        assert np.abs(body["moment_of_momentum"] - about - own).max() <= 1e-11 * (
            size * case.length + np.abs(own).max()
        )
        total, orbital, spin = total + p, orbital + about, spin + own
    for name, whole in (("total", total), ("moment_orbital", orbital), ("moment_spin", spin)):
        assert np.abs(found.momentum[name] - whole).max() <= 1e-11 * (np.abs(whole).max() + case.length)


@pytest.mark.parametrize("seed", [1, 4, 9])
def test_their_rates_are_the_mass_effects(seed: int) -> None:
    """(56) is the time derivative of (16) and (17)."""
    case = tree(seed)
    times = [0.1 - SMALL, 0.1, 0.1 + SMALL]
    found = case.study.resample(np.array(times))
    effect = found.foundation["mass_effect"]
    for momentum, rate in (("total", "force"), ("moment_orbital", "moment_orbital"), ("moment_spin", "moment_spin")):
        slope = (found.momentum[momentum][2] - found.momentum[momentum][0]) / (2.0 * SMALL)
        assert np.abs(slope - effect[rate][1]).max() <= 1e-4 * max(np.abs(effect[rate]).max(), case.force[1])


@pytest.mark.parametrize("seed", SOME)
def test_parts_of_the_system_vector(seed: int) -> None:
    """B = m v x a + 2 E w + G, G across nothing where w and its rate are along one line."""
    found = tree(seed).found
    vector = found.system_vector
    for name, body in found.bodies.items():
        mass = mass_of(tree(seed).plain["bodies"][name])
        R, w = body["rotation"], body["angular_velocity"]
        Iw = np.einsum("tij,jk,tlk,tl->ti", R, np.asarray(mass.inertia), R, w)
        energy = np.sum(w * Iw, axis=1)[:, None] * w
        shift = mass.mass * np.cross(body["center_velocity"], body["center_acceleration"])
        size = np.abs(vector["bodies"][name]).max() + np.abs(energy).max() + np.abs(shift).max() + 1e-12
        assert np.abs(vector["energy_part"][name] - energy).max() <= 1e-11 * size
        left = vector["bodies"][name] - shift - energy
        assert np.abs(vector["deviation_part"][name] - left).max() <= 1e-11 * size


BODY = """\
heun: 1
bodies:
  b:
    shapes:
      - {type: box, center: [0.1, 0, 0], size: [1, 0.3, 0.2], density: 1000}
      - {type: cylinder, from: [0.6, 0, 0], to: [1.2, 0, 0.1], radius: 0.08, density: 3000}
    angular_velocity: [1, -2, 3]
    velocity: [0.4, 0.5, -0.6]
sections:
  beyond: {body: b, at: [0.2, 0, 0], normal: [1, 0, 0]}
  before: {body: b, at: [0.2, 0, 0], normal: [-1, 0, 0]}
  along: {body: b, from: [-0.4, 0, 0], to: [0.5, 0, 0], count: 10}
analysis: {duration: 1, samples: 3}
"""


def test_the_energies_of_two_pieces_make_that_of_the_body() -> None:
    """E = E' + E'', and the pieces beyond the cuts of a run have less and less."""
    found = solved(BODY)
    whole = found.energy["kinetic"]
    pieces = found.sections["beyond"]["energy"] + found.sections["before"]["energy"]
    assert np.abs(pieces - whole).max() <= 1e-13 * whole.max()
    along = found.sections["along"]["energy"]
    assert along.shape == (3, 10) and (np.diff(along, axis=1) < 0.0).all() and (along > 0.0).all()


def turned(angle: float) -> Any:
    axis = np.array([1.0, 2.0, -2.0]) / 3.0
    turn = f"{{axis: {axis.tolist()}, angle: {angle!r}}}"
    body = f"{{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], orientation: {turn}}}"
    scene = f"heun: 1\nbodies: {{b: {body}}}\nanalysis: {{type: state}}\n"
    return axis, solved(scene).bodies["b"]


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0, 3.0, 3.5])
def test_rodrigues_vectors(angle: float) -> None:
    """k = tan(angle / 2) n, and R = (1 + k^)(1 - k^)^-1 is the attitude."""
    axis, body = turned(angle)
    k = body["rodrigues"][0]
    assert np.abs(k - math.tan(angle / 2.0) * axis).max() <= 1e-13 * (1.0 + math.tan(angle / 2.0) ** 2)
    attitude = (np.eye(3) + cross_matrix(k)) @ np.linalg.inv(np.eye(3) - cross_matrix(k))
    assert np.abs(attitude - body["rotation"][0]).max() <= 1e-13


def test_half_a_turn_has_no_rodrigues_vector() -> None:
    assert np.isnan(turned(math.pi)[1]["rodrigues"]).all()
    assert np.isfinite(turned(math.pi - 1e-6)[1]["rodrigues"]).all()
