"""All rules, in the order in which their violations are reported."""

from __future__ import annotations

from heuncli.scene.file_format.rules import (
    analysis,
    bodies,
    cams,
    conditions,
    couplings,
    curves,
    expect,
    joints,
    latches,
    loads,
    methods,
    motors,
    naming,
    not_yet,
    paths,
    plane,
    products,
    references,
    rolling,
    sections,
    stops,
    threads,
)
from heuncli.scene.file_format.rules.registry import RULES, DraftDocument, Rule, Violation, iter_violations

MODULES = (
    naming, references, bodies, products, joints, paths, plane, loads, motors, stops, latches, couplings, threads,
    rolling, cams, sections,
    analysis, methods, conditions, expect, curves, not_yet,
)  # fmt: skip

__all__ = ["MODULES", "RULES", "DraftDocument", "Rule", "Violation", "iter_violations"]
