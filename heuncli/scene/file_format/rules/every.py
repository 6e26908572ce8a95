"""All rules, in the order in which their violations are reported."""

from __future__ import annotations

from heuncli.scene.file_format.rules import (
    analysis,
    bodies,
    conditions,
    couplings,
    expect,
    joints,
    loads,
    paths,
    plane,
    products,
    references,
    rolling,
    sections,
    stops,
)
from heuncli.scene.file_format.rules.registry import RULES, DraftDocument, Rule, Violation, iter_violations

MODULES = (
    references, bodies, products, joints, paths, plane, loads, stops, couplings, rolling, sections, analysis,
    conditions, expect,
)  # fmt: skip

__all__ = ["MODULES", "RULES", "DraftDocument", "Rule", "Violation", "iter_violations"]
