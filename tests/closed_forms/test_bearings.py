"""Mean pressures of bearings: force over diameter times width."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.scenes import solved

BEARING = "bearing: {diameter: 20 mm, width: 30 mm}"
AREA = 0.02 * 0.03
CRANK = (ROOT / "specs" / "slider_crank.yaml").read_text().split("expect:")[0]
DOOR = (ROOT / "specs" / "door.yaml").read_text().split("expect:")[0]


def test_of_a_slider_crank() -> None:
    text = CRANK.replace("main: {type: pin,", f"main: {{type: pin, {BEARING},")
    text = text.replace("big: {type: line,", f"big: {{type: line, {BEARING},")
    found = solved(text)
    for name in ("main", "big"):
        joint = found.joints[name]
        assert joint["pressure"] == pytest.approx(np.linalg.norm(joint["force"], axis=1) / AREA, rel=1e-14)
    wanted = np.hypot(1084.286433062166, 466.0281685288434) / AREA
    assert found.joints["main"]["pressure"][0] == pytest.approx(wanted, rel=1e-12)
    assert "pressure" not in found.joints["small"]


def test_what_is_open_presses_nobody_knows_how(heun: Heun, folder: Path) -> None:
    """Two hinges share the door's weight as they like: their forces are open, and so are the pressures."""
    text = DOOR.replace("{type: ball,", f"{{type: ball, {BEARING},")
    assert text != DOOR
    (folder / "door.yaml").write_text(text)
    found = json.loads(heun("run", "door.yaml", "--format", "json").stdout)
    joint = next(iter(found["joints"].values()))
    assert joint["pressure"] == [None] * len(found["time"])
    assert "pressure" in joint["open"]
    assert "pressure" in heun("run", "door.yaml").stdout


def test_thrust_that_is_open_leaves_the_pressure_of_a_pin_certain() -> None:
    """A flat linkage in space: along its pins forces are open; what presses on a journal acts across it."""
    text = (ROOT / "specs" / "flat_four_bar.yaml").read_text().split("expect:")[0]
    own = re.sub(r"(\n  A: \{type: pin,)", rf"\1 {BEARING},", text)
    assert own != text
    joint = solved(own).joints["A"]
    assert np.isnan(joint["force"][:, 2]).all()
    assert joint["pressure"] == pytest.approx(np.hypot(*joint["force"][:, :2].T) / AREA, rel=1e-12)


def test_it_is_measured_expected_and_shown(heun: Heun, folder: Path) -> None:
    text = CRANK.replace("main: {type: pin,", f"main: {{type: pin, {BEARING},")
    (folder / "crank.yaml").write_text(text + "expect: [{of: joints.main.pressure, peak: max, below: 2e6}]\n")
    assert float(heun("run", "crank.yaml", "--measure", "max joints.main.pressure").stdout) > 1.9e6
    assert heun("check", "crank.yaml").returncode == 0
    assert "pressure [kPa]" in heun("run", "crank.yaml", "--units", "kPa").stdout
    assert "joints,main,pressure,,Pa," in heun("run", "crank.yaml", "--format", "csv").stdout


@pytest.mark.parametrize(
    ("bearing", "says"),
    [
        ("{diameter: 0 mm, width: 1 mm}", "diameter must be greater than 0"),
        ("{diameter: 1 mm}", "width"),
        ("{diameter: 1 kg, width: 1 mm}", "a mass"),
    ],
)
def test_what_is_refused(bearing: str, says: str) -> None:
    with pytest.raises(SpecError, match=says):
        load("crank.yaml", CRANK.replace("main: {type: pin,", f"main: {{type: pin, bearing: {bearing},"))
    with pytest.raises(SpecError, match="not known here"):
        load("crank.yaml", CRANK.replace("guide: {type: slide,", f"guide: {{type: slide, {BEARING},"))
