"""What `heun import` may be asked for, whatever the format: a reader's row says which of it the format has."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple


class ImportAsked(NamedTuple):
    """free: joints are let go, not held by drives; base_free: the root moves, it does not stand on the ground.

    limits: limits of joints become stops; density [kg/m^3]: of the shapes of what has no inertia; repair: the faults
    that are repaired, words of REPAIRS in the reader's package; keyframe: of the file's poses that which is the start.
    """

    free: bool = False
    base_free: bool = False
    limits: bool = False
    density: float | None = None
    repair: frozenset[str] = frozenset()
    keyframe: str | None = None
