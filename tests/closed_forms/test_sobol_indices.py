"""Sobol indices against closed forms, and against SciPy's of the same plan."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import sobol_indices as scipy_indices

from heuncli.analyses.variants.parameters import RandomVariable
from heuncli.analyses.variants.plans import make_draws
from heuncli.analyses.variants.sample_statistics import compute_sobol_indices
from heuncli.results.results import Array
from tests.shared.command import Heun

a, b = 7.0, 0.1
V1 = 0.5 * (1.0 + b * math.pi**4 / 5.0) ** 2
V2 = a**2 / 8.0
V13 = b**2 * math.pi**8 * 8.0 / 225.0
V = V1 + V2 + V13
FIRST = (V1 / V, V2 / V, 0.0)
TOTAL = ((V1 + V13) / V, V2 / V, V13 / V)
# Ishigami and Homma (1990): sin x + a sin² y + b z⁴ sin x, each uniform between -π and π; here a force.
ISHIGAMI = """\
heun: 1
title: Ishigami's function as a force
parameters: {a: 7, b: 0.1, x: 0, y: 0, z: 0}
ground: {points: {O: [0, 0, 0]}}
bodies:
  block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  held: {type: weld, from: ground.O, to: block.o}
forces:
  push: {type: force, on: block.o, vector: ["-sin(x) - a*sin(y)**2 - b*z**4*sin(x)", 0, 0]}
"""


def test_the_closed_form_is_the_published_one() -> None:
    """Saltelli et al., Global Sensitivity Analysis: The Primer (2008), as printed to four digits."""
    assert [round(one, 4) for one in FIRST] == [0.3139, 0.4424, 0.0]
    assert [round(one, 4) for one in TOTAL] == [0.5576, 0.4424, 0.2437]


def ishigami(x: Array) -> Array:
    found: Array = np.sin(x[..., 0]) + a * np.sin(x[..., 1]) ** 2 + b * x[..., 2] ** 4 * np.sin(x[..., 0])
    return found


def test_the_indices_of_ishigamis_function() -> None:
    """As below, without a sweep."""
    laws = [RandomVariable(name, "sobol", -math.pi, math.pi, "") for name in "xyz"]
    own = compute_sobol_indices(ishigami(make_draws(laws, 512, 0, indices=True).values).reshape(-1, 5))
    assert own is not None
    for one, first, total in zip(own, FIRST, TOTAL, strict=True):
        for told, truth in ((one.first, first), (one.total, total)):
            assert told.low is not None and told.high is not None
            half = 0.5 * (told.high - told.low)
            assert abs(told.value - truth) < 3.0 * half and half < 0.16


@pytest.mark.heavy
@pytest.mark.long
def test_a_sweep_finds_the_indices_of_ishigamis_function(heun: Heun, folder: Path) -> None:
    """Within three times what it states, which a true interval passes once in 10^8; and what it states is small."""
    (folder / "ishigami.yaml").write_text(ISHIGAMI)
    ends = ["x=sobol(-180,180)deg", "y=sobol(-180,180)deg", "z=sobol(-3.141592653589793,3.141592653589793)"]
    done = heun(
        "sweep", "ishigami.yaml", *ends, "--samples", "512", "--indices", "--measure", "joints.held.force.x",
        "--format", "json",
    )  # fmt: skip
    assert done.returncode == 0 and "512 x (3 + 2) = 2,560 variants" in done.stderr
    found = json.loads(done.stdout)
    assert [row["number"] for row in found["rows"]] == list(range(2560))
    (own,) = found["statistics"]
    assert own["variants"] == 1024 and own["left_out"] == 0 and own["samples"] == 512
    for one, first, total in zip(own["indices"], FIRST, TOTAL, strict=True):
        for told, truth in ((one["first"], first), (one["total"], total)):
            half = 0.5 * (told["high"] - told["low"])
            assert abs(told["value"] - truth) < 3.0 * half and half < 0.16
    assert abs(own["mean"]["value"] - 0.5 * a) < own["mean"]["high"] - own["mean"]["value"]
    assert own["deviation"]["low"] < math.sqrt(V) < own["deviation"]["high"]


@pytest.mark.parametrize("law", ["uniform", "lhs", "sobol"])
def test_they_are_those_that_scipy_finds_by_the_same_plan(law: str) -> None:
    laws = [RandomVariable(name, law, -math.pi, math.pi, "") for name in "xyz"]  # type: ignore[arg-type]
    f = ishigami(make_draws(laws, 256, 3, indices=True).values).reshape(256, 5)
    own = compute_sobol_indices(f)
    assert own is not None
    given = {"f_A": f[:, :1].T, "f_B": f[:, 1:2].T, "f_AB": f[:, 2:].T[:, None, :]}
    theirs = scipy_indices(func=given, n=256)
    assert np.allclose([one.first.value for one in own], theirs.first_order, rtol=0.0, atol=1e-13)
    assert np.allclose([one.total.value for one in own], theirs.total_order, rtol=0.0, atol=1e-13)


def test_of_a_sum_each_index_is_the_share_of_its_variance() -> None:
    """x + 2 y + 3 z of normal deviations 1: 1/14, 4/14, 9/14, first and total."""
    laws = [RandomVariable(name, "normal", 5.0, 1.0, "") for name in "xyz"]
    f = make_draws(laws, 20_000, 0, indices=True).values @ np.array([1.0, 2.0, 3.0])
    own = compute_sobol_indices(f.reshape(-1, 5))
    assert own is not None
    for one, truth in zip(own, np.array([1.0, 4.0, 9.0]) / 14.0, strict=True):
        assert one.first.low is not None and abs(one.first.value - truth) < 2.0 * (one.first.value - one.first.low)
        assert one.total.low is not None and abs(one.total.value - truth) < 2.0 * (one.total.value - one.total.low)


def test_what_does_not_vary_or_is_known_of_few_samples_has_none() -> None:
    assert compute_sobol_indices(np.ones((100, 4))) is None
    assert compute_sobol_indices(np.random.default_rng(0).random((7, 4))) is None
