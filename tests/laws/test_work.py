"""A drive's work is the energy gained and what dampers took, however smooth the free motion beside it."""

from __future__ import annotations

import pytest

from tests.shared.drive_laws import LAWS, energy_is_kept, nut, winch


def test_a_nut_pushed_back_and_forth() -> None:
    """The free spin is smooth and lets the steps grow long; the drive's power oscillates within them."""
    energy_is_kept(nut())
    assert nut().accuracy["energy_drift"] <= 1e-10


@pytest.mark.parametrize("law", ["harmonic", "composed"])
def test_a_load_hauled(law: str) -> None:
    energy_is_kept(winch(LAWS[law]))
    assert winch(LAWS[law]).accuracy["energy_drift"] <= 1e-9
