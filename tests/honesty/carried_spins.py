"""Modes of carriers on rubber whose rotors spin and are coupled, by matrices of the test's own.

    python -m tests.honesty.carried_spins --cases 3000 [--seed FIRST]

    M q'' + (C + G) q' + K q = 0,   G = -[H x] on the turns of the carrier,   H = sum of I_p W n over the rotors
q: shift and turn of the carrier as far as its joint leaves them, then the angle of each rotor against it, which
couplings and drives tie together. No line of heun stands in it. Each scene is told with its rate on one of the coupled
shafts, then on another, then by a drive, as a motion and as a state: the verdict may not hang on that.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from typing import Any, NamedTuple

import numpy as np

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import SolveError
from heuncli.motion.linearisation.oscillations import SceneModes
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from tests.honesty.rest_poses import spread
from tests.oracle.values import to_yaml
from tests.shared.hunts import asked_of

CARRIERS = ("ball", "universal", "free", "pin", "plane")
COUPLINGS = ("none", "ratio", "gear", "belt", "three", "differential")
ROUNDING = 1e-12  # of the fastest: of both eigenvalue problems
SLOW = 1e-5  # of the fastest: a double eigenvalue 0 comes apart by the root of rounding


class Drawn(NamedTuple):
    """A scene of some carrier. rates (n,): of the rotors; ties (k, n): couplings of their rates, each 0."""

    carrier: str
    coupling: str
    center: Array
    mass: float
    inertia: Array
    at: Array
    places: Array
    axes: Array
    masses: Array
    across: Array
    polar: Array
    rates: Array
    ties: Array
    stiffness: Array
    turning: Array
    damping: Array
    couplings: dict[str, Any]


def drawn(seed: int) -> Drawn:
    """A random carrier with two or three rotors; every other one without any load in its joints."""
    rng = np.random.default_rng([seed, 51])
    carrier = CARRIERS[seed % len(CARRIERS)]
    coupling = str(rng.choice(COUPLINGS))
    count = 3 if coupling in ("three", "differential") else int(rng.integers(2, 4))
    axes = rng.normal(size=(count, 3))
    if rng.integers(2):
        axes[:] = [0.0, 0.0, 1.0]
    places = 0.3 * rng.normal(size=(count, 3))
    if rng.integers(3) == 0:
        places[:] = 0.0
    if coupling in ("gear", "belt"):  # parallel shafts side by side
        axes[1] = axes[0] = [0.0, 0.0, 1.0]
        places[1] = places[0] + [rng.uniform(0.2, 0.4), rng.uniform(-0.1, 0.1), 0.0]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    ties, couplings = coupled(rng, coupling, count, places)
    _, s, V = np.linalg.svd(ties) if len(ties) else (None, np.zeros(0), np.eye(count))
    rates = V[len(s) :].T @ rng.normal(size=count - len(s)) * 10.0 ** rng.uniform(-1.0, 2.7)
    polar = 10.0 ** rng.uniform(-3.0, -1.5, count)
    box = rng.uniform(0.3, 0.6, 3)
    return Drawn(
        carrier, coupling, 0.1 * rng.normal(size=3) * rng.integers(2), rng.uniform(1.0, 5.0),
        np.array([box[1] ** 2 + box[2] ** 2, box[0] ** 2 + box[2] ** 2, box[0] ** 2 + box[1] ** 2]),
        0.1 * rng.normal(size=3) * rng.integers(2), places, axes, rng.uniform(0.5, 2.0, count),
        polar * rng.uniform(0.5, 1.0, count), polar, rates, ties,
        10.0 ** rng.uniform(3.0, 5.0, 3), 10.0 ** rng.uniform(1.0, 3.0, 3),
        10.0 ** rng.uniform(-1.0, 0.0, 3) * rng.integers(2), couplings,
    )  # fmt: skip


def coupled(rng: np.random.Generator, kind: str, count: int, places: Array) -> tuple[Array, dict[str, Any]]:
    """What a coupling asks of the rotors' rates, (k, n), and its entry."""
    row = np.zeros((1, count))
    if kind == "ratio":
        row[0, :2] = rng.uniform(0.4, 2.0, 2) * rng.choice([-1.0, 1.0], 2)
        return row, {"g": {"type": "ratio", "of": ["j0", "j1"], "factors": row[0, :2].tolist()}}
    if kind == "three":
        row[0] = rng.uniform(0.4, 2.0, 3) * rng.choice([-1.0, 1.0], 3)
        return row, {"g": {"type": "ratio", "of": ["j0", "j1", "j2"], "factors": row[0].tolist()}}
    if kind == "gear":
        ratio = rng.choice([-1.0, -rng.uniform(0.3, 3.0)])
        row[0, :2] = 1.0, -ratio
        return row, {"g": {"type": "gear", "of": ["j0", "j1"], "ratio": float(ratio)}}
    if kind == "belt":
        radii = rng.uniform(0.03, 0.08, 2)
        row[0, :2] = radii[0], -radii[1]
        return row, {"g": {"type": "belt", "of": ["j0", "j1"], "radii": radii.tolist(), "pretension": 100.0}}
    if kind == "differential":
        ratio = rng.choice([-1.0, rng.uniform(-2.0, -0.5)])
        row[0] = 1.0, -ratio, ratio - 1.0  # (w0 - w2) = ratio (w1 - w2)
        own = {"type": "differential", "of": ["j0", "j1", "j2"], "ratio": float(ratio)}
        return row, {"g": own}
    return np.zeros((0, count)), {}


def spec_of(one: Drawn, given: list[int], driven: int | None, kind: str) -> dict[str, Any]:
    """The scene with the rates of some rotors given, and one driven, or none."""
    bodies: dict[str, Any] = {
        "c": {
            "mass": one.mass, "center": one.center, "inertia": one.inertia,
            "points": {"o": [0, 0, 0], "b": one.at, **{f"p{i}": x for i, x in enumerate(one.places)}},
        }
    }  # fmt: skip
    if one.carrier == "free":
        bodies["c"]["velocity"] = [0.0, 0.0, 0.0]
    if one.carrier != "pin":
        bodies["c"]["angular_velocity"] = [0.0, 0.0, 0.0]
    joints: dict[str, Any] = {
        "ball": {"u": {"type": "ball", "from": "ground.O", "to": "c.o"}},
        "universal": {"u": {"type": "universal", "from": "ground.O", "to": "c.o", "axis": [1, 0, 0],
                            "to_axis": [0, 1, 0]}},
        "pin": {"u": {"type": "pin", "from": "ground.O", "to": "c.o", "axis": [0, 1, 0], "initial": {"rate": 0.0}}},
        "plane": {"u": {"type": "plane", "from": "ground.O", "to": "c.o", "normal": [0, 0, 1]}},
        "free": {},
    }[one.carrier]  # fmt: skip
    for i, n in enumerate(one.axes):
        across = one.across[i] * np.eye(3) + (one.polar[i] - one.across[i]) * np.outer(n, n)
        bodies[f"r{i}"] = {"mass": one.masses[i], "center": [0, 0, 0], "inertia": across, "points": {"o": [0, 0, 0]}}
        joints[f"j{i}"] = {"type": "pin", "from": f"c.p{i}", "to": f"r{i}.o", "axis": n}
        if i in given:
            joints[f"j{i}"]["initial"] = {"rate": float(one.rates[i])}
    rubber = {"type": "bushing", "from": {"body": "ground", "at": one.at}, "to": "c.b", "stiffness": one.stiffness,
              "turning": one.turning, "turning_damping": one.damping}  # fmt: skip
    found = {"bodies": bodies, "joints": joints, "couplings": one.couplings, "forces": {"rubber": rubber},
             "ground": {"points": {"O": [0, 0, 0]}}}  # fmt: skip
    if driven is not None:
        found["drives"] = {"d": {"joint": f"j{driven}", "rate": float(one.rates[driven])}}
    return {**found, "analysis": {"type": "state"} if kind == "state" else {"duration": 1, "samples": 3}}


def hat(a: Array) -> Array:
    """a x, (3, 3)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def eigenvalues(one: Drawn, driven: int | None) -> Array:
    """Those above 0 in frequency, and real ones, of the test's own matrices; [1/s], sorted; what is free left out."""
    n = len(one.rates)
    f = 6 + n
    M, C, K = (np.zeros((f, f)) for _ in range(3))

    def along(place: Array) -> Array:
        return np.hstack([np.eye(3), -hat(place), np.zeros((3, n))])

    turn = np.hstack([np.zeros((3, 3)), np.eye(3), np.zeros((3, n))])
    M += one.mass * along(one.center).T @ along(one.center) + turn.T @ np.diag(one.inertia) @ turn
    H = np.zeros(3)
    for i, axis in enumerate(one.axes):
        own = turn.copy()
        own[:, 6 + i] = axis
        inertia = one.across[i] * np.eye(3) + (one.polar[i] - one.across[i]) * np.outer(axis, axis)
        M += one.masses[i] * along(one.places[i]).T @ along(one.places[i]) + own.T @ inertia @ own
        H += one.polar[i] * one.rates[i] * axis
    C += turn.T @ (np.diag(one.damping) - hat(H)) @ turn
    K += along(one.at).T @ np.diag(one.stiffness) @ along(one.at) + turn.T @ np.diag(one.turning) @ turn
    held = {"ball": [0, 1, 2], "universal": [0, 1, 2, 5], "free": [], "pin": [0, 1, 2, 3, 5], "plane": [2]}[one.carrier]
    rows = [np.eye(f)[k] for k in held] + [np.concatenate([np.zeros(6), row]) for row in one.ties]
    rows += [] if driven is None else [np.eye(f)[6 + driven]]
    N = np.eye(f)
    if rows:
        _, s, V = np.linalg.svd(np.array(rows))
        N = V[int(np.sum(s > 1e-9)) :].T
    M, C, K = (N.T @ A @ N for A in (M, C, K))
    m = len(M)
    A = np.block([[np.zeros((m, m)), np.eye(m)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    found = np.linalg.eigvals(A)
    fastest = np.abs(found).max()
    found = found[(np.abs(found) > SLOW * fastest) & (found.imag >= 0.0)]
    return np.asarray(found[np.lexsort((found.real, found.imag))])


class Finding(NamedTuple):
    """what: "right", or what is not; ratio: the largest error over the stated one."""

    what: str
    ratio: float
    more: str


def tellings(one: Drawn, seed: int) -> list[tuple[list[int], int | None, str]]:
    """Ways to give the same motion: which rates are given, which is driven, and as what."""
    n, kind = len(one.rates), "state" if seed % 2 else "motion"
    free = [i for i in range(n) if not np.any(one.ties[:, i] if len(one.ties) else 0.0)]
    tied = [i for i in range(n) if i not in free]
    if not tied:
        return [(free, None, kind), (free[1:], free[0], kind)]
    ways = [(sorted(set(range(n)) - {i}), None, kind) for i in tied]
    ways += [(sorted(set(range(n)) - {i, tied[0]}), tied[0], kind) for i in tied[1:]]
    return ways


def judged(one: Drawn, given: list[int], driven: int | None, kind: str) -> Finding:
    """One telling of a scene."""
    try:
        found = compute_spec_modes(load("scene.yaml", to_yaml(spec_of(one, given, driven, kind))))
    except SolveError as error:
        return Finding("refused", 0.0, str(error))
    return compared(found, eigenvalues(one, driven))


def compared(found: SceneModes, right: Array) -> Finding:
    """heun's modes against eigenvalues."""
    if not found.is_steady:
        return Finding("not about the steady motion", 0.0, "")
    own = [mode for mode in found.modes if mode.kind != "free"]
    if len(own) != len(right):
        return Finding("other count", 0.0, f"{[m.eigenvalue for m in own]} {right}")
    left, worst, more = right.copy(), 0.0, ""
    fastest = float(np.abs(right).max(initial=0.0))
    for mode in own:
        k = int(np.argmin(np.abs(left - mode.eigenvalue)))
        ratio = float(abs(left[k] - mode.eigenvalue)) / (mode.error + ROUNDING * fastest)
        if ratio > worst:
            worst, more = ratio, f"{mode.eigenvalue} {left[k]} stated {mode.error:.3g}"
        left = np.delete(left, k)
    return Finding("right" if worst <= 1.0 else "farther than stated", worst, more)


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.carried_spins", __doc__, ["all"])
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        one = drawn(seed)
        for given, driven, kind in tellings(one, seed):
            found = judged(one, given, driven, kind)
            counts[found.what] += 1
            ratios.append(found.ratio)
            if found.what != "right":
                where = f"{seed} {one.carrier} {one.coupling} given {given} driven {driven} {kind}"
                print(f"{where}: {found.what} {found.ratio:.3g}: {found.more}", flush=True)
    print(f"{asked.cases} scenes from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"error over stated: {spread(ratios)}")
    return int(any(what != "right" for what in counts))


if __name__ == "__main__":
    sys.exit(main())
