"""bench.processes: what is known of a child process, and how its end is reported."""

import signal
import sys

import pytest

from aro_robocop_goto_as.bench.processes import Child
from aro_robocop_goto_as.errors import BenchError


def test_ended_process_is_reported_with_its_last_line(tmp_path):
    with Child("the node", ["sh", "-c", "echo no such world; echo; exit 3"], tmp_path / "log") as child:
        with pytest.raises(BenchError, match="the node ended with status 3: no such world"):
            child.wait_until(lambda: child.says("running"), "never")


def test_processor_time_peak_memory_and_words_of_a_process_are_measured(tmp_path):
    code = "import time; memory = bytearray(50_000_000)\nwhile time.process_time() < 0.3: pass"
    code += "\nprint('running', flush=True); time.sleep(60)"
    with Child("the node", [sys.executable, "-c", code], tmp_path / "log") as child:
        child.wait_until(lambda: child.says("running"), "its line")
        assert 0.3 <= child.cpu() < 10.0
        assert 50e6 < child.peak_memory() < 100e6
    assert child.process.returncode == -signal.SIGINT
