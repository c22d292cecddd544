"""A manifest of two figures, and what comes of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from space_robot_description.validation import parse_yaml_text

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

# Two figures share the run "real"; sensors are noisy, so that seeds matter.
MANIFEST = """
title: "A paper with <tags> & brackets [red]"
citation: "Anon, Tests 1, 2023"
notes: Gains are assumed.
figures:
  8:
    title: Orientation
    runs:
      real: {experiment: liu2023/fig08, set: &short {duration: 6.0, plant.sensors.attitude.noise: 1.0e-5}}
      prior: {experiment: liu2023/fig08, set: {<<: *short, nominal.dispersion.eta: 0.2}, seeds: [1, 2]}
    panels:
      - {signals: [base/roll.value, base/roll.reference], of: [real], label: "roll [deg]"}
      - {signals: [base/roll.error], label: "error [deg]", style: {real: red}, legend: {prior 1: first}}
    tables:
      - {rows: runs, columns: {"error [deg]": {signal: base.error, take: max, after: 5.0}}}
    claims:
      - paper: It arrives.
        measures: {late: {signal: base.error, take: max, after: 5.0, of: [real, prior], reduce: max}}
        holds_if: late < 1
        found: "{late:.2f} deg after 5 s in {n} runs"
        expect: holds
      - paper: Wrong parameters make it diverge.
        measures: {diverged: {metric: diverged, of: prior, reduce: sum}}
        holds_if: diverged >= 1
        found: "{diverged:.0f} of {n} diverge"
        expect: does not hold
        because: Twenty percent are little.
      - paper: It is elegant.
        expect: not checkable
        because: No number is given.
  gain:
    title: A varied gain
    kind: beyond
    runs:
      real: {experiment: liu2023/fig08, set: *short}
      varied: {experiment: liu2023/fig08, set: *short, vary: {controller.gains.lambda: [0.5, 1.5]}}
    charts:
      - {measure: {metric: base/roll.final_error}, x: controller.gains.lambda, of: [varied], y_scale: log}
      - {measure: {metric: base/roll.settling_time, missing: skip, reduce: median}}
    tables:
      - {columns: {"error [deg]": {metric: base/roll.final_error, reduce: median}}}
    timing: {of: [real], repeats: 20}
"""


def write(folder: Path, text: str = MANIFEST, **changes: Any) -> None:
    """The manifest, with top-level keys of its first figure changed."""
    data = parse_yaml_text(text, "manifest")
    data["figures"][8].update(changes)
    (folder / "paper.yaml").write_text(json.dumps(data))


def claims(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "claims.json").read_text())
    return found


def without_times(folder: Path) -> str:
    """claims.json without the only numbers that are of the wall clock."""
    data = claims(folder)
    for figure in data["figures"]:
        figure["timing"] = sorted(figure["timing"])
    return json.dumps(data)
