"""`heun check --references`: every number of the published cases agrees, a falsified one does not; how it is told."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import xmlschema
from junitparser import JUnitXml
from scipy.integrate import quad, solve_ivp
from scipy.special import ellipj, ellipk

import heuncli.analyses.published.cases as cases
from heuncli.analyses.published.cases import list_names, numbers_of, parse_case, read_case, spec_of
from heuncli.analyses.published.comparison import AGREES, COARSE, DIFFERS, OPEN, compare_case, parse_decimal
from heuncli.scene.file_format.load import load
from tests.manual import proof
from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.manual import TEXTS, tables_below
from tests.shared.published import compared_case, printed_values

pytestmark = pytest.mark.heavy  # the numbers are those of both kernels
SCHEMA = ROOT / "tests" / "cli" / "junit.xsd"


@pytest.mark.parametrize("name", list_names())
@pytest.mark.third
def test_every_number_agrees(name: str) -> None:
    """And none is told so loosely that it says nothing."""
    numbers = [one for table in compared_case(name) for one in table.numbers]
    assert {one.verdict for one in numbers} == {AGREES}
    for table in compared_case(name):
        assert max(one.tolerance for one in table.numbers) <= 6e-4 * table.largest


@pytest.mark.parametrize("name", list_names())
def test_a_case_names_its_source_and_is_a_spec_to_read(name: str) -> None:
    case, spec = read_case(name), load(f"{name}.yaml", spec_of(name))
    assert spec.warnings == () and spec.title and len(case.description) <= 45
    assert len(case.source) > 40 and not spec.expect  # numbers stand once
    lines = spec_of(name).splitlines() + numbers_of(name).splitlines()
    assert max(map(len, lines)) <= 120
    for table in case.tables:
        places = [(number.path, number.time) for number in table.numbers]
        assert len(set(places)) == len(places)
        assert all(numbers_of(name).splitlines()[one.line - 1].count(one.text) for one in table.numbers)


def test_a_falsified_digit_differs() -> None:
    """The last digit of each number of a case, one more or one less: by more than half of it, if barely."""
    (first, second) = compared_case("sdfast_leg")
    for k, one in enumerate((*first.numbers, *second.numbers)):
        step = -1 if k % 2 else 1
        wrong = f"{one.published.value + step * one.published.last_digit:.6f}"
        text = numbers_of("sdfast_leg").replace(one.published.text, wrong)
        found = [
            each
            for table in compare_case(parse_case("sdfast_leg", text, spec_of("sdfast_leg")))
            for each in table.numbers
        ]
        assert [each.number.path for each in found if each.verdict == DIFFERS] == [one.number.path]


def test_what_is_open_or_coarse_does_not_agree() -> None:
    text = "about: a\nsource: b\ntables:\n  - {where: c, kind: printed, at: 0, of: {joints.P0.force.x: 0.4}}\n"
    assert compare_case(parse_case("bricard", text, spec_of("bricard")))[0].worst.verdict == OPEN
    loose = spec_of("point_pendulum").replace("tolerance: 1e-12", "tolerance: 1e-5")
    found = compare_case(parse_case("point_pendulum", numbers_of("point_pendulum"), loose))
    assert {one.verdict for table in found for one in table.numbers} == {COARSE}


@pytest.mark.parametrize(
    ("text", "last", "digits"), [("0.3284", 1e-4, 4), ("-.5e-4", 1e-5, 1), ("784.0", 0.1, 4), ("1.5e3", 100.0, 2)]
)
def test_how_many_digits_were_printed(text: str, last: float, digits: int) -> None:
    found = parse_decimal(text)
    assert (found.value, found.digit_count) == (float(text), digits)
    assert math.isclose(found.last_digit, last)


@pytest.mark.parametrize("text", ["one", "0x10", "", ".", "1e", "1,5", "nan"])
def test_what_is_no_printed_number(text: str) -> None:
    with pytest.raises(ValueError, match="not a decimal number"):
        parse_decimal(text)


# Formulas, evaluated by other means


def test_the_pendulum_s_numbers() -> None:
    """Jacobi's functions: from the turning point the half angle's sine is k sn(K - w t), k^2 = 1/2."""
    for (path, t), value in printed_values("point_pendulum").items():
        assert t is not None
        sn, _, dn, _ = ellipj(ellipk(0.5) - math.sqrt(9.81) * t, 0.5)
        y = sn * sn - 1.0
        own = {"x": -math.sqrt(2.0) * sn * dn, "y": y, "tension": -3.0 * 9.81 * y}[path.rsplit(".", 1)[1]]
        assert abs(value - own) <= 0.51 * 10.0 ** -(12 if path.endswith(("x", "y")) else 10)


def test_the_windows_numbers() -> None:
    """The period by a quadrature, and the rest of the last turn by integration."""
    G = 3.5 * 9.81 / 3.0

    def rate(th: float) -> float:
        return math.sqrt(1.0 + 2.0 * G * (1.0 - math.cos(th)))

    period = quad(lambda th: 1.0 / rate(th), 0.0, 2.0 * math.pi, epsabs=1e-12, epsrel=1e-12)[0]
    assert abs(period - 1.942514922607) < 1e-12
    for t in (0.5, 1.0, 5.0, 10.0):
        (th,) = solve_ivp(lambda _, y: [rate(y[0])], (0.0, t % period), [0.0], "DOP853", rtol=1e-13, atol=1e-13).y[
            :, -1
        ]
        own = np.array([math.sin(th), math.cos(th), rate(th) * math.cos(th), -rate(th) * math.sin(th)])
        paths = [f"points.bar0.end.{what}.{axis}" for what in ("position", "velocity") for axis in "xy"]
        found = [printed_values("windows", "formula")[path, t] for path in paths]
        np.testing.assert_allclose(found, own, rtol=0, atol=1e-10)


def test_the_chimney_s_numbers() -> None:
    """S, P and M of the paper, with m = H = 1; M here bends the other way."""
    places = {"base": 0.0, "third": 1 / 3, "half": 0.5, "two_thirds": 2 / 3}
    for table, degrees in zip(read_case("chimney").tables, (30, 60, 90), strict=True):
        s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
        for number in table.numbers:
            _, section, what = number.path.split(".")
            x = places[section]
            own = {
                "Q1": 0.75 * 9.81 * s * (x * x - 4 * x / 3 + 1 / 3),
                "N": -0.5 * 9.81 * (1 - x) * ((5 + 3 * x) * c - 3 * (1 + x)),
                "M2": -0.25 * 9.81 * s * x * (1 - x) ** 2,
            }[what]
            assert abs(parse_decimal(number.text).value - own) <= 0.501 * parse_decimal(number.text).last_digit + 1e-15


# The command


def test_all_of_them_and_how_they_are_told(heun: Heun, folder: Path) -> None:
    done = heun("check", "--references", "--junit", "report.xml", "--durations", "2")
    assert done.returncode == 0
    assert [line.split()[0] for line in done.stdout.splitlines()[1:-1] if line] == [*list_names()]
    assert done.stdout.splitlines()[-1].startswith(f"{len(list_names())} cases, ")
    assert max(map(len, done.stdout.splitlines())) <= 150 and "slowest 2" in done.stderr
    xmlschema.XMLSchema(str(SCHEMA)).validate(str(folder / "report.xml"))
    suites = list(JUnitXml.fromfile(str(folder / "report.xml")))
    assert [suite.name for suite in suites] == [
        f"heuncli/analyses/published/numbers/{name}.yaml" for name in list_names()
    ]
    numbers = [one for name in list_names() for table in compared_case(name) for one in table.numbers]
    assert sum(len(list(suite)) for suite in suites) == len(numbers) + len(suites)


def test_one_with_all_its_numbers(heun: Heun) -> None:
    done = heun("check", "--references", "sdfast_leg")
    assert done.returncode == 0 and done.stdout.startswith("case    sdfast_leg\n")
    assert "TestMobilizerReactionForces.cpp" in done.stdout
    for one in (one for table in compared_case("sdfast_leg") for one in table.numbers):
        (row,) = [line for line in done.stdout.splitlines() if one.number.text in line.split()]
        assert one.number.path in row and row.endswith(AGREES)
    told = json.loads(heun("check", "--references", "sdfast_leg", "--format", "json").stdout)
    assert (told["passed"], told["failed"]) == (8, 0)
    block = told["cases"][0]["tables"][1]["numbers"][3]
    assert (block["of"], block["published"], block["verdict"]) == ("joints.knee.force.y", "11.035987", AGREES)
    assert abs(block["found"] - 11.035987) <= 5e-7 and abs(block["last_digits"]) <= 0.5


@pytest.mark.parametrize("form", ["table", "markdown", "github", "json"])
def test_one_that_differs(heun: Heun, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    wrong = numbers_of("sdfast_leg").replace("34.422139", "34.422149")
    monkeypatch.setattr(cases, "numbers_of", lambda name: wrong)
    done = heun("check", "--references", "sdfast_leg", "--format", form)
    assert done.returncode == 1
    assert "34.422149" in done.stdout and DIFFERS in done.stdout
    if form == "github":
        line = wrong.splitlines().index("      joints.knee.force.y: 34.422149") + 1
        assert f"::error file=heuncli/analyses/published/numbers/sdfast_leg.yaml,line={line}" in done.stdout


def test_one_that_cannot_be_solved(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = spec_of("sdfast_leg").replace("angle: hip", "angle: hop")
    monkeypatch.setattr(cases, "spec_of", lambda name: broken)
    done = heun("check", "--references", "sdfast_leg")
    assert done.returncode == 2 and "hop" in done.stderr and "1 case not solved" in done.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["andrew"], "did you mean andrews?"),
        (["andrews", "nosuch/folder"], "there is no such published case"),
        (["--golden", "kept"], "--references and --golden"),
        (["-k", "fast"], "--references and -k"),
    ],
)
def test_what_does_not_go_together(heun: Heun, words: list[str], said: str) -> None:
    done = heun("check", "--references", *words)
    assert done.returncode == 2 and said in done.stderr and not done.stdout


def test_its_spec_is_handed_out(heun: Heun, folder: Path) -> None:
    listed = heun("new").stdout
    assert all(f"\n{name} " in listed for name in list_names())
    assert heun("new", "sdfast_leg").returncode == 0
    done = heun("run", "sdfast_leg.yaml", "--axes", "to", "--measure", "joints.knee.force.y", "--case", "level")
    assert abs(float(done.stdout) - 11.035987) <= 5e-7
    assert not [*folder.glob("andrews*")]


def test_the_tables_of_cases_and_sources() -> None:
    for table in proof.tables():
        assert table.text in tables_below(TEXTS[table.page], table.heading), "python -m tests.manual.tables writes it"
