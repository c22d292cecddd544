"""Experiment files: resolved once, checked completely, said back without loss."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import (
    experiment_from,
    experiment_path,
    load_experiment,
    to_yaml,
    with_duration,
)
from space_robot_bringup.experiment.timebase import steps_of, to_nanoseconds
from space_robot_bringup.modes.run import run_experiment
from space_robot_description.share import shipped
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from tests.support.values import blocks_equal

WATCHERS: list[list[Path]] = []


def _on_audit(event: str, arguments: tuple[Any, ...]) -> None:
    if WATCHERS and event == "open" and isinstance(arguments[0], str | Path):
        path = Path(arguments[0])
        if path.suffix in (".yaml", ".urdf"):
            for found in WATCHERS:
                found.append(path)


# An audit hook sees every way to open a file; it cannot be removed, so it looks whether a test watches.
sys.addaudithook(_on_audit)


@contextmanager
def files_read() -> Iterator[list[Path]]:
    """The experiments, robots and URDFs that are opened in the block."""
    found: list[Path] = []
    WATCHERS.append(found)
    try:
        yield found
    finally:
        WATCHERS.remove(found)


@pytest.mark.parametrize("name", shipped("experiments"))
def test_a_shipped_experiment_composes_and_its_resolved_form_is_the_same(name: str) -> None:
    """What is shipped can be run, and its resolved YAML in a log is the same text and robot: it needs no other file."""
    with files_read() as files:
        first = compose(load_experiment(name))
    assert first.experiment.title
    assert first.experiment.steps > 10
    assert f"{Path(name).name}.yaml" in {path.name for path in files}
    with files_read() as files:
        again = compose(experiment_from(parse_yaml_text(first.header.experiment, "log"), "log"))
    assert files == []
    assert again.header == first.header
    assert again.nominal.urdf == first.nominal.urdf
    assert to_yaml(again.experiment) == first.header.experiment


def test_an_override_changes_its_key_only() -> None:
    """--set replaces one value, of any depth, and leaves the rest."""
    plain = load_experiment("liu2023/fig08")
    changed = load_experiment("liu2023/fig08", ["controller.gains.lambda=0.7", "plant.delay_periods=1"])
    assert changed.controller.gains == plain.controller.gains | {"lambda": 0.7}
    assert changed.plant.delay_periods == 1
    assert changed.model_copy(update={"controller": plain.controller, "plant": plain.plant}) == plain


def test_overrides_are_a_mapping_or_texts() -> None:
    """A mapping with Python's or NumPy's values, texts in YAML, one text: they say the same, law before gains."""
    texts = ["controller.gains.damping=0.5", "controller.law=computed_torque", "duration=5"]
    wanted = load_experiment("liu2023/fig08", texts)
    assert wanted.controller.gains == {"damping": 0.5}
    values = {"controller.gains.damping": np.float32(0.5), "controller.law": "computed_torque", "duration": np.int64(5)}
    assert load_experiment("liu2023/fig08", values) == wanted
    assert load_experiment(experiment_path("liu2023/fig08"), values) == wanted
    assert load_experiment("liu2023/fig08", "seed=7").seed == 7


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        ({"control_period": "fast"}, r"control_period: not accepted; got 'fast'"),
        ({"control_period": float("nan")}, r"control_period: not accepted; got nan"),
        ({"duration.x": 1}, r"^duration\.x: leads to 'x'"),
        ({"": 1}, r"^overrides: not a dotted key; got ''"),
        ({7: 1}, r"^overrides: not a dotted key; got 7"),
        (["duration"], r"--set: not an assignment; got 'duration'"),
    ],
)
def test_an_override_that_cannot_be_used_is_named(overrides: Any, said: str) -> None:
    """One line with the key as it was typed and the value."""
    with pytest.raises(SpecError, match=said):
        load_experiment("liu2023/fig08", overrides)


def test_a_robot_beside_the_experiment_is_found(tmp_path: Path) -> None:
    """A relative robot path starts at the experiment's folder, wherever it is run from."""
    from space_robot_description.share import config_dir

    for suffix in ("yaml", "urdf"):
        (tmp_path / f"mine.{suffix}").write_bytes((config_dir() / "robots" / f"mini.{suffix}").read_bytes())
    (tmp_path / "mine.yaml").write_text((tmp_path / "mine.yaml").read_text().replace("mini.urdf", "mine.urdf"))
    (tmp_path / "task.yaml").write_text(
        "robot: mine.yaml\ncontrol_period: 0.5\nduration: 1.0\nreference: {kind: hold}\n"
    )
    assert compose(load_experiment(str(tmp_path / "task.yaml"))).nominal.n == 4


@given(st.integers(1, 10_000), st.sampled_from([0.1, 0.02, 0.25, 0.05, 0.5, 1.0, 0.3]))
def test_every_decimal_multiple_of_the_period_is_accepted(steps: int, period: float) -> None:
    """Durations people write (0.3 s of 0.1 s) divide exactly: decimals are counted as decimals."""
    from decimal import Decimal

    assert steps_of(float(Decimal(repr(period)) * steps), period) == steps


@pytest.mark.parametrize(("duration", "period"), [(1.0, 0.3), (0.1, 0.25), (1.0, 1e-10)])
def test_a_period_that_does_not_divide_is_refused(duration: float, period: float) -> None:
    """No rounding: the error says what would do."""
    with pytest.raises(SpecError, match="accepted"):
        steps_of(duration, period)


def test_nanoseconds_are_exact() -> None:
    """0.1 s is 100 000 000 ns, not its binary neighbour."""
    assert to_nanoseconds(0.1, "t") == 100_000_000
    assert with_duration(load_experiment("liu2023/fig08"), 10.0).steps == 40


def test_a_recorded_reference_repeats_the_desired_motion(tmp_path: Path) -> None:
    """A recorded reference takes the reference of a log, bit for bit, and the resolved file needs no log any more."""
    run_experiment(load_experiment("liu2023/fig08", ["duration=5.0"]), tmp_path / "first", mode="headless")
    again = tmp_path / "again.yaml"
    again.write_text(
        "robot: mini\ncontrol_period: 0.25\nduration: 5.0\ninitial: {joints_deg: [90, 45, 45, 0]}\n"
        "reference: {kind: recorded, log: first}\ncontroller: {law: computed_torque, gains: {bandwidth: 1.0}}\n"
    )
    composition = compose(load_experiment(str(again)))
    ticks = list(LogReader(tmp_path / "first").ticks())
    assert len(ticks) == 21
    for tick in ticks:
        asked = composition.reference().at(tick.stamp)
        assert blocks_equal((asked.q, asked.v, asked.a), (tick.reference.q, tick.reference.v, tick.reference.a))
    assert "first" not in composition.header.experiment
    again.write_text(again.read_text().replace("log: first", "log: first, stamps: [0]"))
    with pytest.raises(SpecError, match=r"reference\.stamps"):
        load_experiment(str(again))
