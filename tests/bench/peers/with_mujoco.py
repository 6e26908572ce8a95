"""MuJoCo: a body's own tree of balls, Runge-Kutta 4 in C, all steps in one call; the loop of `crank` by a connect.

A connect is soft: its stiffness is the setting beside the step (`solref` negative: stiffness and damping themselves).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from tests.bench.peers.scenes import Crank, G, bars, crank_centers, duration
from tests.bench.peers.ways import Way

FLAGS = '<flag contact="disable" warmstart="disable" {}/>'
NO_CONSTRAINTS = 'constraint="disable"'
mujoco.set_mju_user_warning(lambda _: None)  # of steps too coarse for the motion: else a file in the working folder


def version() -> str:
    """Its version."""
    return str(mujoco.__version__)


def quaternion(R: np.ndarray) -> np.ndarray:
    """w, x, y, z of a rotation."""
    q = np.zeros(4)
    mujoco.mju_mat2Quat(q, np.ascontiguousarray(R).ravel())
    return q


def chain_xml(name: str) -> str:
    """Bars on balls, drawn with their axes as the world's."""
    text, at = "", np.zeros(3)
    links = bars(name)
    for bar in links:
        I = bar.inertia
        full = " ".join(repr(float(x)) for x in (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]))
        text += f'<body name="{bar.name}" pos="{words(at)}"><joint type="ball"/>'
        text += f'<inertial pos="{words(bar.center)}" mass="{bar.mass!r}" fullinertia="{full}"/>'
        at = bar.end
    text += "</body>" * len(links)
    option = f'<option integrator="RK4" gravity="0 0 -{G}">{FLAGS.format(NO_CONSTRAINTS)}</option>'
    return f'<mujoco><compiler balanceinertia="false"/>{option}<worldbody>{text}</worldbody></mujoco>'


def words(a: np.ndarray) -> str:
    """Three numbers."""
    return " ".join(repr(float(x)) for x in a)


def chain(name: str) -> Way:
    """The chains: steps from coarse to fine."""
    model = mujoco.MjModel.from_xml_string(chain_xml(name))
    data, links, T = mujoco.MjData(model), bars(name), duration(name)
    start, rates = np.zeros(model.nq), np.zeros(model.nv)
    before = np.eye(3)
    rate_before = np.zeros(3)  # of the link before, world axes
    for k, bar in enumerate(links):
        start[4 * k :][:4] = quaternion(before.T @ bar.rotation)
        sigma = bar.rotation @ bar.omega
        rates[3 * k :][:3] = bar.rotation.T @ (sigma - rate_before)
        before, rate_before = bar.rotation, sigma

    def prepare(count: int) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
        model.opt.timestep = T / count

        def integrate() -> None:
            model.opt.timestep = T / count
            mujoco.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = start, rates
            mujoco.mj_step(model, data, nstep=count)

        def centers() -> dict[str, Any]:
            mujoco.mj_forward(model, data)
            return {bar.name: data.body(bar.name).xipos.copy() for bar in links}

        return integrate, centers

    return Way("RK4", [25 * 2**k for k in range(11)], prepare)


def crank_xml(stiffness: float) -> str:
    """Crank, rod, and a piston on a slide, to which the rod is connected."""
    c = Crank()
    m1, m2, m3 = c.masses
    a, b = m1 * c.r**2 / 12.0, m2 * c.length**2 / 12.0
    damping = 2.0 * np.sqrt(stiffness)
    thin = 1e-9  # out of the plane nothing turns
    return f"""<mujoco><compiler balanceinertia="false"/>
<option integrator="RK4" gravity="0 0 0" solver="Newton" tolerance="1e-15" iterations="50" jacobian="dense">
{FLAGS.format("")}</option>
<worldbody>
<body name="crank"><joint name="phi" type="hinge" axis="0 0 1"/>
<inertial pos="{c.r / 2} 0 0" mass="{m1}" diaginertia="{thin} {a} {a}"/>
<body name="rod" pos="{c.r} 0 0"><joint name="psi" type="hinge" axis="0 0 1"/>
<inertial pos="{c.length / 2} 0 0" mass="{m2}" diaginertia="{thin} {b} {b}"/></body></body>
<body name="piston"><joint name="x" type="slide" axis="1 0 0"/>
<inertial pos="0 0 0" mass="{m3}" diaginertia="{c.piston_inertia} {c.piston_inertia} {c.piston_inertia}"/></body>
</worldbody>
<equality><connect body1="rod" body2="piston" anchor="{c.length} 0 0" solref="-{stiffness} -{damping}"
solimp="0.9999 0.9999 0.001"/></equality></mujoco>"""


def crank() -> Way:
    """The crank: steps and stiffnesses of the connect together."""
    c, T = Crank(), duration("crank")
    psi, psi_rate = c.start

    def prepare(setting: tuple[int, float]) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
        count, stiffness = setting
        model = mujoco.MjModel.from_xml_string(crank_xml(stiffness))
        model.opt.timestep = T / count
        # the anchor on the piston is taken where the bodies are drawn: it belongs in its origin
        model.eq_data[0, 3:6] = 0.0
        data = mujoco.MjData(model)
        x = c.r * np.cos(c.angle) + c.length * np.cos(psi)
        speed = -c.r * np.sin(c.angle) * c.rate - c.length * np.sin(psi) * psi_rate

        def integrate() -> None:
            mujoco.mj_resetData(model, data)
            data.qpos[:] = c.angle, psi - c.angle, x
            data.qvel[:] = c.rate, psi_rate - c.rate, speed
            mujoco.mj_step(model, data, nstep=count)

        def centers() -> dict[str, Any]:
            phi, relative, at = data.qpos
            return crank_centers(phi, phi + relative, at)

        return integrate, centers

    counts, parts = [125 * 2**k for k in range(10)], (0.3, 0.7)
    settings = [(count, (part * count / T) ** 2) for count in counts for part in parts]
    return Way("RK4, tuned", settings, prepare)


def ways(name: str) -> list[Way]:
    """Its one method of order above 2."""
    return [crank() if name == "crank" else chain(name)]
