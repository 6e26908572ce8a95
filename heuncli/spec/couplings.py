"""Couplings as they are meant: what stands under `couplings` and `rolling`, SI, references followed.

One class a type; joints and bodies by their names. As in spec/models.py, None is what was left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from heuncli.named_tuples import NamedTuple

if TYPE_CHECKING:
    from heuncli.spec.models import End


class Term(NamedTuple):
    """A joint's coordinate and how many times it is taken."""

    joint: str
    quantity: Literal["angle", "travel"]
    factor: float


class Ratio(NamedTuple):
    """A linear relation: the sum of the terms stays what it is at the start, or is `is_`."""

    terms: tuple[Term, ...]
    is_: float | None = None
    type: Literal["ratio"] = "ratio"


class Passage(NamedTuple):
    """Where a rope passes: a point of a body, radius 0, or a sheave about it.

    axis: of the sheave, body axes, None: that of the pin there; side: past which the rope runs, None: the shortest way;
    grips: the rope does not slip on the sheave.
    """

    end: End
    radius: float = 0.0
    axis: tuple[float, float, float] | None = None
    side: Literal["over", "under", "left", "right"] | None = None
    grips: bool = False


class Rope(NamedTuple):
    """A rope without mass through points and over sheaves; length [m], None: as assembled.

    tension_only: the run ends where it would push; with restitution it goes slack instead, and catches again.
    """

    through: tuple[Passage, ...]
    length: float | None = None
    tension_only: bool = False
    restitution: float | None = None
    type: Literal["rope"] = "rope"

    @property
    def terms(self) -> tuple[Term, ...]:
        """No coordinates of joints."""
        return ()

    @property
    def gripped(self) -> frozenset[str]:
        """The bodies with sheaves on which it does not slip."""
        return frozenset(x.end.body for x in self.through if x.grips)


Coupling = Ratio | Rope
