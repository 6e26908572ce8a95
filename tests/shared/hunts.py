"""What the commands that hunt through random cases are asked: which kind, how many, from which on, where finds go."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path


def asked_of(prog: str, description: str | None, kinds: Sequence[str] = ()) -> argparse.Namespace:
    """The words of the command line: kind (of `kinds`, by default the first), cases, seed, save."""
    parser = argparse.ArgumentParser(prog=f"python -m {prog}", description=description)
    if kinds:
        parser.add_argument("--kind", choices=kinds, default=kinds[0])
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="of the first case")
    parser.add_argument("--save", type=Path, metavar="FOLDER", help="where scenes go that are wrong")
    return parser.parse_args()
