"""What runs come to, as digests: computed here, and in a process that believes it has an old processor."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from space_robot_bringup.modes.headless import write_bag
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_msgs_py.log.reader import LogReader
from tests.support.compiled_runs import TICKS, case, looped
from tests.support.paths import ROOT

# No AVX and no FMA, for the C library, BLAS and NumPy.
OLD = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA",
    "OPENBLAS_CORETYPE": "Nehalem",
    "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F AVX512_SKX",
}
# Kernels as they are here; in Python; compiled for a processor of 2008.
LIKE_HERE: dict[str, str] = {}
INTERPRETED = {"NUMBA_DISABLE_JIT": "1"}
COMPILED = {"NUMBA_CPU_NAME": "nehalem", "NUMBA_CPU_FEATURES": ""}


def digests(seeds: Sequence[int], ticks: int = TICKS) -> dict[str, str]:
    """Of every array and every topic of the random runs of these seeds, see ``compiled_runs.case``."""
    found = {}
    for seed in seeds:
        composition = case(seed, ticks)
        sink, name = looped(composition), f"{seed} {composition.experiment.controller.law}"
        arrays = sink.arrays
        for field in fields(LogArrays):
            value = getattr(arrays, field.name)
            for label, array in value.items() if isinstance(value, dict) else (("", value),):
                if array is not None:
                    found[f"{name} {field.name} {label}"] = hashlib.sha256(array.tobytes()).hexdigest()
        with tempfile.TemporaryDirectory() as scratch:
            write_bag(sink, composition, Path(scratch) / "run")
            topics: defaultdict[str, Any] = defaultdict(hashlib.sha256)
            for topic, _, data in LogReader(Path(scratch) / "run").messages():
                topics[topic].update(data)
        found |= {f"{name} {topic}": digest.hexdigest() for topic, digest in topics.items()}
    return found


def digests_elsewhere(seeds: Sequence[int], how: dict[str, str], ticks: int = TICKS) -> dict[str, str]:
    """The same in a process with an old processor."""
    code = (
        f"import json; from tests.support.processors import digests; print(json.dumps(digests({list(seeds)}, {ticks})))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | OLD | how, cwd=ROOT, capture_output=True, text=True, check=True
    )
    found: dict[str, str] = json.loads(done.stdout)
    return found
