"""The options of `heun import`, for all formats. `ModelReader.options` says which of them a format supports."""

from __future__ import annotations

from heuncli.base.named_tuples import NamedTuple


class ImportOptions(NamedTuple):
    """The options of one import.

    free: leave the joints free instead of holding them by drives
    base_free: let the root move instead of fixing it to the ground
    limits: turn joint limits into stops
    density: density of the shapes of links without inertia [kg/m^3]
    repair: the faults to repair, names from `ModelReader.repairs`
    keyframe: the pose in the file to start from
    """

    free: bool = False
    base_free: bool = False
    limits: bool = False
    density: float | None = None
    repair: frozenset[str] = frozenset()
    keyframe: str | None = None
