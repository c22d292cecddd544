"""A run in the tables of other tools: xarray, HTML, CSV, Parquet."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

import space_robot as sr
from space_robot_bringup.public.units import units_of
from tests.support.tool import Tool, refused


@pytest.fixture(scope="module")
def run() -> sr.Run:
    """A run of a few ticks."""
    return sr.run("liu2023/fig08", {"duration": 2.0})


def test_a_dataset_has_every_array_with_units_and_names(run: sr.Run) -> None:
    """Under the same name, with the same bits; joints, axes and units are said."""
    pytest.importorskip("xarray")
    data = run.to_xarray()
    assert {name for name, _, _ in run.arrays.variables()} == set(data.data_vars)
    for name, value, labels in run.arrays.variables():
        np.testing.assert_array_equal(data[name].to_numpy(), value if labels else value[:, 0])
    joint = data["joints.position"].sel(joint="joint2")
    np.testing.assert_array_equal(joint, run.arrays.joints.position[:, 1])
    assert joint.attrs["units"] == "rad"
    assert data["reference.joints.acceleration"].attrs["units"] == "rad/s2"
    assert data["command.torque"].sel(axis="z").attrs["units"] == "N m"
    assert data.time.attrs["units"] == "s"
    assert data["base.quaternion"].dims == ("time", "component")
    assert data.attrs["title"] == run.experiment.title
    without = {name for name in data.data_vars if "units" not in data[name].attrs}
    assert all(name.startswith("telemetry.") for name in without)


def test_a_joint_that_slides_has_the_units_of_lengths() -> None:
    """A robot with both kinds says both, and each column of a table its own."""
    urdf = """<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
    <joint name="turn" type="revolute"><parent link="a"/><child link="b"/></joint>
    <joint name="slide" type="prismatic"><parent link="b"/><child link="c"/></joint></robot>"""
    unit = units_of(sr.LogHeader("", urdf, 0, ("turn", "slide")))
    assert [unit("joints.velocity", joint) for joint in ("turn", "slide")] == ["rad/s", "m/s"]
    assert [unit("command.effort", joint) for joint in ("turn", "slide")] == ["N m", "N"]
    assert unit("telemetry.plant.energy", "") == ""


def test_a_notebook_shows_verdict_and_axes(run: sr.Run) -> None:
    """As tables; what a file says is text, never markup."""
    html = run._repr_html_()
    assert run.conclusion in html
    for name in ("completed", "momentum_residual", "base/pitch [deg]", "joint4 [deg]"):
        assert f"<td>{name}</td>" in html
    evil = sr.run("liu2023/fig08", {"duration": 0.5, "title": "<script>alert(1)</script>"})
    assert "<script>" not in evil._repr_html_()
    assert "&lt;script&gt;" in evil._repr_html_()


def test_a_table_of_text_has_the_bits_of_the_log(run: sr.Run, tmp_path: Path) -> None:
    """Read back from CSV every number is the one that was logged, whatever the length of the blocks."""
    place = sr.export(run, tmp_path / "run.csv")
    with place.open(newline="", encoding="utf-8") as stream:
        head, *rows = csv.reader(stream)
    assert head == ["time", "stamp", *(name for name, _ in run.arrays.columns())]
    read = np.array([[float(cell) for cell in row] for row in rows])
    np.testing.assert_array_equal(read[:, 0], run.arrays.time)
    for index, (_, value) in enumerate(run.arrays.columns(), start=2):
        np.testing.assert_array_equal(read[:, index], value)
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]


def test_a_parquet_table_says_its_units(run: sr.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same columns, typed, with the unit of each; a log in several blocks is one table."""
    pq = pytest.importorskip("pyarrow.parquet")
    blocks = sr.LogReader.blocks
    monkeypatch.setattr(sr.LogReader, "blocks", lambda log: blocks(log, 4))
    table = pq.read_table(sr.export(str(run.directory), str(tmp_path / "run.parquet")))
    columns = {"time": run.arrays.time, "stamp": run.arrays.stamp, **dict(run.arrays.columns())}
    assert table.column_names == list(columns)
    for name, value in columns.items():
        np.testing.assert_array_equal(table[name].to_numpy(), value)
    units = {field.name: field.metadata[b"unit"].decode() for field in table.schema}
    assert (units["time"], units["stamp"], units["base.acceleration.x"]) == ("s", "ns", "m/s2")
    assert units["joints.effort.joint1"] == "N m"


def test_a_table_never_replaces_another_silently(run: sr.Run, tmp_path: Path) -> None:
    """One error per mistake, and the file that was there stays."""
    (tmp_path / "there.csv").write_text("mine", encoding="utf-8")
    with pytest.raises(sr.SpaceRobotError, match=r"^out: is there already; got .*accepted: overwrite, or another"):
        sr.export(run, tmp_path / "there.csv")
    assert (tmp_path / "there.csv").read_text(encoding="utf-8") == "mine"
    assert sr.export(run, tmp_path / "there.csv", overwrite=True).stat().st_size > 1000
    with pytest.raises(sr.SpaceRobotError, match=r"^out: not a format of tables; got .*\.xlsx"):
        sr.export(run, tmp_path / "run.xlsx")
    with pytest.raises(sr.SpaceRobotError, match="cannot be written"):
        sr.export(run, tmp_path / "no" / "run.csv")


def test_the_command_writes_the_table_of_python(run: sr.Run, tmp_path: Path, space_robot: Tool) -> None:
    """Beside the run where nothing else is said; a second time only with --overwrite."""
    bag = tmp_path / "bag"
    bag.symlink_to(run.directory)
    sr.export(run, tmp_path / "wanted.csv")
    assert space_robot("export", "bag").returncode == 0
    assert (tmp_path / "bag.csv").read_bytes() == (tmp_path / "wanted.csv").read_bytes()
    refused(space_robot("export", "bag"), "--out", "bag.csv", "--overwrite")
    assert space_robot("export", "bag", "--overwrite").returncode == 0


@pytest.mark.parametrize(
    ("package", "call", "extra"),
    [
        ("xarray", lambda run, place: run.to_xarray(), "xarray"),
        ("pyarrow", lambda run, place: sr.export(run, place / "run.parquet"), "campaign"),
    ],
)
def test_a_missing_package_names_its_extra(
    run: sr.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: str, call: object, extra: str
) -> None:
    """One line that says what to install; nothing is written."""
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(sr.SpaceRobotError, match=rf"needs more packages .*space-robot\[{extra}\]"):
        call(run, tmp_path)  # type: ignore[operator]
    assert [*tmp_path.iterdir()] == []
