"""Values in time as numbers, derivatives and text at once: a scene can be solved here and written for the program."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Harmonic:
    """offset + slope t + amplitude sin(omega t + phase)."""

    offset: float
    slope: float
    amplitude: float
    omega: float
    phase: float

    def __call__(self, t: float) -> float:
        return self.offset + self.slope * t + self.amplitude * math.sin(self.omega * t + self.phase)

    def first(self, t: float) -> float:
        return self.slope + self.amplitude * self.omega * math.cos(self.omega * t + self.phase)

    def second(self, t: float) -> float:
        return -self.amplitude * self.omega**2 * math.sin(self.omega * t + self.phase)

    @property
    def source(self) -> str:
        """The same as an expression of a spec, digits exact."""
        return (
            f"({self.offset!r}) + ({self.slope!r})*t + ({self.amplitude!r})*sin(({self.omega!r})*t + ({self.phase!r}))"
        )

    def drive(self) -> tuple[Callable[[float], float], Callable[[float], float], Callable[[float], float]]:
        """Value, first and second derivative, as a drive wants them."""
        return self, self.first, self.second

    def scaled(self, factor: float, time: float = 1.0) -> Harmonic:
        """factor·f(t / time)."""
        return Harmonic(
            factor * self.offset, factor * self.slope / time, factor * self.amplitude, self.omega / time, self.phase
        )

    @staticmethod
    def random(rng: np.random.Generator, size: float) -> Harmonic:
        """Some value of about this size."""
        a, b, c = (float(x) for x in size * rng.standard_normal(3))
        return Harmonic(a, b, c, float(rng.uniform(0.5, 3.0)), float(rng.uniform(0, 6)))

    @staticmethod
    def starting(rng: np.random.Generator, value: float, rate: float) -> Harmonic:
        """One with a given value and rate at t = 0."""
        h = Harmonic.random(rng, 0.5)
        at_zero = Harmonic(0.0, 0.0, h.amplitude, h.omega, h.phase)
        return Harmonic(value - float(at_zero(0.0)), rate - float(at_zero.first(0.0)), h.amplitude, h.omega, h.phase)


@dataclass(frozen=True)
class Kinked:
    """A smooth value whose rate jumps at an instant; there the rate is that after it."""

    smooth: Harmonic
    at: float
    jump: float

    def __call__(self, t: float) -> float:
        return self.smooth(t) + self.jump * max(t - self.at, 0.0)

    def first(self, t: float) -> float:
        return self.smooth.first(t) + (self.jump if t >= self.at else 0.0)

    @property
    def source(self) -> str:
        """The same as an expression of a spec, digits exact."""
        return f"{self.smooth.source} + ({self.jump!r})*max(t - ({self.at!r}), 0)"

    def drive(self) -> tuple[Callable[[float], float], Callable[[float], float], Callable[[float], float]]:
        """Value, first and second derivative, as a drive wants them."""
        return self, self.first, self.smooth.second


def to_yaml(scene: Mapping[str, Any]) -> str:
    """The scene as a spec: block style down to the entries, each entry in flow style, floats by repr."""
    lines = ["heun: 1"]
    for key, value in scene.items():
        entries = isinstance(value, Mapping) and value and all(isinstance(v, Mapping) for v in value.values())
        if entries and key != "ground":
            lines += [f"{key}:", *(f"  {name}: {flow(entry)}" for name, entry in value.items())]
        else:
            lines.append(f"{key}: {flow(value)}")
    return "\n".join(lines) + "\n"


def flow(value: Any) -> str:
    """Flow style; a callable by its source, a drive by its first callable's."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{k}: {flow(v)}" for k, v in value.items()) + "}"
    if callable(value):
        return json.dumps(value.source)
    if isinstance(value, tuple) and value and all(callable(v) for v in value):
        source = getattr(value[0], "source", None)
        if source is not None and not hasattr(value[1], "source"):
            return json.dumps(source)
    if isinstance(value, str | bool) or value is None:
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple | np.ndarray):
        return "[" + ", ".join(flow(v) for v in value) + "]"
    return repr(float(value)) if isinstance(value, float | np.floating) else repr(int(value))
