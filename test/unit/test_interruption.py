"""A signal that comes in a deferred block reaches its handler at the end of it, a second one at once."""

import signal
import subprocess
import sys

import pytest

DEADLINE = 30.0  # [s, wall]
BEGIN = """
import os, signal
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


def test_second_signal_does_not_wait(number):
    code = """
with Deferred():
    os.kill(os.getpid(), number)
    print("first", flush=True)
    os.kill(os.getpid(), number)
    print("second", flush=True)
"""
    said, status = said_by(code, number)
    assert said[0] == "first" and said[-1] == "second" and "handled" in said[1:-1] and status == 0


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
