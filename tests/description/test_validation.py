"""YAML and typed files: every complaint is one line with place, key, value and what would be accepted."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np
import pytest
from pydantic import Field
from pydantic_core.core_schema import ErrorType

from space_robot_description.complaints import WORDS
from space_robot_description.spec import Actuators, Strict, expand
from space_robot_description.validation import nearest, parse_yaml, parse_yaml_text, validate
from space_robot_msgs_py.errors import InputFileError, NonFiniteError, SpecError


class Inner(Strict):
    """A section."""

    kind: Literal["inner"] = "inner"
    gain: float = Field(gt=0)


class Other(Strict):
    """Another section of the same union."""

    kind: Literal["other"] = "other"
    limit: float
    # A value that is also another member's tag must not confuse the two.
    like: Literal["inner", "other"] = "other"


class Outer(Strict):
    """A file."""

    mode: Literal["fast", "slow"] = "slow"
    part: Annotated[Inner | Other, Field(discriminator="kind")] | None = None
    parts: tuple[Inner, ...] = ()
    named: dict[str, Inner] = Field(default_factory=dict)
    value: float | tuple[float, ...] = 0.0


BAD_DATA = {
    "unknown key": ({"mod": "fast"}, "f.yaml mod: unknown key; accepted: did you mean mode, named? valid: mode, part"),
    "nothing near": ({"zzz": 1}, "f.yaml zzz: unknown key; accepted: mode, part, parts, named, value"),
    "in a union": (
        {"part": {"kind": "other", "limt": 1}},
        "f.yaml part.limt: unknown key (and 1 more); accepted: did you mean limit, like? valid: kind, limit, like",
    ),
    "in a list": (
        {"parts": [{"gain": 1}, {"gain": 1, "gian": 2}]},
        "f.yaml parts.1.gian: unknown key; accepted: did you",
    ),
    "in a mapping": ({"named": {"a": {"gain": 1, "gian": 2}}}, "f.yaml named.a.gian: unknown key"),
    "literal": ({"mode": "fats"}, "f.yaml mode: not accepted; got 'fats'; accepted: 'fast' or 'slow'"),
    "missing": ({"parts": [{}]}, "f.yaml parts.0.gain: is required and missing"),
    "bound": ({"parts": [{"gain": 0}]}, "f.yaml parts.0.gain: not accepted; got 0; accepted: a number greater than 0"),
    "tag": ({"part": {"kind": "inne"}}, "f.yaml part: not accepted"),
    "union": ({"value": "x"}, "f.yaml value: not accepted; got 'x'; accepted: a number, or a list"),
    "two": ({"mode": 1, "value": "x"}, "f.yaml mode: not accepted (and 1 more)"),
    "nan": ({"value": float("nan")}, "f.yaml value: not accepted"),
    "no mapping": ([1], "f.yaml: not accepted"),
}


@pytest.mark.parametrize("case", BAD_DATA)
def test_bad_data_is_one_line_with_the_dotted_key(case: str) -> None:
    """A file that does not fit its model names the key as the user wrote it, the value and what is accepted."""
    data, message = BAD_DATA[case]
    with pytest.raises(SpecError) as error:
        validate(Outer, data, "f.yaml")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_all_complaints_are_there() -> None:
    """The error says the first and how many more; its problems are all, each as if it were alone."""
    with pytest.raises(SpecError) as error:
        validate(Outer, {"mode": 1, "value": "x", "zzz": 2}, "f.yaml")
    assert [problem.key for problem in error.value.problems] == ["f.yaml zzz", "f.yaml mode", "f.yaml value"]
    assert all("more" not in str(problem) for problem in error.value.problems)
    with pytest.raises(SpecError) as one:
        validate(Outer, {"zzz": 2}, "f.yaml")
    assert one.value.problems == ()


KINDS = [
    ({"x": "1"}, "a number"),
    ({"n": 1.5}, "a whole number"),
    ({"yes": "maybe"}, "true or false"),
    ({"text": 1}, "text"),
    ({"three": [1, 2]}, "at least 3 values, not 2"),
    ({"three": [1, 2, 3, 4]}, "at most 3 values, not 4"),
    ({"three": 1}, "a list"),
    ({"section": 1}, "a section with keys"),
    ({"table": [1]}, "a section with keys"),
    ({"tagged": {}}, "a section with kind"),
    ({"tagged": {"kind": "third"}}, "kind: 'inner', 'other'"),
    ({"share": 1.5}, "a number less than or equal to 1"),
    ({"text": "x" * 30_000}, "text of at most 20000 characters"),
]


class Kinds(Strict):
    """A value of every kind."""

    x: float = 0.0
    n: int = 0
    yes: bool = False
    text: str = ""
    three: Annotated[tuple[float, ...], Field(min_length=3, max_length=3)] = (0.0, 0.0, 0.0)
    section: Inner | None = None
    table: dict[str, float] = Field(default_factory=dict)
    tagged: Annotated[Inner | Other, Field(discriminator="kind")] | None = None
    share: Annotated[float, Field(le=1.0)] = 0.0


@pytest.mark.parametrize(("data", "words"), KINDS)
def test_what_is_accepted_is_said_in_words_of_this_project(data: dict[str, object], words: str) -> None:
    """Whatever the value: the sentences of the library below are for programmers."""
    with pytest.raises(SpecError) as error:
        validate(Kinds, data, "f.yaml")
    assert words in error.value.accepted
    assert "nput" not in str(error.value)
    assert set(WORDS) <= set(get_args(ErrorType))


def test_missing_key_of_a_union_member_is_named() -> None:
    """A key missing inside a chosen union member is named without the member's tag."""
    with pytest.raises(SpecError, match=r"^f\.yaml part\.limit: is required and missing$"):
        validate(Outer, {"part": {"kind": "other"}}, "f.yaml")


def test_valid_keys_are_those_of_the_chosen_member() -> None:
    """Only the keys of the union member that the tag chose are offered."""
    with pytest.raises(
        SpecError, match=r"part\.gian: unknown key; accepted: did you mean gain, kind\? valid: kind, gain$"
    ):
        validate(Outer, {"part": {"kind": "inner", "gain": 1, "gian": 1}}, "f.yaml")


def test_long_values_do_not_bury_the_message() -> None:
    """A long offending value is cut."""
    with pytest.raises(SpecError) as error:
        validate(Outer, {"mode": "x" * 5000}, "f.yaml")
    assert len(str(error.value)) < 300


BAD_YAML = {
    "syntax": ("a: [1, 2\nb: 3\n", "not valid YAML at line 2, column 2"),
    "indent": ("a: 1\n  b: 2\n", "not valid YAML at line 2"),
    "twice": ("a: 1\na: 2\n", 'line 2, column 1: found duplicate key "a"'),
    "nan": ("a: {b: [1, .nan]}\n", "f.yaml a.b.1: not a finite number; got nan"),
    "infinity": ("a: -.inf\n", "f.yaml a: not a finite number; got -inf"),
    "list": ("- 1\n", "does not hold a mapping"),
    "empty": ("", "does not hold a mapping"),
    "python": ("a: !!python/object:os.system {}\n", "not valid YAML"),
}


@pytest.mark.parametrize("case", BAD_YAML)
def test_bad_yaml_is_one_line_with_its_place(case: str) -> None:
    """What is not YAML, ambiguous or not finite is one SpecError line with its place."""
    text, message = BAD_YAML[case]
    with pytest.raises(SpecError) as error:
        parse_yaml_text(text, "f.yaml")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_yaml_1_2_numbers_and_words() -> None:
    """YAML 1.2: `on` and `no` are words, 1e-3 is a number, aliases work."""
    text = "a: on\nb: no\nc: 1e-3\nd: &x [1, 2]\ne: *x\n"
    assert parse_yaml_text(text, "f") == {"a": "on", "b": "no", "c": 0.001, "d": [1, 2], "e": [1, 2]}


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    """A missing file, a folder and a binary file are InputFileErrors that name the path."""
    binary = tmp_path / "binary.yaml"
    binary.write_bytes(b"\xff\xfe\x00")
    for path in (tmp_path / "none.yaml", tmp_path, binary):
        with pytest.raises(InputFileError) as error:
            parse_yaml(path)
        assert str(path) in str(error.value)


@pytest.mark.parametrize(
    ("values", "expected"),
    [(2, [2, 2, 2]), ([1, 2, 3], [1, 2, 3]), ({"c": 3.0, "a": 1.0, "b": 2.0}, [1, 2, 3])],
)
def test_expand_gives_one_number_per_joint(values: Any, expected: list[float]) -> None:
    """A scalar, a list and a mapping all become one read-only array in joint order."""
    out = expand(values, ("a", "b", "c"), "key")
    np.testing.assert_array_equal(out, expected)
    assert not out.flags.writeable


def test_expand_refuses_what_does_not_fit() -> None:
    """Missing and unknown joints, a wrong count and NaN are refused with the key."""
    names = ("shoulder", "elbow")
    with pytest.raises(SpecError, match="key: a joint has no value; got 'elbow'"):
        expand({"shoulder": 1.0}, names, "key")
    with pytest.raises(SpecError, match="key: no such joint; got 'elbo'; accepted: elbow"):
        expand({"elbo": 1.0}, names, "key")
    with pytest.raises(SpecError, match="key: wrong number of values; got 1; accepted: 2"):
        expand([1.0], names, "key")
    with pytest.raises(NonFiniteError, match="key: not a finite number"):
        expand([1.0, float("nan")], names, "key")
    np.testing.assert_array_equal(expand({"elbow": 1.0}, names, "key", default=[5.0, 6.0]), [5.0, 1.0])


def test_nearest_names() -> None:
    """Names that look alike are offered, best first; nothing alike gives an empty text."""
    assert nearest("servicr", ["mini", "servicer", "service"]) == "servicer, service"
    assert nearest("xyz", ["mini"]) == ""


def test_specs_have_a_json_schema() -> None:
    """Editors get a schema with descriptions."""
    assert "saturation" in Actuators.model_json_schema()["properties"]
