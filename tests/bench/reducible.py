"""Scenes of which only a part, or something smaller, has to be solved; as text."""

from __future__ import annotations

import math

HEAD = "heun: 1\ntitle: {}\ngravity: [0, 0, -9.81]\nground: {{points: {{O: [0, 0, 0]}}}}\nbodies:\n"
TAIL = "analysis: {duration: 1, samples: 21, tolerance: 1e-8}\nreport: [motion, foundation]\n"
BRICK = "mass: 1, center: [0, 0, 0], inertia: [0.02, 0.03, 0.04]"


def cluster(links: int = 8) -> str:
    """A chain on balls of which each link is six bricks, welded in a circle."""
    places = [(0.2 * min(k, 5 - k), 0.2 * (k > 2), 0.0) for k in range(6)]
    bodies, joints = [], []
    for i in range(links):
        for k, (x, y, z) in enumerate(places):
            bodies.append(f"  b{i}_{k}: {{{BRICK}, position: [{i + x}, {y}, {z}]}}\n")
            other = (k + 1) % 6
            at = [one - of for one, of in zip((x, y, z), places[other], strict=True)]
            ends = f"from: {{body: b{i}_{k}, at: [0, 0, 0]}}, to: {{body: b{i}_{other}, at: {at}}}"
            joints.append(f"  w{i}_{k}: {{type: weld, {ends}}}\n")
        before = f"{{body: b{i - 1}_2, at: [0.6, 0, 0]}}" if i else "ground.O"
        joints.append(f"  j{i}: {{type: ball, from: {before}, to: {{body: b{i}_0, at: [0, 0, 0]}}}}\n")
    return HEAD.format("welded") + "".join(bodies) + "joints:\n" + "".join(joints) + TAIL


def truss(bays: int = 4) -> str:
    """A mast of bars on balls, nine to a bay, that carries a swinging brick."""
    ring = [(math.cos(a), math.sin(a)) for a in (0.0, 2.0 * math.pi / 3, 4.0 * math.pi / 3)]

    def node(level: int, k: int) -> list[float]:
        return [*ring[k % 3], 1.0 * level]

    steps = (0, 0, 1, 0), (0, 0, 1, 1), (1, 0, 1, 1)  # from level and corner, to level and corner
    bars = [((n + i, k + j), (n + u, k + v)) for n in range(bays) for k in range(3) for i, j, u, v in steps]
    bodies, joints = [], []
    first: dict[tuple[int, int], str] = {}
    for n, bar in enumerate(bars):
        p, q = (node(*end) for end in bar)
        shape = f"{{type: cylinder, from: {p}, to: {q}, radius: 0.02, density: 7850}}"
        bodies.append(f"  k{n}: {{shapes: [{shape}]}}\n")
        for level, k in bar:
            place = f"{{body: k{n}, at: {node(level, k)}}}"
            base = f"{{body: ground, at: {node(level, k)}}}" if level == 0 else None
            of = base or first.setdefault((level, k % 3), place)
            if of != place:
                joints.append(f"  j{len(joints)}: {{type: ball, from: {of}, to: {place}}}\n")
    x, y, z = node(bays, 0)
    bodies.append(f"  x: {{{BRICK}, position: [{x + 0.3}, {y}, {z - 0.1}], angular_velocity: [0.1, 0.2, 3]}}\n")
    joints.append(f"  swing: {{type: ball, from: {first[bays, 0]}, to: {{body: x, at: [-0.3, 0, 0.1]}}}}\n")
    return HEAD.format("mast") + "".join(bodies) + "joints:\n" + "".join(joints) + TAIL


def spun(radius: float, spin: float) -> str:
    """A wire a metre long, or a shaft, on a ball; radius [m]."""
    shape = f"{{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: {radius}, density: 7850}}"
    body = f"  w: {{shapes: [{shape}], points: {{top: [0, 0, 0]}}, orientation: {{axis: [1, 0, 0], angle: 60 deg}}, "
    body += f"angular_velocity: {{vector: [0.3, -0.2, {spin}], frame: body}}}}\n"
    tail = "joints:\n  j: {type: ball, from: ground.O, to: w.top}\nanalysis: {duration: 1, samples: 21}\n"
    return HEAD.format("wire") + body + tail


def pendulums(count: int = 101) -> str:
    """Pendulums side by side, each of its own length."""
    bodies, joints = [], []
    for i in range(count):
        points = "points: {top: [0, 0, 0]}"
        bodies.append(f"  b{i}: {{mass: 1, center: [0, 0, {-0.5 - 0.01 * i}], inertia: [0.1, 0.1, 0.001], {points}}}\n")
        ends = f"from: {{body: ground, at: [0, {i}, 0]}}, to: b{i}.top"
        joints.append(f"  p{i}: {{type: pin, {ends}, axis: [0, 1, 0], initial: {{angle: 1}}}}\n")
    tail = "analysis: {duration: 2, samples: 201}\n"
    return HEAD.format("pendulums") + "".join(bodies) + "joints:\n" + "".join(joints) + tail


def engine(crank: float = 0.05, rod: float = 0.15) -> str:
    """Four cylinders in line on a crankshaft with its flywheel, at constant speed; two turns; 20 cuts of a rod."""
    steel, bore = "density: 7850 kg/m^3", "{body: ground, at: [0, 0, 0]}"
    pins = [(crank * math.cos(a), crank * math.sin(a), 0.1 * i) for i, a in enumerate((0.5, 3.6, 3.6, 0.5))]
    points = ", ".join(f"c{i}: [{x}, {y}, {z}]" for i, (x, y, z) in enumerate(pins))
    bodies = [
        f"  crank: {{mass: 4, center: [0, 0, 0.15], inertia: [0.1, 0.1, 0.02], points: {{m: [0, 0, 0], {points}}}}}\n",
        f"  wheel: {{shapes: [{{type: cylinder, from: [0, 0, 0.4], to: [0, 0, 0.44], radius: 0.12, {steel}}}]}}\n",
    ]
    joints = [f"  main: {{type: pin, from: {bore}, to: crank.m, axis: [0, 0, 1]}}\n"]
    joints.append("  hub: {type: weld, from: {body: crank, at: [0, 0, 0.4]}, to: {body: wheel, at: [0, 0, 0.4]}}\n")
    for i, (x, y, z) in enumerate(pins):
        to = x + math.sqrt(rod * rod - y * y)
        bar = f"shapes: [{{type: cylinder, from: [{x}, {y}, {z}], to: [{to}, 0, {z}], radius: 0.008, {steel}}}]"
        mass = f"mass: 0.4, center: [{to}, 0, {z}], inertia: [3e-4, 3e-4, 3e-4]"
        bodies.append(f"  rod{i}: {{{bar}, points: {{a: [{x}, {y}, {z}], b: [{to}, 0, {z}]}}}}\n")
        bodies.append(f"  piston{i}: {{{mass}, points: {{p: [{to}, 0, {z}]}}}}\n")
        bore = f"{{body: ground, at: [0, 0, {z}]}}"
        joints.append(f"  big{i}: {{type: line, from: crank.c{i}, to: rod{i}.a, axis: [0, 0, 1]}}\n")
        joints.append(f"  wrist{i}: {{type: pin, from: rod{i}.b, to: piston{i}.p, axis: [0, 0, 1]}}\n")
        joints.append(f"  bore{i}: {{type: slide, from: {bore}, to: piston{i}.p, axis: [1, 0, 0]}}\n")
    tail = """drives: {motor: {joint: main, angle: "200*t"}}
sections: {along: {body: rod0, from: a, to: b, count: 20}}
analysis: {duration: 0.0628318530717959, samples: 720}
report: [joints, sections]
"""
    return HEAD.format("engine") + "".join(bodies) + "joints:\n" + "".join(joints) + tail
