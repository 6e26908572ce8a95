"""The kernel's own equations on dual numbers: its plain files run once more, beside those that compute.

No second representation: the code objects of heuncli/kernel/*.py are run as modules of their own, whose imports of one
another give these modules, and whose mathematical functions are those of duals.py. Impure: keeps the modules loaded;
none of them stands in sys.modules.
"""

from __future__ import annotations

import builtins
from importlib.machinery import SourceFileLoader
from types import ModuleType
from typing import Any

from heuncli.kernel.form import FOLDER, PACKAGE
from tests.shared import duals

AS_THEY_ARE = frozenset({"modules", "shadow"})  # nothing is computed there
loaded: dict[str, ModuleType] = {"math": duals, f"{PACKAGE}.libm": duals}


def dual_module(name: str) -> Any:
    """A module of the kernel, by its short name, that computes with dual numbers."""
    full = f"{PACKAGE}.{name}"
    if full not in loaded:
        path = str(FOLDER / f"{name}.py")
        code = SourceFileLoader(full, path).get_code(full)
        assert code is not None
        module = ModuleType(full)
        module.__dict__.update(__file__=path, __package__=PACKAGE)
        module.__dict__["__builtins__"] = vars(builtins) | {"__import__": _import}
        loaded[full] = module
        exec(code, module.__dict__)
    return loaded[full]


def _import(name: str, *rest: Any) -> Any:
    """What `import` gives to a module of the dual kernel."""
    short = name.removeprefix(f"{PACKAGE}.")
    if name in loaded:
        return loaded[name]
    if short != name and short not in AS_THEY_ARE:
        return dual_module(short)
    return builtins.__import__(name, *rest)
