"""A law that carries something into the next run is found before the first."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.compose.memory import what_is_not_forgotten
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_control.laws import law_names
from tests.support.tool import Tool

LAW = """
import numpy as np
from space_robot import Law, tracking_errors

class {name}(Law):
    shared = [0.0]

    def __init__(self, robot, control_period, gains=None):
        super().__init__(robot, control_period, gains)
        self.integral = 0.0

    def reset(self):
        super().reset()
        {reset}

    def compute(self, state, reference):
        {remember}
        u = np.zeros(6 + self.n)
        u[6] = self.integral + self.shared[0]
        return u, {{"integral": np.array([self.integral])}}
"""
ADD = "self.integral += tracking_errors(state, reference).joints[0]"


def warned(folder: Path, **parts: str) -> str:
    """What is said of a law."""
    parts = {"name": "Pid", "reset": "self.integral = 0.0", "remember": ADD} | parts
    (folder / "law.py").write_text(LAW.format(**parts), encoding="utf-8")
    changes = {"controller.law": f"{folder}/law.py:{parts['name']}", "expect": {}}
    return what_is_not_forgotten(compose(load_experiment("liu2023/fig08", changes)))


def test_a_law_that_forgets_is_fine(tmp_path: Path) -> None:
    """Memory within a run is what laws have."""
    assert warned(tmp_path) == ""


def test_an_integral_that_is_not_reset_is_found(tmp_path: Path) -> None:
    """With the first tick and the names of what is different."""
    said = warned(tmp_path, reset="pass")
    assert "law.py:Pid does not forget: after a reset" in said
    assert "(tick 0: command, integral)" in said


def test_what_all_laws_of_a_class_share_is_found(tmp_path: Path) -> None:
    """Reset or not: the second law has it, too."""
    said = warned(tmp_path, remember="self.shared[0] += 1.0")
    assert "does not forget" in said
    assert "(tick 0: command)" in said


def test_a_law_that_fails_is_another_matter(tmp_path: Path) -> None:
    """It says so itself when it runs."""
    assert warned(tmp_path, remember="raise ValueError('no')") == ""


@pytest.mark.parametrize("law", law_names())
def test_shipped_laws_are_not_asked(law: str) -> None:
    """Their tests do; a check of an experiment with them makes no other law."""
    spec = load_experiment("liu2023/fig08", {"controller.law": law, "expect": {}})
    assert what_is_not_forgotten(compose(spec)) == ""


def test_check_says_it(tmp_path: Path, space_robot: Tool) -> None:
    """As a warning: the run is possible, its repetition is not."""
    (tmp_path / "law.py").write_text(LAW.format(name="Pid", reset="pass", remember=ADD), encoding="utf-8")
    options = ("--set", "controller.law=law.py:Pid", "--set", "controller.gains={}")
    done = space_robot("check", "liu2023/fig08", *options)
    assert done.returncode == 0
    assert "law.py:Pid does not forget" in done.stdout + done.stderr
