"""One page per log or campaign: offline, complete, small, and also of what is left of a corrupted log."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("plotly")

from space_robot_bringup.logs.assessed import read_judged
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from space_robot_report.pages.log_report import write_log_report
from tests.support.report_pages import data_of, own_markup, recorded, unpacked
from tests.support.tool import Tool, refused

MAX_BYTES = 10_000_000


@pytest.fixture(scope="module")
def page(bag: Path) -> str:
    out = bag.with_name("fig08.html")
    write_log_report(bag, out)
    return out.read_text(encoding="utf-8")


def test_a_page_needs_nothing_else(page: str) -> None:
    """No element of the page loads another file or asks a server."""
    assert not re.search(r"<(link|img|iframe|script)[^>]*(src|href)=", page.split("<body>")[0] + own_markup(page))
    assert "url(" not in own_markup(page)
    assert not re.search(r"<script[^>]+src=", page)


def test_a_page_has_verdict_bounds_axes_claims_and_provenance(page: str) -> None:
    """Verdict, bounds, axes, the paper's words with their verdict, and provenance are on the page."""
    text = own_markup(page)
    for words in ("PASS", "base/roll.settling_time", "6 +- 1", "momentum_residual", "joint4 [deg]"):
        assert words in text
    for words in ("Orientation process under real inertial parameters", "is demonstrated in", "reproduce liu2023"):
        assert words in text
    for words in ("headless", "version of numpy", "law: adaptive", "completed"):
        assert words in text


def test_every_block_of_telemetry_is_drawn_under_its_name(bag: Path, page: str) -> None:
    """What the law shows is there, block by block, with the numbers of the log; what never changes is a line."""
    arrays = read_judged(bag).arrays
    titles = re.findall(r'<h3>(.*?)</h3>\n(?:<p class="soft">.*?</p>\n)?<div class="plot" data-plot="(\d+)">', page)
    numbers = {title: int(number) for title, number in titles}
    figures = data_of(page, "plots")
    assert isinstance(figures, list)
    moving = {label: block for label, block in arrays.controller.items() if (block != block[:1]).any()}
    assert set() < set(moving) <= numbers.keys()
    still = set(arrays.controller) - set(moving)
    assert still.isdisjoint(numbers)
    assert still <= set(re.findall(r"<tr><td>(\w+)</td><td>[-\d]", page))
    for label, block in moving.items():
        traces = figures[numbers[label]]["data"]
        assert len(traces) == block.shape[1]
        np.testing.assert_array_equal(unpacked(traces[0]["y"]), block[:, 0].astype("<f4"))


def test_the_playback_stands_where_the_log_says(bag: Path, page: str) -> None:
    """The base of the 3-D playback is at the true poses, tick by tick, and every part belongs to a body."""
    scene, arrays = data_of(page, "scene"), read_judged(bag).arrays
    assert isinstance(scene, dict)
    poses = unpacked(scene["poses"]).reshape(-1, scene["bodies"], 7)
    np.testing.assert_allclose(poses[:, 0], arrays.plant["true_configuration"][:, :7], atol=1e-6)
    assert all(0 <= part["body"] < scene["bodies"] for part in scene["parts"])
    assert len(scene["parts"]) == 7


def test_changes_during_the_run_are_on_the_page(bag: Path, tmp_path: Path) -> None:
    """Gains changed and laws switched during the run stand on the page with their time, and are marked in the plots."""
    reader = LogReader(bag)
    sink = LogSink(tmp_path / "run", reader.header)
    for tick in reader.ticks():
        event = ControllerEvent(tick.stamp, "parameters", {"values": {"gains.kappa": 1.5}})
        events = (event,) if tick.stamp == 5_000_000_000 else ()
        sink.record(replace(tick, output=replace(tick.output, events=events)))
    sink.close("completed")
    write_log_report(tmp_path / "run", tmp_path / "run.html")
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert "What happened" in own_markup(page)
    assert "gains.kappa" in own_markup(page)
    assert data_of(page, "marks") == [5.0]


# What their sources name: "Table 1", "Fig. 6-9", "Sec. V, Fig. 1", no figure at all.
FIGURES = {
    "song2023/pccs": ["table1"],
    "song2023/attitude_6_85": ["6-9"],
    "giordano2023/sec5": ["1b", "1c"],
    "song2023/servicer": [],
}


@pytest.mark.parametrize("name", FIGURES)
def test_other_plants_and_robots_have_pages(tmp_path: Path, name: str) -> None:
    """Testbeds, captured debris and free-flying robots are drawn and played, and belong to figures of their papers."""
    bag = recorded(tmp_path / "run", name, "duration=2.0", "expect={}")
    judged = write_log_report(bag, tmp_path / "run.html")
    assert judged.troubles == ()
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    scene = data_of(page, "scene")
    assert isinstance(scene, dict)
    assert scene["parts"]
    named = re.findall(r"space-robot reproduce \w+ --figure ([\w.-]+)", own_markup(page))
    assert named == FIGURES[name]


STICKS = """<robot name="sticks"><link name="hull">{inertial}</link><link name="arm">{inertial}</link>
<link name="hand">{inertial}</link>
<joint name="a" type="revolute"><origin xyz="0.5 0 0"/><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="b" type="prismatic"><origin xyz="0 0.7 0"/><parent link="arm"/><child link="hand"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
ROBOT = """
name: sticks
urdf: sticks.urdf
base_mode: free_floating
actuators: {joints: {effort: 1.0}, base_torque: {kind: ideal, limit: [1, 1, 1]}}
"""
EXPERIMENT = (
    "{robot: sticks.yaml, control_period: 0.5, duration: 1.0, reference: {kind: step, attitude_deg: [5, 0, 0]}}"
)


def test_a_robot_without_visuals_is_drawn_as_sticks(space_robot: Tool, tmp_path: Path) -> None:
    """A URDF that says nothing of its looks is played as sticks between its joints, prismatic ones too."""
    (tmp_path / "sticks.urdf").write_text(STICKS.format(inertial=INERTIAL))
    (tmp_path / "sticks.yaml").write_text(ROBOT)
    (tmp_path / "mine.yaml").write_text(EXPERIMENT)
    space_robot("run", "mine.yaml", "--out", "bag")
    assert space_robot("report", "bag").returncode == 0
    scene = data_of((tmp_path / "bag.html").read_text(encoding="utf-8"), "scene")
    assert isinstance(scene, dict)
    assert [part["body"] for part in scene["parts"]] == [0, 1]
    np.testing.assert_allclose(unpacked(scene["axes"]).reshape(-1, 3), [[0, 0, 1], [0, 1, 0]], atol=1e-7)


def test_run_view_serves_the_log_of_the_run(space_robot: Tool, monkeypatch: pytest.MonkeyPatch) -> None:
    """``run --view`` runs, prints the verdict, then serves the log at the port asked for."""
    shown = []
    monkeypatch.setattr(
        "space_robot_cli.run_command.show_log", lambda log, **options: shown.append((str(log), options))
    )
    done = space_robot("run", "liu2023/fig08", "--out", "bag", "--view", "--port", "9000", "--no-browser")
    assert done.returncode == 0
    assert "PASS" in done.stdout
    assert shown == [("bag", {"port": 9000, "open_browser": False, "meshes": []})]


@pytest.mark.slow
def test_a_long_run_makes_a_small_page(tmp_path: Path) -> None:
    """A run of 150 s of the robot with the finest meshes gives a page below 10 MB."""
    out = tmp_path / "panda.html"
    bag = recorded(tmp_path / "panda", "point_to_point/panda_sat", "duration=150.0", "expect={}")
    assert write_log_report(bag, out).arrays.time[-1] == 150.0
    assert out.stat().st_size < MAX_BYTES


def test_texts_of_a_log_stay_texts(tmp_path: Path) -> None:
    """A title with markup is shown as it is written; it closes no element and starts no script."""
    evil = "</script><script>alert(1)</script><b>"
    bag = recorded(tmp_path / "run", "liu2023/fig08", f"title='{evil}'", "duration=1.0", "expect={}")
    out = tmp_path / "run.html"
    write_log_report(bag, out)
    page = out.read_text(encoding="utf-8")
    assert "alert(1)</script>" not in page
    assert "&lt;/script&gt;&lt;script&gt;alert(1)" in page


def test_the_command_writes_a_page_and_refuses_in_one_line(space_robot: Tool, bag: Path, tmp_path: Path) -> None:
    """``report`` exits 0 and names the page; what is no log, and a page that cannot be written, exit 2."""
    done = space_robot("report", str(bag), "-o", "page.html")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "page.html").stat().st_size < MAX_BYTES
    refused(space_robot("report", "nothing"), "nothing")
    refused(space_robot("report", "/"), "not a run directory")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    refused(space_robot("report", "loop"), "loop")
    refused(space_robot("report", str(bag), "-o", str(tmp_path)), "--out")
    refused(space_robot("report", str(bag), "-o", "no/such/place.html"), "place.html")
    (tmp_path / "text.mcap").write_text("no log")
    refused(space_robot("report", "text.mcap"), "not an MCAP file")


@pytest.mark.parametrize(
    ("missing", "command", "extra"), [("viser", "view", "view"), ("plotly", "report", "viz,campaign")]
)
def test_a_missing_optional_package_is_named(bag: Path, missing: str, command: str, extra: str) -> None:
    """Without viser or plotly the command exits 2 with one line that says what to install."""
    hide = f"import sys; sys.modules[{missing!r}] = None; sys.argv[1:] = [{command!r}, {str(bag)!r}]"
    code = f"{hide}; from space_robot_cli.main import main; main()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    refused(done, missing, f"space-robot[{extra}]")


def test_the_viewer_refuses_what_is_no_log_in_one_line(space_robot: Tool, tmp_path: Path) -> None:
    """``view`` of nothing, and of a file that is no log, exits 2 before anything is served."""
    pytest.importorskip("viser")
    refused(space_robot("view", "nothing", "--no-browser"), "nothing")
    (tmp_path / "text.mcap").write_text("no log")
    refused(space_robot("view", "text.mcap", "--no-browser"), "not an MCAP file")


CAMPAIGN = """
title: test
experiment: liu2023/fig08
set: {duration: 4.0, expect: {base/pitch.max_error: {max: 6.0}}}
runs: 6
seed: 2
disperse:
  initial.attitude_deg: {rotation: {max_deg: 20}}
vary:
  plant.delay_periods: [0, 1]
"""


def test_a_campaign_has_a_page(space_robot: Tool, tmp_path: Path) -> None:
    """Rates with intervals, spreads, failures with their reason, and a command for each case are on the page."""
    pytest.importorskip("distributed")
    (tmp_path / "test.yaml").write_text(CAMPAIGN)
    space_robot("campaign", "test.yaml", "--out", "mc", "--workers", "1")
    done = space_robot("report", "mc")
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "mc.html").read_text(encoding="utf-8")
    text = own_markup(page)
    rows = [json.loads(line) for line in (tmp_path / "mc" / "rows.jsonl").read_text().split("\n")[1:-1]]
    failed = [row["columns"]["index"] for row in rows if not row["columns"]["passed"]]
    assert 0 < len(failed) < 12
    for index in failed:
        assert f"space-robot run --from mc --index {index}" in text
    assert "plant.delay_periods=1" in text
    assert "95 % interval" in text
    assert "base/pitch.max_error" in text
    figures = data_of(page, "plots")
    assert isinstance(figures, list)
    assert {trace["type"] for figure in figures for trace in figure["data"]} == {"box"}
