"""What a reader's eye would stumble over: units, orders, instants and noise that mean nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from heuncli.base import records
from heuncli.output.documents.as_text import format_plain
from heuncli.output.tables.page import make_page
from heuncli.results.results import Magnitudes, Results
from heuncli.study.quantities.labels import JointInfo, Labels
from tests.shared.fakes import LABELS, MAGNITUDES, FakeStudy, found_extremes, pendulum, restrict
from tests.shared.heading import format_heading

ONE = np.array([0.5])


def at_one(wanted: str, labels: Labels = LABELS, of: Magnitudes = MAGNITUDES, **changes: Any) -> list[str]:
    results = restrict(pendulum(ONE, **changes), {wanted})
    return [format_plain(table) for table in make_page(results, labels, of).make_tables_at_instants(results)]


def test_without_a_force_there_is_no_axis_and_that_is_not_called_open() -> None:
    nowhere = np.full((1, 3), np.nan)
    foundation = pendulum(ONE).foundation | {"axis": {"point": nowhere, "direction": nowhere, "pitch": nowhere[:, 0]}}
    text = next(text for text in at_one("foundation", foundation=foundation) if "CENTRAL AXIS" in text)
    assert text.splitlines()[1:] == ["none: no axis, the force is zero"]


def test_the_origin_is_called_so() -> None:
    unnamed = records.replace(LABELS, moment_point=None)
    assert "about the origin (0, 0, 0) m" in at_one("foundation", unnamed)[0]
    elsewhere = pendulum(ONE).foundation | {"about": np.array([0.0, 0.0, 2.0])}
    assert "about the point (0, 0, 2) m" in at_one("foundation", unnamed, foundation=elsewhere)[0]


def test_stresses_are_told_in_megapascal() -> None:
    stress = {"mises": np.array([95.2e6]), "utilisation": np.array([0.4])}
    (text,) = at_one("sections", sections={"root": {"N": np.array([1.0]), "open": [], "stress": stress}})
    assert "mises [MPa]" in text
    assert text.splitlines()[2].split()[-2:] == ["95.2", "0.4"]


def test_columns_keep_their_order_where_some_joints_lack_them() -> None:
    pivot, elbow = pendulum(ONE).joints.values()
    zero = np.zeros((1, 3))
    joints = {"line": {**pivot, "axial": ONE, "radial": ONE, "tilting": 0 * ONE, "moment": zero}, "elbow": elbow}
    (text,) = at_one("joints", joints=joints)
    heads = [word for word in text.splitlines()[1].split() if not word.startswith("[")]
    assert heads == ["joint", "Fx", "Fy", "Fz", "|F|", "Mx", "My", "Mz", "|M|", "axial", "radial"]


def test_a_steady_cut_has_no_instant() -> None:
    class Steady(FakeStudy):
        def resample(self, times: np.ndarray) -> Results:
            n = len(times)
            along = {name: np.tile([3.0, 2.0, 0.0], (n, 1)) for name in ("N", "Q1", "Q2", "T", "M1", "M2")}
            along["M2"] = np.sin(np.asarray(times))[:, None] * along["M2"]
            return pendulum(np.asarray(times), sections={"along": {"s": np.array([0.0, 0.5, 1.0]), **along}})

    study = Steady(np.linspace(0.0, 1.0, 11))
    page = make_page(restrict(study.results, {"sections"}), LABELS, MAGNITUDES)
    found = found_extremes(study, page, {"sections"})
    lines = format_plain(page.make_tables_of_extremes(found)[0]).splitlines()
    assert next(line.split() for line in lines if line.startswith("N ")) == ["N", "N", "0", "1.0", "3.0", "0"]
    assert next(line.split() for line in lines if line.startswith("M2"))[-3:] == ["2.52441", "0", "1.0"]


def test_a_moment_that_is_noise_beside_the_force_on_its_arm_reads_0() -> None:
    section = {"N": np.array([1.2e6]), "Q1": np.array([-694064.0]), "M1": np.array([1.6e-11]), "open": []}
    of = MAGNITUDES._replace(by_unit={**MAGNITUDES.by_unit, "N": 1.2e6, "N·m": 0.3 * 1.2e6})
    (text,) = at_one("sections", LABELS, of, sections={"cut": section})
    assert text.splitlines()[1:3] == ["section    N [N]   Q1 [N]", "cut      1200000  -694064"]


def test_what_is_driven_is_told_beside_the_freedoms() -> None:
    free = pendulum(ONE)
    driven = replace(free, model=free.model | {"freedoms": 0, "driven": 1})
    assert "2 bodies, 4 degrees of freedom\n" in format_heading(free)
    assert "2 bodies, 0 degrees of freedom, 1 driven\n" in format_heading(driven)


def test_what_is_0_takes_no_column_but_a_vector_stays_whole() -> None:
    pivot = pendulum(ONE).joints["pivot"]
    (text,) = at_one("joints", joints={"a": {**pivot, "axial": 0 * ONE}})
    heads = [word for word in text.splitlines()[1].split() if not word.startswith("[")]
    assert heads == ["joint", "Fx", "Fy", "Fz", "|F|"]
    assert text.splitlines()[-1] == "Columns that are zero in every row are not shown."


def test_a_run_that_stopped_says_so_once() -> None:
    message = "at t = 0.5 s the rod rope would have to push"
    stopped = pendulum(ONE, warnings=(f"stopped before the end: {message}",))
    stopped = replace(stopped, status={"code": "stopped", "message": message})
    assert format_heading(stopped).count(message) == 1


def test_a_slide_that_is_noise_beside_what_turns_reads_0() -> None:
    turning = {"angle": ONE, "rate": 157.0 * ONE, "acceleration": 24e3 * ONE}
    sliding = {"travel": ONE, "speed": 6e-25 * ONE, "acceleration": 4e-12 * ONE}
    scene = Labels(joints={"shaft": JointInfo("pin", "", ""), "splines": JointInfo("slide", "", "")})
    *_, text = at_one("motion", scene, bodies={}, coordinates={"shaft": turning, "splines": sliding})
    assert "travel [m]" in text
    assert "speed" not in text
    assert "acceleration" not in text
