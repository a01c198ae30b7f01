"""Hooks of mkdocs: pages of the site that are not in docs/, and links to files outside of it.

CONTRIBUTING.md and CHANGELOG.rst become pages. A file or folder of the repository that a page links to gets a page with
its content, under source/. Each part of the core has a page with its API, from the docstrings.
"""

import posixpath
import re
from pathlib import Path
from typing import Dict, Iterable, Iterator, Set

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "aro_robocop_goto_as"
OTHERS = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.rst": "changelog.md", "README.md": "index.md"}
# The parts of the core that do not need ROS, in the order in which they build on one another.
CORE = (
    *("goto", "goto_params", "sim_params", "bridge_params", "web_params", "param_loading", "geometry", "errors"),
    *("simulation", "robot", "sensors", "physics", "raycast", "world"),
)
LINK = re.compile(r"(?<=\]\()(?!\w+:|#)([^)#\s]+)")  # the path of a Markdown link
LEXERS = {".py": "python", ".yaml": "yaml", ".sdf": "xml", ".urdf": "xml", ".launch": "xml", ".c": "c"}
FENCE = "~~~~~~~~"
NOT_FOR_READERS = ("__pycache__", "__init__.py")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Append the API's pages to the navigation."""
    assert isinstance(config.nav, list)
    config.nav.append({"API of the core": ["api/index.md", *({part: f"api/{part}.md"} for part in CORE)]})
    config.watch.append(str(PACKAGE))
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are not in docs/."""
    pages = {OTHERS[name]: (ROOT / name).read_text(encoding="utf-8") for name in ("CONTRIBUTING.md", "CHANGELOG.rst")}
    pages["changelog.md"] = _markdown_of(pages["changelog.md"])
    pages.update(_api_pages())
    written = [ROOT / "docs" / page.src_uri for page in files.documentation_pages()]
    for path in sorted(_linked([*written, ROOT / "CONTRIBUTING.md"])):
        pages[f"source/{path}.md"] = _source_page(path)
    for uri, content in pages.items():
        files.append(File.generated(config, uri, content=content))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links to files of the repository into links to their pages."""
    uri = page.file.src_uri
    if uri.startswith(("api/", "source/", "changelog.md")):
        return markdown
    at = "" if uri in OTHERS.values() and uri != "index.md" else "docs"

    def replaced(link: "re.Match[str]") -> str:
        path = posixpath.normpath(posixpath.join(at, link[1]))
        return _uri_of(path) if (ROOT / path).exists() else link[1]

    return LINK.sub(replaced, markdown)


def _uri_of(path: str) -> str:
    """The page, or picture, of the site for a file or folder of the repository; pages with links are at the top."""
    if path.startswith("docs/"):
        return path[len("docs/") :]
    return OTHERS.get(path, f"source/{path}.md")


def _linked(pages: Iterable[Path]) -> Set[str]:
    """Files and folders outside of docs/ that these pages link to, and the text files in such folders."""
    found: Set[str] = set()
    for page in pages:
        for link in LINK.findall(page.read_text(encoding="utf-8")):
            path = (page.parent / link).resolve()
            relative = path.relative_to(ROOT).as_posix() if path.exists() else ""
            if relative and relative not in OTHERS and not relative.startswith("docs/"):
                found.add(relative)
                found.update(name.relative_to(ROOT).as_posix() for name in _text_files(path) if path.is_dir())
    return found


def _text_files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.glob("*")):
        if path.is_file() and path.name not in NOT_FOR_READERS:
            yield path


def _source_page(path: str) -> str:
    """A file's text, or a folder's files with links."""
    where = ROOT / path
    head = f"---\nsearch:\n  exclude: true\n---\n# {path}\n\n"
    if where.is_file():
        lexer = LEXERS.get(where.suffix, "text")
        return f"{head}{FENCE}{lexer}\n{where.read_text(encoding='utf-8')}\n{FENCE}\n"
    rows = [f"- [{name.name}]({where.name}/{name.name}.md)" for name in _text_files(where)]
    rows += [f"- {name.name}/" for name in sorted(where.glob("*/")) if name.name not in NOT_FOR_READERS]
    return head + "\n".join(rows) + "\n"


def _markdown_of(text: str) -> str:
    """The changelog, of which only title and literals are written differently in Markdown."""
    title, *lines = [line for line in text.splitlines() if not re.fullmatch(r"\^+", line)]
    return "\n".join([f"# {title}", *lines]).replace("``", "`")


def _api_pages() -> Dict[str, str]:
    pages = {"api/index.md": "# API of the core\n\n::: aro_robocop_goto_as\n    options: {members: []}\n"}
    for part in CORE:
        module = f"::: {PACKAGE.name}.{part}\n    options: {{heading_level: 1}}\n"
        modules = sorted(path for path in (PACKAGE / part).rglob("*.py") if path.name != "__init__.py")
        names = [".".join(path.relative_to(ROOT / "src").with_suffix("").parts) for path in modules]
        pages[f"api/{part}.md"] = "\n".join([module, *(f"::: {name}\n" for name in names)])
    return pages
