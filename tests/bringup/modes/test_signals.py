"""A signal or a limit on time ends what is going on: in order where that is possible, at once where it is not."""

from __future__ import annotations

import os
import signal
import threading
import time

import pytest

from space_robot_bringup.modes.signals import Interrupted, RunStop, StopFlag, raising


def spin(condition: object = None, seconds: float = 20.0) -> None:
    """Be stuck, as a law may be."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass
    raise AssertionError(f"not interrupted within {seconds} s")


def kill_me(number: signal.Signals) -> None:
    os.kill(os.getpid(), number)


@pytest.mark.parametrize(("number", "reason"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")])
def test_a_signal_before_the_run_raises_at_once(number: signal.Signals, reason: str) -> None:
    """While nothing looks at the reason there is nothing to end in order: the signal raises where it arrives."""
    with RunStop(signal.SIGINT, signal.SIGTERM) as stop:
        with pytest.raises(Interrupted) as caught:
            kill_me(number)
        assert caught.value.reason == reason == stop.reason


def test_a_run_that_looks_is_never_interrupted() -> None:
    """Once the reason was looked at, nothing is raised, however long the end takes; the first signal counts."""
    with RunStop(signal.SIGINT, signal.SIGTERM, timeout=0.05) as stop:
        assert stop.reason is None
        kill_me(signal.SIGTERM)
        kill_me(signal.SIGINT)
        assert stop.reason == "terminated"
        stop._due = 0.0  # As if the grace were over.
        signal.raise_signal(signal.SIGALRM)
        assert stop.reason == "terminated"


@pytest.mark.parametrize("source", ["signal", "thread", "timeout"])
def test_a_run_that_does_not_look_is_interrupted(source: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the reason is not looked at in time, it is raised in the main thread, and again until it is looked at."""
    monkeypatch.setattr("space_robot_bringup.modes.signals.GRACE_SECONDS", 0.2)
    with RunStop(signal.SIGINT, timeout=0.3 if source == "timeout" else None) as stop:
        assert stop.reason is None
        if source == "signal":
            kill_me(signal.SIGINT)
        if source == "thread":
            threading.Thread(target=stop.end, args=("ordered",)).start()
        for _ in range(2):
            with pytest.raises(Interrupted):
                spin()
        assert stop.reason == {"signal": "interrupted", "thread": "ordered", "timeout": "timeout"}[source]
        stop.ending()


def test_progress_and_idle_waiting_use_up_no_time() -> None:
    """A run that reaches new ticks is not over its limit by the clock; one that reaches none is, without any CPU."""
    with RunStop(timeout=0.5) as stop:
        assert stop.reason is None
        end, tick = time.monotonic() + 1.0, 0
        while time.monotonic() < end:
            tick += 1
            stop.reach(tick)
            time.sleep(0.05)
            assert stop.reason is None
        with pytest.raises(Interrupted):
            time.sleep(20.0)
        assert stop.reason == "timeout"


def test_the_handlers_of_before_are_back_afterwards() -> None:
    """A block leaves the process's handlers and timers as they were."""
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)]
    with RunStop(signal.SIGINT, signal.SIGTERM, timeout=100.0), StopFlag(signal.SIGINT):
        assert signal.getsignal(signal.SIGALRM) is not before[2]
    with raising(signal.SIGTERM), pytest.raises(Interrupted, match="terminated"):
        kill_me(signal.SIGTERM)
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)] == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
