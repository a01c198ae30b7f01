"""Submissions that attack the judge come to nothing; run by `./robocop test --all`, where bubblewrap can run."""

import os
import socket
import subprocess

import attacks
import pytest
from graded import PLAN, RIGHT, SHARE, STATE, recorded, the_cage

from aro_robocop_goto_as.errors import GradingError, RobocopError
from aro_robocop_goto_as.grading import skeleton
from aro_robocop_goto_as.grading.submission import take

BUDGET = 60.0  # [s, wall] for an attack's two scenarios


def attacked(code, folder):
    """The base with an attack in it, in its first scenario: the record of its output, and what cut it short."""
    text = RIGHT["base_server"].read_text()
    names = f"PLAN, FOLDER, PID = {str(PLAN)!r}, {str(folder)!r}, {os.getpid()}\n"
    text = text.replace("if __name__", f"{names}{code}\nif __name__")
    it = recorded(text, folder, only=("left",), budget=BUDGET)
    lines = [line.text for record in it.records.values() for line in record.lines]
    assert not [line for line in lines if "SUCCESS" in line]
    return it, lines


@pytest.mark.parametrize("name", ["FORK_BOMB", "FULL_DISK", "READ", "KILL_ALL", "FORGE", "GIGABYTE_OF_LOG"])
def test_an_attack_comes_to_nothing_and_the_solution_is_graded_all_the_same(name, tmp_path):
    neighbour = tmp_path / "neighbour"
    neighbour.mkdir()
    (neighbour / "solution.py").write_text("secret")
    it, _ = attacked(getattr(attacks, name), tmp_path / "mine")
    assert it.problem == ""
    assert "left" in it.records or not it.records["start"].up, "judged, whatever the node came to"


def test_no_port_outside_is_reached(tmp_path):
    with socket.socket() as outside:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        _, lines = attacked(attacks.OUTSIDE.replace("PORT", str(outside.getsockname()[1])), tmp_path / "mine")
    assert sum("refused" in line for line in lines) == 3


def test_an_endless_loop_is_a_fail_with_a_reason(tmp_path):
    it, _ = attacked(attacks.ENDLESS, tmp_path / "mine")
    assert not it.records["start"].up


def test_who_kills_the_master_and_the_grader_loses_and_the_reason_is_said(tmp_path):
    it, _ = attacked(attacks.KILL_MASTER, tmp_path / "mine")
    assert "was ended while the submission ran" in it.problem or "was shut down while" in it.problem


@pytest.mark.parametrize("name", ["MEMORY", "MEMFD"])
def test_who_takes_all_memory_in_many_pieces_is_ended_and_the_reason_is_said(name, tmp_path):
    it, _ = attacked(getattr(attacks, name), tmp_path / "mine")
    reasons = {death.reason for record in it.records.values() for death in record.deaths}
    assert reasons == {"its processes together took more than 2048 MB of memory"}, it.problem


def test_of_a_flood_of_messages_only_what_is_of_use_is_kept(tmp_path):
    it, lines = attacked(attacks.FLOOD, tmp_path / "mine")
    assert "left" in it.records and it.problem == ""
    assert 100 < max(map(len, lines)) < 3000
    assert sum(path.stat().st_size for path in (tmp_path / "mine" / "out").iterdir()) < 64 * 1024 ** 2


def test_a_cage_that_is_not_roots_has_no_other_place_to_write_to(tmp_path):
    tmp_path.chmod(0o755)
    code = ("import subprocess, sys\nfrom pathlib import Path\nfrom aro_robocop_goto_as.grading.sandbox import Cage\n"
            "cage = Cage(())\n"
            "command = ['sh', '-c', 'for place in / /etc /dev /usr; do touch $place/here && echo SUCCESS $place; done; "
            "touch /tmp/here && echo fine']\n"
            "sys.exit(subprocess.call(cage.around_probe(cage.around_node(command, {}, (), Path('/tmp/home')))))")
    nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    done = subprocess.run([*nobody, "/usr/bin/python3", "-c", code], env={**os.environ, "HOME": "/tmp"},
                          capture_output=True, text=True, timeout=BUDGET, cwd="/tmp")
    assert done.stdout == "fine\n", done.stdout + done.stderr


@pytest.fixture
def package(tmp_path):
    """The skeleton's package, as `robocop new` makes it."""
    skeleton.make(SHARE, tmp_path / "lab")
    return tmp_path / "lab"


def taken(package, workshop):
    """Build and read a package as the judge does."""
    return take(str(package), SHARE, STATE, workshop, the_cage())


def test_building_a_package_and_reading_its_launch_file_reach_nothing_outside(package, tmp_path, monkeypatch):
    neighbour = tmp_path / "neighbour.py"
    neighbour.write_text("secret")
    monkeypatch.setenv("SECRET_OF_THE_TEACHER", "42")
    (package / "link").symlink_to(neighbour)
    with socket.socket() as outside:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        names = f"PLAN, NEIGHBOUR, PORT = {str(PLAN)!r}, {str(neighbour)!r}, {outside.getsockname()[1]}\n"
        (package / "attack.py").write_text(names + attacks.BUILD)
        with open(package / "CMakeLists.txt", "a") as text:
            text.write("execute_process(COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/attack.py)\n")
        launch = package / "launch" / "robocop_goto_as.launch"
        command = "sh -c &quot;python3 $(find aro_robocop_goto_as)/attack.py&quot;"
        launch.write_text(f'<launch><param name="loot" command="{command}"/></launch>')
        submission = taken(package, tmp_path / "workshop")
    log = next((tmp_path / "workshop").glob("*/build.log")).read_text()
    assert set(submission.parameters) == {"/loot"}
    for words in (log, submission.parameters["/loot"]):
        assert sum(line.startswith("refused ") for line in words.splitlines()) == 9, words
        assert "SUCCESS" not in words, words


@pytest.mark.parametrize("name", ["package.xml", "launch/robocop_goto_as.launch"])
def test_a_link_to_a_device_is_not_waited_for(name, package, tmp_path):
    (package / name).unlink()
    (package / name).symlink_to("/dev/ptmx")
    with pytest.raises(RobocopError, match="expected an ordinary file"):
        taken(package, tmp_path / "workshop")


def test_a_pipe_that_the_build_makes_is_not_waited_for(package, tmp_path):
    with open(package / "CMakeLists.txt", "a") as text:
        text.write("execute_process(COMMAND mkfifo ${CMAKE_CURRENT_SOURCE_DIR}/launch/zz.launch)\n")
    with pytest.raises(RobocopError, match="zz.launch: expected an ordinary file"):
        taken(package, tmp_path / "workshop")


def test_a_build_that_fills_the_disk_is_ended_and_the_reason_is_said(package, tmp_path):
    (package / "attack.py").write_text(attacks.BUILD_FULL)
    with open(package / "CMakeLists.txt", "a") as text:
        text.write("execute_process(COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/attack.py)\n")
    with pytest.raises(GradingError, match="catkin_make was ended: it wrote more than 512 MB"):
        taken(package, tmp_path / "workshop")
