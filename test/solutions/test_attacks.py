"""Attacks of submissions on the grader have no effect; run by `./robocop test --all` where bubblewrap can run."""

import os
import socket
import subprocess

import attacks
import pytest
from graded import PLAN, RIGHT, SHARE, STATE, recorded, sandbox

from aro_robocop_goto_as.errors import GradingError, RobocopError
from aro_robocop_goto_as.grading import skeleton
from aro_robocop_goto_as.grading.submission import prepare_submission

BUDGET = 60.0  # [s, wall] for an attack's two scenarios


def attacked(code, folder):
    """Run the base solution with an attack through one scenario; the recorded run and the lines of its output."""
    text = RIGHT["base_server"].read_text()
    names = f"PLAN, FOLDER, PID = {str(PLAN)!r}, {str(folder)!r}, {os.getpid()}\n"
    text = text.replace("if __name__", f"{names}{code}\nif __name__")
    run = recorded(text, folder, only=("left",), budget=BUDGET)
    lines = [line.text for record in run.records.values() for line in record.lines]
    assert not [line for line in lines if "SUCCESS" in line]
    return run, lines


@pytest.mark.parametrize("name", ["FORK_BOMB", "FULL_DISK", "READ", "KILL_ALL", "FORGE", "GIGABYTE_OF_LOG"])
def test_attack_fails_and_the_submission_is_still_graded(name, tmp_path):
    neighbour = tmp_path / "neighbour"
    neighbour.mkdir()
    (neighbour / "solution.py").write_text("secret")
    run, _ = attacked(getattr(attacks, name), tmp_path / "mine")
    assert run.problem == ""
    assert "left" in run.records or not run.records["start"].up, "neither judged nor recorded as not started"


def test_ports_outside_the_sandbox_are_unreachable(tmp_path):
    with socket.socket() as outside:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        _, lines = attacked(attacks.OUTSIDE.replace("PORT", str(outside.getsockname()[1])), tmp_path / "mine")
    assert sum("refused" in line for line in lines) == 3


def test_server_with_an_endless_loop_counts_as_not_started(tmp_path):
    run, _ = attacked(attacks.ENDLESS, tmp_path / "mine")
    assert not run.records["start"].up


def test_killing_the_ros_master_ends_the_run_with_a_reason(tmp_path):
    run, _ = attacked(attacks.KILL_MASTER, tmp_path / "mine")
    assert "was ended while the submission ran" in run.problem or "was shut down while" in run.problem


@pytest.mark.parametrize("name", ["MEMORY", "MEMFD"])
def test_processes_that_together_exceed_the_memory_limit_are_killed_with_a_reason(name, tmp_path):
    run, _ = attacked(getattr(attacks, name), tmp_path / "mine")
    reasons = {death.reason for record in run.records.values() for death in record.deaths}
    assert reasons == {"its processes together took more than 2048 MB of memory"}, run.problem


def test_flood_of_log_messages_is_truncated(tmp_path):
    run, lines = attacked(attacks.FLOOD, tmp_path / "mine")
    assert "left" in run.records and run.problem == ""
    assert 100 < max(map(len, lines)) < 3000
    assert sum(path.stat().st_size for path in (tmp_path / "mine" / "out").iterdir()) < 64 * 1024**2


def test_sandbox_started_by_an_unprivileged_user_has_no_other_writable_places(tmp_path):
    tmp_path.chmod(0o755)
    code = (
        "import subprocess, sys\nfrom pathlib import Path\nfrom aro_robocop_goto_as.grading.sandbox import Sandbox\n"
        "sandbox = Sandbox(())\n"
        "command = ['sh', '-c', 'for place in / /etc /dev /usr; do touch $place/here && echo SUCCESS $place; done; "
        "touch /tmp/here && echo fine']\n"
        "sys.exit(subprocess.call(sandbox.probe_command(sandbox.node_command(command, {}, (), Path('/tmp/home')))))"
    )
    nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    done = subprocess.run(
        [*nobody, "/usr/bin/python3", "-c", code],
        env={**os.environ, "HOME": "/tmp"},
        capture_output=True,
        text=True,
        timeout=BUDGET,
        cwd="/tmp",
    )
    assert done.stdout == "fine\n", done.stdout + done.stderr


@pytest.fixture
def package(tmp_path):
    """The package that `robocop new` creates."""
    skeleton.make(SHARE, tmp_path / "lab")
    return tmp_path / "lab"


def prepared(package, workshop):
    """Build and read a package as the grader does."""
    return prepare_submission(str(package), SHARE, STATE, workshop, sandbox())


def test_build_and_launch_file_cannot_reach_anything_outside_the_sandbox(package, tmp_path, monkeypatch):
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
        submission = prepared(package, tmp_path / "workshop")
    log = next((tmp_path / "workshop").glob("*/build.log")).read_text()
    assert set(submission.parameters) == {"/loot"}
    for words in (log, submission.parameters["/loot"]):
        assert sum(line.startswith("refused ") for line in words.splitlines()) == 9, words
        assert "SUCCESS" not in words, words


@pytest.mark.parametrize("name", ["package.xml", "launch/robocop_goto_as.launch"])
def test_link_to_a_device_is_refused_without_blocking(name, package, tmp_path):
    (package / name).unlink()
    (package / name).symlink_to("/dev/ptmx")
    with pytest.raises(RobocopError, match="expected an ordinary file"):
        prepared(package, tmp_path / "workshop")


def test_named_pipe_created_by_the_build_is_refused_without_blocking(package, tmp_path):
    with open(package / "CMakeLists.txt", "a") as text:
        text.write("execute_process(COMMAND mkfifo ${CMAKE_CURRENT_SOURCE_DIR}/launch/zz.launch)\n")
    with pytest.raises(RobocopError, match="zz.launch: expected an ordinary file"):
        prepared(package, tmp_path / "workshop")


def test_build_that_fills_the_disk_is_killed_with_a_reason(package, tmp_path):
    (package / "attack.py").write_text(attacks.BUILD_FULL)
    with open(package / "CMakeLists.txt", "a") as text:
        text.write("execute_process(COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/attack.py)\n")
    with pytest.raises(GradingError, match="catkin_make was ended: it wrote more than 512 MB"):
        prepared(package, tmp_path / "workshop")
