"""Random rows of balls, and bodies on posts and ropes, struck in sequence, against event-driven codes of their own.

    python -m tests.honesty.impact_sequences --kind rows|bodies --cases 1000 [--seed FIRST] [--save FOLDER]

A scene whose contacts touch and are struck by `impacts: sequential` is held against equal gaps that vanish: the
reference lets balls fly between impacts and strikes them one by one by the formula of two masses, in plain Python. Rows
are run with real gaps of 1e-9 to 1e-3 m, too. Prints what is wrong, and how differences are spread over the errors that
runs state.
"""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.study.queries.study import Study
from tests.honesty.rest_poses import spread
from tests.oracle.values import to_yaml
from tests.shared.hunts import asked_of
from tests.shared.said_again import error_of
from tests.shared.scenes import study

FACTOR = 2.0  # of what is stated: an estimate, no bound
ROUNDING = 1e-12  # of the largest: some hundred roundings of sums, and what ends a sequence without end
RIGHT = ("same", "endless", "beyond the reference")
ENDLESS = 4_000  # impacts of a reference
SMALLEST = 1e-14  # of the fastest: closing no more


@dataclass(frozen=True)
class Contact:
    """A contact of two balls, or of a ball and a wall (-1), struck where sense * (v_j - v_i) < 0."""

    i: int
    j: int
    sense: float
    e: float


@dataclass
class Ended:
    """What a reference came to: speeds, impulses of each contact, and how many impacts, and when the last was."""

    v: list[float]
    impulses: list[float]
    count: int = 0
    last: float = 0.0
    is_endless: bool = False
    fastest: float = 0.0

    @property
    def doubt(self) -> float:
        """What is missing of the speeds where a geometric sequence is left at SMALLEST: that, over its ratio less 1."""
        return SMALLEST * self.fastest * (1 + self.count)


def event_driven(masses: list[float], v: list[float], contacts: list[Contact], gaps: list[float]) -> Ended:
    """Balls on a line from impact to impact; gaps: between them at the start, all of what strikes first."""
    v, gaps = list(v), list(gaps)
    found = Ended(v, [0.0] * len(contacts))
    fastest = max(map(abs, v)) or 1.0

    def speed(i: int) -> float:
        return 0.0 if i < 0 else v[i]

    while True:
        found.fastest = max(found.fastest, *map(abs, v))
        rates = [c.sense * (speed(c.j) - speed(c.i)) for c in contacts]
        closing = [k for k, rate in enumerate(rates) if rate < -SMALLEST * fastest]
        if not closing:
            return found
        if found.count >= ENDLESS:
            found.is_endless = True
            return found
        k = min(closing, key=lambda k: gaps[k] / -rates[k])
        flight = gaps[k] / -rates[k]
        gaps = [max(gap + rate * flight, 0.0) for gap, rate in zip(gaps, rates, strict=True)]
        gaps[k] = 0.0
        c = contacts[k]
        z = -(1.0 + c.e) * rates[k] / sum(1.0 / masses[m] for m in (c.i, c.j) if m >= 0)
        for m, way in ((c.i, -1.0), (c.j, 1.0)):
            if m >= 0:
                v[m] += way * c.sense * z / masses[m]
        found.impulses[k] += z
        found.count += 1
        found.last += flight


@dataclass
class Row:
    """A row of balls: of which masses, how fast, with which contacts; how it is written, and how it is struck.

    driven: the first ball moves as a drive says; given: the impulse on a ball; names of balls and contacts.
    """

    masses: list[float]
    v: list[float]
    contacts: list[Contact]
    way: str
    strike: str
    direction: list[float]
    planar: bool
    balls: list[str]
    names: list[str]
    backwards: bool
    given: tuple[int, float] | None = None
    masses_met: list[float] = field(default_factory=list)


def row(seed: int) -> Row:
    """A random row."""
    rng = np.random.default_rng([seed, 411])
    n = int(rng.integers(2, 7))
    wide = [0.0, 1.0, 3.0][int(rng.integers(3))]
    masses = [float(10.0 ** rng.uniform(-wide, wide)) for _ in range(n)]
    way = str(rng.choice(["rod", "rope", "coupling", "nested"]))
    strike = str(rng.choice(["start", "flight", "impulse", "drive"][way == "coupling" :]))  # taut, it starts fitting
    alike = [None, 1.0, 0.0, float(rng.uniform(0.0, 1.0))][int(rng.integers(4))]
    e = [float(rng.uniform(0.0, 1.0)) if alike is None else alike for _ in range(n + 1)]
    sense = -1.0 if way in ("rope", "coupling") else 1.0
    contacts = [Contact(k, k + 1, sense, e[k]) for k in range(n - 1)]
    if rng.random() < 0.4 and way != "nested":
        contacts.append(Contact(n - 1, -1, sense, e[n]))
    v = [0.0] * n
    given = None
    speed = float(sense * rng.uniform(0.5, 2.0))
    if strike == "impulse":
        given = (int(rng.integers(n)), float(rng.uniform(0.5, 2.0) * rng.choice([-1.0, 1.0])))
    elif strike == "start":
        v = [float(x) for x in rng.uniform(-1.0, 1.0, n)]
    else:
        v[0] = speed
    planar = bool(rng.random() < 0.5)
    direction = rng.standard_normal(2 if planar else 3)
    labels = [f"{a}{k}" for k, a in enumerate(rng.permutation(list("abcdefg")))]
    return Row(masses, v, contacts, way, strike, (direction / np.linalg.norm(direction)).tolist(), planar, labels[:n],
               [f"c{x}" for x in labels[: len(contacts)]], bool(rng.random() < 0.5), given,
               [math.inf if k == 0 and strike == "drive" else m for k, m in enumerate(masses)])  # fmt: skip


def written(own: Row, gap: float = 0.0, last: float = 0.05) -> dict[str, Any]:
    """A row as a spec, with gaps between all that touches; it is struck at 0.01 s, or at the start."""
    n, u = len(own.balls), np.array(own.direction)
    at = 0.01 if own.strike in ("flight", "drive") else 0.0
    spacing = 1.0 + gap * own.contacts[0].sense
    x = [k * spacing for k in range(n)]
    v = [0.0 if k == 0 and own.strike == "drive" else speed for k, speed in enumerate(own.v)]
    if own.strike == "flight":
        x[0] -= own.v[0] * at
    bodies, joints, stops, couplings = {}, {}, {}, {}
    for k, name in enumerate(own.balls):
        frame = {"inertia": 0.01} if own.planar else {"inertia": [0.01, 0.02, 0.03]}
        bodies[name] = {"mass": own.masses[k], "center": [0.0] * len(u), **frame,
                        "points": {"o": [0.0] * len(u)}, "position": (x[k] * u).tolist()}  # fmt: skip
        before = "ground.O" if own.way != "nested" or not k else f"{own.balls[k - 1]}.o"
        lead = x[k] - (x[k - 1] if own.way == "nested" and k else 0.0)
        rate = v[k] - (v[k - 1] if own.way == "nested" and k else 0.0)
        joints[f"g{name}"] = {"type": "slide", "from": before, "to": f"{name}.o", "axis": u.tolist(),
                              "initial": {"travel": lead, "speed": rate}}  # fmt: skip
    for c, name in zip(own.contacts, own.names, strict=True):
        if c.j < 0:
            limit = x[c.i] + c.sense * gap if own.strike != "flight" or c.i else c.sense * gap
            stops[name] = {"joint": f"g{own.balls[c.i]}", "restitution": c.e,
                           "travel": [None, limit] if c.sense > 0.0 else [limit, None]}  # fmt: skip
        elif own.way == "nested":
            stops[name] = {"joint": f"g{own.balls[c.j]}", "travel": [1.0, None], "restitution": c.e}
        else:
            ends = {"from": f"{own.balls[c.i]}.o", "to": f"{own.balls[c.j]}.o"}
            if own.way == "rod":
                joints[f"r{name}"] = {"type": "rod", **ends}
                stops[name] = {"joint": f"r{name}", "length": [1.0, None], "restitution": c.e}
            elif own.way == "rope":
                joints[name] = {"type": "rod", **ends, "length": 1.0, "tension_only": True, "restitution": c.e}
            else:
                couplings[name] = {"type": "rope", "through": [*ends.values()], "length": 1.0, "tension_only": True,
                                   "restitution": c.e}  # fmt: skip
    tree: dict[str, Any] = {"ground": {"points": {"O": [0.0] * len(u)}}, "bodies": bodies, "joints": joints,
                            "analysis": {"times": [0.0, last], "impacts": "sequential"}}  # fmt: skip
    if own.planar:
        tree["space"] = "planar"
    if own.strike == "drive":
        joints[f"g{own.balls[0]}"].pop("initial")
        tree["drives"] = {"push": {"joint": f"g{own.balls[0]}", "travel": f"{own.v[0]!r}*max(t - {at!r}, 0)"}}
    if own.given is not None:
        struck, size = own.given
        tree["impulses"] = {"blow": {"on": f"{own.balls[struck]}.o", "vector": (size * u).tolist()}}
        tree["analysis"] = {"type": "impulse", "impacts": "sequential"} if not gap else tree["analysis"]
    for name, block in (("stops", stops), ("couplings", couplings)):
        if block:
            tree[name] = block
    if own.backwards:
        for name in ("bodies", "joints", "stops", "couplings"):
            if name in tree and (name != "joints" or own.way != "nested"):
                tree[name] = dict(reversed(tree[name].items()))
    return tree


@dataclass
class Verdict:
    """What a scene is, the largest difference over what is stated, and more."""

    what: str
    ratio: float = 0.0
    more: str = ""


def answer(tree: dict[str, Any]) -> Study | str:
    """A scene solved, or why not."""
    try:
        return study(to_yaml(tree))
    except HeunError as error:
        return error.problems[0].code


def start_of(own: Row) -> list[float]:
    """The speeds behind what is given, before anything is struck."""
    v = list(own.v)
    if own.given is not None:
        v[own.given[0]] += own.given[1] / own.masses[own.given[0]]
    return v


def laws(run: Study, own: Row, wanted: Ended) -> str:
    """What of the laws of impacts does not hold of the first blow, or nothing."""
    block = run.results.impulses[0]
    u = np.array([*own.direction, 0.0][:3])
    jumps = [float(np.dot(block["bodies"][name]["center_velocity_jump"], u)) for name in own.balls]
    size = max(wanted.impulses) + sum(m * abs(x) for m, x in zip(own.masses, start_of(own), strict=True))
    free = own.strike != "drive" and all(c.j >= 0 for c in own.contacts)
    given = own.given[1] if own.given is not None else 0.0
    if free and abs(sum(m * x for m, x in zip(own.masses, jumps, strict=True)) - given) > 1e-10 * size:
        return "momentum"
    before, after = float(block["energy_before"]), float(block["energy_after"])
    energies = [0.5 * sum(m * x * x for m, x in zip(own.masses, v, strict=True)) for v in (start_of(own), wanted.v)]
    if own.strike != "drive":
        if after > energies[0] * (1.0 + 1e-10):
            return f"energy grows from {energies[0]!r} to {after!r}"
        if all(c.e == 1.0 for c in own.contacts) and abs(after - energies[0]) > 1e-10 * energies[0]:
            return f"energy at restitution 1: {energies[0]!r}, {after!r}"
    if abs(after - energies[1]) > 1e-9 * max(after, before, energies[0]):
        return f"energy {after!r}, not {energies[1]!r}"
    loaded = [name for name, z in zip(own.names, wanted.impulses, strict=True) if z > 1e-9 * max(wanted.impulses)]
    told = run.results.model.get("contacts", ())
    if len(loaded) > 1 and not (any("impacts: sequential" in one for one in told) and run.results.warnings):
        return "not said"
    if sum(z > 0.0 for z in wanted.impulses) < 2 and any("share" in one for one in told):
        return f"said of one contact: {told}"
    return ""


def compare_row(run: Study, own: Row, wanted: Ended) -> tuple[float, str]:
    """The largest difference of jumps and impulses of the first blow over what is stated, and of which."""
    block, stops = run.results.impulses[0], own.way in ("rod", "nested")
    u = np.array([*own.direction, 0.0][:3])
    largest = max(wanted.impulses)
    # a light ball that carries a heavy one in a nested row: digits that the inertia of the branch loses
    lost = np.finfo(float).eps * max(own.masses) / min(own.masses) if own.way == "nested" else 0.0
    found, doubts = [], []
    for c, name, z in zip(own.contacts, own.names, wanted.impulses, strict=True):
        if stops or c.j < 0:
            has = abs(float(block.get("stops", {}).get(name, {}).get("force", 0.0)))
            path = ("stops", name, "force")
        else:
            kind = "joints" if own.way == "rope" else "couplings"
            has = abs(float(block.get(kind, {}).get(name, {}).get("tension", 0.0)))
            path = (kind, name, "tension")
        stated = error_of(run, path, "N·s") if run.history.check_impulses else 0.0
        doubts.append(stated + (ROUNDING + lost) * largest + wanted.doubt * sum(own.masses))
        found.append((abs(has - z) / doubts[-1], name))
    motion = float(run.results.accuracy["estimate"]["motion"]) * run.magnitudes.size
    for k, name in enumerate(own.balls):
        jump = float(np.dot(block["bodies"][name]["center_velocity_jump"], u))
        off = abs(jump - (wanted.v[k] - own.v[k] * (own.strike != "drive" or k > 0)))
        found.append((off / (motion + 2.0 * max(doubts) / own.masses[k] + ROUNDING * wanted.fastest), name))
    return max(found)


def judged_row(seed: int) -> tuple[Verdict, dict[str, Any]]:
    """A row that touches, by its first blow, or one with gaps, by its speeds in the end."""
    own = row(seed)
    gap = 0.0 if seed % 3 else 10.0 ** np.random.default_rng([seed, 5]).uniform(-9.0, -3.0)
    if gap and own.strike == "flight":
        gap = 0.0  # which gaps are open when the first strikes is the reference's own story
    wanted = event_driven(own.masses_met, start_of(own), own.contacts, [gap or 1.0] * len(own.contacts))
    tree = written(own, gap, max(0.05, 1.5 * wanted.last + 0.02) if gap else 0.05)
    if wanted.is_endless or (gap and wanted.count > 100):
        if gap or any(c.e < 1.0 for c in own.contacts):
            return Verdict("beyond the reference"), tree
        found = answer(tree)
        return Verdict("endless" if found == "endless-impacts" else "not refused", more=str(found)), tree
    run = answer(tree)
    if isinstance(run, str):
        return Verdict("refused", more=run), tree
    if not any(wanted.impulses):
        return Verdict("same" if gap or not any(own.names[k] in b["names"] for b in run.results.impulses[:1]
                                                for k in range(len(own.names))) else "struck"), tree  # fmt: skip
    if gap:
        return judged_gaps(run, own, wanted), tree
    if broken := laws(run, own, wanted):
        return Verdict("law", more=broken), tree
    ratio, name = compare_row(run, own, wanted)
    what = "same" if ratio <= FACTOR else "farther than stated"
    return Verdict(what, ratio, f"{name}; {own.way}, {own.strike}, {wanted.count} impacts"), tree


def judged_gaps(run: Study, own: Row, wanted: Ended) -> Verdict:
    """Speeds behind all impacts of a row with gaps."""
    u = np.array([*own.direction, 0.0][:3])
    speeds = [float(np.dot(run.results.bodies[name]["velocity"][-1], u)) for name in own.balls]
    fastest = max(abs(x) for x in (*start_of(own), *wanted.v))
    off = max(abs(a - b) for a, b in zip(speeds, wanted.v, strict=True))
    stated = float(run.results.accuracy["estimate"]["motion"]) * run.magnitudes.size
    ratio = off / (stated + 10.0 * ROUNDING * fastest + wanted.doubt)
    return Verdict("same" if ratio <= FACTOR else "farther than stated", ratio, f"gaps, {wanted.count} impacts")


# ---- a free body on posts and ropes
@dataclass
class Held:
    """A free body on posts, or ropes, each at a point p (3,) from its centre with a direction n of push (3,)."""

    mass: float
    inertia: np.ndarray
    v: np.ndarray
    w: np.ndarray
    p: np.ndarray
    n: np.ndarray
    e: np.ndarray
    ropes: bool


def held(seed: int) -> Held:
    """A random one, which falls on its posts."""
    rng = np.random.default_rng([seed, 97])
    k = int(rng.integers(2, 8))
    turned, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    moments = np.array([1.0, 1.0, 1.0]) + rng.uniform(-0.3, 0.3, 3)
    p = rng.uniform(-1.0, 1.0, (k, 3))
    up = np.array([0.0, 0.0, 1.0])
    n = up + rng.uniform(0.0, 0.8) * rng.standard_normal((k, 3))
    n /= np.linalg.norm(n, axis=1)[:, None]
    if seed % 4 == 0:  # flat on posts, more than needed
        p[:, 2], n[:] = -0.2, up
    e = rng.uniform(0.0, 1.0, k) if seed % 3 else np.full(k, rng.choice([0.0, 0.5, 1.0]))
    v = np.array([0.0, 0.0, -1.0]) + 0.3 * rng.standard_normal(3)
    return Held(float(rng.uniform(0.5, 3.0)), turned @ np.diag(moments) @ turned.T, v, 0.5 * rng.standard_normal(3),
                p, n, e, bool(rng.random() < 0.4))  # fmt: skip


def fall_in_sequence(own: Held) -> tuple[Ended, np.ndarray, np.ndarray]:
    """Newton's and Euler's laws from impact to impact, with equal gaps at the start."""
    v, w, gaps = own.v.copy(), own.w.copy(), [1.0] * len(own.p)
    levers = np.cross(own.p, own.n)
    turns = np.linalg.solve(own.inertia, levers.T).T
    found = Ended([], [0.0] * len(own.p))
    rates = own.n @ v + levers @ w
    fastest = found.fastest = float(np.abs(rates).max())
    while True:
        rates = own.n @ v + levers @ w
        closing = [k for k, rate in enumerate(rates) if rate < -SMALLEST * fastest]
        if not closing:
            return found, v, w
        if found.count >= ENDLESS:
            found.is_endless = True
            return found, v, w
        k = min(closing, key=lambda k: gaps[k] / -rates[k])
        flight = gaps[k] / -rates[k]
        gaps = [max(gap + rate * flight, 0.0) for gap, rate in zip(gaps, rates, strict=True)]
        gaps[k] = 0.0
        z = -(1.0 + own.e[k]) * rates[k] / (1.0 / own.mass + levers[k] @ turns[k])
        v, w = v + z * own.n[k] / own.mass, w + z * turns[k]
        found.impulses[k] += float(z)
        found.count += 1


def written_body(own: Held) -> dict[str, Any]:
    """The body as a spec: posts and ropes of 1 m."""
    side = 1.0 if own.ropes else -1.0
    anchors = {f"A{k}": (p + side * n).tolist() for k, (p, n) in enumerate(zip(own.p, own.n, strict=True))}
    joints, stops = {}, {}
    for k, e in enumerate(own.e.tolist()):
        ends = {"type": "rod", "from": f"ground.A{k}", "to": f"b.p{k}"}
        if own.ropes:
            joints[f"s{k}"] = {**ends, "length": 1.0, "tension_only": True, "restitution": e}
        else:
            joints[f"r{k}"] = ends
            stops[f"s{k}"] = {"joint": f"r{k}", "length": [1.0, None], "restitution": e}
    tree = {"ground": {"points": anchors}, "joints": joints,
            "bodies": {"b": {"mass": own.mass, "center": [0.0, 0.0, 0.0], "inertia": inertia_of(own.inertia),
                             "points": {f"p{k}": p.tolist() for k, p in enumerate(own.p)},
                             "velocity": own.v.tolist(), "angular_velocity": own.w.tolist(),
                             "position": [0.0, 0.0, 0.0]}},
            "analysis": {"times": [0.0, 0.05], "impacts": "sequential"}}  # fmt: skip
    return tree | ({"stops": stops} if stops else {})


def inertia_of(tensor: np.ndarray) -> Any:
    """A tensor of inertia as a spec has it."""
    return (0.5 * (tensor + tensor.T)).tolist()


def judged_body(seed: int) -> tuple[Verdict, dict[str, Any]]:
    """The first blow of a body on posts: jumps of velocities, impulses where they are not open."""
    own = held(seed)
    wanted, v, w = fall_in_sequence(own)
    tree = written_body(own)
    if wanted.is_endless:
        return Verdict("beyond the reference"), tree
    run = answer(tree)
    if isinstance(run, str):
        return Verdict("refused", more=run), tree
    if not any(wanted.impulses):
        return Verdict("same" if not run.results.impulses else "struck"), tree
    block = run.results.impulses[0]
    after = 0.5 * own.mass * v @ v + 0.5 * w @ own.inertia @ w
    before = 0.5 * own.mass * own.v @ own.v + 0.5 * own.w @ own.inertia @ own.w
    if float(block["energy_after"]) > before * (1.0 + 1e-11):
        return Verdict("law", more="energy grows"), tree
    largest, found = max(wanted.impulses), []
    kind, part = ("joints", "tension") if own.ropes else ("stops", "force")
    for k, z in enumerate(wanted.impulses):
        has = abs(float(block.get(kind, {}).get(f"s{k}", {}).get(part, 0.0)))
        stated = error_of(run, (kind, f"s{k}", part), "N·s")
        found.append((abs(has - z) / (stated + 10.0 * ROUNDING * largest + wanted.doubt), f"s{k}"))
    jump = np.concatenate([block["bodies"]["b"][x] for x in ("center_velocity_jump", "angular_velocity_jump")])
    off = float(np.abs(jump - np.concatenate([v - own.v, w - own.w])).max())
    found.append((off / (10.0 * ROUNDING * max(1.0, float(np.abs(jump).max())) + wanted.doubt), "b"))
    if abs(float(block["energy_after"]) - after) > 1e-9 * before:
        return Verdict("law", more=f"energy {block['energy_after']!r}, not {after!r}"), tree
    ratio, name = max(found, key=lambda one: -1.0 if math.isnan(one[0]) else one[0])
    if any(math.isnan(one[0]) for one in found):
        return Verdict("open", more=str(found)), tree
    what = "same" if ratio <= FACTOR else "farther than stated"
    return Verdict(what, ratio, f"{name}; {len(own.e)} contacts, {wanted.count} impacts"), tree


KINDS = {"rows": judged_row, "bodies": judged_body}


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.impact_sequences", __doc__, tuple(KINDS))
    counts: Counter[str] = Counter()
    ratios: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        verdict, tree = KINDS[asked.kind](seed)
        counts[verdict.what] += 1
        if verdict.what in ("same", "farther than stated"):
            ratios.append(verdict.ratio)
        if verdict.what not in RIGHT:
            print(f"{seed}: {verdict.what} {verdict.ratio:.3g}: {verdict.more}", flush=True)
            if asked.save is not None:
                asked.save.mkdir(parents=True, exist_ok=True)
                (asked.save / f"{asked.kind}_{seed}.yaml").write_text(to_yaml(tree), encoding="utf-8")
    print(f"{asked.cases} {asked.kind} from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"difference over stated error: {spread(ratios)}")
    return int(any(what not in RIGHT for what in counts))


if __name__ == "__main__":
    sys.exit(main())
