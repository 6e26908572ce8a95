"""The command `heun`, and `python -m heuncli`.

Impure: listens to signals before anything else is imported, sets OPENBLAS_NUM_THREADS before NumPy can be (threads cost
more to start than they save here), how often Python looks for cycles of dead objects, and whether its own warnings are
shown.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]

if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
    _signal.signal(_signal.SIGINT, _signal.SIG_DFL)  # ends without a word until `listen` can say one

import gc
import os
import sys
import warnings

from heuncli.app.cli import at_once
from heuncli.base import signals

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
MANY = 500_000  # objects made between two searches for dead cycles; 700 by default: 20 ms while modules are loaded


def main() -> None:
    """Run the command line and leave with its exit code."""
    signals.listen()
    gc.set_threshold(MANY)
    fill_gaps()
    if not sys.warnoptions and os.environ.get("HEUN_DEBUG") != "1":
        warnings.simplefilter("ignore")  # a net: what warns is mended where it arises, and is an error in tests
    code = 0
    if not at_once.answered(sys.argv[1:]):
        from heuncli.app.cli.entry import enter  # after the environment is set

        code = enter(sys.argv[1:])
    signals.deafen()
    gc.freeze()  # all memory goes with the process: the search at its end would take 30 ms
    sys.exit(code)


def command() -> None:
    """Run the command line as all that this process is for."""
    try:
        main()
    except SystemExit as leave:
        signals.end(int(leave.code or 0))
        raise


def fill_gaps() -> None:
    """Stand in for standard streams that are closed: else the next file opened is taken for one of them.

    What reads from the one or writes to the others is refused, as before.
    """
    for number, mode in enumerate((os.O_WRONLY, os.O_RDONLY, os.O_RDONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)


if __name__ == "__main__":
    command()
