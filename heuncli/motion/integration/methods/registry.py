"""Load methods by name; the coefficients of each are loaded on demand.

The rows are in heuncli/base/method_rows.py, where the spec reads them, too.
"""

from __future__ import annotations

from importlib import import_module

from heuncli.base.method_rows import AUTO, DEFAULT, find_method
from heuncli.motion.integration.methods.method import Method


def load_method_by_name(name: str) -> Method:
    """Return the method of that name, in either case; for `auto`, the default method. Raises KeyError for any other
    name.
    """
    row = find_method(DEFAULT if name.lower() == AUTO else name)
    if row is None:
        raise KeyError(name)
    module, _, attribute = row.coefficients.partition(".")
    method: Method = getattr(import_module(f"heuncli.motion.integration.methods.{module}"), attribute)
    return method
