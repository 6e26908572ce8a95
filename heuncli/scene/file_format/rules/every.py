"""All rules: importing their modules registers them, in this order."""

from __future__ import annotations

from heuncli.scene.file_format.rules import (  # noqa: F401 (each registers its rules)
    analysis,
    bodies,
    bushings,
    couplings,
    expect,
    joints,
    loads,
    members,
    paths,
    plane,
    products,
    references,
    rolling,
    sections,
    segments,
    stops,
)
from heuncli.scene.file_format.rules.registry import RULES, DraftDocument, Rule, Violation, iter_violations

__all__ = ["RULES", "DraftDocument", "Rule", "Violation", "iter_violations"]
