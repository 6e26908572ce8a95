"""What a run is made of as its scene grows in one thing, counted: `python -m tests.bench growth`.

`tests/package/test_growth.py` holds how these may grow.
"""

from __future__ import annotations

from tests.shared.counting import counts_of
from tests.shared.growing import GROWING

COUNTS = ("evaluations", "steps", "answered", "looked", "cuts")


def growth() -> None:
    """Each count of a run as JSON, and with the extremes searched for tables, by the size of the scene."""
    print(f"{'':16}" + "".join(f"{name:>22}" for name in COUNTS) + "   (as JSON / as tables)")
    for what, (scene, sizes) in GROWING.items():
        for n in sizes:
            bare, table = counts_of(scene(n)), counts_of(scene(n), table=True)
            print(f"{n:6d} {what:9}" + "".join(f"{f'{bare[name]} / {table[name]}':>22}" for name in COUNTS))
