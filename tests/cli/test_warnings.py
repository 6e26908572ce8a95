"""Python's warnings reach nobody but those who ask for them: in tests they are errors."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Sequence

import numpy as np
import pytest

from tests.shared.command import Heun

DIVIDES = """
import sys
import numpy as np
from heuncli import __main__
from heuncli.app.cli import entry
entry.enter = lambda argv: int((np.ones(1) / np.zeros(1))[0] < 0)
__main__.main()
"""


@pytest.mark.parametrize(("debug", "words"), [("", ""), ("1", "RuntimeWarning: divide by zero")])
def test_a_warning_is_shown_to_those_who_debug(debug: str, words: str) -> None:
    env = {key: value for key, value in os.environ.items() if key != "PYTHONWARNINGS"} | {"HEUN_DEBUG": debug}
    done = subprocess.run([sys.executable, "-c", DIVIDES], env=env, capture_output=True, text=True, check=True)
    assert words in done.stderr
    assert bool(words) == bool(done.stderr)


def test_it_is_an_error_in_tests_and_in_what_they_start() -> None:
    with pytest.raises(RuntimeWarning):
        warnings.warn("as NumPy does", RuntimeWarning, stacklevel=1)
    with pytest.raises(RuntimeWarning):
        np.ones(1) / np.zeros(1)
    done = subprocess.run([sys.executable, "-c", DIVIDES], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "RuntimeWarning" in done.stderr


def test_a_deprecation_between_other_packages_ends_nothing(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    """An older typer uses what a newer click deprecates; under `python -W error` that was told as a bug of heun."""

    def deprecated(words: Sequence[str]) -> int:
        warnings.warn("'click.utils.get_binary_stream' is deprecated", DeprecationWarning, stacklevel=1)
        return 2

    monkeypatch.setattr("heuncli.app.cli.typer_reader.read", deprecated)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert heun("runn") == (2, "", "")
