"""What the nodes' imports leave out, and that it is there when it is used."""

import subprocess
import sys


def run(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_node_is_imported_without_parsers_and_without_a_search_among_all_packages():
    code = "import sys, aro_robocop_goto_as.ros.sim.node; print(*(name.partition('.')[0] for name in sys.modules))"
    assert set(run(code)) & {"catkin_pkg", "pyparsing", "setuptools", "pybullet", "tf2_ros"} == set()


def test_the_launcher_is_imported_without_setuptools_and_what_only_rviz_needs():
    code = "import sys, aro_robocop_goto_as.ros.cli.launch; print(*(name.partition('.')[0] for name in sys.modules))"
    assert set(run(code)) & {"setuptools", "distutils", "tf2_ros", "rospy"} == set()


def test_programs_of_packages_are_found_nevertheless():
    code = (
        "import aro_robocop_goto_as.ros, roslib.packages as p\n"
        "for _ in range(2): print(*p.find_node('aro_robocop_goto_as', 'robocop_sim.py'))"
    )
    found = run(code)
    half = len(found) // 2
    assert half and found[:half] == found[half:] and all(path.endswith("/robocop_sim.py") for path in found)


def test_size_of_the_logs_is_measured_nevertheless(tmp_path):
    code = f"import aro_robocop_goto_as.ros, rosclean; print(rosclean.get_disk_usage({str(tmp_path)!r}))"
    assert int(run(code)[0]) >= 0
