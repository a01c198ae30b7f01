"""Signals end a program once, never within a deferred block, and even if a library swallows the exception."""

import signal
import subprocess
import sys

import pytest

DEADLINE = 30.0  # [s, wall]
BEGIN = """
import os, signal
from aro_robocop_goto_as.process import signals
from aro_robocop_goto_as.process.signals import Deferred
number = int({number})
signal.signal(number, lambda *_: print("handled", flush=True))
"""


def output_of(code, number):
    program = subprocess.run(
        [sys.executable, "-c", BEGIN.format(number=int(number)) + code],
        stdout=subprocess.PIPE,
        text=True,
        timeout=DEADLINE,
    )
    return program.stdout.split(), program.returncode


@pytest.fixture(params=[signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def number(request):
    return request.param


def test_signal_is_deferred_to_the_end_of_the_block_whoever_handles_it(number):
    code = """
with Deferred():
    os.kill(os.getpid(), number)
    print("block", flush=True)
print("after", flush=True)
"""
    assert output_of(code, number) == (["block", "handled", "after"], 0)
    assert output_of(f"signal.signal(number, signal.SIG_DFL)\n{code}", number) == (["block"], -number)


def test_keyboard_interrupt_is_raised_only_once(number):
    code = """
signals.interrupt_on_signal()
try:
    os.kill(os.getpid(), number)
except KeyboardInterrupt:
    for again in signals.ENDING_SIGNALS:
        os.kill(os.getpid(), again)
    print("cleaned", flush=True)
"""
    assert output_of(code, number) == (["cleaned"], 0)


def test_swallowed_keyboard_interrupt_is_raised_again(number):
    code = """
signals.interrupt_on_signal()
signals.reraise_if_interrupted()
try:
    os.kill(os.getpid(), number)
except BaseException:
    print("swallowed", flush=True)
try:
    signals.reraise_if_interrupted()
except KeyboardInterrupt:
    print("raised", flush=True)
"""
    assert output_of(code, number) == (["swallowed", "raised"], 0)


@pytest.mark.parametrize("set_handlers", ["signals.interrupt_on_signal()", "Deferred().__enter__()"])
def test_process_started_with_nohup_survives_sighup(set_handlers):
    code = f"""
signal.signal(signal.SIGHUP, signal.SIG_IGN)
{set_handlers}
os.kill(os.getpid(), signal.SIGHUP)
print(signal.getsignal(signal.SIGHUP) is signal.SIG_IGN, flush=True)
"""
    assert output_of(code, signal.SIGUSR1) == (["True"], 0)
