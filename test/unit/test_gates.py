"""Rules that every file of the project satisfies: style, types, spelling, and which module may import which."""

import ast
import importlib.util
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import foreign_insides
import pytest
from imports import PACKAGE, Imports, within

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
IMPORTS = Imports(SOURCE)
PYTHON = ("src", "scripts", "launch", "test", "docs", "setup.py")
# Correct words, and deliberate misspellings in tests.
SPELT_RIGHT = "colision,crate,fro,modle,orgin,poin,sise,wrold"
PROSE = (
    *("README.md", "CONTRIBUTING.md", "CHANGELOG.rst", "CMakeLists.txt", "package.xml", "pyproject.toml"),
    *("docs/site/mkdocs.yml", "robocop"),
)
PROSE_FOLDERS = ("action", "cfg", "compat", "config", "msg", "src/robocop_grading/skeleton", "srv", "worlds")
SPELT = (*PYTHON, *PROSE, "Dockerfile", *PROSE_FOLDERS)
GRADER = "robocop_grading"
READER = f"{GRADER}.builds.roslaunch_reader"
MAY_IMPORT_ROS = (
    "ros",
    f"{GRADER}.agent.ros",
    f"{GRADER}.agent.connections",
    f"{GRADER}.session",
    f"{GRADER}.sim_with",
    READER,
)
MAY_IMPORT_PYBULLET = ("physics", "sensors.camera_renderer")
# Every folder (or module beside the folders), and what its modules may import; each row names only rows above it.
ORDER = {
    "errors": "",
    "suggestions": "",
    "names": "",
    "param_loading": "errors suggestions",
    "geometry": "param_loading",
    "compiled": "errors",
    "reading": "errors",
    "goto_params": "param_loading",
    "bridge_params": "param_loading",
    "web_params": "param_loading",
    "process": "errors names",
    "probes": "errors names",
    "world": "errors geometry reading suggestions",
    "robot": "compiled errors geometry param_loading reading suggestions world",
    "raycast": "compiled errors geometry robot world",
    "physics": "compiled errors geometry param_loading raycast robot world",
    "sensors": "compiled geometry param_loading physics raycast robot world",
    "simulation.jobs": "errors",
    "simulation.rates": "param_loading",
    "simulation.lockstep": "param_loading simulation.jobs",
    "simulation.time_control": "param_loading simulation.jobs",
    "sim_params": "param_loading physics robot sensors simulation.lockstep simulation.rates simulation.time_control",
    "goto": "geometry goto_params",
    "obstacle_ahead": "",
    "web": "errors geometry names world",
    "simulation": "errors geometry sim_params physics raycast robot sensors world",
    "ros": "compiled errors geometry param_loading probes sim_params process robot names sensors simulation world",
    "ros.sim": "errors geometry sim_params probes process raycast robot ros names sensors simulation suggestions world",
    "ros.server": "errors geometry goto goto_params obstacle_ahead sim_params probes process ros names simulation",
    "ros.client": "bridge_params errors geometry probes process ros names suggestions",
    "ros.web": "errors geometry param_loading probes ros ros.client names web web_params",
    "ros.cli": "errors geometry param_loading sim_params probes process reading robot ros ros.client names "
    "suggestions web web_params world",
    f"{GRADER}.agent": "",
    f"{GRADER}.files": "errors process",
    f"{GRADER}.builds": f"errors process names {GRADER}.files",
    f"{GRADER}.sim_with": f"errors process ros.cli {GRADER}.files {GRADER}.builds",
    GRADER: f"errors geometry {GRADER}.files {GRADER}.builds param_loading probes process sim_params web "
    "web_params world",
    f"{GRADER}.classroom": f"errors {GRADER} {GRADER}.files {GRADER}.builds process",
    f"{GRADER}.session": "errors geometry goto obstacle_ahead process robot ros names ros.sim sim_params simulation "
    f"web world {GRADER}",
}
# Modules whose rosdep key differs from their name.
ROSDEP_KEYS = {
    name: f"python3-{name}" for name in ("jinja2", "lxml", "matplotlib", "numpy", "psutil", "rospkg", "yaml")
}
ROSDEP_KEYS.update(PIL="python3-pil", pybullet="python3-pybullet-pip", trimesh="python3-trimesh-pip")
# Imported on request only: in compat/, in install/deb-packages/class.txt or grade.txt, in install/requirements-web.txt.
OPTIONAL = {"dask", "gazebo_msgs", "distributed", "seccomp", "viser", "websockets", "wx"}
# Where the insides of other libraries are used, in how many lines at most, and why. What is not here may use none.
INSIDES = {
    f"{PACKAGE}/ros/connected_nodes.py": (2, "rospy only counts connections"),
    f"{PACKAGE}/ros/publishing/": (6, "rospy can't send to several topics or subscribers at once, nor without loss"),
    f"{PACKAGE}/ros/sim/gazebo_topics.py": (1, "genpy has no public name for a message's definition"),
    f"{PACKAGE}/ros/web/server.py": (2, "viser has no setting for who may use its web server"),
    f"{GRADER}/session/services.py": (3, "genpy has no public name for a service's request and response"),
    f"{GRADER}/session/topics.py": (1, "genpy has no public name for a message's definition"),
    f"{GRADER}/agent/": (1000, "the agent replaces parts of the standard library and of rospy from within"),
}


def run_checker(*command):
    """Run a checker; its output becomes the test's failure message."""
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        pytest.fail(f"{' '.join(map(str, command))}\n{done.stdout}", pytrace=False)


def expect_none(problems):
    """Fail if there are problems, with one per line."""
    if problems:
        pytest.fail("\n".join(problems), pytrace=False)


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
    run_checker("shellcheck", "robocop", ".ci/run", f"src/{PACKAGE}/ros/cli/completion.bash")


def test_sources_are_valid_python_3_8():
    paths = [path for part in PYTHON for path in [ROOT / part, *(ROOT / part).rglob("*.py")] if path.is_file()]
    assert len(paths) > 100
    for path in paths:
        ast.parse(path.read_text(encoding="utf-8"), filename=str(path), feature_version=(3, 8))


def is_ros(name):
    """Whether a module belongs to ROS 1, generated messages and services included."""
    top, *rest = name.split(".")
    return (
        top.startswith(("ros", "actionlib", "tf2_", "dynamic_reconfigure", "genpy"))
        and top != "rospkg"
        or top.endswith(("_msgs", "_srvs"))
        or (top in ("msg", "srv", "cfg") and not rest)
    )


def test_ros_is_imported_only_where_it_belongs():
    expect_none(
        [
            f"{module} imports {name}"
            for module, names in IMPORTS.external.items()
            if not within(module, *MAY_IMPORT_ROS)
            for name in sorted(filter(is_ros, names))
        ]
    )


def test_pybullet_is_imported_only_where_it_belongs():
    expect_none(
        [
            f"{module} imports {name}"
            for module, names in IMPORTS.external.items()
            if not within(module, *MAY_IMPORT_PYBULLET)
            for name in sorted(names)
            if name.startswith("pybullet")
        ]
    )


def test_imports_have_no_cycles():
    expect_none([" <-> ".join(modules) for modules in IMPORTS.cycles()])


def row_of(module):
    """The row of ORDER that a module belongs to: the longest that fits."""
    return max((row for row in ORDER if within(module, row)), key=len)


def test_order_of_folders_has_no_cycles():
    for number, (row, names) in enumerate(ORDER.items()):
        assert set(names.split()) <= set(list(ORDER)[:number]), f"{row} may only import rows above it"


def test_modules_import_only_what_the_order_of_folders_allows():
    expect_none(
        [
            f"{module} imports {imported}"
            for module, names in IMPORTS.internal.items()
            if module
            for imported in sorted(filter(None, names))
            if not within(imported, row_of(module), *ORDER[row_of(module)].split())
        ]
    )


def test_insides_of_libraries_are_used_only_where_that_is_allowed():
    problems = []
    for path in SOURCE.rglob("*.py"):
        name, places = str(path.relative_to(SOURCE)), foreign_insides.places(path)
        allowed = max((number for row, (number, _) in INSIDES.items() if name.startswith(row)), default=0)
        if len(places) > allowed:
            problems += [f"{name}:{place.line}: {place.what} (allowed: {allowed} lines)" for place in places]
    expect_none(problems)


def test_scripts_are_installed_and_only_start_a_main():
    cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    scripts = sorted((ROOT / "scripts").glob("*.py"))
    assert scripts
    for path in scripts:
        assert path.stat().st_mode & 0o111, f"{path.name} is not executable"
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 20, path.name
        assert f"scripts/{path.name}\n" in cmake, f"{path.name} is not installed by CMake"


def is_installed(name):
    """Whether a top-level module comes from a Debian or PyPI package, or is missing."""
    spec = importlib.util.find_spec(name)
    return spec is None or "-packages" in str(spec.origin)


def test_package_xml_declares_every_import():
    depends = ElementTree.parse(ROOT / "package.xml").getroot()
    declared = {entry.text for entry in depends if entry.tag in ("depend", "exec_depend")}
    imported = {name.split(".")[0] for names in IMPORTS.external.values() for name in names}
    imported = {name for name in imported - {PACKAGE, GRADER, "msg", "srv", "cfg"} if is_installed(name)}
    assert {ROSDEP_KEYS.get(name, name) for name in imported - OPTIONAL} - declared == set()
