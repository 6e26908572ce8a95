"""Two readers of the command line, one meaning; and no more imported than needed."""

from __future__ import annotations

import random
import subprocess
import sys

import pytest

from heuncli.app.cli import entry, typer_reader
from heuncli.app.cli.options import list_fields
from heuncli.app.cli.registry import COMMANDS
from tests.shared.loaded_modules import loaded_by

WORDS = {
    str | None: ["x", "0.5,1", "-1", "a b", "k=v=w", ""],
    float | None: ["1e-9", "3", "0.5"],
    int | None: ["1", "12"],
    tuple[str, ...]: ["L=1", "a.b=2 mm"],
}


def random_line(seed: int) -> list[str]:
    draw = random.Random(seed)
    command = draw.choice(COMMANDS)
    line = []
    for row in list_fields(command.request):
        if not row.option.words:
            many = row.type == tuple[str, ...]
            line += [[draw.choice(["a.yaml", "-", "dir/b.yaml"])] for _ in range(draw.randint(1, 3) if many else 1)]
        elif draw.random() < 0.4:
            word = draw.choice(row.option.words)
            if row.type is bool:
                line.append([word])
            else:
                value = draw.choice(WORDS[row.type])
                line.append([f"{word}={value}"] if word.startswith("--") and draw.random() < 0.5 else [word, value])
    draw.shuffle(line)
    return [command.name, *(word for part in line for word in part)]


@pytest.mark.parametrize("seed", range(60))
def test_both_readers_understand_a_plain_line_alike(seed: int) -> None:
    line = random_line(seed)
    request = entry.read_plain(line)
    assert request is not None
    assert typer_reader.read(line) == request


@pytest.mark.parametrize(
    "line",
    [
        [],
        ["--help"],
        ["run"],
        ["run", "a.yaml", "b.yaml"],
        ["run", "a.yaml", "--nonsense"],
        ["run", "a.yaml", "--tolerance", "small"],
        ["run", "a.yaml", "--tolerance"],
        ["run", "a.yaml", "--all=yes"],
        ["run", "--help"],
        ["nonsense"],
    ],
)
def test_what_is_not_plain_is_left_to_typer_which_answers_with_2_or_help(
    line: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert entry.read_plain(line) is None
    code = typer_reader.read(line)
    assert code == (0 if "--help" in line else 2)
    answer = capsys.readouterr()
    assert (
        ("Usage: heun" in answer.out)
        if code == 0
        else ("Error: " in answer.err or "Usage: heun" in answer.err + answer.out)
    )


def imported(code: str) -> set[str]:
    shown = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.argv[:] = ['heun', *{code.split()!r}]\n" + IMPORTS],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(shown.stdout.splitlines()[-1].split())


IMPORTS = """
from heuncli.__main__ import main
try:
    main()
except SystemExit:
    pass
print(' '.join(sys.modules))
"""


@pytest.mark.heavy
def test_help_imports_no_numpy() -> None:
    for line in ("--help", "run --help", "nonsense", "schema x"):
        assert not {"numpy", "yaml", "rich", "scipy"} & (imported(line) - loaded_by("typer")), line


def test_the_version_imports_nothing_heavy() -> None:
    assert not {"numpy", "yaml", "typer", "pydantic"} & imported("--version")


@pytest.mark.parametrize(
    ("line", "hints"),
    [
        ("run specs/double.yaml --json", ["hint: write --format json for --json"]),
        (
            "run specs/double.yaml --dt=0.1 --out x",
            ["hint: write --step SECONDS for --dt", "hint: write --output FILE for --out"],
        ),
        ("check specs/double.yaml --dt 0.1", []),  # it has no --step
        ("methods --full", []),
    ],
)
def test_options_of_other_programs_have_a_hint_where_the_command_has_such_an_option(
    line: str, hints: list[str]
) -> None:
    assert entry.find_option_hints(line.split()) == hints


def test_hints_name_options_that_some_command_has() -> None:
    words = {word for command in COMMANDS for field in list_fields(command.request) for word in field.option.words}
    assert {known.split()[0] for known in entry.FOREIGN_OPTIONS.values()} <= words
    assert not entry.FOREIGN_OPTIONS.keys() & {"--format", "--output"}
