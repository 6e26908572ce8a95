"""What a run says is open, and which sums it says are certain, in a form that can be compared."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Results
from tests.shared.scenes import terms_at


def open_forces(found: Results, name: str) -> set[str]:
    return {n[-1] for n in found.joints[name]["open"] if n.startswith("force.")}


def sums(found: Results) -> list[tuple[dict[str, float], float]]:
    """Terms and value at the first instant."""
    return [(terms_at(s["terms"], 0), float(np.atleast_1d(s["value"])[0])) for s in found.certain_sums]


def told_by_sums(found: Results, terms: dict[str, float]) -> bool:
    """Whether the listed sums together tell this one."""
    names = sorted({n for t, _ in sums(found) for n in t} | set(terms))
    rows = np.array([[t.get(n, 0.0) for n in names] for t, _ in sums(found)])
    wanted = np.array([terms.get(n, 0.0) for n in names])
    return bool(np.linalg.norm(wanted - rows.T @ np.linalg.lstsq(rows.T, wanted, rcond=None)[0]) < 1e-9)


def open_parts(found: Results) -> dict[str, set[str]]:
    """Of each joint everything open at some instant."""
    return {name: set(block["open"]) for name, block in found.joints.items()}
