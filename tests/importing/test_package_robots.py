"""Robots of packages that pip installs, where they are: read, or refused for a reason of mechanics; MuJoCo agrees.

pip install --no-deps airo-models compas-fab drake example-robot-data genesis-world icub-models mani-skill \
    pybullet robosuite robosuite-models rtb-data
"""

from __future__ import annotations

from collections import Counter
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from heuncli.scene.importers.description import clean_name
from heuncli.scene.importers.readers import READERS
from heuncli.scene.importers.spec_text import format_spec
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.imported import described
from tests.shared.scenes import near

pytestmark = pytest.mark.heavy
REPAIRS = frozenset(READERS[0].repairs)
# of URDF: those that are read, those that are with all repairs, all
COUNTS = {
    "airo-models": (7, 15, 16), "compas-fab": (3, 6, 6), "drake": (13, 14, 14), "example-robot-data": (39, 67, 69),
    "genesis-world": (13, 25, 34), "icub-models": (13, 16, 16), "mani-skill": (32, 48, 60),
    "pybullet": (1057, 1074, 1095), "robosuite": (4, 4, 5), "rtb-data": (3, 8, 9),
}  # fmt: skip
MODELS = {"robosuite": 21, "robosuite-models": 18}  # of MuJoCo that hold themselves by drives alone
REASONS = {  # of mechanics, and a file that describes nothing
    "import-inertia",
    "import-joint",
    "import-mass",
    "import-massless",
    "import-mimic",
    "import-missing",
    "import-part",
    "import-tree",
}
DAMAGE = {"import-number", "import-twice", "import-xacro", "not-xml"}  # of the file itself: words for numbers, two axes
MOST_DAMAGED = 7  # files of one package  # fmt: skip


def list_files(package: str, ending: str) -> list[Path]:
    try:
        files = metadata.distribution(package).files or []
    except metadata.PackageNotFoundError:
        pytest.skip(f"needs the package {package}")
    return sorted(Path(str(file.locate())) for file in files if file.name.endswith(ending))


def find_refusal(file: Path, repairs: frozenset[str]) -> str:
    """Return the code for which a file is refused, or an empty text where its spec loads."""
    try:
        machine = described(file.read_bytes(), str(file), repair=repairs)
        load("robot.yaml", format_spec(machine, "robot.yaml"), checking=False)
    except SpecError as error:
        return error.problems[0].code
    return ""


@pytest.mark.parametrize("package", COUNTS)
def test_robots_are_read_or_refused_for_a_reason_of_mechanics(package: str) -> None:
    files = list_files(package, ".urdf")
    plain, repaired = (Counter(find_refusal(file, repairs) for file in files) for repairs in (frozenset(), REPAIRS))
    assert {*plain, *repaired} <= REASONS | DAMAGE | {""}
    assert sum(repaired[code] for code in DAMAGE) <= MOST_DAMAGED
    read, mended, count = COUNTS[package]
    assert plain[""] >= read and repaired[""] >= mended and len(files) >= count, (plain, repaired)


@pytest.mark.parametrize("package", MODELS)
def test_models_hold_themselves_as_mujoco_says(package: str) -> None:
    mujoco = pytest.importorskip("mujoco", reason="needs the package mujoco: pip install -e '.[test]'")
    compared = 0
    for file in list_files(package, ".xml"):
        if b"<mujoco" not in file.read_bytes():
            continue
        try:
            model = mujoco.MjModel.from_xml_path(str(file))
            machine = described(file.read_bytes(), str(file))
        except (ValueError, SpecError):
            continue
        if model.neq or not set(model.jnt_type.tolist()) <= {
            int(mujoco.mjtJoint.mjJNT_SLIDE),
            int(mujoco.mjtJoint.mjJNT_HINGE),
        }:
            continue
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        data = mujoco.MjData(model)
        mujoco.mj_inverse(model, data)
        spec = load("m.yaml", format_spec(machine, "m.yaml"), checking=False)
        found = solve(spec, Options(requested_reports=frozenset({"joints"}))).results.joints
        names = [clean_name(model.joint(k).name, "joint") for k in range(model.njnt)]
        if all(name in found for name in names):
            efforts = [found[name]["drive"][0] for name in names]
            near(efforts, data.qfrc_inverse, float(np.abs(data.qfrc_inverse).max()) + 1e-9, 1e-12)
            compared += 1
    assert compared >= MODELS[package], compared
