"""The few lines that colcon needs: everything else is declared in pyproject.toml."""

from setuptools import setup

setup(python_requires=">=3.11")
