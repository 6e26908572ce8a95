"""Equalities of MuJoCo's, imported: loops close where MuJoCo says they do, and what drives them is d'Alembert's share.

Of a machine of coordinates q whose equalities leave q' = G u' (J G = 0, u the driven coordinates) the drives are
G^T tau, tau what MuJoCo's inverse dynamics of the open tree says of q, q', q'' as heun finds them.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.scene.importers.spec_text import format_spec
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import described, imported
from tests.shared.mjcf_trees import random_tree, words
from tests.shared.scenes import near

mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
pytestmark = pytest.mark.heavy
RATES = {"angle": "rate", "travel": "speed"}
POLE = (
    '<body name="pole" pos="0.5 2 1"><joint name="pole"/><geom size="0.1" pos="0 0 0.3"/>'
    '<site name="end" pos="0.4 0 0"/></body>'
)
CUP = "".join(
    f'<joint name="{type}_{number}" type="{type}" axis="{axis}"/>'
    for type in ("slide", "hinge")
    for number, axis in enumerate(("1 0 0", "0 1 0.2", "0.1 0 1"))
)
CUP = f'<body name="cup" pos="0.3 0.1 0">{CUP}<geom size="0.1" pos="0.1 0 0.3"/></body>'
DENSE = 'jacobian="dense"'


def closed(rng: np.random.Generator, names: list[str], kind: int) -> str:
    """One of each: a connect by a point, a rod, two couplings of which one hangs on the other; or a weld, as drawn or
    turned; or fixed tendons that stay, or follow one another.
    """
    if kind == 0:
        return f"""<tendon><fixed name="f"><joint joint="{names[0]}" coef="1.3"/><joint joint="{names[1]}" coef="-2"/>
            <joint joint="{names[2]}" coef="0.4"/></fixed><fixed name="g"><joint joint="{names[2]}" coef="1"/>
            <joint joint="{names[3]}" coef="0.4"/></fixed><fixed name="h"><joint joint="{names[4]}" coef="2"/></fixed>
            </tendon><equality><tendon tendon1="f" polycoef="0.02 0 0 0 0"/>
            <tendon name="fg" tendon1="g" tendon2="f" polycoef="0.03 -0.5 0 0 0"/>
            <tendon name="held" tendon1="h" polycoef="0.04 0 0 0 0"/></equality>"""
    if kind == 1:
        turned = words(np.array([1.0, 0.2, -0.3, 0.5]) * rng.uniform(1, 2))
        return f'<equality><weld name="turned" body1="b1" body2="cup" relpose=".1 .2 0 {turned}"/></equality>'
    if kind == 2:
        return f"""<tendon><spatial name="bar"><site site="wall"/><site site="end"/></spatial></tendon><equality>
            <connect name="closed" body1="b1" body2="b0" anchor="{words(rng.normal(size=3))}"/>
            <tendon tendon1="bar"/><joint joint1="{names[0]}" joint2="{names[1]}" polycoef="0.01 0.5 -2 0 0"/>
            <joint joint1="{names[2]}" joint2="{names[0]}" polycoef="-0.02 3 0 0.1 0"/>
            <joint joint1="{names[3]}" polycoef="0.03 0 0 0 0"/></equality>"""
    return '<equality><weld name="closed" body1="b0" body2="b1"/></equality>'


@pytest.mark.parametrize("seed", range(12))
def test_loops_close_and_are_driven_as_mujocos_own_rows_and_torques_say(seed):
    rng = np.random.default_rng(200 + seed)
    tree = random_tree(rng, 7, ("hinge", "slide"), loads=True)
    rest = closed(rng, [name for name, _ in tree.joints], seed % 4)
    tree.text += POLE + CUP * ("cup" in rest)
    xml = tree.model(DENSE, rest)
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    machine = described(xml)
    motions = {one.name: f"({one.name} + {rng.normal()!r}*t + {rng.normal()!r}*t**2)" for one in machine.parameters}
    drives = [
        drive._replace(
            keys={
                key: law if type(law) is float or key == "joint" else with_motions(law, motions)
                for key, law in drive.keys.items()
            }
        )
        for drive in machine.drives
    ]
    moved = {
        parameter.name: f"{rng.normal() * 0.02 + _start(model, parameter.name)!r}" for parameter in machine.parameters
    }
    spec = load("loops.yaml", format_spec(machine._replace(drives=tuple(drives)), "loops.yaml"), overrides=moved)
    results = solve(spec, Options(requested_reports=frozenset({"motion", "joints"}))).results
    acceleration = set_state(model, data, results)
    J, gaps = np.array(data.efc_J).reshape(-1, model.nv)[: data.ne], np.array(data.efc_pos)[: data.ne]
    closing = np.array(
        [
            model.eq_type[k] != mujoco.mjtEq.mjEQ_JOINT and model.eq(k).name != "held"
            for k in np.array(data.efc_id)[: data.ne]
        ]
    )
    # couplings are drives, which have efforts of their own
    near(gaps, np.zeros(len(gaps)), 1.0, 1e-9)
    near(J @ data.qvel, np.zeros(len(gaps)), 1.0, 1e-8)
    J = J[closing]
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
    data.qacc[:] = acceleration
    mujoco.mj_inverse(model, data)
    driven = [model.joint(str(drive.keys["joint"])).id for drive in machine.drives if drive.keys["joint"] != "turned"]
    _, s, V = np.linalg.svd(J)
    N = V[int((s > 1e-9).sum()) :].T
    G = N @ np.linalg.inv(N[driven])
    found = [results.joints[model.joint(number).name]["drive"][0] for number in driven]
    near(found, G.T @ data.qfrc_inverse, float(np.abs(data.qfrc_inverse).max() * np.abs(G).max()), 1e-9)


@pytest.mark.parametrize("kind", [0, 1, 3])
def test_what_is_let_go_accelerates_within_the_equalities_as_its_torques_say(kind):
    """Gauss: M q'' less the torques works on no motion that the equalities allow; and q'' keeps to them."""
    rng = np.random.default_rng(300 + kind)
    tree = random_tree(rng, 7, ("hinge", "slide"), loads=True)
    rest = closed(rng, [name for name, _ in tree.joints], kind)
    tree.text += CUP * ("cup" in rest)
    xml = tree.model(DENSE, rest)
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    spec = load("free.yaml", imported(xml, free=True) + "\nanalysis: {type: state}\n")
    acceleration = set_state(model, data, solve(spec, Options(requested_reports=frozenset({"motion"}))).results)
    J = np.array(data.efc_J).reshape(-1, model.nv)[: data.ne]
    near(np.array(data.efc_pos)[: data.ne], np.zeros(len(J)), 1.0, 1e-9)
    near(J @ acceleration, np.zeros(len(J)), float(np.abs(acceleration).max()), 1e-9)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
    data.qacc[:] = acceleration
    mujoco.mj_inverse(model, data)
    _, s, V = np.linalg.svd(J)
    free = V[int((s > 1e-9).sum()) :]
    assert len(free) > 3
    near(free @ data.qfrc_inverse, np.zeros(len(free)), float(np.abs(data.qfrc_inverse).max()), 1e-9)


def set_state(model, data, results):
    """Set MuJoCo's state to that of results at their first instant. Returns the accelerations."""
    for number in range(model.njnt):
        name, at = model.joint(number).name, int(model.jnt_qposadr[number])
        block = results.coordinates[name]
        key = "angle" if "angle" in block else "travel"
        data.qpos[at] = block[key][0] + model.qpos0[at]
        data.qvel[at], data.qacc[at] = block[RATES[key]][0], block["acceleration"][0]
    acceleration = np.array(data.qacc)
    mujoco.mj_forward(model, data)
    return acceleration


def with_motions(law: str, motions: dict[str, str]) -> str:
    """A law of drives with motions in the place of parameters."""
    return re.sub(r"[a-z]\w*", lambda found: motions.get(found[0], found[0]), law)


def _start(model, name: str) -> float:
    return float(model.qpos0[model.jnt_qposadr[model.joint(name).id]])
