"""Rules that every file of the project satisfies: style, types, spelling, and which module may import which."""

import ast
import importlib.util
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytestmark = pytest.mark.timeout(300)  # mypy and import-linter read everything

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
PYTHON = ("src", "scripts", "launch", "test", "setup.py")
# Correct words, and deliberate misspellings in tests.
SPELT_RIGHT = "colision,crate,fro,modle,orgin,poin,sise,wrold"
PROSE = ("README.md", "CONTRIBUTING.md", "CHANGELOG.rst", "CMakeLists.txt", "package.xml", "pyproject.toml", "robocop")
PROSE_FOLDERS = ("action", "cfg", "compat", "config", "docs", "msg", "src/robocop_grading/skeleton", "srv", "worlds")
SPELT = (*PYTHON, *PROSE, "Dockerfile", *PROSE_FOLDERS)
PACKAGE, GRADER = "aro_robocop_goto_as", "robocop_grading"
# Modules whose rosdep key differs from their name.
ROSDEP_KEYS = {
    name: f"python3-{name}" for name in ("jinja2", "lxml", "matplotlib", "numpy", "psutil", "rospkg", "yaml")
}
ROSDEP_KEYS.update(PIL="python3-pil", pybullet="python3-pybullet-pip", trimesh="python3-trimesh-pip")
# Imported on request only: in compat/, in install/deb-packages/class.txt or grade.txt, in install/requirements-web.txt.
OPTIONAL = {"dask", "gazebo_msgs", "distributed", "seccomp", "viser", "websockets", "wx"}


def run_checker(*command, folder=ROOT):
    """Run a checker; its output becomes the test's failure message."""
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        pytest.fail(f"{' '.join(map(str, command))}\n{done.stdout}", pytrace=False)


def test_ruff_reports_nothing():
    run_checker(sys.executable, "-m", "ruff", "check", *PYTHON)


def test_files_are_formatted_by_ruff():
    run_checker(sys.executable, "-m", "ruff", "format", "--check", "--diff", *PYTHON)


def test_mypy_reports_nothing():
    run_checker(sys.executable, "-m", "mypy")


def test_codespell_reports_nothing():
    run_checker("codespell", "--ignore-words-list", SPELT_RIGHT, *SPELT)


def test_catkin_lint_reports_nothing():
    # A checkout may have any name.
    run_checker("catkin_lint", "-W2", "--strict", "--offline", "--ignore", "package_path_name", ".")


def test_shellcheck_reports_nothing():
    run_checker("shellcheck", "robocop", ".ci/run")


def test_modules_import_only_what_the_contracts_in_pyproject_allow():
    # In src/: elsewhere the package's name means its generated messages, which catkin builds.
    run_checker("lint-imports", "--no-cache", "--config", ROOT / "pyproject.toml", folder=SOURCE)


def test_scripts_are_installed_and_only_start_a_main():
    cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    scripts = sorted((ROOT / "scripts").glob("*.py"))
    assert scripts
    for path in scripts:
        assert path.stat().st_mode & 0o111, f"{path.name} is not executable"
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 20, path.name
        assert f"scripts/{path.name}\n" in cmake, f"{path.name} is not installed by CMake"


def imported_by(path):
    """The top-level modules that a file imports from other packages."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module.split(".")[0]


def is_installed(name):
    """Whether a top-level module comes from a Debian or PyPI package, or is missing."""
    spec = importlib.util.find_spec(name)
    return name not in (PACKAGE, GRADER) and (spec is None or "-packages" in str(spec.origin))


def test_package_xml_declares_every_import():
    depends = ElementTree.parse(ROOT / "package.xml").getroot()
    declared = {entry.text for entry in depends if entry.tag in ("depend", "exec_depend")}
    imported = {name for path in SOURCE.rglob("*.py") for name in imported_by(path) if is_installed(name)}
    assert {ROSDEP_KEYS.get(name, name) for name in imported - OPTIONAL} - declared == set()
