"""The methods by their names, each with its coefficients loaded where it is asked for.

The rows stand in heuncli/base/method_rows.py, where the spec reads them, too.
"""

from __future__ import annotations

from importlib import import_module

from heuncli.base.method_rows import AUTO, DEFAULT, row_of
from heuncli.motion.integration.methods.method import Method


def method_of(name: str) -> Method:
    """The method of that name, in whatever case; of `auto` the one that a scene takes unless something speaks against.

    Raises KeyError for any other name.
    """
    row = row_of(DEFAULT if name.lower() == AUTO else name)
    if row is None:
        raise KeyError(name)
    module, _, attribute = row.coefficients.partition(".")
    method: Method = getattr(import_module(f"heuncli.motion.integration.methods.{module}"), attribute)
    return method
