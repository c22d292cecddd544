"""What tells curves apart: runs, groups, varied values and signals have looks of their own, and a given style wins."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_studies.reproduce.manifest import Figure, Panel
from space_robot_studies.reproduce.planner import DistinctRun, PlannedRun
from space_robot_studies.reproduce.reproduction import FigureResult
from space_robot_studies.reproduce.run_data import RunData

pytest.importorskip("matplotlib")
from space_robot_report.figures.chart import plain
from space_robot_report.figures.curves import SINGLY, Curve, curves_of
from space_robot_report.palette import PALETTE

TIME = np.arange(5.0)
EXPERIMENT = load_experiment("liu2023/fig08")


def figure_result(**groups: int | str) -> FigureResult:
    """A figure with so many runs per group; ``"varied"`` is one of three values. Each run has x, and y.reference."""
    data: dict[str, Any] = {"title": "t", "runs": {}}
    runs = []
    for group, kind in groups.items():
        data["runs"][group] = {"experiment": "e"} | ({"vary": {"k": [1, 2, 3]}} if kind == "varied" else {})
        count = 3 if kind == "varied" else int(kind)
        for index in range(count):
            label = f"{group} {index}" if count > 1 else group
            curves = {"x": TIME * (index + 1), "y.reference": TIME}
            planned = DistinctRun(label, "e", (), EXPERIMENT)
            runs.append((PlannedRun(label, group, {}, planned), RunData("completed", time=TIME, curves=curves)))
    return FigureResult("8", Figure.model_validate(data), tuple(runs), (), {}, ())


def curves(figure: FigureResult, **keys: Any) -> list[Curve]:
    return curves_of(Panel.model_validate({"signals": ["x"]} | keys), figure)


def test_runs_of_small_groups_have_colors_of_their_own() -> None:
    """Colors go through the palette run by run, whatever else the panel shows."""
    figure = figure_result(real=1, prior=3)
    assert [curve.color for curve in curves(figure)] == list(PALETTE[:4])
    assert [curve.color for curve in curves(figure, of=["prior"])] == list(PALETTE[1:4])
    assert [curve.label for curve in curves(figure)] == ["real", "prior 0", "prior 1", "prior 2"]


def test_large_groups_are_one_cloud() -> None:
    """Many runs share a color and one entry of the legend that says how many they are."""
    cloud = curves(figure_result(real=1, many=SINGLY + 1), of=["many"])
    assert len({curve.color for curve in cloud}) == 1
    assert [curve.label for curve in cloud] == [f"many ({SINGLY + 1} runs)"] + [""] * SINGLY


def test_varied_runs_differ_by_shade_and_groups_by_line() -> None:
    """The runs of a group that varies something differ by shade; two such groups by their lines."""
    first, second = curves(figure_result(a="varied", b="varied"))[:3], curves(figure_result(a="varied", b="varied"))[3:]
    assert len({curve.color for curve in first}) == 3
    assert [curve.color for curve in first] == [curve.color for curve in second]
    assert {curve.line for curve in first} == {"solid"}
    assert {curve.line for curve in second} == {"dashed"}
    assert {curve.line for curve in curves(figure_result(a="varied", b="varied"), of=["b"])} == {"solid"}


def test_a_shared_reference_is_drawn_once() -> None:
    """What the runs are compared with is one black dotted line, named by its signal."""
    drawn = curves(figure_result(a=2, b=1), signals=["y.reference", "x"])
    assert {curve.line for curve in drawn} == {"dotted", "solid"}
    (reference,) = (curve for curve in drawn if curve.line == "dotted")
    assert (reference.color, reference.label) == ("black", "y.reference")
    assert len(drawn) == 4


def test_style_and_legend_of_the_manifest_override_the_defaults() -> None:
    """Style and legend go by signal, run or group; an empty text leaves the legend out."""
    style = {"prior": {"color": "grey", "width": 3}, "prior 1": "red"}
    drawn = curves(figure_result(real=1, prior=2), style=style, legend={"real": "", "prior 1": "second"})
    assert [curve.color for curve in drawn] == [PALETTE[0], "grey", "red"]
    assert [curve.width for curve in drawn[1:]] == [3, 3]
    assert [curve.label for curve in drawn] == ["", "prior 0", "second"]


def test_curves_are_cut_to_the_window() -> None:
    """After and before cut what is drawn, ends included."""
    (curve,) = curves(figure_result(real=1), after=1.0, before=3.0)
    assert curve.time.tolist() == [1.0, 2.0, 3.0]


def test_a_text_is_never_a_formula() -> None:
    """Dollar signs in labels are dollar signs."""
    assert plain("cost [$], $x$") == r"cost [\$], \$x\$"
