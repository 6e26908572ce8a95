"""What couplings mean: their references followed, defaults filled in; a row a type of entry.

For documents in which no rule found an error.
"""

from __future__ import annotations

from typing import Protocol

from heuncli.expressions.programs import Expression
from heuncli.joint_kinds import TYPES
from heuncli.spec import couplings as c
from heuncli.spec import format as whole
from heuncli.spec import format_couplings as f
from heuncli.spec.fields import EndEntry
from heuncli.spec.format_rolling import RollingEntry
from heuncli.spec.models import End


class Following(Protocol):
    """What follows the references of a document (resolve.py)."""

    document: whole.Document

    def end(self, end: EndEntry) -> End:
        """The point that an end names."""

    def placed(self, value: Expression, path: str) -> Expression:
        """An expression with its place in the file; path: dotted."""


def meant(by: Following, name: str, entry: f.CouplingEntry) -> c.Coupling:
    """The coupling that an entry means; name: of it, for the places of its expressions."""
    return MEANINGS[entry.type](by, name, entry)


def ratio(by: Following, name: str, entry: f.RatioEntry) -> c.Ratio:
    """A linear relation of the first coordinates of joints."""
    kinds = [TYPES[by.document.joints[joint].type] for joint in entry.of]
    rows = zip(entry.of, kinds, entry.factors, strict=True)
    return c.Ratio(tuple(c.Term(joint, kind.coordinates[0], factor) for joint, kind, factor in rows))


def wheel_meant(by: Following, entry: RollingEntry) -> c.Wheel:
    """The wheel that an entry of `rolling` means."""
    return c.Wheel(
        by.end(entry.wheel), entry.axis if entry.shape == "disc" else None, entry.radius, by.end(entry.on),
        entry.normal, entry.friction, entry.slides is not None, entry.held,
    )  # fmt: skip


MEANINGS = {"ratio": ratio}
