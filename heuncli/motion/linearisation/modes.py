"""The modes of a scene as reported: about which state, frequencies, damping, growth, and shapes by coordinates."""

from __future__ import annotations

from typing import Any, Literal

from heuncli.base.joint_kinds import is_length
from heuncli.base.records import record
from heuncli.motion.linearisation.oscillations import Mode
from heuncli.results.results import Array


@record
class SceneModes:
    """The modes of a scene.

    reference: the pose they are about, "rest" or "state"
    shapes: coordinates of each mode, the largest 1
    """

    title: str
    reference: Literal["rest", "state"]
    is_steady: bool  # something moves steadily; the modes are seen from its frame
    has_held_drives: bool  # there are drives, and they are held
    modes: tuple[Mode, ...]
    shapes: tuple[dict[str, complex], ...]
    largest: tuple[tuple[str, ...], ...]  # the coordinates that move most in each mode, lengths relative to the size
    omitted_paths: tuple[str, ...] = ()  # forces left out and drives held, as `forces.push`

    def to_block(self) -> dict[str, Any]:
        """Return the modes as in the JSON output."""
        rows = [mode_to_block(mode, shape) for mode, shape in zip(self.modes, self.shapes, strict=True)]
        without = {"without": list(self.omitted_paths)} if self.omitted_paths else {}
        return {"at": self.reference, "steady": self.is_steady, **without, "modes": rows}


def mode_to_block(mode: Mode, shape: dict[str, complex]) -> dict[str, Any]:
    """Return a mode as in the JSON output; error [1/s]: of growth and 2 pi frequency."""
    return {
        "frequency": mode.frequency,
        "damping": mode.damping,
        "growth": mode.growth,
        "kind": mode.kind,
        "error": mode.error,
        "shape": {name: [x.real + 0.0, x.imag + 0.0] for name, x in shape.items()},
    }


def make_shape(x: Array, rows: dict[str, Array]) -> dict[str, complex]:
    """Return a displacement by coordinates, its largest 1."""
    components = {name: complex(row @ x) for name, row in rows.items()}
    largest = max(components.values(), key=abs, default=0j)
    return {name: value / largest if largest else value for name, value in components.items()}


def find_largest_coordinates(shape: dict[str, complex], size: float) -> tuple[str, ...]:
    """Return the coordinates that move most, at most three that move by at least half of it; lengths relative to the
    size.
    """
    magnitudes = {name: abs(x) / (size if is_length(name) else 1.0) for name, x in shape.items()}
    largest = max(magnitudes.values(), default=0.0)
    names = sorted(
        (name for name, x in magnitudes.items() if x >= 0.5 * largest), key=lambda name: -round(magnitudes[name], 9)
    )
    return tuple(names[:3]) or ("nothing",)
