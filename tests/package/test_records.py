"""Records: fields by place or name, none missing, unknown or twice, none set afterwards. Named tuples as Python's."""

from __future__ import annotations

import copy
import pickle
import re
from functools import cached_property
from pathlib import Path
from typing import Any
from typing import NamedTuple as NamedTupleOfPython

import pytest

import heuncli
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import fields, record, replace


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


@record
class PlacedCut(Cut):
    """A record that extends another one."""

    place: float = 0.5


def test_a_record_has_the_fields_of_the_one_that_it_extends() -> None:
    assert fields(PlacedCut("b", 2)) == {"body": "b", "count": 2, "place": 0.5}
    assert fields(replace(PlacedCut("b", place=0.1), count=3)) == {"body": "b", "count": 3, "place": 0.1}
    with pytest.raises(TypeError, match="body"):
        PlacedCut(place=0.1)  # type: ignore[call-arg]


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


class Bolt(NamedTuple):
    """As told by heun: two fields, the second with a default."""

    size: float
    name: str = "M8"

    @property
    def twice(self) -> float:
        return 2.0 * self.size


class BoltOfPython(NamedTupleOfPython):
    """As told by Python."""

    size: float
    name: str = "M8"


class Nothing(NamedTuple):
    """No field at all."""


CALLS: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
    ((), {}), ((1.0,), {}), ((1.0, "M6"), {}), ((1.0, "M6", 3), {}), ((), {"name": "M6", "size": 2.0}),
    ((1.0,), {"size": 2.0}), ((1.0,), {"length": 2.0}), ((), {"name": "M6"}),
]  # fmt: skip


@pytest.mark.parametrize(("values", "named"), CALLS)
def test_named_tuples_are_made_as_those_of_python(values: tuple[Any, ...], named: dict[str, Any]) -> None:
    def made(cls: Any) -> tuple[str, ...] | str:
        try:
            return cls(*values, **named), repr(cls(*values, **named)).replace("OfPython", "")
        except TypeError as error:
            return str(error).replace("OfPython", "")

    assert made(Bolt) == made(BoltOfPython)


def test_named_tuples_know_of_themselves_what_those_of_python_do() -> None:
    bolt, other = Bolt(2.0), BoltOfPython(2.0)
    assert (bolt.size, bolt.name, bolt.twice) == (2.0, "M8", 4.0)
    assert bolt == (2.0, "M8") and hash(bolt) == hash(other) and isinstance(bolt, tuple)
    for word in ("_fields", "_field_defaults", "__match_args__", "__slots__"):
        assert getattr(Bolt, word, None) == getattr(BoltOfPython, word, None), word
    assert bolt._asdict() == other._asdict() and bolt._replace(name="M6") == other._replace(name="M6")
    assert copy.deepcopy(bolt) == pickle.loads(pickle.dumps(bolt)) == Bolt._make([2.0, "M8"]) == bolt
    assert type(copy.copy(bolt)) is Bolt and Nothing() == ()
    with pytest.raises(AttributeError):
        bolt.size = 3.0  # type: ignore[misc]
    with pytest.raises(TypeError, match="Expected 2"):
        Bolt._make([1.0])
    with pytest.raises(ValueError, match="length"):
        bolt._replace(length=1.0)  # type: ignore[call-arg]


def test_a_default_goes_to_the_field_that_has_it() -> None:
    with pytest.raises(TypeError, match="default"):
        type("Wrong", (NamedTuple,), {"__annotations__": {"a": int, "b": int}, "a": 1})


def test_the_package_has_no_others() -> None:
    """Python's take a tenth of a millisecond each when they are imported."""
    files = {str(path): path.read_text("utf-8") for path in Path(heuncli.__file__).parent.rglob("*.py")}
    told = {name for name, text in files.items() if re.search(r"from typing import .*NamedTuple|namedtuple\(", text)}
    assert {Path(name).name for name in told} == {"named_tuples.py"}
