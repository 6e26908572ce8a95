"""CSV, tables in any units and joints' axes tell the numbers of the JSON: told_forms.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.told_forms import compared
from tests.shared.folders import SPECS


@pytest.mark.parametrize("name", ["crane", "engine", "bricard", "press", "top", "lamp"])
@pytest.mark.third
def test_every_form_tells_the_same(name: str) -> None:
    assert compared(SPECS / f"{name}.yaml") > 60
