"""What becomes of a part whose run is cut short, and what a run leaves behind."""

import signal

import pytest
from grading_records import PLAN
from processes import processes_mentioning

from aro_robocop_goto_as.physics.quiet_pybullet import pybullet
from robocop_grading import runner as module
from robocop_grading.errors import GraderLostError, UngradableError
from robocop_grading.record import NodeEnd, Record
from robocop_grading.runner import Runner
from robocop_grading.sandbox import guard
from robocop_grading.submission import Script, Submission

MEMORY = "its processes together took more than 2048 MB of memory"


def recorded(folder, text="", **options):
    """The outcome of a server that is this program, which is started without a sandbox."""
    (folder / "server.py").write_text(text)
    script = Script("server", folder / "server.py", "node")
    return Runner(PLAN, folder, **options).run(Submission("anna", {}, [script]), script, folder / "out")


@pytest.fixture
def scenarios(monkeypatch):
    """Sets what the scenarios do, and the record of one that they leave."""

    def set_to(do, record=None):
        class Fake:
            def __init__(self, *_):
                self.scenario, self.records = "far", {} if record is None else {record.name: record}
                self.scenarios, self.close = do, lambda: None

        monkeypatch.setattr(module, "ServerRun", Fake)
        monkeypatch.setattr(module, "Stage", lambda: None)

    return set_to


def failing(error):
    def fail():
        raise error

    return fail


def test_run_for_which_the_machine_has_no_time_gets_no_grade_and_leaves_nothing(tmp_path):
    before = [pybullet.isConnected(number) for number in range(9)]
    with pytest.raises(UngradableError, match="^server: not done within 0 s, stopped at start$"):
        recorded(tmp_path, "import time\ntime.sleep(1e6)", budget=0.0)
    assert processes_mentioning(tmp_path) == []
    assert [pybullet.isConnected(number) for number in range(9)] == before


def test_what_the_system_refuses_the_grader_is_an_error_and_not_blamed_on_the_submission(scenarios, tmp_path):
    scenarios(failing(OSError(28, "No space left on device")))
    with pytest.raises(UngradableError, match="No space left on device$"):
        recorded(tmp_path)


def test_run_is_cut_short_by_a_node_that_gives_answers_that_can_not_be_true(scenarios, tmp_path):
    scenarios(failing(GraderLostError("it lies")))
    assert recorded(tmp_path).problem == "the run was cut short during far: it lies"


@pytest.mark.parametrize(
    "end, more, is_graded",
    [
        (NodeEnd(1.0, 137), 1, False),  # as bubblewrap reports it
        (NodeEnd(1.0, -signal.SIGKILL), 1, False),
        (NodeEnd(1.0, 137), 0, True),
        (NodeEnd(1.0, -signal.SIGKILL, MEMORY), 1, True),
        (NodeEnd(1.0, 1), 1, True),
        (NodeEnd(1.0, 128 + signal.SIGXCPU), 1, True),  # from its own limit
    ],
)
def test_node_that_the_kernel_may_have_killed_for_memory_gets_no_grade(
    end, more, is_graded, scenarios, tmp_path, monkeypatch
):
    counter = tmp_path / "vmstat"
    counter.write_text("pgfault 5\noom_kill 3\nswap_ra 7\n")
    monkeypatch.setattr(guard, "COUNTERS", counter)
    scenarios(lambda: counter.write_text(f"oom_kill {3 + more}"), Record("far", "server", node_ends=(end,)))
    if is_graded:
        assert recorded(tmp_path).records["far"].node_ends == (end,)
    else:
        with pytest.raises(UngradableError, match="^server: the machine ran out of memory$"):
            recorded(tmp_path)


def test_kernel_that_does_not_tell_has_killed_nothing(tmp_path, monkeypatch):
    assert guard.kernel_kills() >= 0
    monkeypatch.setattr(guard, "COUNTERS", tmp_path / "vmstat")
    assert guard.kernel_kills() == 0
