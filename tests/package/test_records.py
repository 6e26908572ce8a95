"""Records: fields by place or name, nothing missing, unknown or twice, nothing set afterwards."""

from __future__ import annotations

from functools import cached_property

import pytest

from heuncli.records import fields, record, replace


@record
class Cut:
    """Two fields, the second with a default."""

    body: str
    count: int = 1

    @cached_property
    def made(self) -> list[int]:
        return [self.count]


def test_fields_by_place_and_by_name() -> None:
    assert fields(Cut("b")) == fields(Cut(body="b")) == {"body": "b", "count": 1}
    assert repr(Cut("b", 3)) == "Cut(body='b', count=3)"


@pytest.mark.parametrize(
    ("values", "named", "wrong"),
    [((), {}, "body"), ((), {"count": 2}, "body"), (("b",), {"size": 2}, "size"), (("b",), {"body": "c"}, "body"),
     (("b", 1, 2), {}, "Cut")],
)  # fmt: skip
def test_what_does_not_fit_is_refused(values: tuple[object, ...], named: dict[str, object], wrong: str) -> None:
    with pytest.raises(TypeError, match=wrong):
        Cut(*values, **named)


def test_nothing_is_set_afterwards() -> None:
    cut = Cut("b")
    with pytest.raises(AttributeError, match="frozen"):
        cut.count = 2
    with pytest.raises(AttributeError, match="frozen"):
        del cut.body


def test_a_changed_copy_makes_anew_what_follows_from_its_fields() -> None:
    first = Cut("b", 2)
    assert first.made is first.made
    second = replace(first, count=3)
    assert (second.body, second.made, first.made) == ("b", [3], [2])
    with pytest.raises(TypeError, match="size"):
        replace(first, size=3)


def test_a_record_equals_itself_alone() -> None:
    one, other = Cut("b"), Cut("b")
    assert one == one and one != other and len({one, other}) == 2
