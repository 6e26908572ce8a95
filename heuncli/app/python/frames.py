"""Numbers over the instants as a pandas.DataFrame; pandas is an extra of its own (heuncli[pandas])."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from typing import TYPE_CHECKING

from heuncli.base.errors import Problem, UsageError

if TYPE_CHECKING:
    import pandas as pd

    from heuncli.app.python.asked_run import AskedRun
    from heuncli.app.python.signals import Signal

INSTALL = 'pip install "heuncli[pandas]"; study[PATH].values needs NumPy alone'


def frame_of(run: AskedRun, signals: Sequence[Signal], units: bool, *, named: bool) -> pd.DataFrame:
    """A column a number, an instant a row; named: whether each signal was asked for. Raises UsageError."""
    if importlib.util.find_spec("pandas") is None:
        message = "frame: pandas makes frames, and is not installed"
        raise UsageError(Problem("missing-extra", message, hint=INSTALL))
    still = next((signal for signal in signals if signal.times is None), None)
    if named and still is not None:
        hint = f'its numbers are study["{still.path}"].values'
        raise UsageError(Problem("bad-option", f"frame: {still.path} has no instants", hint=hint))
    import pandas as pd

    columns, of_units, errors = {}, {}, {}
    times = run.results.time.copy()  # an index may keep it
    for signal in signals:
        if signal.times is None or signal.path == "time":
            continue
        flat = signal.values.reshape(len(times), -1)
        for component, column in zip(signal.components, flat.T, strict=True):
            path = f"{signal.path}.{component}" if component else signal.path
            name = f"{path} [{signal.unit}]" if units and signal.unit not in ("", "1") else path
            columns[name], of_units[name], errors[name] = column.copy(), signal.unit, signal.error
    frame = pd.DataFrame(columns, index=pd.Index(times, name="time [s]" if units else "time"))
    frame.attrs = {"units": of_units, "errors": errors, "title": run.results.title}
    return frame
