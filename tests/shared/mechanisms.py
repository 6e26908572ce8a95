"""Planar machines in space, closed exactly: a crank-rocker that can turn over, as the oracle's dicts."""

from __future__ import annotations

from math import atan2, cos, sin
from typing import Any

import numpy as np

from tests.oracle.published import four_bar

CRANK, COUPLER, ROCKER, BASE = 0.4, 1.0, 0.8, 1.0  # [m]; shortest + longest < the other two: the crank turns over


def crank_rocker(phi: float, rate: float) -> dict[str, Any]:
    """The four-bar at a crank angle and rate, elbow up, its other attitudes and rates worked out."""
    B, D = CRANK * np.array([cos(phi), sin(phi)]), np.array([BASE, 0.0])
    across = D - B
    span = float(np.linalg.norm(across))
    along = (COUPLER**2 - ROCKER**2 + span**2) / (2 * span)
    up = np.array([-across[1], across[0]]) / span
    C = B + along * across / span + np.sqrt(COUPLER**2 - along**2) * up
    theta, psi = atan2(*(C - B)[::-1]), atan2(*(C - D)[::-1])
    lever = [[-COUPLER * sin(theta), ROCKER * sin(psi)], [COUPLER * cos(theta), -ROCKER * cos(psi)]]
    rates = np.linalg.solve(lever, rate * CRANK * np.array([sin(phi), -cos(phi)]))
    return four_bar(phi, theta, psi, (CRANK, COUPLER, ROCKER, BASE), (rate, float(rates[0]), float(rates[1])))
