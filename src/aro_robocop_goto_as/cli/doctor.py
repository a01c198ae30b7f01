"""robocop doctor: reports the system, the versions, what answers, and what is missing and how to install it."""

import contextlib
import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Dict, List, Tuple

from .. import x_display
from ..errors import MasterError
from ..names import ROOT, SIMULATOR, absolute, robocop

PYTHON = "/usr/bin/python3"
PACKAGES = ("rospy", "numpy", "pybullet")
STAMPS = ("venv/made-as", "venv/requirements", "workspace/built-from")  # what a complete set-up leaves
SETTINGS = ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "ROS_HOME", "ROS_LOG_DIR")
OPTIONAL_LISTS = ("rviz", "gui", "hosting", "grade", "class", "test")  # in install/deb-packages/
# What neither ROS in /opt/ros, which is not installed by ./robocop, nor the system may lack.
MODULES = (
    "rospy actionlib tf2_ros tf2_geometry_msgs nav_msgs sensor_msgs visualization_msgs std_srvs"
    " catkin_pkg numpy lxml collada PIL yaml ensurepip"
).split()
FIND = "import sys, importlib.util as u\nprint(*[m for m in sys.argv[1:] if not u.find_spec(m)])"
PROBE_TIMEOUT = 60.0  # [s, wall] imports may be slow on a busy machine
PROBE = """
import importlib, json, sys
from importlib import metadata
versions = {}
for name in sys.argv[1:]:
    try:
        module = importlib.import_module(name)
    except Exception as error:
        versions[name] = "" if isinstance(error, ModuleNotFoundError) else f"fails to import: {error}"
        continue
    versions[name] = "of unknown version"
    for package in (name, name + "-arm64"):
        try:
            versions[name] = metadata.version(package) + (f" of {package}" if package != name else "")
        except metadata.PackageNotFoundError:
            continue
    if name == "pybullet" and not module.isNumpyEnabled():
        versions[name] += ", without NumPy"
print(json.dumps(versions))
"""
Row = Tuple[str, str]


def system() -> str:
    """Distribution, architecture and size of this machine."""
    name = platform.system()
    with contextlib.suppress(OSError, KeyError), open("/etc/os-release", encoding="utf-8") as release:
        name = dict(line.rstrip().partition("=")[::2] for line in release)["PRETTY_NAME"].strip('"')
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    return f"{name}, {platform.machine()}, {os.cpu_count()} cores, {memory:.1f} GB of memory"


def versions(python: str) -> Dict[str, str]:
    """The versions of PACKAGES that an interpreter imports; "" for one that it does not find."""
    try:
        command = [python, "-c", PROBE, *PACKAGES]
        done = subprocess.run(command, capture_output=True, timeout=PROBE_TIMEOUT)
        return dict(json.loads(done.stdout.decode().splitlines()[-1]))
    except (OSError, subprocess.TimeoutExpired, IndexError, ValueError) as error:
        return {name: f"unknown, {python} failed: {error}" for name in PACKAGES}


def master_row() -> Tuple[str, str]:
    """What answers at ROS_MASTER_URI, in words, and what to do about a problem; empty if there is no problem."""
    try:
        import rosgraph

        from ..ros import graph, settings
    except ImportError:
        return "not asked, as ROS is not installed", ""
    uri = rosgraph.get_master_uri()
    problem = settings.problem()
    if problem:
        return "not asked, as these settings are of no use", problem
    try:
        if not graph.master_answers():
            return f"none at {uri}", ""
        simulator = graph.running_node(absolute("", SIMULATOR), "a simulator")
        state = simulator or graph.no_simulator() or "no simulator is running"
        commanded = graph.running_publishers("cmd_vel").items()
        several = [f"{topic} is published by {' and '.join(nodes)}" for topic, nodes in commanded if len(nodes) > 1]
        return "; ".join([f"answers at {uri}", state, *several]), ""
    except (OSError, rosgraph.MasterException, MasterError) as error:
        return "does not answer", str(error)


def ros_in_opt() -> str:
    """The folder of the ROS in /opt/ros that is in use; empty where ROS comes from Debian packages."""
    return os.path.dirname(os.environ.get("ROBOCOP_BASE_SETUP", ""))


def missing_modules() -> str:
    """The Python modules that ROS in /opt/ros and the system lack."""
    return subprocess.run([PYTHON, "-c", FIND, *MODULES], stdout=subprocess.PIPE, text=True).stdout.strip()


def require_modules() -> None:
    """End with an error if ROS in /opt/ros lacks Python modules, which ./robocop does not install there."""
    missing = missing_modules()
    if missing:
        where = f"ROS is at {ros_in_opt()}, but these Python modules are missing: {missing}"
        sys.exit(f"robocop: {where} (in ros-noetic-* or python3-* packages)")


def examine(
    checkout: str, state: str, ros: str, unsupported: str, missing: Dict[str, str]
) -> Tuple[List[Row], List[Row]]:
    """The rows of the report, and what is missing with what to do about it.

    ros: its folder in /opt/ros, or empty; unsupported: why this system is not supported, or empty; missing: the
    packages (Python modules for `modules`) that are not installed, for each list in install/deb-packages/.
    """
    python = str(Path(state, "venv", "bin", "python"))
    complete = all(Path(state, stamp).exists() for stamp in STAMPS)
    installed = versions(python if os.access(python, os.X_OK) else PYTHON)
    debian_ros = "Debian packages in /usr" if shutil.which("roslaunch", path="/usr/bin") else "not installed"
    master_state, master_problem = master_row()
    name = os.environ.get("DISPLAY")
    display = f"{name} {'answers' if x_display.answers() else 'does not answer'}" if name else "DISPLAY is not set"
    optional = [f"{part} {'not yet' if missing.get(part) else 'yes'}" for part in OPTIONAL_LISTS]
    rows = [
        ("system", system()),
        ("python", f"{platform.python_version()} ({PYTHON})"),
        ("ROS", ros or debian_ros),
        *((package, version or "not installed") for package, version in installed.items()),
        ("checkout", checkout),
        ("set-up", f"{'complete' if complete else 'not complete'}, in {state}"),
        ("optional", ", ".join(optional) + " (installed by the command that needs it)"),
        ("display", display),
        ("settings", ", ".join(f"{key}={os.environ[key]}" for key in SETTINGS if key in os.environ)),
        ("ROS master", master_state),
    ]
    problems = _problems(unsupported, missing, complete and installed["pybullet"][:1].isdigit())
    return rows, problems + ([("ROS", master_problem)] if master_problem else [])


def _problems(unsupported: str, missing: Dict[str, str], complete: bool) -> List[Row]:
    problems = []
    if unsupported:
        problems.append(("this system is not supported", unsupported))
    elif missing.get("run"):
        sudo = "" if os.geteuid() == 0 else "sudo "
        install = f"{sudo}apt-get update && {sudo}apt-get install --no-install-recommends {missing['run']}"
        problems.append((f"{len(missing['run'].split())} Debian packages", install))
    if missing.get("modules"):
        problems.append((f"Python modules of ROS: {missing['modules']}", "install ros-noetic-* or python3-* packages"))
    if not complete:
        problems.append(("the virtual environment or the workspace", f"{robocop()} setup"))
    return problems


def report(unsupported: str, *lists: str) -> int:
    """Print the report, and return the exit status, 0 if nothing is missing.

    unsupported: why this system is not supported, or empty; lists: "LIST=PACKAGE..." for each list in
    install/deb-packages/, with those of its packages that are not installed.
    """
    ros = ros_in_opt()
    missing = dict(entry.split("=", 1) for entry in lists)
    if ros:
        missing.update(run="", modules=missing_modules())
    rows, problems = examine(str(ROOT), os.environ["ROBOCOP_STATE"], ros, unsupported, missing)
    for name, value in rows:
        print(f"{name:11} {value}")
    print(f"\nnothing is missing: {robocop()} run starts the lab" if not problems else "\nmissing or wrong:")
    for what, remedy in problems:
        print(f"  {what}\n      {remedy}")
    return 1 if problems else 0
