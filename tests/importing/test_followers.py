"""Joints that follow others, let go: couplings hold them; what leads feels their inertia by the ratio's square."""

from __future__ import annotations

import pytest

from heuncli.base.errors import SpecError
from tests.shared.imported import imported
from tests.shared.scenes import near, solved

INERTIA = '<inertia ixx="0.3" iyy="0.5" izz="0.3" ixy="0" ixz="0" iyz="0"/>'
URDF = f"""<robot name="grip">
<link name="base"><inertial><mass value="1"/>{INERTIA}</inertial></link>
<link name="a"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>{INERTIA}</inertial></link>
<link name="b"><inertial><mass value="2"/>{INERTIA}</inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/></joint>
<joint name="k" type="continuous"><parent link="base"/><child link="b"/><axis xyz="0 1 0"/>
<mimic joint="j" multiplier="-2" offset="0.3"/></joint>
</robot>"""
MJCF = """<mujoco><worldbody>
<body name="a"><joint name="j" axis="0 1 0"/><inertial pos="0.1 0 0" mass="2" diaginertia="0.3 0.5 0.3"/></body>
<body name="b"><joint name="k" axis="0 1 0"/><inertial pos="0 0 0" mass="2" diaginertia="0.3 0.5 0.3"/></body>
</worldbody><equality><joint joint1="k" joint2="j" polycoef="{}"/></equality></mujoco>"""


@pytest.mark.parametrize("model", [URDF, MJCF.format("0.3 -2 0 0 0")], ids=["URDF", "MJCF"])
def test_what_follows_is_coupled_where_joints_are_free(model: str) -> None:
    found = solved(imported(model, free=True))
    near(found.coordinates["k"]["angle"], 0.3, 1.0, 1e-15)
    turned = 2 * 9.81 * 0.1 / (0.5 + 2 * 0.01 + 4 * 0.5)  # z is up: turning on about y lowers what lies along x
    near(found.coordinates["j"]["acceleration"], turned, turned, 1e-12)
    near(found.coordinates["k"]["acceleration"], -2 * turned, turned, 1e-12)


def test_what_follows_by_a_curve_is_refused_where_joints_are_free() -> None:
    with pytest.raises(SpecError) as refused:
        imported(MJCF.format("0 1 1 0 0"), free=True)
    (problem,) = refused.value.problems
    assert problem.code == "import-mimic" and problem.hint
