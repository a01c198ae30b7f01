"""Errors of a hosted package's nodes name its author's files, and each node that has ended is named with its reason."""

import subprocess
import sys

import pytest

COPY = "/with/package-1"
# Prints lines as roslaunch and its nodes do, some of them before the overview.
PROGRAM = """
import sys
from pathlib import Path
from robocop_hosting.node_errors import NodeErrors

with NodeErrors({Path("/with/package-1/src/lab"): Path("/home/me/my_lab")}) as errors:
    sys.stderr.write(sys.argv[1])
    print("the overview", flush=True)
    if sys.argv[2]:
        errors.show()
        sys.stderr.write(sys.argv[2])
"""
TRACEBACK = f"""Traceback (most recent call last):
  File "{COPY}/devel/lib/lab/robocop_goto_as.py", line 15, in <module>
    exec(compile(fh.read(), python_script, 'exec'), context)
  File "{COPY}/src/lab/scripts/robocop_goto_as.py", line 42, in <module>
    start()
  File "/usr/lib/python3/dist-packages/rospy/core.py", line 7, in start
    raise TabError("words")
TabError: words
"""


def died(name="aro_robocop_goto_as_node", code=1, script="robocop_goto_as.py"):
    """What roslaunch prints, in colour."""
    command = f"{COPY}/devel/lib/lab/{script} __name:={name}"
    return f"\x1b[31m[{name}-3] process has died [pid 7, exit code {code}, cmd {command}].\nlog file: /l*.log\x1b[0m\n"


def screen(before: str, after: str = "") -> str:
    """What is shown of lines that are printed before and after the overview."""
    done = subprocess.run([sys.executable, "-c", PROGRAM, before, after], stderr=subprocess.PIPE, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stderr


@pytest.mark.parametrize("moment", ["before", "after"])
def test_node_that_has_died_is_named_with_its_exception_and_the_line_in_the_authors_file(moment: str) -> None:
    lines = TRACEBACK + died()
    *above, last = screen(*([lines] if moment == "before" else ["", lines])).splitlines()
    assert last.startswith(
        "[ERROR] your server (aro_robocop_goto_as_node) has ended: TabError: words "
        "(/home/me/my_lab/scripts/robocop_goto_as.py, line 42). Correct that"
    )
    assert '  File "/home/me/my_lab/scripts/robocop_goto_as.py", line 42, in <module>' in above
    assert "process has died" not in "".join(above) and "log file" not in "".join(above)


def test_nodes_that_have_ended_are_told_below_what_other_nodes_print() -> None:
    clean = "[WARN] helper has ended, without an error, as after `rosnode kill`\n"
    lines = screen(died("follower", code=-11) + clean + "[ERROR] of another node\nand its last words\n")
    assert lines.splitlines() == [
        "[ERROR] of another node",
        "and its last words",
        "[ERROR] follower has ended, by signal 11",
        clean.strip(),
    ]


@pytest.mark.parametrize(
    "words, hint",
    [
        ("time is not initialized. Have you called init_node()?", "rospy.init_node(NAME) has to come first; "),
        ("Type <class 'P'> if not loaded or supported", "tf2 can transform messages of geometry_msgs only after: imp"),
        ("ROS shutdown request", "the node was told to end, as by Ctrl-C; that is no mistake"),
    ],
)
def test_exception_that_does_not_say_what_to_do_is_followed_by_that(words: str, hint: str) -> None:
    elsewhere = f'  File "/usr/lib/python3/rospy/timer.py", line 223, in run\n    r = Rate()\nError: {words}\n'
    *_, above, last = screen("", elsewhere + TRACEBACK.replace("TabError: words", f"Error: {words}")).splitlines()
    assert above == f"Error: {words}"
    assert last.startswith(f"[WARN] robocop_goto_as.py, line 42: {hint}")
    assert screen(TRACEBACK.replace("TabError: words", f"Error: {words}") + elsewhere).splitlines()[-2:] == [
        f"Error: {words}",
        last,
    ], "below the overview, and only where the author's own file is in the traceback"


def test_exception_of_one_script_is_not_the_reason_for_the_end_of_another() -> None:
    said = screen(TRACEBACK + died("follower", script="follower.py"))
    assert said.endswith("[ERROR] follower has ended, with exit status 1\n")
