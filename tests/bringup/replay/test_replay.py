"""What a replay says when something is different, and when a log holds less than it should."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from space_robot_bringup.replay.comparison import Tolerance
from space_robot_msgs_py.topics import CONTROLLER_TELEMETRY, JOINT_COMMAND
from tests.support.replays import first, one, record_run, replayed, rewritten
from tests.support.tool import Tool, refused

SHORT = "duration=5.0"
PERIOD = 250_000_000


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five seconds of fig08, 21 ticks."""
    return record_run(tmp_path_factory.mktemp("logs") / "fig08", "liu2023/fig08", SHORT)


def test_another_gain_is_found_at_once_and_named(bag: Path) -> None:
    """An overridden gain shows in the first command, with the field, both values and what was changed."""
    done = replayed(bag, overrides=["controller.gains.kappa=1.000001"])
    controller, plant = done.outcomes
    found = first(controller)
    assert (found.stamp, found.topic) == (0, "base/wrench_command")
    assert found.field.startswith("wrench.torque.")
    assert isinstance(found.recorded, float)
    assert isinstance(found.fresh, float)
    assert found.recorded != found.fresh
    assert done.recording.changes == {"controller.gains.kappa": (1.0, 1.000001)}
    assert plant.equal
    assert not done.equal


def test_another_law_answers_the_recorded_states(bag: Path) -> None:
    """With another law the commands are compared and its telemetry has blocks the log has not."""
    done = replayed(bag, against="controller", overrides=["controller.law=pd"])
    assert one(done).ticks == 21
    places = {(topic, block) for topic, block in one(done).comparison.worst}
    assert ("joint_command", "effort") in places
    worst = one(done).comparison.worst.items()
    fresh_only = {block for (_, block), found in worst if found.recorded is None}
    recorded_only = {block for (_, block), found in worst if found.fresh is None}
    assert fresh_only >= {"attitude_error", "twist_error", "joint_rate_error"}
    assert recorded_only >= {"euler_error", "sliding_variable", "parameters"}


def test_a_plant_that_is_otherwise_shows_in_the_state(bag: Path) -> None:
    """An unknown payload moves the states from the first step on, not the commands that answer the recorded ones."""
    done = replayed(bag, overrides=["plant.payload={mass: 1.0e-3, inertia: [1.0e-6, 1.0e-6, 1.0e-6]}"])
    controller, plant = done.outcomes
    assert controller.equal
    assert first(plant).stamp == PERIOD
    assert "plant.payload.mass" in done.recording.changes


def test_tolerances_forgive_what_is_small(bag: Path) -> None:
    """The same difference passes with a tolerance above it and not with one below it."""
    overrides = ["controller.gains.kappa=1.000001"]
    for atol, equal in ((1e-5, True), (1e-8, False)):
        outcome = one(replayed(bag, against="controller", overrides=overrides, tolerance=Tolerance(atol=atol)))
        assert outcome.equal is equal


def test_an_ignored_topic_or_block_is_not_compared(bag: Path) -> None:
    """A topic, or one block of it, can be left out by name."""
    order = {"against": "controller", "overrides": ["controller.gains.kappa=1.000001"]}
    ignore = ("base/wrench_command", "joint_command")
    outcome = one(replayed(bag, **order, tolerance=Tolerance(ignore=ignore)))
    assert first(outcome).topic == CONTROLLER_TELEMETRY.name
    blocks = {block for topic, block in outcome.comparison.worst if topic == CONTROLLER_TELEMETRY.name}
    ignore += tuple(f"{CONTROLLER_TELEMETRY.name}/{block}" for block in blocks)
    assert one(replayed(bag, **order, tolerance=Tolerance(ignore=ignore))).equal


def test_one_changed_number_is_the_only_difference(bag: Path, tmp_path: Path) -> None:
    """A command altered in its last bit is found: this stamp, this joint, and nothing else against the controller."""

    def change(stamp: int, parts: dict[str, bytes]) -> dict[str, bytes]:
        raw = bytearray(parts[JOINT_COMMAND.name])
        raw[-16] ^= (stamp == 3 * PERIOD) * 1
        return parts | {JOINT_COMMAND.name: bytes(raw)}

    controller, plant = replayed(rewritten(bag, tmp_path / "run", change)).outcomes
    found = first(controller)
    assert (found.topic, found.stamp, found.field) == ("joint_command", 3 * PERIOD, "effort[joint3]")
    assert list(controller.comparison.differing.values()) == [1]
    assert first(plant).stamp == 4 * PERIOD


def test_a_truncated_log_is_compared_to_its_end(bag: Path, tmp_path: Path) -> None:
    """A log without the end of its run replays as far as it goes."""
    cut = rewritten(bag, tmp_path / "run", lambda stamp, parts: parts if stamp < 9 * PERIOD else None)
    done = replayed(cut)
    assert done.equal
    assert [outcome.ticks for outcome in done.outcomes] == [9, 9]


def test_a_gap_ends_the_comparison_with_a_remark(bag: Path, tmp_path: Path) -> None:
    """After a missing tick neither law nor plant knows the past: what follows is not compared, and a note says so."""
    gap = rewritten(bag, tmp_path / "run", lambda stamp, parts: None if stamp == 5 * PERIOD else parts)
    done = replayed(gap)
    assert [outcome.against for outcome in done.outcomes] == ["controller", "plant"]
    for outcome in done.outcomes:
        assert outcome.equal
        assert outcome.ticks == 5
        assert "states are missing between" in outcome.remarks[-1]


def test_a_controller_without_telemetry_is_compared_by_its_commands(bag: Path, tmp_path: Path) -> None:
    """Topics that are not in a log are named, and what is there is compared."""
    bare = rewritten(bag, tmp_path / "run", drop=("controller/telemetry", "reference/base", "base/imu"))
    outcome = one(replayed(rewritten(bag, tmp_path / "two", drop=("controller/telemetry",)), against="controller"))
    assert outcome.equal
    assert outcome.absent == ("controller/telemetry",)
    with pytest.raises(OSError, match="nothing to compare"):
        replayed(bare, against="controller")


def test_replay_prints_the_verdict_and_exits_by_it(space_robot: Tool, bag: Path) -> None:
    """0 where everything is equal, 1 where not; JSON says the same as the lines."""
    done = space_robot("replay", str(bag))
    assert done.returncode == 0, done.stderr
    assert "controller: EQUAL" in done.stdout
    assert "plant: EQUAL" in done.stdout
    done = space_robot("replay", str(bag), "--set", "controller.gains.kappa=1.000001", "--against", "controller")
    assert done.returncode == 1
    for words in ("changed: controller.gains.kappa was 1.0, is 1.000001", "DIFFERENT", "first: base/wrench_command at"):
        assert words in done.stdout
    done = space_robot("replay", str(bag), "--set", "controller.gains.kappa=1.000001", "--json")
    assert done.returncode == 1
    said = json.loads(done.stdout)
    assert [(side["against"], side["equal"]) for side in said["replays"]] == [("controller", False), ("plant", True)]
    assert said["replays"][0]["first"]["stamp"] == 0
    assert space_robot("replay", str(bag), str(bag), "--rtol", "1e-9").returncode == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--against", "wall"), ("--against", "wall", "controller")),
        (("--rtol", "nan"), ("--rtol", "nan")),
        (("--atol", "-1"), ("--atol", "-1")),
        (("--ignore", "base/odometer"), ("--ignore", "base/odometer", "base/odom")),
        (("--set", "controller.gains.kapa=1"), ("kapa", "kappa")),
        (("--set", "control_period=0.1"), ("control_period",)),
        (("--experiment", "nowhere"), ("nowhere",)),
    ],
)
def test_bad_orders_get_one_line(
    space_robot: Tool, bag: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """A wrong option is named with what would do, exit 2."""
    refused(space_robot("replay", str(bag), *arguments), *words)


def test_replay_of_a_missing_bag_is_one_line(space_robot: Tool, tmp_path: Path) -> None:
    """No bag, or an empty directory, is one line and exit 2."""
    refused(space_robot("replay", "nowhere"), "nowhere")
    (tmp_path / "empty").mkdir()
    refused(space_robot("replay", "empty"), "empty")


def test_references_are_made_new_whole_or_not_at_all(space_robot: Tool, bag: Path, tmp_path: Path) -> None:
    """--update-refs says what is different, runs again and replaces the bag, which then replays; or leaves it."""
    altered = rewritten(bag, tmp_path / "ref", lambda stamp, parts: parts if stamp < 9 * PERIOD else None)
    before = (altered / "ref_0.mcap").read_bytes()
    done = space_robot("replay", "ref", "--update-refs")
    assert done.returncode == 0
    assert "replaced by a new run" in done.stderr
    assert (altered / "ref_0.mcap").read_bytes() != before
    assert (altered / "ref_0.mcap").read_bytes() == next(bag.glob("*.mcap")).read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ref"]
    assert sorted(path.name for path in altered.iterdir()) == ["metadata.yaml", "ref_0.mcap"]
    assert "up to date" in space_robot("replay", "ref", "--update-refs").stderr
    kept = (altered / "ref_0.mcap").read_bytes()
    done = space_robot("replay", "ref", "--update-refs", "--set", "controller.law=tests.support.laws:GivesUp")
    refused(done, "ends otherwise", "enough")
    assert (altered / "ref_0.mcap").read_bytes() == kept
