"""Entry point of the command `heun` and of `python -m heuncli`.

Impure: installs the signal handlers before anything else is imported, sets OPENBLAS_NUM_THREADS before NumPy is loaded
(more threads cost more to start than they save here), sets the threshold of the garbage collector, and hides Python's
own warnings.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]

if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
    _signal.signal(_signal.SIGINT, _signal.SIG_DFL)  # ends without a message until `listen` is set up

import gc
import os
import sys
import warnings

from heuncli.app.cli import terminal
from heuncli.base import signals

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
GC_THRESHOLD = 500_000  # objects between two garbage collections; the default of 700 costs 20 ms while modules load


def main() -> None:
    """Run the command line and exit with its code."""
    signals.install_handlers()
    gc.set_threshold(GC_THRESHOLD)
    fill_closed_streams()
    if not sys.warnoptions and os.environ.get("HEUN_DEBUG") != "1":
        warnings.simplefilter("ignore")  # only a safety net: in tests every warning is an error
    code = 0
    if not terminal.try_answer(sys.argv[1:]):
        from heuncli.app.cli.entry import enter  # after the environment is set

        code = enter(sys.argv[1:])
    signals.ignore_signals()
    gc.freeze()  # all memory goes with the process: the search at its end would take 30 ms
    sys.exit(code)


def command() -> None:
    """Run the command line as the only task of this process, and end the process by the signal that it received, if
    any.
    """
    try:
        main()
    except SystemExit as leave:
        signals.exit_quickly(int(leave.code or 0))
        raise


def fill_closed_streams() -> None:
    """Open the null device for each standard stream that is closed, so that no file opened later takes its descriptor.

    Reading from the replaced input or writing to the replaced outputs still fails, as it does on a closed stream.
    """
    for number, mode in enumerate((os.O_WRONLY, os.O_RDONLY, os.O_RDONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)


if __name__ == "__main__":
    command()
