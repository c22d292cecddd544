"""Experiment files with a base: what they resolve to, and what is refused."""

from __future__ import annotations

import json
from difflib import SequenceMatcher
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.experiment.base import with_base
from space_robot_bringup.experiment.experiment import experiment_from, load_experiment, to_yaml
from space_robot_description.share import config_dir, shipped
from space_robot_description.validation import parse_yaml, parse_yaml_text
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_studies.campaign.spec import load_campaign
from tests.support.tool import Tool, refused

WHOLE = """
title: whole
robot: mini
control_period: 0.25
duration: 4.0
initial: {joints_deg: [90, 45, 45, 0]}
reference: {kind: step, attitude_deg: [10, 0, 0], joints_deg: [90, 55, 55, 10]}
controller: {law: adaptive, gains: {update: none, lambda: 1.0, kappa: 1.0}}
plant: {payload: {mass: 1.0}, delay_periods: 1}
expect: {base/roll.final_error: {max: 1.0}, base/yaw.final_error: {max: 2.0}}
"""


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def resolved(folder: Path, text: str) -> dict[str, Any]:
    """The resolved experiment of a file with base ``whole``."""
    write(folder, whole=WHOLE, mine=f"base: whole.yaml\n{text}")
    return parse_yaml_text(to_yaml(load_experiment(str(folder / "mine.yaml"))), "resolved")


@pytest.mark.parametrize(
    ("text", "changes"),
    [
        ("", {}),
        ("title: other", {"title": "other"}),
        ("duration: 8.0\nseed: 3", {"duration": 8.0, "seed": 3}),
        ("plant: {payload: {mass: 2.0}}", {"plant.payload.mass": 2.0}),
        ("initial: {joints_deg: [0, 0, 0, 0]}", {"initial.joints_deg": [0, 0, 0, 0]}),
        ("expect: {base/roll.final_error: {max: 3.0}}", {"expect.base/roll.final_error.max": 3.0}),
        ("controller: {gains: {lambda: 2.0}}", {"controller.gains.lambda": 2.0}),
        ("controller: {gains: {kappa: null}}", {"controller.gains": {"update": "none", "lambda": 1.0}}),
        ("controller: {law: pd, gains: {bandwidth: 0.2}}", {"controller": {"law": "pd", "gains": {"bandwidth": 0.2}}}),
        ("controller: {law: adaptive, gains: {lambda: 2.0}}", {"controller.gains.lambda": 2.0}),
        ("reference: {kind: hold}", {"reference": {"kind": "hold"}}),
        ("plant: null", {"plant": None}),
        ("expect: null\nplant: {payload: null}", {"expect": None, "plant.payload": None}),
    ],
)
def test_a_file_with_a_base_is_the_file_that_says_everything(
    tmp_path: Path, text: str, changes: dict[str, Any]
) -> None:
    """Sections are merged, lists and values replaced, null removes, another law or kind drops what belongs to it."""
    data = parse_yaml_text(WHOLE, "whole")
    for key, value in changes.items():
        *above, last = key.split(".", key.count(".") if not key.startswith("expect") else 1)
        if key.startswith("expect."):
            above, last = ["expect", "base/roll.final_error"], "max"
        place = data
        for name in above:
            place = place[name]
        place.pop(last) if value is None else place.update({last: value})
    found = resolved(tmp_path, text)
    assert found == parse_yaml_text(to_yaml(experiment_from(data, "whole")), "resolved")
    assert "base" not in found


def test_files_are_found_from_where_they_are_named(tmp_path: Path) -> None:
    """A base is relative to the file that names it, or shipped; a robot or a log to the file that says it."""
    (tmp_path / "below" / "robots").mkdir(parents=True)
    for suffix in ("yaml", "urdf"):
        content = (config_dir() / "robots" / f"mini.{suffix}").read_bytes()
        (tmp_path / "below" / "robots" / f"mini.{suffix}").write_bytes(content)
    write(tmp_path / "below", whole=WHOLE.replace("robot: mini", "robot: robots/mini.yaml"))
    write(tmp_path, mine="base: below/whole.yaml\n", shipped="base: liu2023/fig08\ntitle: mine\n")
    assert load_experiment(str(tmp_path / "mine.yaml")).robot == str(tmp_path / "below" / "robots" / "mini.yaml")
    fig08 = load_experiment("liu2023/fig08")
    assert load_experiment(str(tmp_path / "shipped.yaml")) == fig08.model_copy(update={"title": "mine"})
    write(tmp_path / "below", recorded="reference: {kind: recorded, log: logs/old}\n")
    found = with_base({"base": "recorded.yaml"}, tmp_path / "below", "mine.yaml")
    assert found["reference"]["log"] == str(tmp_path / "below" / "logs" / "old")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("base: mine.yaml", ("mine.yaml base", "is the file itself")),
        ("base: ./mine.yaml", ("mine.yaml base", "is the file itself")),
        ("base: two.yaml", ("mine.yaml base", "two.yaml", "one level")),
        ("base: liu2023/fig13", ("mine.yaml base", "liu2023/fig13", "one level")),
        ("base: nowhere.yaml", ("mine.yaml base", "nowhere.yaml", "no such file")),
        ("base: liu2023/fig8", ("mine.yaml base", "liu2023/fig08")),
        ("base: folder", ("mine.yaml base", "folder", "no such file")),
        ("base: liu2023", ("mine.yaml base", "liu2023")),
        ('base: ""', ("mine.yaml base", "not the name")),
        ("base: [whole.yaml]", ("mine.yaml base", "not the name")),
        ("base: 7", ("mine.yaml base", "7")),
        ("base: null", ("mine.yaml base", "not the name")),
        ("base: list.yaml", ("list.yaml", "does not hold a mapping")),
        ("base: broken.yaml", ("broken.yaml", "not valid YAML")),
        ('base: "a\\0b"', ("mine.yaml", "NUL")),
        ("base: whole.yaml\nplnt: null", ("mine.yaml (base whole.yaml) plnt", "plant")),
        ("base: whole.yaml\nplant: {paylod: {mass: 1}}", ("mine.yaml (base whole.yaml) plant.paylod", "payload")),
        ("base: whole.yaml\nrobot: null", ("mine.yaml (base whole.yaml) robot", "missing")),
    ],
)
def test_a_base_that_cannot_be_used_is_one_clear_error(
    space_robot: Tool, tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    """A missing base, a folder, the file itself, a second level, and what is no mapping: file, key and exit 2."""
    (tmp_path / "folder").mkdir()
    write(tmp_path, whole=WHOLE, mine=text, two="base: whole.yaml", list="- 1\n", broken="a: {")
    refused(space_robot("check", "mine.yaml"), *words)


@pytest.mark.parametrize("command", ["run", "check"])
def test_an_override_is_no_base(space_robot: Tool, tmp_path: Path, command: str) -> None:
    """`--set base=...` is refused: only files have a base."""
    refused(space_robot(command, "liu2023/fig08", "--set", "base=liu2023/fig09"), "base", "is for experiment files")


def test_a_resolved_experiment_that_names_a_base_is_refused() -> None:
    """The experiment of a log, or of a case, that names a base is refused, and no file is read for it."""
    data = parse_yaml_text(WHOLE, "whole") | {"base": "/etc/passwd"}
    with pytest.raises(SpecError, match="log base: is for experiment files: a resolved experiment is whole"):
        experiment_from(data, "log")


def test_campaigns_take_experiments_with_a_base(tmp_path: Path) -> None:
    """A campaign's experiment, named or written into it, may have a base; resolved it is whole."""
    write(tmp_path, whole=WHOLE, mine="base: whole.yaml\nduration: 2.0\n", named="experiment: mine.yaml\nruns: 1\n")
    write(tmp_path, written="experiment: {base: whole.yaml, duration: 2.0}\nruns: 1\n")
    named, written = (load_campaign(tmp_path / f"{name}.yaml").experiment for name in ("named", "written"))
    assert named == written
    assert isinstance(named, dict)
    assert (named["duration"], "base" in named) == (2.0, False)
    write(tmp_path, set="experiment: mine.yaml\nset: {base: whole.yaml}\nruns: 1\n")
    with pytest.raises(SpaceRobotError, match="base: is for experiment files"):
        load_campaign(tmp_path / "set.yaml")


def test_the_schema_knows_files_with_a_base(space_robot: Tool) -> None:
    """Editors get one schema for both kinds of file: whole ones, and those that name a base."""
    whole, differing = json.loads(space_robot("schema").stdout)["anyOf"]
    assert "robot" in whole["required"]
    assert "base" not in whole["properties"]
    assert differing["required"] == ["base"]
    assert set(differing["properties"]) == {"base", *whole["properties"]}


def test_no_shipped_experiment_copies_another() -> None:
    """Two shipped files of which all but three lines are the same are variants of one base."""
    paths = {name: config_dir() / "experiments" / f"{name}.yaml" for name in shipped("experiments")}
    texts = {name: path.read_text(encoding="utf-8").splitlines() for name, path in paths.items()}
    bases = {name: parse_yaml(path).get("base", name) for name, path in paths.items()}
    copies = []
    for one, other in combinations(texts, 2):
        blocks = SequenceMatcher(None, texts[one], texts[other], autojunk=False).get_matching_blocks()
        same = sum(block.size for block in blocks)
        longer = max(len(texts[one]), len(texts[other]))
        if longer - same <= 3 < same and bases[one] != bases[other]:
            copies.append((one, other))
    assert copies == []
    assert len(set(bases.values())) < len(bases) / 2
