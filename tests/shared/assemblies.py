"""What two assemblies are compared by: the motion they find, and the calls of Python that finding it takes."""

from __future__ import annotations

import sys
from types import FrameType

import numpy as np
import pytest

from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.model import Assembly, Mechanism
from tests.shared.drafted_mechanisms import (
    centre,
    index,
)


def same_motion(s: Mechanism, a: Assembly, t: Mechanism, b: Assembly, tolerance: float = 1e-12) -> None:
    """The same bodies (by name) have the same centres, attitudes relative to the start and rates."""
    for i, one in enumerate(s.bodies):
        k = index(t, one.name)
        assert centre(t, b, k) == pytest.approx(centre(s, a, i), abs=tolerance)
        assert b.rotation[k] == pytest.approx(a.rotation[i], abs=tolerance)
        assert b.angular_velocity[k] == pytest.approx(a.angular_velocity[i], abs=tolerance)
        arm = [c.rotation[m] @ r.bodies[m].center for r, c, m in ((s, a, i), (t, b, k))]
        speeds = [
            c.velocity[m] + np.cross(c.angular_velocity[m], r) for (c, m), r in zip(((a, i), (b, k)), arm, strict=True)
        ]
        assert speeds[1] == pytest.approx(speeds[0], abs=tolerance)


def calls(s: Mechanism) -> int:
    """How many calls of functions assembling takes."""
    count = 0

    def counted(frame: FrameType, event: str, arg: object) -> None:
        nonlocal count
        count += 1

    sys.setprofile(counted)
    try:
        assemble(s)
    finally:
        sys.setprofile(None)
    return count
