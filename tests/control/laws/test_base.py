"""The law base class and the registry: what a user's law can rely on, and which error it gets."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from typing import Any

import numpy as np
import pytest
from pydantic import Field

from space_robot_control.laws import Blocks, Law, law_class, law_names, make_law, registry
from space_robot_control.laws.computed_torque.law import ComputedTorque
from space_robot_control.laws.zero_command import ZeroCommand
from space_robot_msgs_py.errors import CommandError, ControlError, SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from tests.support.paths import ROOT
from tests.support.robots import arm_model, random_state, robot_of

N = 2
FLYING, FLOATING = (robot_of(arm_model(N), floating=floating) for floating in (False, True))


class Canned(Law):
    """A law that answers what it was given, for one test after the other."""

    class Gains(Law.Gains):
        """One number."""

        level: float = Field(default=1.0, description="[-]")

    name = "canned"
    gains: Gains
    u: Any = np.arange(6.0 + N)
    blocks: Blocks = {"level": 1.0}  # noqa: RUF012

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return what stands in the class, or call it."""
        return (self.u() if callable(self.u) else self.u), self.blocks


def state_at(stamp: int = 2_500_000_000, n: int = N) -> RobotState:
    """Some state."""
    q, v = random_state(np.random.default_rng(1), n)
    return RobotState(stamp, q, v, np.zeros(n), np.zeros(3))


def reference_at(stamp: int = 2_500_000_000, n: int = N) -> Reference:
    """Some reference."""
    q, v = random_state(np.random.default_rng(2), n)
    return Reference(stamp, q, v, np.zeros(6 + n))


def test_command_and_telemetry_carry_the_stamp_of_the_state() -> None:
    """The generalised force is split into wrench and efforts; both outputs answer the state's stamp."""
    output = Canned(FLYING, 0.1).update(state_at(), reference_at())
    assert output.command.stamp == output.telemetry.stamp == 2_500_000_000
    assert output.command.u.tolist() == list(range(6 + N))
    assert output.telemetry["level"].tolist() == [1.0]


def divide() -> Vector:
    """Fail as user code fails."""
    return np.full(6 + N, 1.0 / int("0"))


def singular() -> Vector:
    """Fail as linear algebra fails."""
    return np.linalg.solve(np.zeros((6 + N, 6 + N)), np.ones(6 + N))


def give_up() -> Vector:
    """Fail on purpose."""
    raise ControlError("close to the singularity", key="theta", value=1.57, accepted="below 1.5")


@pytest.mark.parametrize(
    ("u", "says"),
    [
        (np.full(6 + N, np.nan), r"u \(command.wrench\): not a finite number"),
        (np.r_[np.zeros(6), [0.0, np.inf]], r"u \(command.effort\): not a finite number"),
        (np.zeros(5), r"u: wrong size .*accepted: \(8,\)"),
        (np.zeros((6 + N, 1)), "u: wrong size"),
        (divide, "u: float division by zero"),
        (singular, "u: Singular matrix"),
        (give_up, "theta: close to the singularity .*got 1.57; accepted: below 1.5"),
    ],
)
def test_bad_numbers_of_a_law_name_law_quantity_and_time(u: object, says: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a law fails with, the one-line error says which law, which quantity, at what time."""
    monkeypatch.setattr(Canned, "u", staticmethod(u) if callable(u) else u)
    with pytest.raises(ControlError, match=f"^canned: {says}") as caught:
        Canned(FLYING, 0.1).update(state_at(), reference_at())
    assert "at t = 2.5 s" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_non_finite_telemetry_names_its_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """NaN in telemetry is an error too: it would poison the log."""
    monkeypatch.setattr(Canned, "blocks", {"good": [1.0, 2.0], "estimate": [0.0, np.nan]})
    with pytest.raises(ControlError, match=r"canned: telemetry \(estimate\): not a finite number at t = 2.5 s"):
        Canned(FLYING, 0.1).update(state_at(), reference_at())


@pytest.mark.parametrize("blocks", [{"level": [1.0, 2.0]}, {"other": 1.0}, {"level": 1.0, "more": 1.0}, {}])
def test_telemetry_layout_is_fixed_within_a_run(blocks: Blocks, monkeypatch: pytest.MonkeyPatch) -> None:
    """Labels and sizes of the first update hold until reset."""
    law = Canned(FLYING, 0.1)
    law.update(state_at(), reference_at())
    monkeypatch.setattr(Canned, "blocks", blocks)
    with pytest.raises(ControlError, match=r"canned: telemetry: changed within a run at t = 2\.5 s"):
        law.update(state_at(), reference_at())
    law.reset()
    assert law.update(state_at(), reference_at()).telemetry.labels == tuple(blocks)


def test_a_force_on_a_free_floating_base_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """What no actuator can give is no command; zero force passes."""
    law = Canned(FLOATING, 0.1)
    with pytest.raises(ControlError, match="force on a free-floating base"):
        law.update(state_at(), reference_at())
    monkeypatch.setattr(Canned, "u", np.r_[np.zeros(3), np.ones(3 + N)])
    assert law.update(state_at(), reference_at()).command.effort.tolist() == [1.0] * N


@pytest.mark.parametrize(
    ("state", "reference", "says"),
    [
        (state_at(n=3), reference_at(n=3), "does not fit the robot"),
        (state_at(), reference_at(n=1), "does not fit the robot"),
        (state_at(), reference_at(stamp=2_400_000_000), "reference of another tick"),
    ],
)
def test_inputs_that_do_not_fit_are_refused(state: RobotState, reference: Reference, says: str) -> None:
    """State and reference have the robot's size and one stamp."""
    with pytest.raises(CommandError, match=says):
        Canned(FLYING, 0.1).update(state, reference)


def test_an_attitude_that_is_no_rotation_is_refused() -> None:
    """A measured quaternion of length 1.1 is an error, one of length 1.0001 is noise."""
    good, bad = state_at(), state_at()
    scaled = np.array(good.q)
    scaled[3:7] *= 1.1
    bad = RobotState(good.stamp, scaled, good.v, good.effort, good.base_acceleration)
    with pytest.raises(ControlError, match=r"canned: state.q: not a unit quaternion at t = 2.5 s"):
        Canned(FLYING, 0.1).update(bad, reference_at())
    scaled[3:7] *= 1.0001 / 1.1
    noisy = RobotState(good.stamp, scaled, good.v, good.effort, good.base_acceleration)
    assert Canned(FLYING, 0.1).update(noisy, reference_at()).command.stamp == good.stamp


@pytest.mark.parametrize("period", [0.0, -0.1, np.nan, np.inf])
def test_a_period_that_is_none_is_refused(period: float) -> None:
    """The control period is positive and finite."""
    with pytest.raises(SpecError, match="control_period: not a period"):
        Canned(FLYING, period)


def test_gains_of_another_law_are_refused() -> None:
    """A law takes its own gains, or their defaults."""
    assert Canned(FLYING, 0.1).gains.level == 1.0
    with pytest.raises(SpecError, match="not the gains of this law"):
        Canned(FLYING, 0.1, ComputedTorque.Gains())  # type: ignore[arg-type]


def test_laws_by_name_module_path_and_file() -> None:
    """Built-in names, module:Class and file.py:Class all lead to classes."""
    assert law_class("computed_torque") is ComputedTorque
    assert law_class("none") is ZeroCommand
    assert law_class(f"{__name__}:Canned") is Canned
    mine = law_class(f"{ROOT / 'examples' / 'my_law.py'}:PdPlus")
    assert issubclass(mine, Law)
    assert mine.name == "pd_plus"
    assert law_names()[: len(registry.BUILT_IN)] == tuple(registry.BUILT_IN)


def test_laws_of_installed_distributions_are_found_and_cannot_hide_built_in_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An entry point in the group space_robot.laws is a law by its name; a built-in name stays the built-in law."""
    points = [EntryPoint(name, f"{__name__}:Canned", registry.GROUP) for name in ("theirs", "none")]
    monkeypatch.setattr("importlib.metadata.entry_points", lambda group: points if group == registry.GROUP else [])
    assert law_class("theirs") is Canned
    assert law_class("none") is ZeroCommand
    assert law_names() == (*registry.BUILT_IN, "theirs")


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("computed_torqe", "no such law; got 'computed_torqe'; accepted: .*computed_torque"),
        ("xyzzy", f"no such law; .*{', '.join(registry.BUILT_IN)}, module:Class"),
        ("no.such.module:Law", "cannot import"),
        ("no_such_file.py:Law", "cannot import"),
        (f"{__name__}:Missing", "no such class; .*one of Canned"),
        (f"{__name__}:state_at", "not a law"),
        (f"{__name__}:Law", "not a law"),
        ("math:pi", "not a law"),
    ],
)
def test_a_law_that_is_none_is_one_clear_error(name: str, says: str) -> None:
    """Wrong names say the nearest; wrong paths say what is wrong with them."""
    with pytest.raises(SpecError, match=rf"^controller\.law: {says}") as caught:
        law_class(name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("gains", "says"),
    [
        ({"bandwith": 1.0}, "bandwith: unknown key.*bandwidth"),
        ({"damping": -1.0}, "damping: not accepted.*greater than 0"),
        ({"damping": float("nan")}, "damping: not accepted.*finite"),
        ({"bandwidth": {"joints": [1.0]}}, "bandwidth.joints: wrong number"),
        ({"bandwidth": {"joints": {"joint_7": 1.0}}}, "joint_0"),
        ({"bandwidth": {"rotation": [1.0, 1.0]}}, "rotation: not accepted"),
    ],
)
def test_bad_gains_name_their_key(gains: dict[str, Any], says: str) -> None:
    """Unknown keys, wrong ranges and wrong sizes are SpecErrors with the dotted key."""
    with pytest.raises(SpecError, match=rf"controller\.gains.*{says}"):
        make_law("computed_torque", FLYING, 0.1, gains)


def test_gains_that_are_made_by_hand_are_refused_in_the_same_words() -> None:
    """A line each with law, key, value and what is accepted, wherever in a program they are made."""
    with pytest.raises(SpecError) as caught:
        Canned.Gains(level="high", sharpness=2.0)  # type: ignore[arg-type, call-arg]
    assert [str(one) for one in caught.value.problems] == [
        "Canned.Gains.sharpness: unknown key; accepted: level",
        "Canned.Gains.level: not accepted; got 'high'; accepted: a number",
    ]


def test_gains_that_are_no_model_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A class of numbers in place of a model is named, with what it has to be."""
    monkeypatch.setattr(Canned, "Gains", type("Gains", (), {"level": 1.0}))
    with pytest.raises(SpecError, match=r"Canned\.Gains: is no model of gains; .*Gains\(space_robot\.Law\.Gains\)"):
        make_law(f"{__name__}:Canned", FLYING, 0.1)


def test_every_gain_says_what_it_is_and_in_which_unit() -> None:
    """Defaults live with the law, and every field has a description, a number with its unit."""
    for name in registry.BUILT_IN:
        for key, field in law_class(name).Gains.model_fields.items():
            assert field.description, key
            assert "[" in field.description or not isinstance(field.default, float), key
