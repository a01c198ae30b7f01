"""What every file of the project must satisfy, before any of its behaviour is tested."""
import ast
import importlib.util
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src" / "aro_robocop_goto_as"
PYTHON_FILES = sorted(path for part in ("src", "scripts", "test") for path in (ROOT / part).rglob("*.py"))
# The parts that may use ROS. All the rest is the core.
ROS_PARTS = ("nodes", "grading.probe", "bench")
# Modules that package.xml knows by another name.
ROSDEP_KEYS = {name: f"python3-{name}" for name in ("lxml", "matplotlib", "numpy", "psutil", "rospkg", "yaml")}
ROSDEP_KEYS.update(PIL="python3-pil", pybullet="pybullet-pip", trimesh="python3-trimesh-pip")
OPTIONAL = {"gazebo_msgs", "distributed"}  # imported on request only: in compat/, in deb-packages/class.txt
IMPORT_WITHOUT_ROS = """
import importlib, sys

class NoRos:
    def find_spec(self, name, path=None, target=None):
        top = name.split(".")[0]
        if top in ("rospy", "rosgraph", "roslib", "actionlib", "tf2_ros", "ros_numpy") or top.endswith("_msgs"):
            raise ImportError(f"the core must not import {name}")

sys.path.insert(0, sys.argv[1])
sys.meta_path.insert(0, NoRos())
for module in sys.argv[2:]:
    importlib.import_module(module)
"""


def core_modules():
    for path in sorted(SOURCE.rglob("*.py")):
        parts = path.relative_to(SOURCE.parent).with_suffix("").parts
        if not ".".join(parts[1:]).startswith(ROS_PARTS):
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def check(*command):
    """Run a checker; what it prints is what the test fails with."""
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        pytest.fail(f"{' '.join(map(str, command))}\n{done.stdout}", pytrace=False)


def installed_imports(path):
    """Top-level names of what a source file imports from Debian's or PyPI's packages."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names = [node.module]
        for name in {name.split(".")[0] for name in names} - {SOURCE.name}:
            found = importlib.util.find_spec(name)
            if found is None or "-packages" in str(found.origin):
                yield name


def test_ruff_has_no_complaint():
    check(sys.executable, "-m", "ruff", "check", "src", "scripts", "test", "setup.py")


def test_types_of_the_core_hold():
    check(sys.executable, "-m", "mypy")


def test_catkin_lint_has_no_complaint():
    # A checkout may be called what it likes, and ./robocop has no business in an install space.
    ignored = ("--ignore", "package_path_name", "--ignore", "uninstalled_script")
    check("catkin_lint", "-W2", "--strict", "--offline", *ignored, ".")


def test_shellcheck_has_no_complaint():
    check("shellcheck", "robocop", ".ci/run")


@pytest.mark.parametrize("path", PYTHON_FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_source_is_valid_python_3_8(path):
    ast.parse(path.read_text(encoding="utf-8"), filename=str(path), feature_version=(3, 8))


def test_core_imports_without_ros():
    check(sys.executable, "-c", IMPORT_WITHOUT_ROS, str(SOURCE.parent), *core_modules())


@pytest.mark.parametrize("path", sorted((ROOT / "scripts").glob("*.py")), ids=lambda path: path.name)
def test_script_is_installed_and_only_starts_a_main(path):
    assert path.stat().st_mode & 0o111, "not executable"
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 20
    assert f"scripts/{path.name}\n" in (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), "not installed by CMake"


def test_package_xml_declares_every_import():
    depends = ElementTree.parse(ROOT / "package.xml").getroot()
    declared = {entry.text for entry in depends if entry.tag in ("depend", "exec_depend")}
    imported = {name for path in SOURCE.rglob("*.py") for name in installed_imports(path)}
    assert {ROSDEP_KEYS.get(name, name) for name in imported - OPTIONAL} - declared == set()
