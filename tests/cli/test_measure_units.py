"""The units of `--measure`: stated on standard error, chosen by `--units`, refused before anything is solved."""

from __future__ import annotations

import json
import math

import pytest

from tests.shared.command import Heun
from tests.shared.folders import SPECS

BEAM = str(SPECS / "overhang.yaml")
FORCE, MOMENT = "max abs sections.beam.Q1", "max abs sections.beam.M2"


def numbers(heun: Heun, *words: str) -> tuple[list[float], list[str]]:
    """The numbers on standard output and the lines on standard error."""
    done = heun("run", BEAM, *words)
    assert done.returncode == 0, done.stderr
    return [float(line) for line in done.stdout.splitlines()], done.stderr.splitlines()


def test_the_unit_goes_to_standard_error(heun: Heun) -> None:
    (plain,), told = numbers(heun, "--measure", FORCE)
    assert told == ["unit: N"]
    (quiet,), told = numbers(heun, "--measure", FORCE, "--quiet")
    assert (quiet, told) == (plain, [])


def test_of_several_each_unit_is_stated(heun: Heun) -> None:
    found, told = numbers(heun, "--measure", FORCE, "--measure", MOMENT)
    assert len(found) == 2
    assert told == [f"unit: N ({FORCE})", f"unit: N·m ({MOMENT})"]


@pytest.mark.parametrize(
    ("units", "size", "unit"), [("kN", 1e-3, "kN"), ("kN,mm,deg", 1e-3, "kN"), ("lbf", 1 / 4.4482216152605, "lbf")]
)
def test_the_number_is_in_the_unit_asked_for(heun: Heun, units: str, size: float, unit: str) -> None:
    (plain,), _ = numbers(heun, "--measure", FORCE)
    (found,), told = numbers(heun, "--measure", FORCE, "--units", units)
    assert math.isclose(found, plain * size, rel_tol=1e-15)
    assert told == [f"unit: {unit}"]
    assert numbers(heun, "--measure", FORCE, "--units", units, "--quiet") == ([found], [])


def test_what_follows_from_the_units_is_converted_too(heun: Heun) -> None:
    (plain,), _ = numbers(heun, "--measure", MOMENT)
    (found,), told = numbers(heun, "--measure", MOMENT, "--units", "kN,mm")
    assert math.isclose(found, plain, rel_tol=1e-15) and told == ["unit: kN·mm"]


def test_a_measure_that_no_unit_fits_stays_in_si(heun: Heun) -> None:
    (plain,), _ = numbers(heun, "--measure", FORCE)
    (force, _), told = numbers(heun, "--measure", FORCE, "--measure", MOMENT, "--units", "mm")
    assert force == plain
    assert told == [f"unit: N ({FORCE})", f"unit: N·mm ({MOMENT})"]


@pytest.mark.heavy
def test_a_stress_is_in_mpa_only_if_asked(heun: Heun) -> None:
    spec, path = str(SPECS / "jib.yaml"), "max sections.root.stress.mises"
    plain = heun("run", spec, "--measure", path)
    chosen = heun("run", spec, "--measure", path, "--units", "MPa")
    assert (plain.stderr, chosen.stderr) == ("unit: Pa\n", "unit: MPa\n")
    assert math.isclose(float(chosen.stdout), 1e-6 * float(plain.stdout), rel_tol=1e-15)
    refused = heun("run", spec, "--measure", path, "--units", "kN")
    assert (refused.returncode, refused.stdout) == (2, "")


def test_json_stays_in_si(heun: Heun) -> None:
    (plain,), _ = numbers(heun, "--measure", FORCE)
    done = heun("run", BEAM, "--measure", FORCE, "--format", "json", "--units", "kN")
    assert json.loads(done.stdout)["value"] == plain
    assert "json stays in SI" in done.stderr and "unit:" not in done.stderr


@pytest.mark.parametrize(
    ("words", "wrong", "hint"),
    [
        (("--measure", FORCE, "--units", "mm"), "sections.beam.Q1 is in N [bad-option]", "for example --units kN"),
        (("--measure", MOMENT, "--units", "rpm"), "sections.beam.M2 is in N·m [bad-option]", "example --units kN,m"),
        (("--measure", FORCE, "--units", "foo"), "'foo' is not a unit [bad-option]", "known units"),
        (("--measure", "max sections.beam.Q9", "--units", "kN"), "'Q9' is not a result [unknown-path]", "known quant"),
        (("--measure", "model.freedoms", "--units", "kN"), "model.freedoms has no unit [bad-option]", "leave --units"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_before_the_run(heun: Heun, words: tuple[str, ...], wrong: str, hint: str) -> None:
    done = heun("run", BEAM, *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert wrong in done.stderr and hint in done.stderr and "unit:" not in done.stderr


@pytest.mark.parametrize(
    ("spec", "path", "wrong"),
    [
        ("engine", "max joints.main.tension", "a pin has no tension"),
        ("engine", "max joints.main.torque", "a pin has no torque"),
        ("engine", "max joints.main.pressure", "the joint has no bearing"),
        ("overhang", "max sections.beam.stress.mises", "the section has no properties"),
    ],
)
def test_what_the_model_does_not_have_is_refused_before_the_run(heun: Heun, spec: str, path: str, wrong: str) -> None:
    done = heun("run", str(SPECS / f"{spec}.yaml"), "--measure", path, "--verbose")
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{wrong} [unknown-path]" in done.stderr and "integrate" not in done.stderr


def test_a_determinate_sum_has_its_unit(heun: Heun) -> None:
    done = heun("run", str(SPECS / "door.yaml"), "--measure", "certain_sums.0.value", "--units", "kN")
    assert math.isclose(float(done.stdout), 0.04905, rel_tol=1e-12) and done.stderr.endswith("unit: kN\n")


def test_all_cases_have_one_line_for_the_unit(heun: Heun) -> None:
    done = heun("run", str(SPECS / "axle_loads.yaml"), "--case", "all", "--measure", "joints.front.force.z")
    assert len(done.stdout.splitlines()) > 1 and done.stderr.count("unit: N\n") == 1
