"""A case run in sight: what each of its command lines said."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from tests.faults.cases import Case
from tests.faults.worker import executed, inner

MOST = 3000  # characters of an output


def show(of: Case) -> None:
    """Print what a case's command lines left behind."""
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(inner(folder))
        try:
            done = executed(of)
        finally:
            os.chdir(here)
    for one in done:
        print(f"-> {one.code} in {one.seconds:.2f} s")
        print(one.err.decode(errors="backslashreplace")[:MOST])
        print(one.out.decode(errors="backslashreplace")[:MOST])
