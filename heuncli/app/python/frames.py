"""Export signals to a pandas.DataFrame; pandas is an optional extra (heuncli[pandas])."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from typing import TYPE_CHECKING

from heuncli.base.errors import Problem, UsageError
from heuncli.output.documents.document import format_head

if TYPE_CHECKING:
    import pandas as pd

    from heuncli.app.python.locked_run import LockedRun
    from heuncli.app.python.signals import Signal

INSTALL = 'pip install "heuncli[pandas]"; study[PATH].values needs only NumPy'


def make_frame(run: LockedRun, signals: Sequence[Signal], units: bool, *, is_explicit: bool) -> pd.DataFrame:
    """Make a frame with one column per number and one row per instant. Raises UsageError [missing-extra], [bad-option].

    is_explicit: whether the caller named the signals; then one without instants is an error, else it is left out
    """
    if importlib.util.find_spec("pandas") is None:
        message = "frame: requires pandas, which is not installed"
        raise UsageError(Problem("missing-extra", message, hint=INSTALL))
    timeless = next((signal for signal in signals if signal.times is None), None)
    if is_explicit and timeless is not None:
        hint = f'use study["{timeless.path}"].values'
        raise UsageError(Problem("bad-option", f"frame: {timeless.path} does not depend on time", hint=hint))
    import pandas as pd

    columns, unit_names, errors = {}, {}, {}
    times = run.results.time.copy()  # the index may keep a reference
    for signal in signals:
        if signal.times is None or signal.path == "time":
            continue
        flat = signal.values.reshape(len(times), -1)
        for component, column in zip(signal.components, flat.T, strict=True):
            path = f"{signal.path}.{component}" if component else signal.path
            name = format_head(path, signal.unit) if units else path
            columns[name], unit_names[name], errors[name] = column.copy(), signal.unit, signal.error
    frame = pd.DataFrame(columns, index=pd.Index(times, name="time [s]" if units else "time"))
    frame.attrs = {"units": unit_names, "errors": errors, "title": run.results.title}
    return frame
