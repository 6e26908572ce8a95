"""Units of tables: what is asked for and what follows from it, the same numbers in other units, their digits."""

from __future__ import annotations

import math
import re

import pytest

from heuncli.app.cli.entry import enter
from heuncli.base.errors import Finding
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.table_units import Units, parse_units
from tests.shared.folders import SPECS


@pytest.mark.parametrize(("words", "unit", "shown", "size"), [
    ("kN", "N", "kN", 1e-3), ("kN", "N·m", "kN·m", 1e-3), ("kN,mm", "N·m", "kN·mm", 1.0), ("mm", "m/s²", "mm/s²", 1e3),
    ("kN,mm,kNm", "N·m", "kN·m", 1e-3), ("N*mm", "N·m", "N·mm", 1e3), ("Nmm", "N·m", "N·mm", 1e3), ("mm", "N", "N", 1),
    ("deg", "rad/s", "deg/s", 180.0 / math.pi), ("deg,rpm", "rad/s", "rpm", 30.0 / math.pi), ("rpm", "rad", "rad", 1.0),
    ("deg,rpm", "rad/s²", "deg/s²", 180.0 / math.pi), ("kN", "Pa", "MPa", 1e-6), ("bar", "Pa", "bar", 1e-5),
    ("kJ", "J", "kJ", 1e-3), ("kJ", "N·m", "N·m", 1.0), ("Nm", "J", "J", 1.0), ("kW", "W", "kW", 1e-3),
    ("kN,mm", "N·m·s", "kN·mm·s", 1.0), ("kN", "N·s", "kN·s", 1e-3), ("m/s^2", "m/s²", "m/s²", 1.0),
    ("in, lbf", "N·m", "lbf·in", 1.0 / (0.0254 * 4.4482216152605)), ("km/h", "m/s", "km/h", 3.6), ("mm", "J", "J", 1.0),
])  # fmt: skip
def test_what_is_asked_for_and_what_follows(words: str, unit: str, shown: str, size: float) -> None:
    told, found = parse_units(words).find(unit)
    assert told == shown
    assert found == pytest.approx(size, rel=1e-14)


def test_without_any_stresses_alone_are_not_in_si() -> None:
    assert [Units().find(unit) for unit in ("Pa", "N")] == [("MPa", 1e-6), ("N", 1.0)]


@pytest.mark.parametrize(("words", "message"), [
    ("kN,N", "kN and N are units of the same quantity: a force"),
    ("J,kJ", "same quantity: an energy"), ("deg,mrad", "same quantity: an angle"),
    ("kg", "tables show no mass"), ("ms", "times stay in s"), ("kN/m", "tables show no stiffness"),
    ("", "expected units"), ("kN;mm", "is not a unit"), ("Newton", "is not a unit"), ("m^4", "tables show no second"),
])  # fmt: skip
def test_what_is_refused(words: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(Finding, match=message):
        parse_units(words)
    assert enter(["run", str(SPECS / "double.yaml"), "--units", words]) == 2
    assert "[bad-option]" in capsys.readouterr().err


def report(capsys: pytest.CaptureFixture[str], spec: str, *words: str) -> str:
    assert enter(["run", str(SPECS / f"{spec}.yaml"), *words]) == 0
    return capsys.readouterr().out


CELL = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?$")
INSTANTS = frozenset({"at [s]", "t [s]", "at s [m]"})


def numbers(text: str) -> list[tuple[str, float, float]]:
    """Unit, value, and last digit of the numbers in lines that begin with a label and a unit."""
    found = []
    for line in text.splitlines():
        cells = re.split(r"\s{2,}", line.strip())
        if len(cells) > 3 and re.fullmatch(r"[kmNJWradegspPM·/²]+", cells[1]):
            numeric = [cell for cell in cells[2:4] if CELL.match(cell)]  # the first and the last
            found += [(cells[1], float(cell), 10.0 ** -len(cell.partition(".")[2])) for cell in numeric]
    return found


@pytest.mark.heavy
@pytest.mark.parametrize("spec", ["engine", "double"])
def test_the_numbers_are_the_same_to_their_last_digits(spec: str, capsys: pytest.CaptureFixture[str]) -> None:
    only = ("--only", "motion,foundation,joints,forces,energy")
    si, other = (numbers(report(capsys, spec, *only, *words)) for words in ((), ("--units", "kN,mm,kNm,deg,rpm,kJ,kW")))
    sizes = parse_units("kN,mm,kNm,deg,rpm,kJ,kW")
    assert len(si) == len(other) > 60
    for (unit, value, last), (shown, told, digit) in zip(si, other, strict=True):
        assert shown == sizes.find(unit)[0]
        size = sizes.find(unit)[1]
        assert abs(told - size * value) <= 0.51 * (digit + size * last), (unit, value, told)


def test_digits_are_those_that_the_error_leaves() -> None:
    """20,000 N to 30 N: to hundreds, whatever the unit; and what is lost by rounding is 0 in any."""
    units = parse_units("kN,mm")
    plain = StatedErrors({("reactions", "N"): 30.0, ("reactions", "N·m"): 30.0}, {"N": 1e-9}, units=Units({}))
    certain = plain._replace(units=units)
    assert plain.choose_style("reactions", "N", 2e4).write(20123.4) == "2.01e+04"
    assert certain.choose_style("reactions", "N", 2e4).write(20.1234) == "20.1"
    assert (  # kN·mm and N·m are of one size
        certain.choose_style("reactions", "N·m", 2e4).decimals == plain.choose_style("reactions", "N·m", 2e4).decimals
    )
    assert certain.choose_style("reactions", "N", 1e-10).write(1e-13) == "0"


@pytest.mark.heavy
def test_of_a_blow_head_and_rows_are_in_one_unit(capsys: pytest.CaptureFixture[str]) -> None:
    text = report(capsys, "hammered_four_bar", "--only", "impulses", "--units", "mN,cm")
    assert re.search(r"^N +mN·s +-1000\.0 +40\.0 before +1000\.0 +40\.0 beyond", text, re.MULTILINE)
    assert re.search(r"^ *40\.0  before +-1000\.0", text, re.MULTILINE)
    assert "about A = (0, 0, 0) cm" in text
    assert "N·m" not in text.replace("mN·cm·s", "")


@pytest.mark.heavy
def test_causes_add_up_in_any_unit(capsys: pytest.CaptureFixture[str]) -> None:
    text = report(capsys, "crane", "--only", "sections", "--by-cause", "--units", "kN,cm")
    lines = [line for line in text.splitlines() if re.match(r"\s*(N|M1|M2) (min|max) +kN", line)]
    assert len(lines) >= 4
    for line in lines:
        *_, whole, total = line.split()
        assert whole == total


def test_data_stay_in_si(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--measure", "max joints.elbow.force", "--format", "json")
    plain = report(capsys, "double", *words)
    assert report(capsys, "double", *words, "--units", "kN") == plain
    assert enter(["run", str(SPECS / "door.yaml"), "--format", "csv", "--units", "kN"]) == 0
    told = capsys.readouterr()
    assert ",N," in told.out
    assert told.err == "heun: --units applies to tables only; csv stays in SI\n"
    assert "kN·m" in report(capsys, "chimney", "--format", "markdown", "--units", "kN")
