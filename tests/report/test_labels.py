"""Units and notes that the kinds of joints and forces decide."""

from __future__ import annotations

import pytest

from heuncli.results.path_words import find_quantity
from heuncli.scene.file_format.models import End, Section
from heuncli.study.quantities.labels import ForceInfo, JointInfo, Labels, _make_section_info

KINDS = ("ball", "pin", "slide", "cylinder", "universal", "weld", "line", "plane", "rod")
LABELS = Labels(
    {kind: JointInfo(kind, "ground.O", "b.p") for kind in KINDS},
    {
        "couple": ForceInfo("couple"),
        "spring": ForceInfo("spring"),
        "motor": ForceInfo("torque", "pin"),
        "thrust": ForceInfo("torque", "slide"),
        "grease": ForceInfo("damper", "ball"),
        "rail": ForceInfo("damper", "plane"),
        "brake": ForceInfo("friction", "cylinder", turning=False),
    },
)


@pytest.mark.parametrize(
    ("kind", "name", "key", "unit"),
    [
        ("coordinates", "pin", "acceleration", "rad/s²"),
        ("coordinates", "slide", "acceleration", "m/s²"),
        ("coordinates", "cylinder", "acceleration", "m/s²"),
        ("coordinates", "pin", "angle", "rad"),
        ("joints", "pin", "drive", "N·m"),
        ("joints", "slide", "drive", "N"),
        ("joints", "cylinder", "drive", "N"),
        ("joints", "rod", "drive", "N"),
        ("joints", "pin", "force", "N"),
        ("forces", "couple", "value", "N·m"),
        ("forces", "spring", "value", "N"),
        ("forces", "spring", "rate", "m/s"),
        ("forces", "motor", "value", "N·m"),
        ("forces", "motor", "rate", "rad/s"),
        ("forces", "thrust", "value", "N"),
        ("forces", "grease", "value", "N·m"),
        ("forces", "rail", "rate", "m/s"),
        ("forces", "brake", "value", "N"),
        ("forces", "motor", "power", "W"),
    ],
)
def test_units(kind: str, name: str, key: str, unit: str) -> None:
    row = find_quantity((kind, name, key))
    assert row is not None
    assert row.select_unit(len(row.units) > 1 and LABELS.is_rotational(kind, name)) == unit


@pytest.mark.parametrize(
    ("normal", "first_axis", "words"),
    [
        ((0.0, 0.0, -1.0), None, "body x"),
        ((1.0, 0.0, 0.0), None, "body y"),
        ((1.0, 1.0, 0.0), None, "body y, made perpendicular to n (n is closest to body x)"),
        ((1.0, 1e-12, 2e-12), None, "body y"),
        ((0.0, 0.0, 3.0), (0.0, 1.0, 0.5), "body (0, 1, 0.5)"),
    ],
)
def test_the_first_axis_in_words(
    normal: tuple[float, float, float], first_axis: tuple[float, float, float] | None, words: str
) -> None:
    assert _make_section_info(Section("b", normal, first_axis=first_axis)).first_axis == words


def test_the_point_of_the_moments_in_words() -> None:
    normal = (1.0, 0.0, 0.0)
    assert _make_section_info(Section("b", normal)).moment_point == "the cut's point"
    assert _make_section_info(Section("b", normal, reduce_to="centroid")).moment_point == "the cut's centroid"
    assert (
        _make_section_info(Section("b", normal, reduce_to=End("ground", (0.0, 0.0, 0.0), "O"))).moment_point
        == "ground.O"
    )
    assert (
        _make_section_info(Section("b", normal, reduce_to=End("a", (1.0, 0.0, 0.0)))).moment_point == "a at (1, 0, 0)"
    )
