"""A full disk below the logs of a whole system: goals are reached, no traceback, and the loss is said afterwards."""

import os
import signal
import subprocess

import pytest
import waiting
from programs import Program

from aro_robocop_goto_as.process.ports import free_port

# A file system of 512 KiB that nobody else sees, so that no privilege is needed.
MOUNT = 'mount -t tmpfs -o size=512k tmpfs "$0" && exec "$@" >"$0/output" 2>&1'
LOST = "log lines were lost: [Errno 28] No space left on device"
LAUNCH = ("robocop_launch.py", "--screen", "aro_robocop_goto_as", "robocop_goto_as.launch", "rviz:=false")


@pytest.mark.slow
def test_goals_are_reached_while_the_disk_is_full_and_lost_lines_are_counted_afterwards(tmp_path):
    disk, port = tmp_path / "disk", free_port()
    disk.mkdir()
    settings = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost", "DISPLAY": ""}
    system = subprocess.Popen(
        ["unshare", "--map-root-user", "--mount", "sh", "-c", MOUNT, disk]
        + ["rosrun", "aro_robocop_goto_as", LAUNCH[0], f"--port={port}", *LAUNCH[1:], "world:=empty"],
        env={**os.environ, **settings, "ROS_HOME": str(disk), "ROS_LOG_DIR": str(disk), "PYTHONUNBUFFERED": "1"},
    )
    inside = f"/proc/{system.pid}/root{disk}"

    def output():
        with open(f"{inside}/output", encoding="utf-8", errors="replace") as file:
            return file.read()

    def lines_with(words):
        return subprocess.run(["grep", "-rh", words, inside], stdout=subprocess.PIPE, text=True).stdout

    def reach(x, name):
        (tmp_path / name).mkdir()
        goto = Program(tmp_path / name, "robocop_goto.py", x, "0", "--frame", "odom", **settings)
        try:
            assert goto.process.wait(goto.deadline) == 0, goto.output
        finally:
            goto.kill()

    try:
        waiting.wait_for(
            lambda: os.path.exists(f"{inside}/output") and "is ready, no goal" in output(), "the system runs"
        )
        with open(f"{inside}/filler", "wb", buffering=0) as filler:
            for size in (4096, 1):
                try:
                    while filler.write(bytes(size)):
                        pass
                except OSError:
                    pass
        reach("0.3", "full")
        reach("0.6", "still_full")
        os.remove(f"{inside}/filler")
        reach("0.9", "room")
        waiting.wait_for(lambda: LOST in lines_with("lines were lost"), "a line about the lost ones")
        with open(f"{inside}/output", encoding="utf-8", errors="replace") as file:  # before its mounts end with it
            system.send_signal(signal.SIGINT)
            assert system.wait(waiting.DEADLINE) == 0
            assert "Traceback" not in file.read()
    finally:
        system.kill()
        system.wait()
