"""The one door to the kernel from outside: its modules, in the form chosen for this process (form.py).

Import them from here (`from heuncli.kernel.choose import steps`), never directly: the choice has to stand before the
first of them is loaded.
"""

from __future__ import annotations

from heuncli.kernel.form import KERNEL  # isort: split

from heuncli.kernel import enclosure, expressions, integration, jets, scene, steps, structs, workspace

__all__ = ["KERNEL", "enclosure", "expressions", "integration", "jets", "scene", "steps", "structs", "workspace"]
