"""What each program is asked: ways to integrate a scene, each at settings from coarse to fine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple


class Way(NamedTuple):
    """A way of a program to integrate a scene.

    prepare: of a setting, what integrates from the start (timed), and what then gives the centres of mass by body.
    """

    label: str
    settings: Sequence[Any]
    prepare: Callable[[Any], tuple[Callable[[], Any], Callable[[], dict[str, Any]]]]
