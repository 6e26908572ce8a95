"""What is known of one instant on other ways is, to the bit, what is found of it afresh."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.sharing import is_same
from heuncli.scene.file_format.source import read_source
from heuncli.study.compose.recovery import recover
from heuncli.study.model.options import Options
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.queries.measure import find_peak, find_reports
from heuncli.study.search.columns import ChannelSearch
from heuncli.study.workflow import solve
from tests.shared.folders import ROOT, SPECS

BODIES = ("R", "x", "v", "a", "omega", "alpha", "centre", "v_centre", "a_centre")
JOINTS = ("point", "force", "moment", "axis", "drive", "tension")
SCENES = (*sorted(SPECS.glob("*.yaml")), ROOT / "heuncli" / "starters" / "truss.yaml")
LEFT_OUT = ("expect", "report", "cases", "impulses")  # of a scene as it stands at its start


def at_its_start(path: Path) -> str:
    """The text of a scene of which the instant of its start is asked for."""
    data = {key: value for key, value in read_source(str(path), None).data.items() if key not in LEFT_OUT}
    return json.dumps(data | {"analysis": {"type": "state"}})


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
@pytest.mark.third
def test_states_that_were_compared_are_those_found_afresh(path: Path) -> None:
    study = solve(load(str(path), at_its_start(path)), Options())
    afresh = recover(study.setup, study.history.solutions, study.options.least_norm)
    for name in BODIES:
        assert is_same(getattr(study.recovery.states, name), getattr(afresh.states, name)), name
    for own, other in zip(study.recovery.kernel_joint_loads, afresh.kernel_joint_loads, strict=True):
        assert own.joint is other.joint
        for name in JOINTS:
            assert is_same(getattr(own, name), getattr(other, name)), (own.joint.name, name)
        for stop, beside in zip(own.stops, other.stops, strict=True):
            assert is_same((stop.value, stop.unit), (beside.value, beside.unit))


@pytest.mark.parametrize("how", ["max", "min", "abs"])
@pytest.mark.parametrize("path", ["joints.end.force", "joints.end.force.y", "sections.lower.N", "joints.low.moment"])
def test_the_extreme_of_one_instant_is_what_a_search_finds(path: str, how: str) -> None:
    study = solve(load(str(ROOT / "heuncli" / "starters" / "truss.yaml")), Options())

    def collect(results: Results) -> list[Channel]:
        return [make_path_channel(find_values(results, path))]

    bounds = study.search_extremes(ChannelSearch(collect, lambda _: math.nan, (-1.0, 1.0)), find_reports(path))
    low, high = float(bounds.low[0]), float(bounds.high[0])
    found = find_peak(study, path, how)
    value = low if how == "min" or (how == "abs" and abs(low) > abs(high)) else high
    wanted = abs(value) if how == "abs" else value
    assert found.time == bounds.low_at[0] == bounds.high_at[0] == 0.0
    assert abs(found.value - wanted) <= 1e-15 * abs(wanted)
