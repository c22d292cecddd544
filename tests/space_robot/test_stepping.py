"""An experiment stepped by hand is the run of it."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

import space_robot as sr

SHORT = {"duration": 5.0, "expect": {}}
# Everything that has a memory or draws numbers.
ROUGH = SHORT | {
    "plant.delay_periods": 1,
    "nominal.delay_periods": 1,
    "plant.sensors.attitude.noise": 1e-4,
    "plant.dispersion.eta": 0.1,
    "faults": [{"kind": "joint_stuck", "joint": "joint2", "at": 2.0}],
}


@pytest.mark.parametrize("changes", [SHORT, ROUGH], ids=["smooth", "rough"])
def test_the_ticks_are_those_of_the_run(changes: dict[str, object]) -> None:
    """States, references and commands, bit for bit."""
    logged = list(sr.run("liu2023/fig08", changes).log.ticks())
    stepped = list(sr.closed_loop("liu2023/fig08", changes))
    assert len(stepped) == len(logged) == 21
    for one, other in zip(stepped, logged, strict=True):
        assert one.sample.state.q.tobytes() == other.sample.state.q.tobytes()
        assert one.reference.q.tobytes() == other.reference.q.tobytes()
        assert one.output.command.u.tobytes() == other.output.command.u.tobytes()


def test_the_plant_answers_the_commands_of_a_run_with_its_states() -> None:
    """As commands or as numbers, twice in a row."""
    run = sr.run("liu2023/fig08", ROUGH)
    ticks = list(run.log.ticks())
    plant = sr.make_plant(run.experiment)
    assert plant.joint_names == run.joint_names
    for way in (lambda command: command, lambda command: command.u.tolist()):
        for tick in ticks:
            assert plant.state.q.tobytes() == tick.sample.state.q.tobytes()
            assert plant.reference.q.tobytes() == tick.reference.q.tobytes()
            plant.step(way(tick.output.command))
        plant.reset()


def test_a_loop_may_be_left_and_a_mistake_is_an_error_at_the_call() -> None:
    """Nothing is computed that is not asked for."""
    assert [tick.stamp for tick in islice(sr.closed_loop("liu2023/fig08"), 3)] == [0, 250_000_000, 500_000_000]
    with pytest.raises(sr.SpaceRobotError, match=r"controller\.gains\.kapa"):
        sr.closed_loop("liu2023/fig08", {"controller.gains.kapa": 1.0})


def test_what_is_no_command_moves_nothing() -> None:
    """A wrong size, a number that is not finite, the answer to another state: each is one error."""
    plant = sr.make_plant("liu2023/fig08")
    bad = [
        np.zeros(3),
        [np.nan] * 10,
        sr.Command(250_000_000, np.zeros(6), np.zeros(4)),
        sr.Command(0, np.zeros(6), np.zeros(2)),
    ]
    for command in bad:
        with pytest.raises(sr.SpaceRobotError):
            plant.step(command)
    assert plant.state.stamp == 0
    assert plant.step(None).state.stamp == 250_000_000
