"""The checks of pictures find faults that are planted, and none in a picture that has none."""

from __future__ import annotations

import pytest

from heuncli.output.drawing.style import ENVELOPE_WIDTH
from tests.gallery.checks import (
    find_empty_thirds,
    find_in_svg,
    find_label_overlaps,
    find_long_numbers,
    find_other_numbers,
    find_small_text,
    find_struck_text,
    find_text_outside,
    find_unreadable_words,
    find_words_on_bands,
    text_width,
)

SOUND = (
    '<polyline points="20,20 200,150 380,280" fill="none" stroke="#0072b2" stroke-width="1.5"/>',
    '<polyline points="20,280 380,20" fill="none" stroke="#e6e6e6" stroke-width="0.8"/>',
    '<text x="200" y="40" font-size="14" text-anchor="middle">Main bearing, radial force</text>',
    '<text x="40" y="250" font-size="14" text-anchor="start">24.56 kN at 0.0415 s</text>',
)
STROKE = '<polyline points="0,246 400,246" fill="none" stroke="#444444" stroke-width="1"/>'
HALO = 'paint-order="stroke" stroke="#ffffff" stroke-width="3"'


def drawing(*more: str, sound: tuple[str, ...] = SOUND) -> str:
    """A picture of 400 by 300 pixels."""
    parts = "".join((*sound, *more))
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="400" height="300">{parts}</svg>'


def words(text: str, x: float = 250.0, y: float = 200.0, more: str = "") -> str:
    return f'<text x="{x}" y="{y}" font-size="14" text-anchor="start" {more}>{text}</text>'


def test_a_sound_picture_has_no_findings() -> None:
    assert find_in_svg(drawing()) == []


def test_words_over_words_are_found_at_their_place() -> None:
    (found,) = find_label_overlaps(drawing(words("pendant 140 kN", 60.0, 247.0)))
    assert found.kind == "overlap" and "24.56 kN at 0.0415 s" in found.what and found.x == 60.0
    assert find_label_overlaps(drawing(words("pendant 140 kN", 60.0, 265.0))) == []


def test_vertical_words_are_compared_where_they_stand() -> None:
    turned = 'transform="rotate(-90 60 252)"'
    assert find_label_overlaps(drawing(words("force", 60.0, 252.0, turned)))  # upwards, from the words below it
    assert not find_label_overlaps(drawing(words("force", 60.0, 232.0, 'transform="rotate(-90 60 232)"')))


def test_a_stroke_through_words_is_found_and_a_halo_before_it_helps() -> None:
    assert [f.what for f in find_struck_text(drawing(STROKE))] == ["24.56 kN at 0.0415 s"]
    haloed = words("5.23 kN", 250.0, 250.0, HALO)
    behind, before = drawing(STROKE, haloed, sound=()), drawing(haloed, STROKE, sound=())
    assert find_struck_text(behind) == [] and len(find_struck_text(before)) == 1


def test_a_sign_on_a_line_is_found_despite_its_halo() -> None:
    sign = words("−", 250.0, 250.0, HALO)
    assert [f.what for f in find_struck_text(drawing(STROKE, sign, sound=()))] == ["−"]


def test_words_on_the_line_of_a_band_are_found_despite_their_halo() -> None:
    line = STROKE.replace('width="1"', f'width="{ENVELOPE_WIDTH}"')
    on_line, above = words("-940 N", 250.0, 250.0, HALO), words("-940 N", 250.0, 238.0, HALO)
    assert [f.what for f in find_words_on_bands(drawing(line, on_line, sound=()))] == ["-940 N"]
    assert find_words_on_bands(drawing(line, above, sound=())) == []


def test_six_digits_before_the_point_and_low_letters_are_found() -> None:
    long = [words(text, 10.0) for text in ("254256 N·mm", "-865881 N·mm", "25774 N·mm", "254.3 N·m")]
    assert [f.what for f in find_long_numbers(drawing(*long, sound=()))] == ["254256 N·mm", "-865881 N·mm"]
    low = '<text x="9" y="9" font-size="13" text-anchor="start">2.1 mm</text>'
    assert [f.what for f in find_small_text(drawing(low))] == ["2.1 mm"]


def test_words_beyond_the_edge_are_found() -> None:
    (found,) = find_text_outside(drawing(words("mode 3: 1.14 Hz, damping 0; cd: rotation about y", 200.0)))
    assert found.what.startswith("mode 3")


def test_an_empty_third_is_found() -> None:
    narrow = '<polyline points="10,20 60,150 120,280" fill="none" stroke="#0072b2" stroke-width="1.5"/>'
    columns = [f.what[:11] for f in find_empty_thirds(drawing(narrow, sound=()))]
    assert columns == ["column 2 of", "column 3 of"]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("coordinates.main.angle [deg]", "path"), ("motion within 3e-15 of model size", "noise"),
        ("0.000219 kN", "noise"), ("-617.448 at s = 700 mm", "digits"),
        ("/home/me/specs/engine.yaml; DOP853", "folder"),
    ],
)  # fmt: skip
def test_words_that_no_client_reads_are_found(text: str, kind: str) -> None:
    assert [f.kind for f in find_unreadable_words(drawing(words(text, 10.0)))] == [kind]


def test_numbers_of_a_picture_are_compared_with_the_run() -> None:
    assert find_other_numbers(drawing(), [24558.1]) == []
    (found,) = find_other_numbers(drawing(), [24610.0, -3.0])
    assert found.kind == "number"


def test_widths_are_those_of_a_usual_face() -> None:
    assert text_width("Main bearing, radial force", 12.0) == pytest.approx(142.0, rel=0.1)  # of Liberation Sans
