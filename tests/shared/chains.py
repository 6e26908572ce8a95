"""Masses on slides one behind the other with springs and dampers between: linear motions, whose matrix is known."""

from __future__ import annotations

import random
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]
DRAWN = 0.1  # all travels at the start [m]


def chain(seed: int, analysis: str) -> tuple[str, Array]:
    """A scene of one to four masses, at rest at the start, and the matrix of (travels, speeds)."""
    draw = random.Random(seed)
    n = draw.randint(1, 4)
    m = [10 ** draw.uniform(-1, 1) for _ in range(n)]
    k = [10 ** draw.uniform(0, 4) for _ in range(n)]
    c = [10 ** draw.uniform(-2, 2) for _ in range(n)]
    bodies, joints, forces = [], [], []
    before = "ground.O"
    for i in range(n):
        bodies.append(f"  b{i}: {{mass: {m[i]!r}, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}")
        start = f"initial: {{travel: {DRAWN}}}"
        joints.append(f"  s{i}: {{type: slide, axis: [1, 0, 0], from: {before}, to: b{i}.c, {start}}}")
        forces.append(f"  f{i}: {{type: torque, joint: s{i}, value: {-k[i]!r}*s{i}.travel - {c[i]!r}*s{i}.speed}}")
        before = f"b{i}.c"
    head = "heun: 1\nground: {points: {O: [0, 0, 0]}}\n"
    blocks = [("bodies", bodies), ("joints", joints), ("forces", forces)]
    text = head + "".join(f"{name}:\n" + "\n".join(rows) + "\n" for name, rows in blocks)
    # x_i = sum of the travels up to i; the force of a travel acts on both its ends
    to_places = np.tril(np.ones((n, n)))
    M = to_places.T @ np.diag(m) @ to_places
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, np.diag(k)), -np.linalg.solve(M, np.diag(c))]])
    return text + f"analysis: {analysis}\n", A
