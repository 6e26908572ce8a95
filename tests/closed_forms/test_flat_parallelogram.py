"""A parallelogram lying flat on a line: rank 16 of 20, and of its rates only those of its two branches pass.

manual/theory.md, "Singular poses": to second order (φ̇ − ψ̇)(3φ̇ + ψ̇) = 0, φ the crank, ψ the rocker: it opens as a
parallelogram, ψ = φ, or as crossed bars, tan ψ/2 = −3 tan φ/2.
"""

from __future__ import annotations

import copy
import json
from typing import Any

import numpy as np
import pytest

from heuncli.app.cli.entry import enter
from heuncli.base.errors import SolveError
from tests.oracle.read import start_state
from tests.oracle.solve import solve
from tests.oracle.values import to_yaml
from tests.shared.parallelogram import parallelogram_in_line
from tests.shared.scenes import moving, near, solved


def some_rates(**rates: float) -> dict[str, Any]:
    """The flat scene with the rates of these bars alone, all else left to the assembly."""
    scene = copy.deepcopy(parallelogram_in_line(0.0, 0.0))
    for name, body in scene["bodies"].items():
        del body["velocity"], body["angular_velocity"]
        if name in rates:
            body["angular_velocity"] = [0.0, 0.0, rates[name]]
    return scene


@pytest.mark.parametrize("rates", [(1, 1), (1, -3), (-2, -2), (0.5, -1.5)])
def test_rates_of_a_branch_pass(rates: tuple[float, float]) -> None:
    """Accelerations and what is certain as the oracle has them; along the line all is open, and a warning says why."""
    scene = parallelogram_in_line(*rates)
    found, wanted = solved(scene), solve(scene, start_state(scene))
    assert (wanted.rows, wanted.rank, wanted.residual < 1e-14) == (20, 16, True)
    assert (found.model["freedoms"], found.model["redundant"]) == (1, 3)  # as in any other pose
    assert "the start is a singular position: 1 constraint is redundant only there" in found.model["notes"]
    assert any("singular position at t = 0" in w for w in found.warnings)
    for name, body in found.bodies.items():
        near(body["center_acceleration"][0], wanted.acceleration[name], 10.0, 1e-13)
        near(body["angular_acceleration"][0], wanted.angular_acceleration[name], 10.0, 1e-13)
    for name, block in found.joints.items():
        assert np.isnan(block["force"][0]).tolist() == [True, False, True]
        near(block["force"][0, 1], wanted.reactions[name].force[1], 10.0, 1e-13)


@pytest.mark.parametrize("rates", [(1, 2), (1, 0), (0, 1), (1, -1)])
def test_other_rates_have_no_acceleration(rates: tuple[float, float]) -> None:
    with pytest.raises(SolveError) as caught:
        solved(parallelogram_in_line(*rates))
    assert caught.value.problems[0].code == "singular-pose"


def test_refused_with_exit_code_and_reason(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    codes = {}
    for rates in ((1, 1), (1, -3), (1, 2)):
        path = tmp_path / "flat.yaml"
        path.write_text(to_yaml(parallelogram_in_line(*rates)))
        codes[rates] = enter(["run", str(path), "--format", "json"])
        out, err = capsys.readouterr()
        if codes[rates] == 0:
            assert json.loads(out)["joints"]["A"]["force"][0][0] is None
        else:
            assert out == ""
            assert "singular position" in err and "no acceleration" in err and "[singular-pose]" in err
            assert "rate of one more joint" in err
    assert codes == {(1, 1): 0, (1, -3): 0, (1, 2): 3}


def test_one_rate_does_not_choose_the_branch() -> None:
    """The crank's alone is refused with what to do; with the rocker's it is done."""
    with pytest.raises(SolveError, match="rate of one more joint"):
        solved(some_rates(crank=1.0))
    for rocker in (1.0, -3.0):
        found = solved(some_rates(crank=1.0, rocker=rocker))
        near(found.bodies["coupler"]["angular_velocity"][0], (0, 0, (rocker - 1.0) / 2), 1.0, 1e-12)


@pytest.mark.heavy
@pytest.mark.parametrize(("rocker", "ratio"), [(1.0, 1.0), (-3.0, -3.0)])
def test_each_keeps_to_its_branch(rocker: float, ratio: float) -> None:
    """Started flat, without weight: all the way as a parallelogram, or as crossed bars."""
    scene = {**parallelogram_in_line(1.0, rocker), "gravity": [0, 0, 0]}
    found = solved(moving(scene, (0.0, 0.2, 0.4, 0.6), 1e-9)).bodies
    R = (found[name]["rotation"] for name in ("crank", "rocker"))
    crank, other = (np.arctan2(r[:, 1, 0], r[:, 0, 0]) for r in R)
    assert crank[-1] > 0.5
    near(np.tan(other / 2), ratio * np.tan(crank / 2), 1.0, 1e-7)
