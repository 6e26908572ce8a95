"""The modes of a scene as they are told: about which state, frequencies, damping, growth, and shapes by coordinates."""

from __future__ import annotations

from typing import Any, Literal

from heuncli.base.joint_kinds import is_length
from heuncli.base.records import record
from heuncli.motion.linearisation.oscillations import Mode
from heuncli.results.results import Array


@record
class SceneModes:
    """The modes of a scene; at: about which pose; shapes: of each mode its coordinates, the largest 1."""

    title: str
    at: Literal["rest", "state"]
    steady: bool  # something moves steadily: in a frame that goes with it
    held: bool  # there are drives, and they are held
    modes: tuple[Mode, ...]
    shapes: tuple[dict[str, complex], ...]
    largest: tuple[tuple[str, ...], ...]  # of each mode the coordinates that move most, lengths by the scene's size
    without: tuple[str, ...] = ()  # forces that were left out and drives that were held, as `forces.push`

    def block(self) -> dict[str, Any]:
        """As JSON has it."""
        rows = [row(mode, shape) for mode, shape in zip(self.modes, self.shapes, strict=True)]
        without = {"without": list(self.without)} if self.without else {}
        return {"at": self.at, "steady": self.steady, **without, "modes": rows}


def row(mode: Mode, shape: dict[str, complex]) -> dict[str, Any]:
    """A mode as JSON has it; error [1/s]: what growth and 2 pi frequency may be off by."""
    return {
        "frequency": mode.frequency,
        "damping": mode.damping,
        "growth": mode.growth,
        "kind": mode.kind,
        "error": mode.error,
        "shape": {name: [x.real + 0.0, x.imag + 0.0] for name, x in shape.items()},
    }


def shape_of(x: Array, rows: dict[str, Array]) -> dict[str, complex]:
    """A displacement by coordinates, its largest 1."""
    found = {name: complex(row @ x) for name, row in rows.items()}
    largest = max(found.values(), key=abs, default=0j)
    return {name: value / largest if largest else value for name, value in found.items()}


def most(shape: dict[str, complex], size: float) -> tuple[str, ...]:
    """The coordinates that move most, at most three that move by half of it; lengths by the scene's size."""
    by = {name: abs(x) / (size if is_length(name) else 1.0) for name, x in shape.items()}
    largest = max(by.values(), default=0.0)
    names = sorted((name for name, x in by.items() if x >= 0.5 * largest), key=lambda name: -round(by[name], 9))
    return tuple(names[:3]) or ("nothing",)
