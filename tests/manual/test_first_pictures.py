"""The pictures at the top of the README: each is what a command written below them draws."""

from __future__ import annotations

import re
import shlex
from itertools import pairwise
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.folders import ROOT
from tests.shared.manual import FOLDER, README, TEXTS, blocks

PICTURES = re.findall(r"!\[[^]]+\]\((heuncli/manual/pictures/[\w-]+\.svg)\)", TEXTS[README])
COMMANDS = [line for block in blocks(README, "sh") for line in block.splitlines() if line.startswith("heun plot ")]
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
TAG_OR_TEXT = re.compile(r"<[^>]*>|[^<]+")
PIXEL_STEP = 0.01  # coordinates have two decimals


def find_command(picture: str) -> list[str]:
    """Find the words of the one command of the README that draws a picture."""
    lines = [shlex.split(command, comments=True)[1:] for command in COMMANDS]
    (words,) = [words for words in lines if ("-o", Path(picture).name) in pairwise(words)]
    return words


def compute_last_digit(number: str) -> float:
    """Compute the step of a number's last printed digit."""
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def list_differences(drawn: str, kept: str) -> list[str]:
    """List what two pictures show differently by more than the last printed digit of a number, or a step of a pixel."""
    if NUMBER.sub("0", drawn) != NUMBER.sub("0", kept):
        return ["words or elements"]
    differences = []
    for ours, theirs in zip(TAG_OR_TEXT.findall(drawn), TAG_OR_TEXT.findall(kept), strict=True):
        for one, other in zip(NUMBER.findall(ours), NUMBER.findall(theirs), strict=True):
            step = PIXEL_STEP if ours.startswith("<") else max(compute_last_digit(one), compute_last_digit(other))
            if abs(float(one) - float(other)) > 1.001 * step:
                differences.append(f"{one} for {other}")
    return differences


def test_the_readme_shows_every_picture_of_the_package() -> None:
    assert len(PICTURES) == 2
    assert {ROOT / picture for picture in PICTURES} == {*(FOLDER / "pictures").iterdir()}


@pytest.mark.heavy
@pytest.mark.parametrize("picture", PICTURES)
def test_a_picture_is_what_its_command_draws(picture: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "specs").symlink_to(ROOT / "specs")
    monkeypatch.chdir(tmp_path)
    assert enter(find_command(picture)) == 0
    drawn = (tmp_path / Path(picture).name).read_text(encoding="utf-8")
    assert list_differences(drawn, (ROOT / picture).read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" 113.5 kN<", " 113.7 kN<"),
        ('x="102.31"', 'x="102.41"'),
        (">elbow ", ">knee "),
        ("</svg>", '<line x1="0"/></svg>'),
    ],
)
def test_a_difference_is_seen(old: str, new: str) -> None:
    kept = (FOLDER / "pictures" / "excavator.svg").read_text(encoding="utf-8")
    assert old in kept and list_differences(kept.replace(old, new), kept)
    assert list_differences(kept, kept) == []
