"""What a person sees: the page of a run and the viewer, in a headless Chromium, with play clicked."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from html import escape
from io import BytesIO
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pytest

playwright = pytest.importorskip("playwright.sync_api")
image = pytest.importorskip("PIL.Image")
pytest.importorskip("viser")

from space_robot_bringup.experiment.experiment import experiment_from, experiment_path  # noqa: E402
from space_robot_bringup.modes.run import run_experiment  # noqa: E402
from space_robot_description.load import load_robot  # noqa: E402
from space_robot_description.validation import parse_yaml  # noqa: E402
from space_robot_msgs_py.codec.codecs import SupervisionCodec, encode_statuses  # noqa: E402
from space_robot_msgs_py.events import ERROR, DiagnosticEvent  # noqa: E402
from space_robot_msgs_py.interfaces import Supervision  # noqa: E402
from space_robot_msgs_py.log.reader import LogReader  # noqa: E402
from space_robot_msgs_py.topics import EVENTS, PLANT_TELEMETRY, SUPERVISOR_MODE, TABLE  # noqa: E402
from space_robot_report.live.brief import Brief  # noqa: E402
from space_robot_report.live.feed import Feed  # noqa: E402
from space_robot_report.pages.log_report import write_log_report  # noqa: E402
from space_robot_report.viewer.live import LiveViewer  # noqa: E402
from tests.support.hostile import with_experiment, with_header  # noqa: E402

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = [
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.xdist_group("browser"),
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine"),
]

# Software rendering: the machine of a test has no graphics card.
ARGUMENTS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
DEADLINE = 120.0
MOVED = 300


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    """One for all tests: it takes seconds to start."""
    with playwright.sync_playwright() as driver:
        program = driver.chromium.launch(executable_path=CHROMIUM, headless=True, args=list(ARGUMENTS))
        try:
            yield program
        finally:
            program.close()


@pytest.fixture
def browser(chromium: Any) -> Iterator[Any]:
    """A page of a profile of its own; an error of a script fails the test."""
    profile = chromium.new_context(viewport={"width": 720, "height": 480})
    errors: list[str] = []
    page = profile.new_page()
    page.set_default_timeout(1000.0 * DEADLINE)
    page.on("pageerror", lambda error: errors.append(str(error)))
    try:
        yield page
    finally:
        profile.close()
    assert errors == []


def pixels(shown: Any) -> np.ndarray:
    """A screenshot as numbers."""
    return np.asarray(image.open(BytesIO(shown.screenshot())).convert("RGB")).astype(int)


def moved(first: np.ndarray, second: np.ndarray) -> int:
    """How many pixels are plainly another color."""
    return int((np.abs(first - second).max(axis=2) > 40).sum())


def eventually(holds: Callable[[], bool], page: Any, what: str) -> None:
    """Wait until it holds."""
    deadline = monotonic() + DEADLINE
    while not holds():
        assert monotonic() < deadline, f"waited in vain for {what}"
        page.wait_for_timeout(100)


def still(shown: Any, page: Any) -> np.ndarray:
    """A screenshot of what no longer changes by itself."""
    last = [pixels(shown)]

    def settled() -> bool:
        page.wait_for_timeout(150)
        last.append(pixels(shown))
        return moved(last[-2], last[-1]) == 0 and len(np.unique(last[-1].reshape(-1, 3), axis=0)) > 50

    eventually(settled, page, "a still picture")
    return last[-1]


def test_the_page_of_a_run_plays(bag: Path, tmp_path: Path, browser: Any) -> None:
    """On the page of a log, play moves robot, slider and clock, pause stops them, and plots follow the time."""
    out = tmp_path / "page.html"
    write_log_report(bag, out)
    browser.goto(out.as_uri())
    canvas = browser.locator("#view")
    before = still(canvas, browser)
    browser.locator("#speed").select_option("2")
    browser.locator("#play").click()
    eventually(lambda: float(browser.locator("#clock").inner_text().split()[0]) > 3.0, browser, "3 s of playback")
    browser.locator("#play").click()
    after = still(canvas, browser)
    assert moved(before, after) > MOVED
    assert browser.locator("#play").inner_text() == "Play"
    assert float(browser.locator("#slider").input_value()) > 3.0
    browser.get_by_role(
        "heading", name="Base attitude, Euler angles R = Rz Ry Rx [deg]", exact=True
    ).scroll_into_view_if_needed()
    eventually(lambda: browser.locator(".plot .main-svg").count() > 2, browser, "plots")


def test_a_click_into_a_plot_goes_to_its_time(bag: Path, tmp_path: Path, browser: Any) -> None:
    """The playback jumps to the time that was clicked in a plot."""
    out = tmp_path / "page.html"
    write_log_report(bag, out)
    browser.goto(out.as_uri())
    plot = browser.locator(".plot").nth(3)
    plot.scroll_into_view_if_needed()
    eventually(lambda: plot.locator(".nsewdrag").count() > 0, browser, "a plot")
    plot.locator(".nsewdrag").first.click(position={"x": 300, "y": 100})
    eventually(lambda: float(browser.locator("#slider").input_value()) > 5.0, browser, "the time of the click")


IMAGE = '<img src="x" onerror="window.ran=1">'
SCRIPT = "<script>window.ran=1</script>"
HOSTILE = f"{IMAGE}{SCRIPT}{{window.ran=1}} ![](/etc/passwd) [a](javascript:window.ran=1) `</code>{IMAGE}"
JOINT = "<img src=x onerror=window.ran=1>"


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag that tries to run a script from everything it says: name, title, source, law, end, joints."""
    folder = tmp_path_factory.mktemp("hostile")
    robot = dict(load_robot("mini").resolved)
    robot["urdf"] = robot["urdf"].replace('"joint1"', f'"{escape(JOINT)}"')
    content = parse_yaml(experiment_path("liu2023/fig08")) | {"robot": robot, "expect": {}, "duration": 1.0}
    content["initial"], content["reference"] = {}, {"kind": "step", "attitude_deg": [10, 0, 0]}
    run_experiment(experiment_from(content, "hostile"), folder / "run", mode="headless")

    def edit(data: dict[str, Any]) -> None:
        data |= {"title": HOSTILE, "source": HOSTILE}
        data["controller"]["standby"] = {f"{HOSTILE} 2": {"law": "none"}}
        data["controller"]["law"] = HOSTILE

    bag = with_experiment(folder / "run", folder / JOINT, edit)
    header = LogReader(bag).header
    return with_header(bag, folder / "again" / JOINT, header, reason=HOSTILE)


def test_the_page_of_a_hostile_log_shows_its_texts_and_runs_nothing(
    hostile: Path, tmp_path: Path, browser: Any
) -> None:
    """Titles, names and reasons of a log are text on its page: no script of theirs runs, nothing is fetched."""
    fetched: list[str] = []
    browser.on("request", lambda request: fetched.append(request.url))
    out = tmp_path / "page.html"
    write_log_report(hostile, out)
    browser.goto(out.as_uri())
    assert browser.locator("h1").inner_text() == HOSTILE
    for place in browser.locator(".plot").all():
        place.scroll_into_view_if_needed()
    eventually(lambda: browser.locator(".legendtext").filter(has_text=JOINT).count() > 0, browser, "a legend")
    assert browser.evaluate("window.ran") is None
    assert [url for url in fetched if not url.startswith(("file:", "data:", "blob:"))] == []
    assert len([url for url in fetched if url.startswith("file:")]) == 1


def test_the_viewer_of_a_hostile_log_shows_its_texts_and_runs_nothing(hostile: Path, browser: Any) -> None:
    """Title, law and reason of a log are text in the viewer: no script of theirs runs, no file of theirs is read."""
    with viewer(hostile) as (address, _):
        browser.goto(address)
        browser.get_by_role("button", name="Play").wait_for()
        browser.get_by_text(HOSTILE).first.wait_for()
        assert browser.locator("img[src=x]").count() == 0
        assert browser.evaluate("window.ran") is None


@contextmanager
def viewer(bag: Path) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """``space-robot view`` and its address."""
    command = [sys.executable, "-m", "space_robot_cli", "view", str(bag), "--no-browser", "--port", "18231"]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None
        found = re.search(r"http://localhost:\d+", child.stdout.readline())
        assert found is not None, child.stderr.read() if child.stderr else ""
        yield found.group(), child
    finally:
        child.kill()
        child.communicate()


def test_the_viewer_plays_and_ends_cleanly(bag: Path, browser: Any) -> None:
    """In the viewer, play moves the robot and the slider; Ctrl-C ends it with exit 0 and no word on stderr."""
    with viewer(bag) as (address, child):
        browser.goto(address)
        button = browser.get_by_role("button", name="Play")
        button.wait_for()
        canvas = browser.locator("canvas").first
        before = still(canvas, browser)
        # Forced: drawn in software, the page is too busy to be found at rest.
        button.click(force=True)
        time = browser.locator("input[type=text]").first
        eventually(lambda: float(time.input_value()) > 2.0, browser, "2 s of playback")
        assert moved(before, pixels(canvas)) > MOVED
        browser.get_by_role("button", name="Pause").click(force=True)
        browser.get_by_role("button", name="Play").wait_for()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=DEADLINE)
    assert (child.returncode, out, err) == (0, "", "")


def test_a_run_is_shown_while_it_goes_on_and_its_texts_are_text(hostile: Path, browser: Any) -> None:
    """Time and robot move with the messages; names, modes and events run no script and name no file that is read."""
    log = LogReader(hostile)
    header = log.header
    brief = Brief(HOSTILE, HOSTILE, header.joint_names, header.urdf, ("events", "supervisor/mode"), view=18232)
    feed = Feed(brief)
    event = DiagnosticEvent(0, ERROR, HOSTILE, HOSTILE, HOSTILE, ((HOSTILE, HOSTILE),))
    mode = SupervisionCodec().encode(Supervision(0, HOSTILE, "law", "reference", 0, -1))
    said = [(EVENTS.name, encode_statuses([event])), (SUPERVISOR_MODE.name, mode)]
    said += [(name, data) for name, _, data in log.messages()]
    with closing(LiveViewer(brief)) as shown:
        browser.goto(shown.address)
        browser.get_by_text("waits for the first state").wait_for()
        for name, data in said:
            topic = next(one for one in TABLE if one.name == name)
            for message in feed.read(topic, data) if topic in feed.topics else ():
                shown.say(*message)
            if name == PLANT_TELEMETRY.name:
                shown.draw(feed)
        browser.get_by_text("time 1.00 s").wait_for()
        browser.get_by_text(HOSTILE).first.wait_for()
        assert browser.locator("img[src=x]").count() == 0
        assert browser.evaluate("window.ran") is None
