"""Scenes as the tests solve them: written as text or as the oracle's dicts; states read back for the oracle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.oracle.read import Placed, state_at
from tests.oracle.values import to_yaml


def study(scene: str | Mapping[str, Any], **options: Any) -> Study:
    """A scene solved; its run stays open for more instants."""
    text = scene if isinstance(scene, str) else to_yaml(scene)
    return solve(load("scene.yaml", text), Options(**options))


def solved(scene: str | Mapping[str, Any], **options: Any) -> Results:
    """The results of a scene."""
    return study(scene, **options).results


def moving(scene: Mapping[str, Any], times: Sequence[float], tolerance: float = 1e-11) -> dict[str, Any]:
    """The scene with a motion asked for at these instants."""
    return {**scene, "analysis": {"times": [float(t) for t in times], "tolerance": tolerance}}


def instants(results: Results) -> Iterator[tuple[int, float, dict[str, Placed]]]:
    """Number, time and state of every instant, the state as the oracle wants it."""
    for k, t in enumerate(results.time.tolist()):
        yield k, t, state_at(results.bodies, k)


def near(found: Any, wanted: Any, size: float, tolerance: float = 1e-9) -> float:
    """Assert closeness relative to a size of the scene; the deviation in that size."""
    difference = float(np.max(np.abs(np.asarray(found, dtype=float) - np.asarray(wanted, dtype=float)), initial=0.0))
    assert difference <= tolerance * size, f"{found} is not {wanted}: off by {difference / size:.3g} of {size:.6g}"
    return difference / size


def terms_at(terms: Mapping[str, Any], k: int) -> dict[str, float]:
    """A certain sum's factors at an instant: those that turn are told for each."""
    return {name: float(factor[k] if np.ndim(factor) else factor) for name, factor in terms.items()}


def largest(values: Mapping[str, Array]) -> float:
    """Largest number among arrays."""
    return max((float(np.abs(v).max(initial=0.0)) for v in values.values()), default=0.0)
