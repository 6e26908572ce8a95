"""The tables of the manual that follow from rows of the code: what they should be, and a command that writes them.

    python -m tests.manual.tables        # renews them all in the pages, after a row has changed, and the help

A table is known by its page, its heading and its first line; what stands around it is written by hand.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from heuncli.app.cli.options import list_fields
from heuncli.app.cli.registry import COMMANDS, Command
from heuncli.app.commands.explain.pages import PAGES, read_summary
from heuncli.base import units as u
from heuncli.base.joint_kinds import SYNONYMS, TYPES, JointKind
from heuncli.base.load_kinds import LOAD_KINDS, LOAD_SYNONYMS
from heuncli.base.method_rows import METHODS
from heuncli.results.results_schema import NOT_YET, ROWS, SPACE, Quantity, is_share
from heuncli.scene.expressions.scope import ARITY, CONSTANTS
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.foreign_words import SHAPE_WORDS, list_aliases
from tests.manual import codes
from tests.manual.keys import PLACES
from tests.shared.help_text import HELP, help_of_typer
from tests.shared.manual import README, anchor, below, file_of, tables_below

(RUN,) = (command for command in COMMANDS if command.name == "run")
OF_RUN = {(field.option.words, field.option.help) for field in list_fields(RUN.request)}
ALIKE = ("`--case NAME`", "`--units UNIT,...`")  # mean what they mean in `heun run`, in other words
SOLVED = [row for row in ROWS if row.meaning != NOT_YET]


class Table(NamedTuple):
    """A table of a page: below which heading, its head, and its rows."""

    page: str
    heading: str
    head: tuple[str, ...]
    rows: Sequence[Sequence[str]]

    @property
    def first_line(self) -> str:
        """The line by which it is known."""
        return line_of(self.head)

    @property
    def text(self) -> str:
        """The table as it should stand in the page."""
        return "\n".join([self.first_line, "|" + "---|" * len(self.head), *map(line_of, self.rows)]) + "\n"


def line_of(cells: Sequence[str]) -> str:
    """A row of a table in markdown."""
    return "|" + "|".join(f" {cell} " if cell else " " for cell in cells) + "|"


def quoted(words: Sequence[str]) -> str:
    """Words of the format, side by side."""
    return ", ".join(f"`{word}`" for word in words)


def grouped(chosen: Sequence[Quantity]) -> Iterator[tuple[str, list[Quantity], str]]:
    """The rows that stand in one place and have one meaning: their paths, themselves, the meaning."""
    for (place, meaning), group in groupby(chosen, lambda row: (row.path.rpartition(".")[0], row.meaning)):
        members = list(group)
        first, *others = [row.path.rpartition(".")[2] for row in members]
        names = [f"`{place}.{first}`" if place else f"`{first}`", *(f"`{name}`" for name in others)]
        yield ", ".join(names), members, meaning


def results() -> Iterator[tuple[str, str, str]]:
    """The numbers of the results with their units; those of shares stand above the table."""
    for names, members, meaning in grouped([row for row in SOLVED if row.units and not is_share(row)]):
        each = [unit_of(row) for row in members]
        yield names, ", ".join(each[:1] if len(set(each)) == 1 else each), meaning


def no_numbers() -> Iterator[tuple[str, str]]:
    """What else stands in the JSON."""
    for names, _, meaning in grouped([row for row in SOLVED if not row.units]):
        yield names, meaning


def unit_of(row: Quantity) -> str:
    """The unit; *m* of a vector, **1** of a matrix."""
    stars = "*" * row.shape.count(SPACE)
    return f"{stars}{' or '.join(row.units)}{stars}"


SAID_OF = {u.NUMBER: "an angle", u.MOMENT: "a moment, an energy"}


def units() -> Iterator[tuple[str, str]]:
    """The units of each dimension that has any of its own."""
    dimensions = dict.fromkeys(dimension for _, dimension in u.UNITS.values())
    for dimension in dimensions:
        yield (
            SAID_OF.get(dimension, u.describe(dimension)),
            quoted([unit for unit, (_, of) in u.UNITS.items() if of == dimension]),
        )


def words() -> Iterator[tuple[str, str]]:
    """What expressions are made of."""
    yield "operators", "`+ - * / **`, parentheses, `< <= > >= == !=`, `and or not`, `a if c else b`"
    yield "functions", f"`{' '.join(name for name in ARITY if name != 'table')}`"
    yield "constants", f"{quoted(list(CONSTANTS))}, as in `1500*rpm*t`"


def joints() -> Iterator[tuple[str, ...]]:
    """What each kind of joint is called, holds and takes."""
    for kind in TYPES.values():
        accepted = list_aliases("joints", kind.name)
        yield (
            f"`{kind.name}`",
            quoted(accepted),
            str(kind.row_count),
            quoted(driven(kind)),
            quoted(kind.loads),
        )


def driven(kind: JointKind) -> list[str]:
    """The keys by which a kind of joint may be driven."""
    rates = {"angle": "rate", "travel": "speed", "length": "speed"}
    return [key for quantity in kind.drives for key in (quantity, rates[quantity])]


def methods() -> Iterator[tuple[str, ...]]:
    """The list of `heun methods`."""
    for row in METHODS:
        yield f"`{row.name}`", str(row.order), row.kind, row.steps, row.attitude, row.purpose


def options(command: Command) -> Iterator[tuple[str, str]]:
    """The arguments and options of a command; those that mean the same as in `heun run` stand in the last row."""
    shared: list[str] = []
    for option in (field.option for field in list_fields(command.request)):
        value = (option.metavar or "").replace("|", "\\|")
        cell = f"`{' '.join([', '.join(option.words), value]).strip()}`"
        if command.name != "run" and (cell in ALIKE or (option.words, option.help) in OF_RUN):
            shared.append(cell if "--format" in option.words else quoted(option.words) or cell)
        else:
            yield cell, option.help.replace("|", "\\|")
    if shared:
        yield ", ".join(shared), "as in [heun run](#heun-run)"


def keys() -> Iterator[tuple[str, str]]:
    """The keys of the format with the chapters of the page on them; those of the same chapters together."""
    places: dict[str, dict[str, list[str]]] = {}
    for place in PLACES:
        places.setdefault(place.key, {}).setdefault(place.heading, []).extend(place.types)
    alike: dict[str, list[str]] = {}
    for key in sorted(places, key=str.lower):
        links = []
        for heading, types in places[key].items():
            of = f" of {quoted(sorted(set(types)))}" if types else ""
            links.append(f"[{heading}](format.md#{anchor(heading)}){of}")
        alike.setdefault("; ".join(links), []).append(key)
    return ((quoted(names), links) for links, names in alike.items())


def types() -> Iterator[tuple[str, str]]:
    """What `type` may be, with the words of others for it, and where each is described."""
    blocks = (
        ("a joint", "joints", fj.JOINTS, SYNONYMS, "Joints"),
        ("a load", "forces", fl.LOADS, LOAD_SYNONYMS, None),
        ("a shape", "shapes", fs.SHAPES, SHAPE_WORDS, "Shapes"),
    )
    for what, block, models, meant, heading in blocks:
        for name in models:
            accepted = list_aliases(block, name)
            refused = [word for word, kind in meant.items() if kind == name and word not in accepted]
            others = [*(f"`{word}`" for word in accepted), *refused]
            link = f"[{heading or name}](format.md#{anchor(heading or name)})"
            yield ", ".join([f"`{name}`", *others]), f"{link}, {what}"


def words_of_expressions() -> Iterator[tuple[str, str]]:
    """What stands in numbers and expressions, and the methods of integration."""
    yield quoted(list(u.UNITS)), "[Units](format.md#units)"
    yield quoted([*ARITY, *CONSTANTS]), "[Expressions](format.md#expressions)"
    yield quoted([row.name for row in METHODS]), "[The list](methods.md#the-list)"


def pages() -> Iterator[tuple[str, str]]:
    """The pages of the manual."""
    for name in PAGES:
        yield f"[{name}](heuncli/manual/{name}.md)", read_summary(name)


def loads() -> Iterator[tuple[str, str]]:
    """The kinds of loads that users write."""
    return ((f"`{name}`", LOAD_KINDS[name].description) for name in fl.LOADS)


TABLES = (
    Table(README, "The manual", ("page", "about"), list(pages())),
    Table("results", "Paths", ("path", "SI unit", ""), list(results())),
    Table("results", "What is not a number", ("path", "meaning"), list(no_numbers())),
    Table("format", "Units", ("quantity", "units"), list(units())),
    Table("format", "Expressions", ("", ""), list(words())),
    Table("format", "Joints", ("type", "or", "conditions", "may be driven", "takes"), list(joints())),
    Table("format", "Forces", ("type", "what it is"), list(loads())),
    Table("methods", "The list", ("name", "order", "kind", "steps", "orientation", "purpose"), list(methods())),
    *(Table("commands", f"heun {each.name}", ("option", "meaning"), list(options(each))) for each in COMMANDS),
    Table("index", "Keys of a spec", ("key", "see"), list(keys())),
    Table("index", "Types", ("type", "see"), list(types())),
    Table("index", "Units, functions, methods", ("words", "see"), list(words_of_expressions())),
)


def renew(table: Table) -> None:
    """Write a table into its page, in the place of the one that begins alike."""
    path = file_of(table.page)
    text = path.read_text(encoding="utf-8")
    (old,) = [found for found in tables_below(text, table.heading) if found.startswith(table.first_line + "\n")]
    start, _ = below(text, table.heading)
    path.write_text(text[:start] + text[start:].replace(old, table.text, 1), encoding="utf-8")


if __name__ == "__main__":
    argparse.ArgumentParser(prog="python -m tests.manual.tables", description=__doc__.partition("\n")[0]).parse_args()
    from tests.manual import proof

    for each in (*TABLES, *proof.tables()):
        renew(each)
    codes.PAGE.write_text(codes.written(), encoding="utf-8")
    HELP.write_text(help_of_typer(), encoding="utf-8")
