"""./robocop docs builds the HTML site: its links and anchors lead somewhere, and it loads nothing from elsewhere."""

import os
import shlex
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).resolve().parents[2]
LOADED = {"script": "src", "img": "src", "iframe": "src", "link": "href", "source": "src"}
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("docs_site")]


class Page(HTMLParser):
    """What a page links to, what it loads, its anchors and its text."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.anchors, self.text = [], [], set(), ""
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors.update(value for name, value in attributes if name in ("id", "name") and value)
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if given.get(LOADED.get(tag)):
            self.loaded.append(given[LOADED[tag]])

    def handle_data(self, data):
        self.text += data


def build(root):
    """`./robocop docs` in a checkout; it has been set up by `./robocop test --all`."""
    return subprocess.run([root / "robocop", "docs"], capture_output=True, text=True, timeout=240)


@pytest.fixture(scope="module")
def site():
    """The pages by their paths in the site."""
    done = build(ROOT)
    assert done.returncode == 0, done.stderr
    folder = Path(done.stderr.split(" is in ")[1].strip()).parent
    return folder, {path: Page(path) for path in folder.rglob("*.html") if path.name != "404.html"}


def test_every_link_and_anchor_leads_somewhere(site):
    folder, pages = site
    broken, checked = [], 0
    for path, page in pages.items():
        for link in page.links + page.loaded:
            url = urlsplit(link)
            if url.scheme:
                continue
            target = (path.parent / unquote(url.path)).resolve() if url.path else path
            anchored = target not in pages or not url.fragment or unquote(url.fragment) in pages[target].anchors
            checked += 1
            if not (target.is_file() and anchored):
                broken.append(f"{path.relative_to(folder)}: {link}")
    assert checked > 1000
    assert broken == []


def test_nothing_is_loaded_from_other_servers(site):
    folder, pages = site
    loaded = {link for page in pages.values() for link in page.loaded}
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
