"""Exudyn: balls as three revolute joints of its kinematic tree, explicit methods in C++; `crank` by plane bodies.

A tree has no balls. Its angles begin at zero where each bar starts (of the top: where it is drawn, for its spin).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    MarkerBodyRigid,
    NodeGenericODE2,
    NodeRigidBody2D,
    ObjectGround,
    ObjectJointPrismatic2D,
    ObjectJointRevolute2D,
    ObjectKinematicTree,
    ObjectRigidBody2D,
)

from tests.bench.peers.scenes import Crank, G, bars, crank_centers, duration
from tests.bench.peers.ways import Way

FIXED = ("RK44", "RK67")


def version() -> str:
    """Its version."""
    return str(exu.__version__)


def turn(axis: int, angle: float) -> np.ndarray:
    """About x, y or z."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
    return R


def settings_of(T: float, count: int, tolerance: float | None) -> Any:
    """Of its solver: so many steps, or steps by a tolerance; nothing written, nothing told."""
    given = exu.SimulationSettings()
    given.timeIntegration.endTime = T
    given.timeIntegration.numberOfSteps = count
    given.timeIntegration.verboseMode = 0
    given.timeIntegration.automaticStepSize = tolerance is not None
    if tolerance is not None:
        given.timeIntegration.absoluteTolerance = given.timeIntegration.relativeTolerance = tolerance
        given.timeIntegration.initialStepSize = 1e-4
    given.solutionSettings.writeSolutionToFile = False
    given.solutionSettings.sensorsWritePeriod = T
    given.displayComputationTime = False
    given.displayStatistics = False
    return given


def runs(
    mbs: Any, solver: Any, given: Any, centers: Callable[[np.ndarray], dict[str, Any]]
) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
    """A system solved from its start."""

    def integrate() -> None:
        mbs.SolveDynamic(given, solverType=solver, updateInitialValues=False, showHints=False)

    return integrate, lambda: centers(np.array(mbs.systemData.GetODE2Coordinates()))


def tree(name: str) -> tuple[Any, Callable[[np.ndarray], dict[str, Any]]]:
    """The chain as a kinematic tree, and the centres from its angles."""
    links, n = bars(name), len(bars(name))
    spinning = name == "top"
    SC = exu.SystemContainer()
    mbs = SC.AddSystem()
    angles, rates, drawn = np.zeros(3 * n), np.zeros(3 * n), []
    before, rate_before = np.eye(3), np.zeros(3)
    for k, bar in enumerate(links):
        sigma = bar.rotation @ bar.omega
        relative = bar.rotation.T @ (sigma - rate_before)
        drawn.append(np.eye(3) if spinning else before.T @ bar.rotation)
        if spinning:  # 30 deg about x, then the spin about z: the rates are the angular velocity's in the turned axes
            angles[0] = np.arctan2(bar.rotation[2, 1], bar.rotation[2, 2])
            rates[:] = 0.0, 0.0, bar.omega[2]
        else:
            rates[3 * k :][:3] = relative
        before, rate_before = bar.rotation, sigma
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * 3 * n, initialCoordinates=angles.tolist(), initialCoordinates_t=rates.tolist(),
            numberOfODE2Coordinates=3 * n,
        )
    )  # fmt: skip
    masses, centres, inertias, offsets, transformations = [], [], [], [], []
    for k, bar in enumerate(links):
        masses += [0.0, 0.0, bar.mass]
        centres += [[0.0] * 3, [0.0] * 3, bar.center.tolist()]
        inertias += [np.zeros((3, 3)), np.zeros((3, 3)), bar.inertia]
        offsets += [links[k - 1].end.tolist() if k else [0.0] * 3, [0.0] * 3, [0.0] * 3]
        transformations += [drawn[k], np.eye(3), np.eye(3)]
    mbs.AddObject(
        ObjectKinematicTree(
            nodeNumber=node, jointTypes=[exu.JointType.RevoluteX, exu.JointType.RevoluteY, exu.JointType.RevoluteZ] * n,
            linkParents=[k - 1 for k in range(3 * n)], jointTransformations=exu.Matrix3DList(transformations),
            jointOffsets=exu.Vector3DList(offsets), linkInertiasCOM=exu.Matrix3DList(inertias),
            linkCOMs=exu.Vector3DList(centres), linkMasses=masses, gravity=[0.0, 0.0, -G],
        )
    )  # fmt: skip
    mbs.Assemble()

    def centers(q: np.ndarray) -> dict[str, Any]:
        found, R, at = {}, np.eye(3), np.zeros(3)
        for k, bar in enumerate(links):
            R = R @ drawn[k] @ turn(0, q[3 * k]) @ turn(1, q[3 * k + 1]) @ turn(2, q[3 * k + 2])
            found[bar.name] = at + R @ bar.center
            at = at + R @ bar.end
        return found

    return (SC, mbs), centers


def chain(name: str) -> list[Way]:
    """Methods of fixed steps, and the adaptive one of order 5."""
    (container, mbs), centers = tree(name)
    T = duration(name)

    def fixed(solver: Any) -> Callable[[int], tuple[Callable[[], Any], Callable[[], dict[str, Any]]]]:
        return lambda count: runs(mbs, solver, settings_of(T, count, None), centers)

    found = [
        Way(label, [25 * 2**k for k in range(10)], fixed(getattr(exu.DynamicSolverType, label))) for label in FIXED
    ]
    adaptive = exu.DynamicSolverType.DOPRI5
    tolerances = [10.0**-k for k in range(3, 14)]
    found.append(Way("DOPRI5", tolerances, lambda x: runs(mbs, adaptive, settings_of(T, 100, x), centers)))
    KEPT.append(container)
    return found


KEPT: list[Any] = []  # containers own their systems


def crank() -> list[Way]:
    """Plane bodies with its own joints, and its generalised-alpha method, implicit, of order 2."""
    c, T = Crank(), duration("crank")
    m1, m2, m3 = c.masses
    psi, psi_rate = c.start
    SC = exu.SystemContainer()
    mbs = SC.AddSystem()
    KEPT.append(SC)
    pin = c.r * np.array([np.cos(c.angle), np.sin(c.angle)])
    pin_rate = c.rate * np.array([-pin[1], pin[0]])
    half = 0.5 * c.length * np.array([np.cos(psi), np.sin(psi)])
    half_rate = psi_rate * np.array([-half[1], half[0]])
    x = c.r * np.cos(c.angle) + c.length * np.cos(psi)
    starts = [(0.5 * pin, 0.5 * pin_rate, c.angle, c.rate, m1, m1 * c.r**2 / 12.0),
              (pin + half, pin_rate + half_rate, psi, psi_rate, m2, m2 * c.length**2 / 12.0),
              (np.array([x, 0.0]), pin_rate + 2.0 * half_rate, 0.0, 0.0, m3, c.piston_inertia)]  # fmt: skip
    bodies = []
    for at, v, angle, rate, mass, inertia in starts:
        node = mbs.AddNode(
            NodeRigidBody2D(referenceCoordinates=[*at, angle], initialVelocities=[v[0], v[1] if rate else 0.0, rate])
        )
        bodies.append(mbs.AddObject(ObjectRigidBody2D(physicsMass=mass, physicsInertia=inertia, nodeNumber=node)))
    ground = mbs.AddObject(ObjectGround())

    def marker(body: int, along: float) -> int:
        return int(mbs.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=[along, 0.0, 0.0])))

    half_crank, half_rod = 0.5 * c.r, 0.5 * c.length
    for a, along_a, b, along_b in (
        (ground, 0.0, bodies[0], -half_crank), (bodies[0], half_crank, bodies[1], -half_rod),
        (bodies[1], half_rod, bodies[2], 0.0),
    ):  # fmt: skip
        mbs.AddObject(ObjectJointRevolute2D(markerNumbers=[marker(a, along_a), marker(b, along_b)]))
    mbs.AddObject(
        ObjectJointPrismatic2D(
            markerNumbers=[marker(ground, 0.0), marker(bodies[2], 0.0)], axisMarker0=[1.0, 0.0, 0.0],
            normalMarker1=[0.0, 1.0, 0.0], constrainRotation=True,
        )
    )  # fmt: skip
    mbs.Assemble()

    def centers(q: np.ndarray) -> dict[str, Any]:
        return crank_centers(q[2] + c.angle, q[5] + psi, q[6] + x)

    def prepare(count: int) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
        given = settings_of(T, count, None)
        given.timeIntegration.newton.useModifiedNewton = True
        given.timeIntegration.generalizedAlpha.spectralRadius = 1.0
        given.timeIntegration.generalizedAlpha.useIndex2Constraints = True
        given.timeIntegration.generalizedAlpha.useNewmark = True
        return runs(mbs, exu.DynamicSolverType.TrapezoidalIndex2, given, centers)

    return [Way("trapezoidal, index 2", [125 * 2**k for k in range(9)], prepare)]


def ways(name: str) -> list[Way]:
    """Its explicit methods for the chains; for the loop, which they do not integrate, its implicit one."""
    return crank() if name == "crank" else chain(name)
