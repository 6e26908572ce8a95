"""Find the sweep that `FILE` (the last one of a store) or `FILE:NUMBER` selects. Impure: checks whether the file
exists.
"""

from __future__ import annotations

from pathlib import Path

from heuncli.analyses.sweep_store.store import StoredSweep
from heuncli.base.errors import Problem, UsageError
from heuncli.base.text_safety import escape


def split_store_argument(word: str, option: str) -> tuple[str, int | None]:
    """Split `FILE` or `FILE:NUMBER` into the store's file and the number of the sweep, None without one. Raises
    UsageError.
    """
    name, colon, number = word.rpartition(":")
    if colon and name and number.isascii() and number.isdecimal() and not Path(word).exists():
        word, sweep_number = name, int(number)
    else:
        sweep_number = None
    if not Path(word).is_file():
        message = f"{option} {word}: file not found"
        raise UsageError(Problem("unreadable", message, hint="create one with heun sweep ... --store FILE"))
    return word, sweep_number


def choose_sweep(name: str, number: int | None, sweeps: list[StoredSweep], option: str) -> StoredSweep:
    """Return the sweep with that number, or the last. Raises UsageError."""
    found = sweeps[-1:] if number is None else [one for one in sweeps if one.number == number]
    if not found:
        numbers = ", ".join(str(one.number) for one in sweeps)
        message = f"{option} {name}: there is no sweep {number if number is not None else 'in it'}"
        raise UsageError(Problem("bad-option", message, hint=f"known: {numbers}" if numbers else "it is empty"))
    return found[0]


def format_sweep(sweep: StoredSweep) -> str:
    """Format a sweep of a store in one line."""
    head = sweep.head
    spec_and_names = f"{escape(head.path)}: {', '.join(head.plan.names)}"
    return (
        f"{sweep.start_time}  {spec_and_names}; {sweep.variant_count} of {head.plan.size} variants; "
        f"{', '.join(m.text for m in head.measures)}"
    )
