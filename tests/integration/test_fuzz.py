"""A slice of the fuzzing, and that it would notice."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from tests.chaos import fuzz
from tests.chaos.targets import Bags

CASES, SEED = 100, 2026


def test_a_slice_of_the_fuzzing_finds_nothing(tmp_path: Path) -> None:
    """YAML, URDF, logs and command lines of a seed end in a result or in one line: no traceback, no hang."""
    pytest.importorskip("viser")
    pytest.importorskip("plotly")
    outcome = fuzz.fuzz(range(CASES), SEED, tmp_path)
    assert outcome.failures == []
    assert sum(outcome.cases.values()) == CASES
    assert all(outcome.refused[kind] for kind in ("yaml", "urdf", "mcap"))


def raises(*_: object) -> None:
    raise KeyError("a bug")


def never_ends(*_: object) -> None:
    while True:
        pass


def dies(*_: object) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def wants_everything(*_: object) -> None:
    bytearray(fuzz.MEMORY * 4)


@pytest.mark.parametrize(
    ("case", "what"),
    [(raises, "traceback"), (never_ends, "hang"), (dies, "end of the process"), (wants_everything, "out of memory")],
)
def test_the_fuzzing_notices(
    case: Callable[[Random, Path, Bags], None], what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A traceback, an endless loop, a crash and a case that fills the memory are failures of that case alone."""
    kinds = {"bad": case, "good": lambda *_: None}
    monkeypatch.setattr(fuzz, "KINDS", kinds)
    monkeypatch.setattr(fuzz, "CPU_SECONDS", 0.5)
    monkeypatch.setattr(fuzz, "make_bags", lambda folder: Bags(b"", b"", folder))
    monkeypatch.setattr(fuzz, "_warm", lambda *_: None)
    outcome = fuzz.fuzz(range(4), 1, tmp_path, tuple(kinds))
    assert [(failure.index, failure.what) for failure in outcome.failures] == [(0, what), (2, what)]
    assert outcome.cases == {"bad": 2, "good": 2}
