"""How the grader interprets a session's output, with a shell in place of the session."""

import pytest
from grading_records import PLAN

from robocop_grading.errors import GradingError, UngradableError
from robocop_grading.record import Death, Record, write
from robocop_grading.runner import Runner

BUDGET = 1.0  # [s, wall]


def supervised(script, folder):
    """The outcome of a session that is this script, and the scenarios it announced."""
    announced = []
    command = ["bash", "-c", script]
    runner = Runner(PLAN, folder, on_progress=lambda _part, name: announced.append(name), budget=BUDGET)
    return runner.supervise(command, {"PATH": "/usr/bin:/bin"}, folder, "server"), announced


@pytest.mark.parametrize("script, where", [("echo begin far; sleep 60", "far"), ("sleep 60", "its start")])
def test_session_for_which_the_machine_has_no_time_gets_no_grade(script, where, tmp_path):
    with pytest.raises(UngradableError, match=f"^server: not done within 1 s, stopped at {where}$"):
        supervised(script, tmp_path)


def test_what_the_system_refuses_the_session_is_an_error_and_not_blamed_on_the_submission(tmp_path):
    with pytest.raises(GradingError, match="^No space left on device$"):
        supervised("echo error No space left on device; sleep 60", tmp_path)


@pytest.mark.parametrize("end, status", [("exit 3", 3), ("kill -9 $$", -9)])
def test_session_that_does_not_start_is_not_blamed_on_the_submission(end, status, tmp_path):
    with pytest.raises(
        UngradableError, match=rf"^server: the grader's session did not start \(status {status}\): no x$"
    ):
        supervised(f"echo no x >&2; {end}", tmp_path)


def test_session_that_fails_later_may_do_so_because_of_the_submission(tmp_path):
    recorded, _ = supervised("echo begin far; echo it lies >&2; exit 1", tmp_path)
    assert recorded.problem == "the run was cut short during far (status 1): it lies"
    assert not recorded.killed


def test_node_that_was_killed_by_nobody_known_is_named(tmp_path):
    write(Record("far", "server", deaths=(Death(1.0, 137),)), tmp_path / "server-far.record")
    recorded, _ = supervised("echo begin far", tmp_path)
    assert (recorded.killed, recorded.excused) == ("the server was killed in scenario far", False)


def test_session_that_is_killed_is_not_blamed_on_the_submission(tmp_path):
    recorded, _ = supervised("echo begin far; kill -9 $$", tmp_path)
    assert recorded.killed == "the grader's own process was killed in scenario far" and recorded.excused
