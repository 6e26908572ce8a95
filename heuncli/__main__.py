"""The command `heun`, and `python -m heuncli`.

Impure: sets OPENBLAS_NUM_THREADS before NumPy can be imported (threads cost more to start than they save here), and
how often Python looks for cycles of dead objects, and whether Python's own warnings are shown.
"""

from __future__ import annotations

import gc
import os
import sys
import warnings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
MANY = 500_000  # objects made between two searches for dead cycles; 700 by default: 20 ms while modules are loaded


def main() -> None:
    """Run the command line and leave with its exit code."""
    gc.set_threshold(MANY)
    if not sys.warnoptions and os.environ.get("HEUN_DEBUG") != "1":
        warnings.simplefilter("ignore")  # a net: what warns is mended where it arises, and is an error in tests
    from heuncli.cli.entry import enter  # after the environment is set

    code = enter(sys.argv[1:])
    gc.freeze()  # all memory goes with the process: the search at its end would take 30 ms
    sys.exit(code)


if __name__ == "__main__":
    main()
