"""The few lines that colcon and the setuptools of Jazzy need: everything else is declared in pyproject.toml."""

from setuptools import __version__, setup

# An SPDX expression in pyproject.toml needs setuptools 77; that of Jazzy, with which colcon builds, is 68.
LICENSE = "license_expression" if int(__version__.partition(".")[0]) >= 77 else "license"

setup(python_requires=">=3.11", **{LICENSE: "Apache-2.0"})
