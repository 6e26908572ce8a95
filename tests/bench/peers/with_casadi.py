"""CasADi with SUNDIALS' CVODES: the equations of motion as its own expressions, factors and Jacobian by itself.

Chains: quaternions and angular velocities in the world's axes, the mass matrix of a tree of balls (Heun's no. 22),
solved by its own L D L' of symbols. Crank: one coordinate, its mass by CasADi's derivatives.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from tests.bench.peers.scenes import Crank, G, bars, crank_centers, duration
from tests.bench.peers.ways import Way


def version() -> str:
    """Its version."""
    return str(ca.__version__)


def solver(
    state: Any, slope: Any, start: np.ndarray, T: float, centers: Any
) -> Callable[[float], tuple[Callable[[], Any], Callable[[], dict[str, Any]]]]:
    """CVODES, Adams' formulas by functional iteration: nothing here is stiff."""

    def prepare(tolerance: float) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
        options = {
            "abstol": tolerance, "reltol": tolerance, "linear_multistep_method": "adams",
            "nonlinear_solver_iteration": "functional", "max_num_steps": 1_000_000,
        }  # fmt: skip
        run = ca.integrator("run", "cvodes", {"x": state, "ode": slope}, 0.0, T, options)
        last: list[Any] = []

        def integrate() -> None:
            last[:] = [np.array(run(x0=start)["xf"]).ravel()]

        return integrate, lambda: centers(last[0])

    return prepare


def rotation(q: Any) -> Any:
    """Of a quaternion w, x, y, z of any length."""
    w, v = q[0], q[1:4]
    hat = ca.skew(v)
    return ca.SX.eye(3) + 2.0 / ca.dot(q, q) * (w * hat + hat @ hat)


def chain(name: str) -> Way:
    """Bars on balls."""
    links = bars(name)
    n = len(links)
    state = ca.SX.sym("y", 7 * n)
    q = [state[4 * k : 4 * k + 4] for k in range(n)]
    omega = [state[4 * n + 3 * k : 4 * n + 3 * k + 3] for k in range(n)]
    R = [rotation(x) for x in q]
    arms = [[R[a] @ (links[a].end if a < i else links[a].center) for a in range(i + 1)] for i in range(n)]
    M, h = [[ca.SX.zeros(3, 3) for _ in range(n)] for _ in range(n)], []
    for a in range(n):
        I = R[a] @ ca.SX(ca.DM(links[a].inertia)) @ R[a].T
        M[a][a] += I
        h.append(ca.cross(omega[a], I @ omega[a]))
    for i, bar in enumerate(links):
        swing = ca.SX.zeros(3, 1)
        for b in range(i + 1):
            swing += ca.cross(omega[b], ca.cross(omega[b], arms[i][b]))
        load = bar.mass * (swing + ca.DM([0.0, 0.0, G]))
        for a in range(i + 1):
            h[a] += ca.cross(arms[i][a], load)
            for b in range(i + 1):
                da, db = arms[i][a], arms[i][b]
                M[a][b] += bar.mass * (ca.dot(da, db) * ca.SX.eye(3) - db @ da.T)
    whole = ca.blockcat(M)
    D, L, order = ca.ldl(whole)
    alpha = ca.ldl_solve(-ca.vertcat(*h), D, L, order)
    rates = []
    for k in range(n):
        w, v, s = q[k][0], q[k][1:4], 0.5 * omega[k]
        rates += [-ca.dot(s, v), w * s + ca.cross(s, v)]
    start = np.concatenate([*(quaternion(b.rotation) for b in links), *(b.rotation @ b.omega for b in links)])
    place = ca.SX.zeros(3, 1)
    found = []
    for k, bar in enumerate(links):
        found.append(place + R[k] @ bar.center)
        place = place + R[k] @ bar.end
    told = ca.Function("centers", [state], found)

    def centers(y: np.ndarray) -> dict[str, Any]:
        given = told(y)
        given = given if isinstance(given, tuple) else (given,)
        return {bar.name: np.array(x).ravel() for bar, x in zip(links, given, strict=True)}

    tolerances = [10.0**-k for k in range(3, 17)]
    return Way("CVODES", tolerances, solver(state, ca.vertcat(*rates, alpha), start, duration(name), centers))


def quaternion(R: np.ndarray) -> np.ndarray:
    """w, x, y, z of a rotation by less than a half turn."""
    w = 0.5 * np.sqrt(1.0 + np.trace(R))
    return np.array([w, *(np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4.0 * w))])


def crank() -> Way:
    """One coordinate: E = M(phi) phidot^2 / 2 makes phiddot = -M'(phi) phidot^2 / 2 M."""
    c = Crank()
    m1, m2, m3 = c.masses
    phi, u = ca.SX.sym("phi"), ca.SX.sym("u")
    psi = -ca.asin(c.r / c.length * ca.sin(phi))
    pin = ca.vertcat(c.r * ca.cos(phi), c.r * ca.sin(phi))
    rod = ca.vertcat(ca.cos(psi), ca.sin(psi))
    middle, piston = ca.jacobian(pin + 0.5 * c.length * rod, phi), ca.jacobian(pin + c.length * rod, phi)
    turn = ca.jacobian(psi, phi)
    M = m1 * c.r**2 / 3.0 + m2 * (ca.dot(middle, middle) + c.length**2 / 12.0 * turn**2) + m3 * piston[0] ** 2
    slope = ca.vertcat(u, -0.5 * ca.jacobian(M, phi) * u**2 / M)

    def centers(y: np.ndarray) -> dict[str, Any]:
        return crank_centers(y[0], -np.arcsin(c.r / c.length * np.sin(y[0])))

    start, tolerances = np.array([c.angle, c.rate]), [10.0**-k for k in range(3, 17)]
    return Way("CVODES", tolerances, solver(ca.vertcat(phi, u), slope, start, duration("crank"), centers))


def ways(name: str) -> list[Way]:
    """SUNDIALS' Adams' method."""
    return [crank() if name == "crank" else chain(name)]
