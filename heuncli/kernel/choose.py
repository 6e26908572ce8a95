"""The only entrance to the kernel from outside: its modules in the form chosen for this process (form.py).

Import them from here (`from heuncli.kernel.choose import steps`), never directly: the form must be chosen before the
first of them is loaded. Compiled, they are one module under each of these names; modules that only declare are always
plain Python.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heuncli.kernel import scene, structs
from heuncli.kernel.form import KERNEL

if TYPE_CHECKING or KERNEL == "pure":
    from heuncli.kernel import components, enclosure, expressions, integration, jets, steps, workspace
else:
    from heuncli.kernel import compiled

    components = enclosure = expressions = integration = jets = steps = workspace = compiled

__all__ = [
    "KERNEL",
    "components",
    "enclosure",
    "expressions",
    "integration",
    "jets",
    "scene",
    "steps",
    "structs",
    "workspace",
]
