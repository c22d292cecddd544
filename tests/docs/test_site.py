"""The documentation site builds without a remark, and the generated page is what the models say."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import space_robot
from space_robot_bringup.experiment.docs import keys_page
from tests.support.paths import ROOT

pytest.importorskip("mkdocs")
# One worker builds it.
pytestmark = pytest.mark.xdist_group("site")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built site."""
    place = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(place)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1", "DISABLE_MKDOCS_2_WARNING": "true"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    return place


def test_the_site_has_every_page_and_every_public_name(site: Path) -> None:
    """Each page of docs/, those of the root, and an entry in the API for each name that has a docstring of its own."""
    pages = [page.relative_to(ROOT / "docs").with_suffix("") for page in (ROOT / "docs").rglob("*.md")]
    assert len(pages) > 35
    for page in (*pages, "security", "changelog", "contributing", "api", "."):
        assert (site / page / "index.html").is_file(), page
    listed = set(re.findall(r'<h3[^>]* id="[\w.]+\.(\w+)"', (site / "api" / "index.html").read_text(encoding="utf-8")))
    aliases = {"Blocks", "Vector", "__version__"}
    assert set(space_robot.__all__) - aliases <= listed


def test_formulas_are_drawn_by_the_browser_itself(site: Path) -> None:
    """Every formula is MathML: nothing on a page comes from another server, and no LaTeX is left over."""
    maths = 0
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        maths += text.count("<math ")
        assert "arithmatex" not in text, page
        assert re.search(r'<(script|link rel="stylesheet")[^>]*(src|href)="https?:', text) is None, page
    assert maths > 200


def test_links_out_of_docs_lead_to_the_repository(site: Path) -> None:
    """A link to code is one to the file on the forge; those to pages stay on the site."""
    text = (site / "laws" / "pd" / "index.html").read_text(encoding="utf-8")
    assert "blob/main/space_robot_control/laws/pd/reference.py" in text
    home = (site / "index.html").read_text(encoding="utf-8")
    assert 'href="python/"' in home
    assert 'src="docs/' not in home


def test_the_page_of_keys_is_that_of_the_models() -> None:
    """``docs/keys.md`` is generated, and up to date."""
    assert keys_page() == (ROOT / "docs" / "keys.md").read_text(encoding="utf-8")
