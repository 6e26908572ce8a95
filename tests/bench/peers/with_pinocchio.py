"""Pinocchio with SciPy's DOP853: its articulated-body algorithm as the right-hand side.

The loop of `crank` is held by its accelerations: mass matrix, Jacobian and drift by Pinocchio, solved by NumPy.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from tests.bench.peers.scenes import Crank, G, bars, crank_centers, duration
from tests.bench.peers.ways import Way

TOLERANCES = [10.0**-k for k in range(3, 14)]


def version() -> str:
    """Its version."""
    return str(pin.__version__)


def integrator(
    slope: Callable[[float, np.ndarray], np.ndarray], start: np.ndarray, T: float,
    centers: Callable[[np.ndarray], dict[str, Any]],
) -> Callable[[float], tuple[Callable[[], Any], Callable[[], dict[str, Any]]]]:  # fmt: skip
    """SciPy's DOP853 at a relative and absolute tolerance."""

    def prepare(tolerance: float) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
        last: list[Any] = []

        def integrate() -> None:
            last[:] = [solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=tolerance, atol=tolerance).y[:, -1]]

        return integrate, lambda: centers(last[0])

    return prepare


def chain(name: str) -> Way:
    """Bars on balls: quaternions and angular velocities in the bodies' axes."""
    links = bars(name)
    n = len(links)
    model = pin.Model()
    model.gravity = pin.Motion(np.array([0.0, 0.0, -G, 0.0, 0.0, 0.0]))
    parent, at = 0, np.zeros(3)
    for bar in links:
        parent = model.addJoint(parent, pin.JointModelSpherical(), pin.SE3(np.eye(3), at), bar.name)
        model.appendBodyToJoint(parent, pin.Inertia(bar.mass, bar.center, bar.inertia), pin.SE3.Identity())
        at = bar.end
    data, none = model.createData(), np.zeros(3 * n)
    start = np.zeros(7 * n)
    before, rate_before = np.eye(3), np.zeros(3)
    for k, bar in enumerate(links):
        start[4 * k :][:4] = pin.Quaternion(before.T @ bar.rotation).coeffs()
        sigma = bar.rotation @ bar.omega
        start[4 * n + 3 * k :][:3] = bar.rotation.T @ (sigma - rate_before)
        before, rate_before = bar.rotation, sigma
    out = np.zeros(7 * n)

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        q = y[: 4 * n].reshape(n, 4)
        v = y[4 * n :]
        unit = q / np.sqrt(np.einsum("ij,ij->i", q, q))[:, None]
        out[4 * n :] = pin.aba(model, data, unit.ravel(), v, none)
        x, y_, z, w = q.T
        a, b, c = 0.5 * v.reshape(n, 3).T
        rate = out[: 4 * n].reshape(n, 4)
        rate[:, 0] = w * a + y_ * c - z * b
        rate[:, 1] = w * b + z * a - x * c
        rate[:, 2] = w * c + x * b - y_ * a
        rate[:, 3] = -x * a - y_ * b - z * c
        return out.copy()

    def centers(y: np.ndarray) -> dict[str, Any]:
        q = y[: 4 * n].reshape(n, 4)
        pin.forwardKinematics(model, data, (q / np.linalg.norm(q, axis=1)[:, None]).ravel())
        return {bar.name: data.oMi[k + 1].act(bar.center) for k, bar in enumerate(links)}

    return Way("SciPy DOP853", TOLERANCES, integrator(slope, start, duration(name), centers))


def crank() -> Way:
    """Crank and rod on hinges, a piston on a slide, and the rod's end held to it at the level of accelerations."""
    c = Crank()
    m1, m2, m3 = c.masses
    model = pin.Model()
    model.gravity = pin.Motion.Zero()
    hinge = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "crank")
    rod = model.addJoint(hinge, pin.JointModelRZ(), pin.SE3(np.eye(3), np.array([c.r, 0.0, 0.0])), "rod")
    slide = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "piston")
    for joint, mass, length in ((hinge, m1, c.r), (rod, m2, c.length)):
        I = mass * length**2 / 12.0
        inertia = pin.Inertia(mass, np.array([length / 2.0, 0.0, 0.0]), np.diag([1e-12, I, I]))
        model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    model.appendBodyToJoint(slide, pin.Inertia(m3, np.zeros(3), c.piston_inertia * np.eye(3)), pin.SE3.Identity())
    none = np.zeros(3)
    psi, psi_rate = c.start
    x = c.r * np.cos(c.angle) + c.length * np.cos(psi)
    speed = -c.r * np.sin(c.angle) * c.rate - c.length * np.sin(psi) * psi_rate
    start = np.array([c.angle, psi - c.angle, x, c.rate, psi_rate - c.rate, speed])
    at = pin.SE3(np.eye(3), np.array([c.length, 0.0, 0.0]))
    end = model.addFrame(pin.Frame("end", rod, at, pin.FrameType.OP_FRAME))
    data = model.createData()
    world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    J, K, right = np.zeros((2, 3)), np.zeros((5, 5)), np.zeros(5)

    def slope(_: float, y: np.ndarray) -> np.ndarray:
        q, v = y[:3], y[3:]
        pin.forwardKinematics(model, data, q, v, none)
        pin.updateFramePlacement(model, data, end)
        drift = pin.getFrameClassicalAcceleration(model, data, end, world).linear
        right[:3] = -pin.nle(model, data, q, v)
        M = pin.crba(model, data, q)
        J[:] = pin.computeFrameJacobian(model, data, q, end, world)[:2]
        J[0, 2] -= 1.0
        K[:3, :3] = np.triu(M) + np.triu(M, 1).T
        K[:3, 3:], K[3:, :3] = J.T, J
        right[3:] = -drift[:2]
        return np.concatenate([v, np.linalg.solve(K, right)[:3]])

    def centers(y: np.ndarray) -> dict[str, Any]:
        return crank_centers(y[0], y[0] + y[1], y[2])

    return Way("SciPy DOP853", TOLERANCES, integrator(slope, start, duration("crank"), centers))


def ways(name: str) -> list[Way]:
    """SciPy's method of order 8."""
    return [crank() if name == "crank" else chain(name)]
