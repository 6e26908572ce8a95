"""Kinetostatics of rigid bodies and linked chains: `import heuncli; study = heuncli.solve("scene.yaml")`.

What follows is all that users may rely on; the page "python" of the manual tells of it. Names are loaded when they are
asked for: the command line, which runs through here, does without most of them.
"""

from __future__ import annotations

TYPE_CHECKING = False  # that of `typing` takes 2 ms
if TYPE_CHECKING:
    from heuncli.door.asked_run import UnknownPath as UnknownPath
    from heuncli.door.diagrams import Diagram as Diagram
    from heuncli.door.measured import Number as Number
    from heuncli.door.signals import Signal as Signal
    from heuncli.door.solved import Solved as Solved
    from heuncli.door.solving import solve as solve
    from heuncli.door.solving import solve_cases as solve_cases
    from heuncli.door.solving import validate as validate
    from heuncli.door.warned import HeunWarning as HeunWarning
    from heuncli.errors import HeunError as HeunError
    from heuncli.errors import LimitError as LimitError
    from heuncli.errors import OutputError as OutputError
    from heuncli.errors import Problem as Problem
    from heuncli.errors import SolveError as SolveError
    from heuncli.errors import SourceLocation as SourceLocation
    from heuncli.errors import SpecError as SpecError
    from heuncli.errors import UsageError as UsageError
    from heuncli.version import VERSION as __version__

HOME = {  # each name, and the module that it is in
    "solve": "door.solving", "solve_cases": "door.solving", "validate": "door.solving",
    "Solved": "door.solved", "Signal": "door.signals", "Number": "door.measured", "Diagram": "door.diagrams",
    "HeunError": "errors", "SpecError": "errors", "SolveError": "errors", "LimitError": "errors",
    "OutputError": "errors", "UsageError": "errors", "UnknownPath": "door.asked_run",
    "Problem": "errors", "SourceLocation": "errors", "HeunWarning": "door.warned",
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
