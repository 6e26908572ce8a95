"""The kernel's plain files run once more, beside the kernel that computes, compiled or not.

The code objects of heuncli/kernel/*.py are run as modules of their own, whose imports of one another give these
modules. Impure: a set of them keeps what it has loaded; none of them stands in sys.modules.
"""

from __future__ import annotations

import builtins
from importlib.machinery import SourceFileLoader
from types import ModuleType
from typing import Any

from heuncli.kernel.form import PACKAGE
from tests.shared.folders import KERNEL as FOLDER

AS_THEY_ARE = frozenset({"modules", "shadow"})  # nothing is computed there


class PlainModules:
    """One set of the kernel's plain modules; in_stead: modules that their imports give for others, by full name."""

    def __init__(self, in_stead: dict[str, ModuleType] | None = None) -> None:
        self.loaded = dict(in_stead or {})

    def __call__(self, name: str) -> Any:
        """A module of the kernel, by its short name."""
        full = f"{PACKAGE}.{name}"
        if full not in self.loaded:
            path = str(FOLDER / f"{name}.py")
            code = SourceFileLoader(full, path).get_code(full)
            assert code is not None
            module = ModuleType(full)
            module.__dict__.update(__file__=path, __package__=PACKAGE)
            module.__dict__["__builtins__"] = vars(builtins) | {"__import__": self._import}
            self.loaded[full] = module
            exec(code, module.__dict__)
        return self.loaded[full]

    def _import(self, name: str, *rest: Any) -> Any:
        """What `import` gives to one of them."""
        short = name.removeprefix(f"{PACKAGE}.")
        if name in self.loaded:
            return self.loaded[name]
        if short != name and short not in AS_THEY_ARE:
            return self(short)
        return builtins.__import__(name, *rest)


plain_module = PlainModules()
