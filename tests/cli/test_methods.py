"""`heun methods`, and the options and keys that choose one."""

from __future__ import annotations

import json

import pytest

from heuncli.base.method_rows import METHODS
from heuncli.motion.integration.methods.method import GLOBAL, QUATERNION, RECENTRED, load_method_by_name
from heuncli.scene.file_format.foreign_words import METHOD_WORDS
from heuncli.scene.file_format.methods import iter_method_problems, method_hint
from tests.shared.command import SPEC_TEXTS, Heun


def test_every_method_is_listed(heun: Heun) -> None:
    done = heun("methods")
    assert (done.returncode, done.stderr) == (0, "")
    assert max(map(len, done.stdout.splitlines())) <= 120
    listed = [line.split()[:4] for line in done.stdout.splitlines()]
    for row in METHODS:
        assert [row.name, str(row.order), row.kind, row.steps] in listed


def test_the_list_as_data(heun: Heun) -> None:
    found = json.loads(heun("methods", "--format", "json").stdout)
    assert found["default"] == "auto"
    assert [m["name"] for m in found["methods"]] == [row.name for row in METHODS]
    assert {"name", "order", "kind", "steps", "attitude", "purpose"} == set(found["methods"][0])


def test_what_is_listed_is_what_is_run() -> None:
    """The rows, which the spec reads, against the coefficients, which the kernel takes."""
    held = {"quaternion": QUATERNION, "rodrigues": GLOBAL, "recentred": RECENTRED}
    for row in METHODS:
        method = load_method_by_name(row.name)
        assert (method.name, method.order, method.attitude) == (row.name, row.order, held[row.attitude])
        assert row.steps == ("fixed" if method.has_fixed_step else "adaptive")
        assert row.kind == ("SciPy" if method.scipy_name else "implicit" if method.implicit else "explicit")
        assert (method.scipy_name or row.name) == row.name.removeprefix("SciPy-")


def test_a_word_too_many_is_bad_usage(heun: Heun) -> None:
    assert heun("methods", "RK4").returncode == 2


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--method", "RK4"], "[fixed-step]"),
        (["--step", "0.01"], "auto chooses its own step size, so no step can be given [fixed-step]"),
        (["--method", "DOP853", "--step", "0.01"], "[fixed-step]"),
        (["--method", "ode45"], "write method: DOPRI5"),
        (["--method", "RK5"], "did you mean RK4? `heun methods` lists them"),
        (["--method", "gauss 4"], "did you mean Gauss4?"),
        (["--method", ""], "'' is not an integration method [unknown-method]"),
        (
            ["--method", "auto", "--step", "0.01"],
            "auto chooses its own step size, so no step can be given [fixed-step]",
        ),
        (["--method", "RK4", "--step", "0"], "expected a positive number [bad-option]"),
        (["--method", "RK4", "--step", "nan"], "expected a positive number [bad-option]"),
        (["--method", "RK4", "--step", "1e-300"], "use steps of at least 2e-07 s"),
        (["--method", "RK4", "--step", "2"], "the step of 2 s is longer than the run of 1 s [step]"),
        (["--method", "RK4", "--step", "1e-8"], "use steps of at least 2e-07 s"),
        (["--method", "RK4", "--step", "-1"], "expected a positive number"),
    ],
)
def test_what_does_not_go_together_is_refused(heun: Heun, words: list[str], told: str) -> None:
    done = heun("run", "swinging.yaml", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert told in done.stderr


def test_a_method_asked_for_stands_for_the_specs(heun: Heun) -> None:
    """Its step goes with it; another one of adaptive step leaves it."""
    of_spec = ("--set", "analysis.method=rk4", "--set", "analysis.step=0.01", "--format", "json")
    found = json.loads(heun("run", "swinging.yaml", *of_spec).stdout)
    assert (found["model"]["method"], found["model"]["step"], found["work"]["steps"]) == ("RK4", 0.01, 100)
    found = json.loads(heun("run", "swinging.yaml", *of_spec, "--method", "heun2", "--step", "0.02").stdout)
    assert (found["model"]["method"], found["model"]["step"], found["work"]["steps"]) == ("Heun2", 0.02, 50)
    found = json.loads(heun("run", "swinging.yaml", *of_spec, "--method", "dop853").stdout)
    assert found["model"]["method"] == "DOP853" and "step" not in found["model"]


def test_the_heading_tells_the_step(heun: Heun) -> None:
    text = heun("run", "swinging.yaml", "--method", "RK4", "--step", "0.01", "--full").stdout
    assert "RK4 in steps of 0.01 s, 100 steps" in text


def test_words_of_other_programs_lead_to_methods() -> None:
    known = {row.name for row in METHODS} | {"auto"}
    for word, name in METHOD_WORDS.items():
        assert word == word.lower() and name in known, word
        assert method_hint(word) == f"write method: {name}"
        assert [one.code for one in iter_method_problems(word, None, 1.0)] == ["unknown-method"]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("method: [RK4]", ["analysis.method: expected a text, found a list [wrong-kind]"]),
        ("method: 5", ["analysis.method: expected a text, found a number [wrong-kind]"]),
        ("method: ''", ["analysis.method: '' is not an integration method [unknown-method]"]),
        ("method: RK4, step: 0", ["analysis.step: step must be greater than 0, but is 0 [not-positive]"]),
        ("method: RK4, step: .nan", ["analysis.step: nan is not a finite number [not-finite]"]),
        ("method: RK4, step: 1 mm", ["analysis.step: '1 mm' is a length, expected a time [dimension]"]),
        (
            "method: auto, step: 0.1",
            ["analysis.step: auto chooses its own step size, so no step can be given [fixed-step]"],
        ),
    ],
)
def test_a_spec_is_told_each_error_once_and_where(heun: Heun, given: str, told: list[str]) -> None:
    """A step that could not be read is not missing beside that."""
    done = heun("run", "-", text=SPEC_TEXTS["swinging"].replace("analysis: {", f"analysis: {{{given}, "))
    assert (done.returncode, done.stdout) == (2, "")
    lines = [line for line in done.stderr.splitlines() if not line.startswith("  hint: ")]
    assert [line.partition(": ")[2] for line in lines] == told


def test_given_steps_are_held_to_a_tolerance_that_was_asked_for(heun: Heun) -> None:
    """Nobody asked for the default's: a step was."""
    words = ("run", "swinging.yaml", "--method", "RK4", "--step", "0.05")
    assert heun(*words).stderr == ""
    assert "tolerance 1e-12 not reached" in heun(*words, "--tolerance", "1e-12").stderr
