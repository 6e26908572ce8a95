"""The kernel's own equations on dual numbers: no second representation, but its plain files run once more.

Their mathematical functions are those of duals.py.
"""

from __future__ import annotations

from heuncli.kernel.form import PACKAGE
from tests.shared import duals
from tests.shared.plain_kernel import PlainModules

dual_module = PlainModules({"math": duals, f"{PACKAGE}.libm": duals})
