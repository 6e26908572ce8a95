"""Tables of the published cases, as `heun check --references` tells them: how near heun comes, and of what source.

The cases are solved where the tables are asked for, not where this is imported.
"""

from __future__ import annotations

from heuncli.analyses.published.cases import list_names, read_case
from heuncli.app.commands.check.references_page import format_digits, format_largest_difference, list_kinds
from tests.manual.tables import Table
from tests.shared.published import compared_case


def row(name: str) -> tuple[str, ...]:
    """The line of a case."""
    case, tables = read_case(name), compared_case(name)
    numbers = [one for table in tables for one in table.numbers]
    told = (str(len(numbers)), list_kinds(case), format_digits(numbers), *format_largest_difference(tables))
    return f"`{name}`", case.description, *told


def tables() -> tuple[Table, Table]:
    """What stands below the heading On your machine."""
    head = ("case", "what", "numbers", "kind", "digits", "in last digits", "relative")
    sources = [(f"`{name}`", read_case(name).source) for name in list_names()]
    return (
        Table("references", "On your machine", head, [row(name) for name in list_names()]),
        Table("references", "On your machine", ("case", "source"), sources),
    )
