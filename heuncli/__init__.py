"""Kinetostatics of rigid bodies and linked chains: `import heuncli; study = heuncli.solve("scene.yaml")`.

The names below are the whole public interface; the manual page "python" describes them. Each is loaded on first use,
because the command line, which also imports this package, needs only a few of them.
"""

from __future__ import annotations

TYPE_CHECKING = False  # that of `typing` takes 2 ms
if TYPE_CHECKING:
    from heuncli.app.api import report as report
    from heuncli.app.api import solve as solve
    from heuncli.app.api import solve_cases as solve_cases
    from heuncli.app.api import validate as validate
    from heuncli.app.python.locked_run import HeunWarning as HeunWarning
    from heuncli.app.python.locked_run import Number as Number
    from heuncli.app.python.locked_run import UnknownPath as UnknownPath
    from heuncli.app.python.result_export import Diagram as Diagram
    from heuncli.app.python.signals import Signal as Signal
    from heuncli.app.python.solved_scene import Solved as Solved
    from heuncli.base.errors import HeunError as HeunError
    from heuncli.base.errors import LimitError as LimitError
    from heuncli.base.errors import OutputError as OutputError
    from heuncli.base.errors import Problem as Problem
    from heuncli.base.errors import SolveError as SolveError
    from heuncli.base.errors import SourceLocation as SourceLocation
    from heuncli.base.errors import SpecError as SpecError
    from heuncli.base.errors import UsageError as UsageError
    from heuncli.version import VERSION as __version__

HOME = {  # each name, and the module that it is in
    "solve": "app.api", "solve_cases": "app.api", "validate": "app.api", "report": "app.api",
    "Solved": "app.python.solved_scene", "Signal": "app.python.signals", "Number": "app.python.locked_run",
    "Diagram": "app.python.result_export",
    "HeunError": "base.errors", "SpecError": "base.errors", "SolveError": "base.errors", "LimitError": "base.errors",
    "OutputError": "base.errors", "UsageError": "base.errors", "UnknownPath": "app.python.locked_run",
    "Problem": "base.errors", "SourceLocation": "base.errors", "HeunWarning": "app.python.locked_run",
}  # fmt: skip
__all__ = [*HOME, "__version__"]


def __getattr__(name: str) -> object:
    """A public name, loaded when it is first asked for."""
    home, own = ("version", "VERSION") if name == "__version__" else (HOME.get(name), name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    found = globals()[name] = getattr(import_module(f"{__name__}.{home}"), own)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
