"""./robocop docs builds the HTML site, refuses links that lead nowhere, and the site loads nothing from elsewhere."""

import os
import shlex
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urlsplit

import pytest

ROOT = Path(__file__).resolve().parents[2]
LOADED = {"script": "src", "img": "src", "iframe": "src", "link": "href", "source": "src"}
pytestmark = pytest.mark.slow


class Page(HTMLParser):
    """What a page loads."""

    def __init__(self, path):
        super().__init__()
        self.loaded = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        loaded = dict(attributes).get(LOADED.get(tag))
        if loaded:
            self.loaded.append(loaded)


def test_site_is_built_and_loads_nothing_from_other_servers():
    done = subprocess.run([ROOT / "robocop", "docs"], capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    folder = Path(done.stderr.split(" is in ")[1].strip()).parent
    loaded = {link for path in folder.rglob("*.html") for link in Page(path).loaded}
    assert any(link.endswith(".css") for link in loaded) and any(link.endswith(".js") for link in loaded)
    assert [link for link in loaded if urlsplit(link).netloc] == []
    sheets = [path.read_text(encoding="utf-8") for path in folder.rglob("*.css")]
    assert not any("url(http" in sheet or "url(//" in sheet or "@import" in sheet for sheet in sheets)


def test_links_that_lead_nowhere_are_errors_that_name_them(tmp_path):
    for name in ("docs", "src", "config", "CONTRIBUTING.md", "CHANGELOG.rst"):
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        copy(ROOT / name, tmp_path / name)
    broken = ["nowhere.md", "worlds.md#nowhere", "../config/nowhere.yaml"]
    with open(tmp_path / "docs" / "web.md", "a", encoding="utf-8") as page:
        page.writelines(f"\n[broken]({link})\n" for link in broken)
    dry_run = {**os.environ, "ROBOCOP_DRY_RUN": "1"}
    command = subprocess.run(
        [ROOT / "robocop", "docs"], env=dry_run, stdout=subprocess.PIPE, text=True, check=True
    ).stdout
    words = shlex.split(command.splitlines()[-1].replace(str(ROOT / "docs" / "site"), str(tmp_path / "docs" / "site")))
    words[words.index("--site-dir") + 1] = str(tmp_path / "site")
    done = subprocess.run(words, capture_output=True, text=True, timeout=240)
    assert done.returncode == 1
    assert [link for link in broken if f"'{link}'" not in done.stderr] == []
