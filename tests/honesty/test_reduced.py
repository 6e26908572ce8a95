"""The smallest model gives what the full one gives, in every spec that is shipped."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.scene.file_format.load import load
from tests.shared.reduced import pair, same

SPECS = sorted(path.name for path in Path("specs").glob("*.yaml"))


@pytest.mark.parametrize("name", SPECS)
@pytest.mark.sixth
def test_specs(name: str) -> None:
    same(pair(load(f"specs/{name}")))
