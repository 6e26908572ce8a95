"""Robots that others described: converted, or refused with every fault by its link; what is repaired says so."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from tests.shared.imported_robots import called_before, imported_robot
from tests.shared.scenes import near, solved

ROBOTS = Path(__file__).parent / "robots"
REPAIRS = frozenset({"negative", "triangle", "zero"})
# the file: what is wrong with it, and how often
PUBLIC = {
    "anymal_c": {"import-inertia": 5}, "double_pendulum": {}, "human": {}, "panda": {},
    "qbmove_2dof": {}, "quadruped": {"import-inertia": 4}, "simple_humanoid": {}, "so101": {"import-inertia": 1},
}  # fmt: skip


def text_of(name: str) -> str:
    return (ROBOTS / f"{name}.urdf").read_text()


def test_every_public_robot_is_here_with_its_source() -> None:
    told = (ROBOTS / "SOURCES.md").read_text()
    assert {path.stem for path in ROBOTS.glob("*.urdf")} == set(PUBLIC)
    assert all(f"`{path.name}`" in told for path in ROBOTS.iterdir() if path.name != "SOURCES.md")


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_robot_is_converted_or_refused_by_name(name: str) -> None:
    faults = PUBLIC[name]
    if not faults:
        solved(imported_robot(text_of(name)).spec_of_tests)
        return
    with pytest.raises(SpecError) as refused:
        imported_robot(text_of(name))
    links = {link.get("name") for link in ElementTree.fromstring(text_of(name)).iter("link")}
    assert {problem.code: 0 for problem in refused.value.problems} == dict.fromkeys(faults, 0)
    assert len(refused.value.problems) == sum(faults.values())
    for problem in refused.value.problems:
        assert problem.location is not None and problem.location.line > 1
        assert problem.location.path.removeprefix("link ") in links
        assert problem.hint


@pytest.mark.parametrize("name", ["anymal_c", "quadruped", "so101"])
def test_only_what_a_comment_names_is_repaired(name: str) -> None:
    """Of every body mass and principal moments are the file's, or a comment beside the number says otherwise."""
    robot = imported_robot(text_of(name), repair=REPAIRS)
    given = {link.get("name"): link.find("inertial") for link in ElementTree.fromstring(text_of(name)).iter("link")}
    repaired = 0
    for body in robot.machine.bodies:
        inertial = given[called_before("link", body)]
        assert inertial is not None
        mass, moments = inertial.find("mass"), inertial.find("inertia")
        assert mass is not None and moments is not None
        assert body.mass == float(mass.get("value", "nan"))
        xx, xy, xz, yy, yz, zz = (float(moments.get(key, "nan")) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        wanted = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        found = np.linalg.eigvalsh(np.array(body.inertia))
        if "repaired" in body.notes.get("inertia", ""):
            repaired += 1
            assert body.notes["inertia"] in robot.text
            assert found[0] >= 0 and found[2] <= (found[0] + found[1]) * (1 + 1e-9)  # as of a body
        else:
            near(found, wanted, wanted[2], 1e-14)
    assert repaired == sum(PUBLIC[name].values())
    assert robot.text.count("repaired (") == repaired
    solved(robot.spec_of_tests)
