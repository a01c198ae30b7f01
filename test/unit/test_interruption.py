"""A signal ends a program where that can be: not twice, not halfway through a block, and not unheard."""

import signal
import subprocess
import sys

import pytest

DEADLINE = 30.0  # [s, wall]
BEGIN = """
import os, signal
from aro_robocop_goto_as import interruption
from aro_robocop_goto_as.interruption import Deferred
number = int({number})
signal.signal(number, lambda *_: print("handled", flush=True))
"""


def said_by(code, number):
    program = subprocess.run([sys.executable, "-c", BEGIN.format(number=int(number)) + code], stdout=subprocess.PIPE,
                             text=True, timeout=DEADLINE)
    return program.stdout.split(), program.returncode


@pytest.fixture(params=[signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def number(request):
    return request.param


def test_signal_waits_for_the_end_of_the_block(number):
    code = """
with Deferred():
    os.kill(os.getpid(), number)
    print("block", flush=True)
print("after", flush=True)
"""
    assert said_by(code, number) == (["block", "handled", "after"], 0)


def test_more_signals_wait_as_well_and_are_one(number):
    code = """
with Deferred():
    os.kill(os.getpid(), number)
    os.kill(os.getpid(), signal.SIGTERM)
    print("block", flush=True)
"""
    assert said_by(code, number) == (["block", "handled"], 0)


def test_signal_waits_for_a_block_that_fails_too(number):
    code = """
try:
    with Deferred():
        os.kill(os.getpid(), number)
        raise OSError
except OSError:
    print("failed", flush=True)
"""
    assert said_by(code, number) == (["handled", "failed"], 0)


def test_default_of_the_signal_ends_the_process_after_the_block(number):
    code = """
signal.signal(number, signal.SIG_DFL)
with Deferred():
    os.kill(os.getpid(), number)
    print("block", flush=True)
print("after", flush=True)
"""
    assert said_by(code, number) == (["block"], -number)


def test_handlers_are_as_before_when_nothing_came(number):
    code = """
with Deferred():
    pass
os.kill(os.getpid(), number)
"""
    assert said_by(code, number) == (["handled"], 0)


def test_ctrl_c_comes_once(number):
    code = """
interruption.as_ctrl_c()
try:
    os.kill(os.getpid(), number)
except KeyboardInterrupt:
    for again in interruption.ENDING_SIGNALS:
        os.kill(os.getpid(), again)
    print("cleaned", flush=True)
"""
    assert said_by(code, number) == (["cleaned"], 0)


def test_ctrl_c_that_somebody_took_for_a_failure_comes_at_the_next_check(number):
    code = """
interruption.as_ctrl_c()
interruption.check()
try:
    os.kill(os.getpid(), number)
except BaseException:
    print("swallowed", flush=True)
try:
    interruption.check()
except KeyboardInterrupt:
    print("raised", flush=True)
"""
    assert said_by(code, number) == (["swallowed", "raised"], 0)


@pytest.mark.parametrize("taken", ["interruption.as_ctrl_c()", "Deferred().__enter__()"])
def test_who_was_started_with_nohup_goes_on_when_the_terminal_closes(taken):
    code = f"""
signal.signal(signal.SIGHUP, signal.SIG_IGN)
{taken}
os.kill(os.getpid(), signal.SIGHUP)
print(signal.getsignal(signal.SIGHUP) is signal.SIG_IGN, flush=True)
"""
    assert said_by(code, signal.SIGUSR1) == (["True"], 0)
