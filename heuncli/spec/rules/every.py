"""All rules, in the order in which their findings are of use."""

from __future__ import annotations

from heuncli.spec.rules import analysis, bodies, expect, joints, loads, naming, not_yet, plane, references, sections
from heuncli.spec.rules.registry import RULES, Found, Rule, Scene, found_by

MODULES = (naming, references, bodies, joints, plane, loads, sections, analysis, expect, not_yet)

__all__ = ["MODULES", "RULES", "Found", "Rule", "Scene", "found_by"]
