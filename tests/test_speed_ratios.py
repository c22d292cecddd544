"""Nothing becomes twice as slow unseen: ratios of CPU times of one run, with a factor of two to spare, no times.

What they are today is on the page of speed; a neighbour's load moves both sides of a ratio alike.
"""

from __future__ import annotations

import pytest

pytest.importorskip("numba")
from benchmarks.bench_fused import measured
from benchmarks.bench_log import beside_mcap, made_ticks
from benchmarks.bench_start import MODELS, cpu_seconds
from space_robot_description.kernel import jit
from space_robot_description.kernel.lanes import LANES

SPARE = 2.0
# How many times the CPU time of the loop: one compiled call, and the lanes of AVX2.
ONE_CALL, SIDE_BY_SIDE = 3.0, 6.5
# Commands, and how many times the CPU time of importing NumPy and pydantic they take.
STARTS = {"--version": 1.2, "list": 1.8, "schema": 1.3, "check liu2023/fig08": 3.9}


def test_a_log_is_written_as_fast_beside_the_writer_of_mcap() -> None:
    """Values to an indexed file, against mcap's own writer that gets the same messages as bytes."""
    ratios = beside_mcap(made_ticks(300), 3)
    assert ratios["log: write and close, times the speed of mcap's writer, zstd"] > 0.75 / SPARE


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_the_graph_is_as_fast_beside_the_bare_transport_of_its_messages() -> None:
    """One process, recorder included, against three nodes that pass on the same messages and look at none."""
    pytest.importorskip("rclpy")
    from benchmarks.bench_graph import beside_bare

    assert beside_bare(300, 2) > 0.15 / SPARE


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_the_hops_of_a_tick_go_round_without_what_is_computed() -> None:
    """What rclpy alone takes for a tick is measured on the same ways: ten messages, nineteen times taken."""
    pytest.importorskip("rclpy")
    from benchmarks.bench_graph import hops

    seen = list[int]()
    taken = hops(3, seen.append)
    assert seen == [1, 2, 3]
    assert taken == {"recorder": 10, "controller": 6, "guidance": 1, "simulator": 2}


def test_commands_start_as_fast_beside_what_they_have_to_load() -> None:
    """Version, list, schema and check."""
    seconds = cpu_seconds(STARTS, 2)
    assert {
        name: seconds[name] / seconds[MODELS]
        for name in STARTS
        if seconds[name] > SPARE * STARTS[name] * seconds[MODELS]
    } == {}


@pytest.mark.skipif(not jit.MACHINE_CODE, reason="without a compiler every run is the loop")
def test_runs_are_as_fast_in_one_call_and_side_by_side_beside_the_loop() -> None:
    """Terminal sliding mode on eight joints: parts, reference and records included."""
    ratios = measured("giordano2023/sec5", (), 300, 3)
    assert ratios["loop over one call"] > ONE_CALL / SPARE
    assert ratios[f"loop over {LANES} lanes"] > SIDE_BY_SIDE / SPARE
