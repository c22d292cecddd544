"""A campaign that is done."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="module")
def finished_campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The campaign run by one worker without interruption, every bag kept."""
    # Here, because without pyarrow it cannot be imported.
    from tests.support.campaigns import run_in

    folder = tmp_path_factory.mktemp("campaign")
    run_in(folder, "one", workers=1, keep="all")
    return folder / "one"
