"""A fresh interpreter, in which every warning is an error."""

from __future__ import annotations

import subprocess
import sys

from tests.support.paths import ROOT

WITHOUT_NUMBA = """
import sys
sys.modules["numba"] = None
from {module} import commands
print(*(number.hex() for number in commands()))
"""


def python(code: str) -> str:
    """What it prints."""
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout


def commands_without_numba(module: str) -> list[float]:
    """What ``commands`` of a test module returns where nothing is compiled."""
    return [float.fromhex(number) for number in python(WITHOUT_NUMBA.format(module=module)).split()]
