"""The bits of a run do not depend on the processor, on BLAS, or on the C library's sine."""

from __future__ import annotations

import platform

import pytest

from space_robot_description.kernel import jit
from tests.support.compiled_runs import LAWS
from tests.support.processors import COMPILED, INTERPRETED, LIKE_HERE, digests, digests_elsewhere

pytestmark = [
    pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="tells glibc which instructions to leave alone"),
    pytest.mark.skipif(not jit.MACHINE_CODE, reason="compares compiled code of here"),
]
ALL = range(len(LAWS))


def test_an_old_processor_gives_the_same_bits() -> None:
    """States, commands and telemetry of all laws do not change where glibc, BLAS and NumPy have no AVX and no FMA."""
    assert digests_elsewhere(ALL, LIKE_HERE) == digests(ALL)


@pytest.mark.slow
def test_plain_python_gives_the_same_bits() -> None:
    """Nor where nothing is compiled; the short form has compiled kernels, which other tests compare with Python."""
    assert digests_elsewhere(ALL, INTERPRETED, ticks=4) == digests(ALL, ticks=4)


@pytest.mark.slow
def test_kernels_compiled_for_an_old_processor_give_the_same_bits() -> None:
    """Two draws of everything; the short form has kernels compiled for the processor that is there."""
    seeds = range(2 * len(LAWS))
    assert digests_elsewhere(seeds, COMPILED) == digests(seeds)
