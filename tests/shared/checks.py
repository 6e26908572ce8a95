"""A run against the oracle: what every closed chain must satisfy, whatever is open in it."""

from __future__ import annotations

import numpy as np

from heuncli.results.results import Array
from tests.oracle.read import GROUND, Joint, State, placed
from tests.oracle.rows import coordinates, directions
from tests.oracle.solve import OPEN
from tests.oracle.totals import Wrench, elements, supports
from tests.oracle.turns import cross
from tests.shared.scenes import near
from tests.shared.trees import ABOUT, Case

FREE = 1e-12  # of the largest load: what may be left of a component along a free direction
FREE_FORCES = {"slide": "along", "cylinder": "along", "line": "along", "plane": "across"}
FREE_MOMENTS = {"ball": "all", "line": "all", "plane": "all", "rod": "all", "pin": "along", "cylinder": "along"}


def same_accelerations(c: Case, tolerance: float = 1e-9) -> None:
    found = c.found.bodies
    for k in range(len(c.oracle)):
        o = c.oracle[k]
        both = (*o.acceleration.values(), *o.angular_acceleration.values())
        fastest = max(1.0, *(float(np.abs(a).max()) for a in both))
        for name in c.read.names:
            near(found[name]["center_acceleration"][k], o.acceleration[name], fastest, tolerance)
            near(found[name]["angular_acceleration"][k], o.angular_acceleration[name], fastest, tolerance)


def same_reactions(c: Case, tolerance: float = 1e-9) -> int:
    """Certain components agree, open ones are nan and listed; how many are open at some instant."""
    count = 0
    for name, block in c.found.joints.items():
        missing = set()
        for k in range(len(c.oracle)):
            r, F = c.oracle[k].reactions[name], c.force[k]
            near(block["point"][k], r.point, c.length)
            parts = (("force", r.force, r.unique[:3], F), ("moment", r.moment, r.unique[3:6], F * c.length))
            for part, wanted, unique, size in parts:
                assert (~np.isnan(block[part][k])).tolist() == unique.tolist(), f"{name}.{part} at instant {k}"
                near(np.where(unique, block[part][k], 0.0), np.where(unique, wanted, 0.0), size, tolerance)
                missing |= {f"{part}.{'xyz'[i]}" for i in np.flatnonzero(~unique)}
            if "drive" in block:
                assert np.isnan(block["drive"][k]) == (not r.unique[6])
                if r.unique[6]:
                    near(block["drive"][k], r.drive, F * c.length, tolerance)
        assert missing == {n for n in block["open"] if "." in n}
        count += len(missing)
    return count


def same_parts(c: Case) -> None:
    """axial, radial, tilting, tension: certain where every part of the wrench they are made of is."""
    for j in c.read.joints:
        block = c.found.joints[j.name]
        for k in range(len(c.oracle)):
            o, F = c.oracle[k], c.force[k]
            r = o.reactions[j.name]
            if j.kind == "rod":
                n = axis_between(j, c.states[k])
                value, certain = o.along(j.name, force=-n)
                assert np.isnan(block["tension"][k]) == (not certain)
                if certain:
                    near(block["tension"][k], value, F)
            if "axial" not in block:
                continue
            n = placed(c.states[k], j.a.body).rotation @ j.axis
            value, certain = o.along(j.name, force=n)
            assert np.isnan(block["axial"][k]) == (not certain)
            if certain:
                near(block["axial"][k], value, F)
            across = [d for d, _ in directions("across", j, c.states[k])]
            for part, which, size in (("radial", "force", F), ("tilting", "moment", F * c.length)):
                certain = all(o.along(j.name, **{which: e})[1] for e in across)
                assert np.isnan(block[part][k]) == (not certain), f"{j.name}.{part}"
                v = r.force if which == "force" else r.moment
                if certain:
                    near(block[part][k], np.linalg.norm(v - (v @ n) * n), size)


def axis_between(j: Joint, state: State) -> Array:
    ((n, _),) = directions("between", j, state)
    return n


def same_foundation(c: Case, tolerance: float = 1e-9) -> None:
    """Totals are always certain; supports carry the verdicts of their joints."""
    found = c.found.foundation
    for k in range(len(c.oracle)):
        o, state, F = c.oracle[k], c.states[k], c.force[k]
        near(found["force"][k], o.foundation_force, F, tolerance)
        near(found["moment"][k], o.foundation_moment, F * c.length, tolerance)
        held = supports(c.plain, state, o)
        assert set(held) == set(found.get("supports", {}))
        for name, w in held.items():
            own, unique = found["supports"][name], o.reactions[name].unique
            parts = (("force", w.force, unique[:3], F), ("moment", w.moment, unique[3:6], F * c.length))
            for part, wanted, certain, size in parts:
                assert (~np.isnan(own[part][k])).tolist() == certain.tolist()
                near(np.where(certain, own[part][k], 0.0), np.where(certain, wanted, 0.0), size, tolerance)
        standing = elements(c.plain, state, o, ABOUT)
        coupled = {name for name, own in c.found.couplings.items() if GROUND in own["on"] and name in o.grounded}
        assert set(standing) | coupled == set(found.get("elements", {}))
        for name in coupled:
            same_grounded(c, k, name, standing.pop(name, Wrench(np.zeros(3), np.zeros(3))), tolerance)
        for name, w in standing.items():
            own = found["elements"][name]
            drive = (c.scene.get("drives") or {}).get(name)
            if drive is not None and not o.reactions[drive["joint"]].unique[6]:
                assert np.isnan(own["force"][k]).any() or np.isnan(own["moment"][k]).any()
                continue
            near(own["force"][k], w.force, F, tolerance)
            near(own["moment"][k] + cross(own["point"][k] - ABOUT, own["force"][k]), w.moment, F * c.length, tolerance)


def same_grounded(c: Case, k: int, name: str, beside: Wrench, tolerance: float) -> None:
    """What a coupling puts on the ground, with its loads beside what it holds; what is open in it is nan."""
    own, o, F = c.found.foundation["elements"][name], c.oracle[k], c.force[k]
    point = own["point"][k]
    wrench, share = o.grounded[name].about(point)
    wrench = wrench + np.concatenate([beside.force, beside.moment - cross(point - ABOUT, beside.force)])
    size = np.repeat([1.0, o.length], 3)
    unique = np.all(np.abs(share) / size[:, None] <= OPEN * o.largest(), axis=1)
    told = np.concatenate([own["force"][k], own["moment"][k]])
    assert (~np.isnan(told)).tolist() == unique.tolist(), f"{name} ON the ground at instant {k}"
    for part in (slice(0, 3), slice(3, 6)):
        wanted = np.where(unique[part], wrench[part], 0.0)
        near(np.where(unique[part], told[part], 0.0), wanted, F if part.start == 0 else F * c.length, tolerance)


def same_coordinates(c: Case) -> None:
    """Angles modulo a turn."""
    for j in c.read.joints:
        block = c.found.coordinates.get(j.name, {})
        for k in range(len(c.oracle)) if block else []:
            for what, value in coordinates(j, c.states[k]).items():
                apart = np.sin((block[what][k] - value) / 2) if what == "angle" else block[what][k] - value
                near(apart, 0.0, c.length)


def free_directions_carry_nothing(c: Case) -> None:
    """In joint axes the components along what the joint leaves free are zero (where they are not open)."""
    for j in c.read.joints:
        block = c.found.joints[j.name]
        for k in range(len(c.oracle)):
            F = c.force[k]
            for part, which, size in (("force", FREE_FORCES, F), ("moment", FREE_MOMENTS, F * c.length)):
                v = block[part][k]
                if np.isnan(v).any():
                    continue
                word = which.get(j.kind)
                for d in [d for d, _ in directions(word, j, c.states[k])] if word else []:
                    near(v @ d, 0.0, size, FREE)
            if j.kind == "universal" and not np.isnan(block["moment"][k]).any():
                a = placed(c.states[k], j.a.body).rotation @ j.axis
                b = placed(c.states[k], j.b.body).rotation @ j.to_axis
                near([block["moment"][k] @ a, block["moment"][k] @ b], 0.0, F * c.length, FREE)
            if j.kind == "cv" and not np.isnan(block["moment"][k]).any():
                ((n, _),) = directions("halving", j, c.states[k])
                near(cross(n, block["moment"][k]), 0.0, F * c.length, FREE)
            if j.kind == "rod" and not np.isnan(block["force"][k]).any():
                near(cross(block["force"][k], axis_between(j, c.states[k])), 0.0, F, FREE)
