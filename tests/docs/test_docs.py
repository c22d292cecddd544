"""What the pages in docs/ and examples/ show works as it stands there."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path
from types import ModuleType

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import experiment_from, load_experiment
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_bringup.modes.run import run_experiment
from space_robot_cli.main import main
from space_robot_description.validation import parse_yaml_text
from space_robot_studies.campaign.cases import check_cases, make_case
from space_robot_studies.campaign.run_case import run_case
from space_robot_studies.campaign.spec import load_campaign
from space_robot_studies.tune.spec import load_tuning
from space_robot_studies.tune.stand import make_stands
from space_robot_studies.tune.tune import check_task
from tests.support.nonempty import nonempty
from tests.support.paths import ROOT

DOCS = sorted([*(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "laws").glob("*.md")])
# A tutorial is followed in its order by test_tutorial.py.
PAGES = {page.name: page.read_text(encoding="utf-8") for page in DOCS if not page.name.startswith("tutorial")}
EXAMPLES = {page.name: page.read_text(encoding="utf-8") for page in sorted((ROOT / "examples").glob("*.py"))}
# Robot files, and arms of one, are loaded by tests/description/test_examples_of_docs.py.
KINDS = {
    "manifest": "figures",
    "campaign": "runs",
    "tuning": "laws",
    "dispersions": "disperse",
    "experiment": "control_period",
    "sections": "reference",
    "robot": "base_mode",
    "arms": "arms",
    "variant": "base",
    "model": "payload",
    "faults": "faults",
    "supervision": "supervision",
    "plant": "plant",
}
# Pages whose commands need those before them.
IN_ORDER = ("benchmark.md", "campaigns.md", "compare.md", "replay.md", "reproduce.md", "tuning.md", "view.md")


def blocks(page: str, language: str) -> list[str]:
    """The fenced blocks of a language on a page."""
    return re.findall(rf"```{language}\n(.*?)```", PAGES[page], re.DOTALL)


def yaml_blocks(kind: str) -> list[str]:
    """All YAML blocks of a kind, the kind being the first of KINDS whose key they have."""
    found = []
    for page in PAGES:
        for text in blocks(page, "yaml"):
            keys = parse_yaml_text(text, page)
            if next((name for name, key in KINDS.items() if key in keys), "") == kind:
                found.append(text)
    return found


def test_every_block_is_of_a_kind_that_is_tried() -> None:
    """No YAML on a page is left untried: each is a file, or sections of one, of a kind that is tried."""
    tried = sum(len(yaml_blocks(kind)) for kind in KINDS)
    assert tried == sum(len(blocks(page, "yaml")) for page in PAGES)
    assert yaml_blocks("manifest")
    assert yaml_blocks("experiment")
    assert yaml_blocks("variant")
    assert yaml_blocks("sections")


@pytest.mark.parametrize(
    "text", [*yaml_blocks("experiment"), *yaml_blocks("variant")], ids=lambda text: text.splitlines()[0][:40]
)
def test_experiments_run_and_pass(tmp_path: Path, text: str) -> None:
    """An experiment copied from a page, whole or a variant of another one, runs and keeps what it expects."""
    (tmp_path / "copied.yaml").write_text(text, encoding="utf-8")
    result = run_experiment(load_experiment(str(tmp_path / "copied.yaml")), tmp_path / "bag", mode="headless")
    assert result.passed is not False, result.checks


@pytest.mark.parametrize("text", yaml_blocks("sections"), ids=lambda text: text.splitlines()[1].strip())
def test_sections_fit_an_experiment(text: str) -> None:
    """Sections copied from a page into an experiment compose."""
    base = {"robot": "mini", "control_period": 0.1, "duration": 1.0}
    experiment = experiment_from(base | parse_yaml_text(text, "docs"), "docs")
    assert compose(experiment).experiment.reference.kind in text


@pytest.mark.parametrize("text", yaml_blocks("plant"), ids=lambda text: text.splitlines()[1].strip())
def test_a_plant_changes_an_experiment(text: str) -> None:
    """A plant copied from a page into an experiment composes, and is another one."""
    base = {"robot": "mini", "control_period": 0.1, "duration": 1.0, "reference": {"kind": "hold"}}
    changed = compose(experiment_from(base | parse_yaml_text(text, "docs"), "docs")).experiment
    assert changed.plant != experiment_from(base, "docs").plant


def test_campaigns_and_their_sections_can_be_run(tmp_path: Path) -> None:
    """A campaign copied from a page, and sections copied into it, have cases that compose; one of them runs."""
    (whole,) = yaml_blocks("campaign")
    parts = yaml_blocks("dispersions")
    assert parts
    for text in (whole, *parts):
        path = tmp_path / "copied.yaml"
        data = parse_yaml_text(whole, "docs") | {"runs": 3, "expect": {}} | parse_yaml_text(text, "docs")
        path.write_text(dump_yaml(data), encoding="utf-8")
        assert check_cases(load_campaign(str(path)))
    outcome = run_case(make_case(load_campaign(str(path)), 0).data, "copied", "none")
    assert outcome.columns["completed"], outcome.columns


def test_tuning_files_can_be_used(tmp_path: Path) -> None:
    """A tuning file copied from a page, and those that are shipped, have searches that compose."""
    (text,) = yaml_blocks("tuning")
    (tmp_path / "copied.yaml").write_text(text, encoding="utf-8")
    for name in (str(tmp_path / "copied.yaml"), "tune_short", "tune_mini", "tune_servicer"):
        found = load_tuning(name)
        stands = make_stands(found)
        assert len(stands) == len(found.laws) * len(found.points)
        judge, _ = check_task(found, found.campaign(), stands[: len(found.laws)])
        assert judge.angles


def test_commands_of_the_tuning_page_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Search, go on with another budget, and go on; a few evaluations of a short task stand for the shipped one."""
    short = {"title": "t", "experiment": "compare/mini", "set": {"duration": 2.0, "reference.duration": 1.0}}
    laws = {"laws": {"pd": {"gains": {"bandwidth": 0.2}}}, "budget": 1, "draws": 1, "held_out": 1}
    (tmp_path / "short.yaml").write_text(dump_yaml(short | laws), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    lines = [line.replace("tune_short", "short.yaml") for line in shell_lines("tuning.md") if line]
    assert len(lines) == 3
    for line, more in zip(lines, ("", "--out runs/law", ""), strict=True):
        assert exit_code(f"{line.replace('--budget 40', '--budget 2')} --workers 1 {more}", monkeypatch) == 0, line


def test_commands_of_the_benchmark_page_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A short part, a law of the user's own, a part of the grid; a small set stands for the shipped one."""
    task = {"experiment": "compare/mini", "set": {"duration": 2.0, "reference.duration": 1.0}}
    rules = {"budget": 1, "draws": 1, "held_out": 1}
    data = {"version": 1, "rules": rules, "vary": {"control_period": [1.0]}, "tasks": {"move_mini": task}}
    short = {"tasks": ["move_mini"], "laws": ["pd"], "rules": rules}
    laws = {"laws": {"pd": {"gains": {"bandwidth": 0.2}}}, "short": short}
    (tmp_path / "small.yaml").write_text(dump_yaml(data | laws), encoding="utf-8")
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    lines = [line.replace("benchmark ", "benchmark small.yaml ") for line in shell_lines("benchmark.md") if line]
    assert len(lines) == 3
    for line, out in zip(lines, ("short", "law", "part"), strict=True):
        assert exit_code(f"{line} --workers 1 --out out/{out}", monkeypatch) == 0, line


def test_overrides_on_the_pages_work() -> None:
    """Every ``--set KEY=VALUE`` on a page changes the page's first experiment."""
    overrides = [found for text in PAGES.values() for found in re.findall(r"--set ([\w.]+=[\w.]+)", text)]
    assert overrides
    experiment = experiment_from(parse_yaml_text(yaml_blocks("experiment")[0], "docs"), "docs")
    assert compose(load_experiment("liu2023/fig08", overrides)).experiment != experiment


def test_python_on_the_pages_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python copied from a page runs where the run directory it speaks of is."""
    snippets = nonempty(text for page in PAGES for text in blocks(page, "python"))
    monkeypatch.chdir(tmp_path)
    for directory in {name for text in snippets for name in re.findall(r'"((?:runs|out)/[\w/]+)"', text)}:
        run_experiment(load_experiment("liu2023/fig08", ["duration=1.0"]), Path(directory), mode="headless")
    for text in snippets:
        # As in a notebook: what a snippet defines is of the running program.
        main = ModuleType("__main__")
        monkeypatch.setitem(sys.modules, "__main__", main)
        exec(compile(text, "docs", "exec"), vars(main))


def shell_lines(page: str) -> list[str]:
    """The commands of a page's shell blocks, without remarks."""
    return [line.split("#")[0].strip() for text in blocks(page, "sh") for line in text.splitlines()]


def commands() -> list[str]:
    """Every ``space-robot ...`` that a page or an example shows with arguments; some pages need an order."""
    shown = [found for text in PAGES.values() for found in re.findall(r"`(space-robot [a-z][^`\n]*)`", text)]
    # What belongs to other tools (ros2, colcon, pip) is tried by the tests of the installs.
    lines = [line for page in PAGES if page not in IN_ORDER for line in shell_lines(page)]
    # How a run ends whose processes are killed depends on the machine: tests/integration/test_failover.py.
    shown += [line for line in lines if line.startswith("space-robot") and "--chaos" not in line]
    return sorted(
        {*shown, *(line for text in EXAMPLES.values() for line in re.findall(r"^ +(space-robot .*)$", text, re.M))}
    )


def exit_code(line: str, monkeypatch: pytest.MonkeyPatch) -> object:
    """What a command line ends with."""
    monkeypatch.setattr(sys, "argv", shlex.split(line))
    with pytest.raises(SystemExit) as end:
        main()
    return end.value.code


@pytest.mark.parametrize("command", commands())
def test_commands_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    """A command copied from a page or an example exits with 0, placeholders filled in and a short run."""
    words = shlex.split(command)[1:]
    for name in ("examples", "config"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "my_robot.yaml").write_text(yaml_blocks("robot")[0], encoding="utf-8")
    (tmp_path / "my_paper.yaml").write_text(yaml_blocks("manifest")[0], encoding="utf-8")
    words = ["liu2023/fig08" if word == "FILE" else word for word in words]
    if words[0] == "run":
        words += ["--out", "bag"]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["space-robot", *words])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0


def test_commands_of_the_campaign_page_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run, go on, and run one case again; schedulers on other machines are tried in test_campaign.py."""
    monkeypatch.chdir(tmp_path)
    lines = [line for line in shell_lines("campaigns.md") if line.startswith("space-robot") and "tcp:" not in line]
    assert len(lines) == 3
    for line in lines:
        words = shlex.split(line.replace("FILE", "fig08_dispersed"))
        words += ["--runs", "3"] if "campaign" in words else ["--mode", "headless"]
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as end:
            main()
        assert end.value.code == 0, line


def test_commands_of_the_comparison_page_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run and show, run and write, and show what was run again."""
    small = {
        "experiment": "compare/mini",
        "set": {"duration": 2.0, "reference.duration": 1.0, "reference.joints_by_deg": 1},
        "runs": 1,
        "vary": {"controller.law": ["computed_torque", "pd"]},
    }
    (tmp_path / "small.yaml").write_text(dump_yaml(small), encoding="utf-8")
    (tmp_path / "runs").mkdir()
    monkeypatch.chdir(tmp_path)
    lines = [line for line in shell_lines("compare.md") if line]
    assert len(lines) == 3
    for line in lines:
        assert exit_code(line.replace("FILE", "small.yaml"), monkeypatch) == 0, line


def test_commands_of_the_reproduction_page_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything, a figure, the rest after an interruption, and all as JSON, of the manifest of the page."""
    (tmp_path / "my_paper.yaml").write_text(yaml_blocks("manifest")[0], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    lines = [line for line in shell_lines("reproduce.md") if line]
    assert [line.partition("my_paper.yaml")[2] for line in lines] == [
        "",
        " --figure 2 --workers 2",
        " --resume",
        " --json",
    ]
    for line in lines[:3]:
        assert exit_code(line, monkeypatch) == 0, line
    assert exit_code(f"{lines[3]} --resume", monkeypatch) == 0


def test_commands_of_the_replay_page_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run, replay, look and recover; what needs a second terminal is tried in test_replay_publish.py."""
    monkeypatch.chdir(tmp_path)
    lines = [line for line in shell_lines("replay.md") if line.startswith("space-robot") and "--publish" not in line]
    assert len(lines) == 6
    for line in lines:
        assert exit_code(line, monkeypatch) == (1 if "--set" in line else 0), line


def test_commands_of_the_page_on_seeing_work_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run and report, one run and a campaign; what is looked at while it lasts is tried in test_browser.py and live."""
    pytest.importorskip("plotly")
    monkeypatch.chdir(tmp_path)
    looking = re.compile(" view |--view|--foxglove")
    lines = [line for line in shell_lines("view.md") if line.startswith("space-robot") and not looking.search(line)]
    assert len(lines) == 6
    for line in lines:
        assert exit_code(line, monkeypatch) == 0, line
    assert (tmp_path / "runs" / "fig08.html").is_file()
    assert (tmp_path / "runs" / "mc.html").is_file()
