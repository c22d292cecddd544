"""`space_robot.sweep`, overrides of campaigns, and laws that only the running program knows."""

from __future__ import annotations

import gc
import linecache
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import space_robot as sr
from space_robot_control.laws.registry import law_class
from space_robot_control.laws.source import source_of
from space_robot_studies.engine import spawner
from tests.support.tool import Tool

pytest.importorskip("pyarrow")
pytest.importorskip("cloudpickle")
pytest.importorskip("pandas")
pytestmark = pytest.mark.xdist_group("campaign")

NAME, SHORT = "compare/mini", {"duration": 2.0, "reference.duration": 1.0, "reference.joints_by_deg": 1}
CELL = '''
import numpy as np
import space_robot as sr
from pydantic import Field

STIFFNESS = 0.5

def pull(error):
    return STIFFNESS * error

class Typed(sr.Law):
    """A law of a notebook cell."""

    class Gains(sr.Law.Gains):
        """Its gain."""

        damping: float = Field(default=1.0, ge=0.0, description="[N m s]")

    def compute(self, state, reference):
        error = sr.tracking_errors(state, reference).configuration
        u = np.zeros(6 + self.n)
        u[6:] = pull(error[6:]) - self.gains.damping * state.v[6:]
        return u, {}
'''


@pytest.fixture
def cell(monkeypatch: pytest.MonkeyPatch) -> type[sr.Law]:
    """The class of a law that was typed into a notebook."""
    main = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", main)
    monkeypatch.setitem(linecache.cache, "<cell>", (len(CELL), None, CELL.splitlines(keepends=True), "<cell>"))
    exec(compile(CELL, "<cell>", "exec"), vars(main))
    law: type[sr.Law] = main.Typed
    return law


def test_each_case_of_a_sweep_is_the_run_with_these_values() -> None:
    """To the bit, for every combination and every seed; the directory exists as long as the result."""
    gains, seeds = [0.5, np.float64(1.5)], [7, 8]
    noisy = SHORT | {"seed": 7, "plant.sensors.attitude.noise": 1e-4}
    spec = sr.load_experiment(NAME, noisy)
    done = sr.sweep(spec, {"controller.law": ["pd"], "duration": gains}, runs=2, workers=2)
    table = done.to_pandas()
    assert (done.done, len(table), done.end_reason) == (4, 4, "completed")
    for index, row in table.iterrows():
        seed, duration = seeds[int(index) // 2], float(gains[int(index) % 2])
        assert (row["seed"], row["duration"]) == (seed, duration)
        run = sr.run(NAME, noisy | {"seed": seed, "controller.law": "pd", "duration": duration})
        assert run.metrics is not None
        for name, value in run.metrics.flat().items():
            assert row.get(name) == value or (value is None and not np.isfinite(row.get(name) or np.nan))
    place = done.directory
    assert place.is_dir()
    del done
    gc.collect()
    assert not place.exists()


def test_a_law_of_a_notebook_cell_runs_replays_and_sweeps(
    cell: type[sr.Law], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """As a class or by its name; in processes that never saw the cell it gives the same numbers."""
    changes = SHORT | {"controller.law": cell}
    run = sr.run(NAME, changes)
    assert run.experiment.controller.law == "__main__:Typed"
    assert run.log.header.laws["__main__:Typed"].text == CELL
    assert sr.replay(run).equal
    assert sr.run(NAME, SHORT | {"controller.law": "__main__:Typed"}).log.path.read_bytes() == run.log.path.read_bytes()
    # A notebook's kernel has several threads: nothing is forked, workers start as new interpreters.
    monkeypatch.setattr(spawner, "_single_threaded", lambda: False)
    assert run.metrics is not None
    done = sr.sweep(NAME, {"controller.law": {"mine": cell, "pd": "pd"}}, SHORT, workers=1)
    mine = done.to_pandas().set_index("controller.law").loc["mine"]
    assert mine["end_reason"] == "completed"
    assert mine["effort_integral"] == run.metrics.flat()["effort_integral"]
    (tmp_path / "few.yaml").write_text(f"experiment: {NAME}\nruns: 1\n", encoding="utf-8")
    few = sr.campaign(tmp_path / "few.yaml", changes, out=tmp_path / "few", workers=1)
    assert few.to_pandas()["effort_integral"].tolist() == [mine["effort_integral"]]


def test_the_source_of_a_law_in_a_cell_is_that_of_its_own_functions(monkeypatch: pytest.MonkeyPatch) -> None:
    """A law that inherits `compute` from a shipped one is not logged with the text of that one."""
    text = "def reset(self):\n    super(type(self), self).reset()\n"
    monkeypatch.setitem(linecache.cache, "<other>", (len(text), None, text.splitlines(keepends=True), "<other>"))
    monkeypatch.setitem(sys.modules, "__main__", ModuleType("__main__"))
    own: dict[str, object] = {"__module__": "__main__"}
    shipped = law_class("pd")
    assert source_of(type("Same", (shipped,), dict(own))) is None
    exec(compile(text, "<other>", "exec"), own)
    found = source_of(type("Other", (shipped,), own))
    assert found is not None
    assert found.text == text


def test_where_a_law_of_this_program_cannot_be_is_said(cell: type[sr.Law], tmp_path: Path) -> None:
    """Processes of a graph, other machines, and classes that no name leads to."""
    changes = SHORT | {"controller.law": cell}
    with pytest.raises(sr.SpaceRobotError, match=r"^controller\.law: is known to this program only; .*mode headless"):
        sr.run(NAME, changes, mode="processes", out=tmp_path / "run")
    (tmp_path / "few.yaml").write_text(f"experiment: {NAME}\nruns: 1\n", encoding="utf-8")
    with pytest.raises(sr.SpaceRobotError, match=r"^controller\.law: is known to this program only; .*FILE\.py:Class"):
        sr.campaign(tmp_path / "few.yaml", changes, out=tmp_path / "few", scheduler="tcp://127.0.0.1:1")

    class Hidden(cell):  # type: ignore[misc,valid-type]
        """Of a function."""

    with pytest.raises(sr.SpaceRobotError, match=r"^controller\.law: is defined inside a function"):
        sr.run(NAME, SHORT | {"controller.law": Hidden})


def test_a_campaign_takes_overrides_as_a_run_does(tmp_path: Path, space_robot: Tool) -> None:
    """As mapping, texts or options; gains given beside a law are meant for it, in whatever order."""
    text = f"experiment: {NAME}\nruns: 1\nset: {{duration: 2.0, reference.duration: 1.0}}\n"
    (tmp_path / "few.yaml").write_text(text, encoding="utf-8")
    overrides = {"controller.gains.damping": 0.8, "controller.law": "pd", "reference.joints_by_deg": 1}
    done = sr.campaign(tmp_path / "few.yaml", overrides, out=tmp_path / "python", workers=1)
    options = [word for key, value in overrides.items() for word in ("--set", f"{key}={value}")]
    assert space_robot("campaign", "few.yaml", "--out", "cli", "--workers", "1", *options).returncode == 0
    for name in ("resolved.yaml", "table.parquet"):
        assert (tmp_path / "cli" / name).read_bytes() == (done.directory / name).read_bytes()
    with pytest.raises(sr.SpaceRobotError, match=r"no_such_key"):
        sr.campaign(tmp_path / "few.yaml", ["no_such_key=1"], out=tmp_path / "no")


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        (["controller.gains.lambda"], r"^vary: not a mapping"),
        ({"controller.gains.lamda": [1.0]}, r"lamda"),
        ({"duration": []}, r"vary\.duration has no value"),
    ],
)
def test_a_sweep_that_cannot_be_run_is_one_error(vary: object, said: str) -> None:
    """Before anything is run."""
    with pytest.raises(sr.SpaceRobotError, match=said):
        sr.sweep(NAME, vary, SHORT)  # type: ignore[arg-type]
