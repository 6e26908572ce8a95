"""Characters of a terminal's line. Impure: asks the environment and the terminal.

As shutil.get_terminal_size finds them; shutil itself, with the archives that it knows, takes 2 ms to import.
"""

from __future__ import annotations

import os
import sys

UNTOLD = 80


def line_width() -> int:
    """What COLUMNS says, else the terminal that standard output was at the start, else 80."""
    try:
        if (given := int(os.environ["COLUMNS"])) > 0:
            return given
    except (KeyError, ValueError):
        pass
    try:
        return os.get_terminal_size(sys.__stdout__.fileno()).columns or UNTOLD  # type: ignore[union-attr]
    except (AttributeError, ValueError, OSError):
        return UNTOLD
