"""Cams told otherwise: what of their entries, and of the tables of their lifts, changes with axes, units and names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.oracle.turns import Array

Spec = Mapping[str, Any]


def turned(cam: Spec, Q: Array) -> Spec:
    """The face's normal in turned axes; lift and angles stay, in a mirror, too."""
    return {**cam, **({"normal": (Q @ np.array(cam["normal"])).tolist()} if "normal" in cam else {})}


def in_units(cam: Spec, length: float) -> Spec:
    """The roller's radius in other units."""
    return {**cam, **({"radius": length * cam["radius"]} if "radius" in cam else {})}


def tables_in_units(scene: Mapping[str, Any], length: float) -> dict[str, Any]:
    """The lifts of followers that slide in other units, those of others as they are."""
    tables = dict(scene.get("tables", {}))
    for cam in scene.get("couplings", {}).values():
        if scene["joints"][cam["of"][1]]["type"] == "slide":
            table = tables[cam["lift"]]
            tables[cam["lift"]] = {**table, "y": [length * y for y in table["y"]]}
    return {"tables": tables} if tables else {}


def renamed(cam: Spec, bodies: Mapping[str, str], joints: Mapping[str, str]) -> Spec:
    """Its joints and the follower under other names."""
    at = {**cam["at"], "body": bodies[cam["at"]["body"]]}
    return {**cam, "of": [joints[name] for name in cam["of"]], "at": at}
