"""Numbers along axes: each tells its place, however far from zero and however short the axis is."""

from __future__ import annotations

import pytest

from heuncli.output.drawing.axes import choose_ticks
from heuncli.output.drawing.figure import Scaling

AXES = [
    Scaling("", 0.0, 1.0), Scaling("", -3e-7, 2.5e-6), Scaling("", 1e5, 1.5e6), Scaling("", 1013240.0, 1013252.0),
    Scaling("", 999990.0, 1000010.0), Scaling("", 1.23456e-5, 1.2346e-5), Scaling("", -1e12, 1e-3),
    Scaling("[deg]", 1e6, 1e6 + 360.0), Scaling("", 1e-12, 1e12, is_logarithmic=True),
    Scaling("", 2.2, 2.9, is_logarithmic=True), Scaling("", 4.0, 4.5, is_logarithmic=True),
]  # fmt: skip


@pytest.mark.parametrize("scaling", AXES)
@pytest.mark.parametrize("most", [2, 5, 9])
def test_numbers_tell_their_places(scaling: Scaling, most: int) -> None:
    found = choose_ticks(scaling, most)
    assert len(found) >= 2
    for value, text in found:
        assert scaling.to_share(float(text.replace("−", "-"))) == pytest.approx(scaling.to_share(value), abs=1e-6)
        assert -1e-6 <= scaling.to_share(value) <= 1.0 + 1e-6
