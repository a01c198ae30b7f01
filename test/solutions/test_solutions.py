"""Correct solutions get full marks; each wrong one fails the intended check with the expected explanation.

A selection of them; `./robocop test --all` has them all.
"""

import os
import signal
import subprocess
import time

import pytest
import rosbag
from graded import PLAN, SHARE, graded, judged, recorded
from processes import busy_processes, processes_mentioning
from right_solutions import HERE, RIGHT
from wrong_solutions import ROWS, WRONG

from robocop_grading import reasons
from robocop_grading.checks.consequences import FOLLOWS
from robocop_grading.cli import INTERRUPTED
from robocop_grading.grades import CheckOutcome
from robocop_grading.plan_file import load

SOME_WRONG = ("bridge_never_cancels",)

# The slowest grade, of a loop without pauses, took 235 s beside two others on two cores.
pytestmark = pytest.mark.timeout(900)


def pytest_generate_tests(metafunc):
    everything = metafunc.config.getoption("--all")
    if "wrong" in metafunc.fixturenames:
        chosen = [wrong for wrong in WRONG if everything or wrong.name in SOME_WRONG]
        metafunc.parametrize("wrong", chosen, ids=lambda wrong: wrong.name)


@pytest.mark.slow
@pytest.mark.parametrize("right", RIGHT)
def test_correct_solution_gets_full_marks(right, tmp_path):
    grade = graded(right, RIGHT[right], tmp_path)
    assert {check.name: check.words for check in grade.checks if check.outcome is not CheckOutcome.PASSED} == {}


def without(row):
    """The table of consequences without a row."""
    left = tuple(it for it in FOLLOWS if ((it.later.split() or [""])[0], it.kind, it.earlier) != row)
    assert len(left) == len(FOLLOWS) - 1, row
    return left


def test_wrong_solution_fails_the_intended_check_with_the_expected_explanation(wrong, tmp_path, monkeypatch):
    rows = [row for row, name in ROWS.items() if name == wrong.name]
    whole = wrong.alone or rows
    for only in ((),) if whole else ((wrong.check,), ()):  # all scenarios, if it depends on those before
        run = recorded(wrong.text(), tmp_path / str(len(only)), only)
        grade = judged(wrong.name, run, only=only)
        check = next(check for check in grade.checks if check.name == wrong.check)
        if check.outcome is CheckOutcome.FAILED:
            break
    assert check.outcome is CheckOutcome.FAILED, check.words
    assert wrong.words in check.words
    if wrong.alone:
        assert [mistake.check.name for mistake in grade.mistakes] == [wrong.check]
    for row in rows:
        monkeypatch.setattr(reasons, "FOLLOWS", without(row))
        begins = [[check.follows for check in it.checks] for it in (grade, judged(wrong.name, run))]
        assert begins[0] != begins[1], row


def test_each_row_of_consequences_of_servers_has_a_wrong_server_that_needs_it():
    bridge = {check.name for check in load(PLAN).checks if check.part == "bridge"}
    rows = {((it.later.split() or [""])[0], it.kind, it.earlier) for it in FOLLOWS if it.earlier not in bridge}
    assert rows == set(ROWS) and set(ROWS.values()) <= {wrong.name for wrong in WRONG}


@pytest.mark.slow
def test_node_that_connects_while_goals_run_leaves_the_same_records_each_time(tmp_path):
    def records(number):
        run = recorded(RIGHT["connects_while_driving"], tmp_path / str(number), only=("reaches_goal",))
        return {it.name: (it.samples, it.feedback, it.commands, it.results) for it in run.records.values()}

    first = records(0)
    assert {len(results) for _, _, _, results in first.values()} == {0, 1}
    assert all(records(number) == first for number in range(1, 3))


@pytest.mark.slow
def test_correct_solution_gets_full_marks_for_drawn_scenarios(tmp_path):
    grade = graded("base_server", RIGHT["base_server"], tmp_path, seed=1)
    assert {check.name: check.words for check in grade.checks if check.outcome is not CheckOutcome.PASSED} == {}


# Adds to a server: the node ends when rospy's time is another one than that of a message on /clock.
COMPARES_CLOCKS = """
from rosgraph_msgs.msg import Clock
def compare_clocks(message):
    if rospy.Time.now() != message.clock:
        rospy.logfatal('rospy has %s, /clock has %s', rospy.Time.now(), message.clock)
        rospy.signal_shutdown('clocks differ')
"""


@pytest.mark.slow
def test_time_of_rospy_is_that_of_the_clock_message_whose_callback_runs(tmp_path):
    text = RIGHT["base_server"].replace("\ndef wrap", f"{COMPARES_CLOCKS}\ndef wrap", 1)
    begin = "        self.count = 0\n"
    text = text.replace(begin, f"{begin}        rospy.Subscriber('/clock', Clock, compare_clocks)\n", 1)
    assert text.count("compare_clocks") == 2
    grade = graded("compares_clocks", text, tmp_path)
    assert grade.failed() == []


@pytest.mark.slow
def test_server_that_knows_where_the_walls_are_passes_only_where_it_knows_them(tmp_path):
    looks, begin = "self.min_dist_ahead < 0.3", "        success = False\n        while"
    knows = "x > {8: 0.9, 10: -9.0, 13: 0.7, 17: 0.9, 18: 0.9}.get(self.count, 9.0)"  # by the number of the goal
    text = RIGHT["base_server"]
    assert looks in text and begin in text
    text = text.replace(looks, knows).replace(begin, f"        self.count += 1\n{begin}")
    assert graded("middle", text, tmp_path / "middle").failed() == []
    assert "stops_at_obstacle" in graded("drawn", text, tmp_path / "drawn", seed=1).failed()


def command(*arguments):
    """`robocop grade` or `robocop new` in this workspace."""
    return subprocess.run(["rosrun", "aro_robocop_goto_as", *arguments], capture_output=True, text=True, timeout=250)


def test_reference_solution_gets_full_marks_and_the_extra_point(tmp_path):
    done = command("robocop_grade.py", str(SHARE), "--report", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    plan = load(PLAN)
    assert f"{plan.points:g} of {plan.points:g} points, {plan.extra:g} of {plan.extra:g} extra" in done.stdout


def test_server_of_the_skeleton_is_graded_and_the_report_names_what_is_missing(tmp_path):
    made = command("robocop_new.py", str(tmp_path / "lab"))
    assert made.returncode == 0, made.stderr
    done = command(
        "robocop_grade.py", str(tmp_path / "lab/scripts/robocop_goto_as.py"), "--report", str(tmp_path / "report")
    )
    assert done.returncode == 1
    assert "No action server was created, or it was not started" in done.stdout, done.stdout + done.stderr
    html = (tmp_path / "report" / "report.html").read_text()
    assert "No action server was created" in html and "http" not in html and "src=" not in html
    assert "replay" not in html, "nothing happens in it"
    assert (tmp_path / "report" / "report.json").exists()
    with rosbag.Bag(tmp_path / "report" / "server-start.bag") as bag:  # one that was closed
        assert "/scan" in bag.get_type_and_topic_info().topics
    assert command("robocop_new.py", str(tmp_path / "lab")).returncode == 1


def test_grading_interrupted_twice_leaves_no_folders_or_processes_behind(tmp_path):
    solution, scratch = tmp_path / "robocop_goto_as.py", tmp_path / "scratch"
    solution.write_text(RIGHT["base_server"])
    scratch.mkdir()
    with open(tmp_path / "output", "w") as output:
        grading = subprocess.Popen(
            ["rosrun", "aro_robocop_goto_as", "robocop_grade.py", str(solution)],
            stdout=output,
            stderr=output,
            env={**os.environ, "TMPDIR": str(scratch)},
        )
    deadline = time.monotonic() + 240.0  # [s, wall] on a busy machine
    # The first scenario is over, the second has begun. Not by glob: folders come and go meanwhile.
    while not any("server-start.bag" in files for _, _, files in os.walk(scratch)):
        assert grading.poll() is None and time.monotonic() < deadline, (tmp_path / "output").read_text()
        time.sleep(0.01)
    with busy_processes():
        for number in (signal.SIGHUP, signal.SIGINT):
            grading.send_signal(number)
        assert grading.wait(240.0) == INTERRUPTED, (tmp_path / "output").read_text()
    assert "Traceback" not in (tmp_path / "output").read_text()
    assert list(scratch.iterdir()) == []
    assert processes_mentioning(scratch) == []


def test_wrong_solutions_are_valid_python_with_unique_names_and_checks_from_the_plan():
    checks = {check.name for check in load(PLAN).checks}
    assert len({wrong.name for wrong in WRONG}) == len(WRONG)
    for wrong in WRONG:
        compile(wrong.text(), wrong.name, "exec")
        assert wrong.text() != (HERE / wrong.base).read_text()
        assert wrong.check in checks
