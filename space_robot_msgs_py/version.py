"""The version of this installation, as pyproject.toml says it."""

from importlib import metadata

try:
    __version__ = metadata.version("space-robot")
except metadata.PackageNotFoundError:
    # A source tree on the path that is not installed.
    __version__ = "unknown"
