"""Ctrl-C while ./robocop starts: no traceback, and none of its processes is left."""

import os
import signal
import subprocess
import time
from pathlib import Path

import psutil
import pytest
from processes import processes_with

from aro_robocop_goto_as.process.ports import free_port

ROOT = Path(__file__).resolve().parents[2]
CATKINS = Path(os.environ["ROBOCOP_STATE"], "tmp")  # for the temporary files of catkin's set-up files
DEADLINE = 120.0  # [s, wall]


def has_child(pid, word):
    """Whether a process, or one it started, has this word on its command line."""
    try:
        process = psutil.Process(pid)
        tree = [process, *process.children(recursive=True)]
        return any(word in argument for child in tree for argument in child.cmdline())
    except psutil.Error:  # it has just ended
        return False


@pytest.mark.slow
@pytest.mark.parametrize(
    "command, word",
    [
        (["run", "rviz:=false"], "_setup_util.py"),
        (["run", "rviz:=false"], "robocop_launch.py"),
        (["goto", "1", "0"], "robocop_goto.py"),
        (["grade", "."], "robocop_grade.py"),
    ],
)
def test_interrupted_while_it_starts_it_ends_without_a_traceback(tmp_path, command, word):
    output = tmp_path / "output"
    setting = {"ROS_HOME": str(tmp_path), "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    environment = {**os.environ, **setting, "ROS_HOSTNAME": "localhost"}

    def start():
        with open(output, "wb") as stream:
            streams = {"stdout": stream, "stderr": subprocess.STDOUT}
            return subprocess.Popen(
                [ROOT / "robocop", *command], env=environment, cwd=tmp_path, start_new_session=True, **streams
            )

    started, end = start(), time.monotonic() + DEADLINE
    try:
        while not has_child(started.pid, word):
            assert started.poll() is None and time.monotonic() < end, f"no {word}: {output.read_text()}"
            if "Ctrl-C in this terminal" in output.read_text():  # it runs: that process ended before it was seen
                os.killpg(started.pid, signal.SIGINT)
                started.wait(DEADLINE)
                started = start()
        os.killpg(started.pid, signal.SIGINT)  # as the terminal does
        assert started.wait(DEADLINE) != 0
        assert "Traceback" not in output.read_text() and "Fatal" not in output.read_text()
        assert processes_with(b"ROS_HOME=" + os.fsencode(tmp_path)) == []
    finally:
        for pid in processes_with(b"ROS_HOME=" + os.fsencode(tmp_path)):
            os.kill(pid, signal.SIGKILL)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_ended_while_the_workspace_is_set_up_it_leaves_no_temporary_file(tmp_path, number):
    environment = {**os.environ, "TMPDIR": str(tmp_path), "ROS_HOME": str(tmp_path / "ros")}
    before = set(CATKINS.glob("setup.sh.*"))

    def heed_hangups():  # also below nohup, where a shell cannot
        signal.signal(signal.SIGHUP, signal.SIG_DFL)

    command = [ROOT / "robocop", "_start", "sleep", "600"]
    started = subprocess.Popen(command, env=environment, start_new_session=True, preexec_fn=heed_hangups)
    try:
        end = time.monotonic() + DEADLINE
        while not set(CATKINS.glob("setup.sh.*")) - before:
            assert started.poll() is None and time.monotonic() < end, "no temporary file of catkin"
        started.send_signal(number)
        assert started.wait(DEADLINE) == -number
        assert list(tmp_path.iterdir()) == []
    finally:
        started.kill()


def test_a_start_removes_what_earlier_ones_that_were_killed_have_left():
    left = CATKINS / "setup.sh.left"
    CATKINS.mkdir(exist_ok=True)
    left.touch()
    os.utime(left, (0, 0))
    subprocess.run([ROOT / "robocop", "_start", "true"], check=True)
    assert not left.exists()
