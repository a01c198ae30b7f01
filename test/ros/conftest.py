"""Programs of a test; what is in nodes/ runs inside rostest, which has a master for it: test_rostests.py."""

import contextlib

import pytest

collect_ignore = ["nodes"]


@pytest.fixture
def started():
    """A function that returns a program; what is left of it at the end of the test is killed."""
    with contextlib.ExitStack() as programs:
        yield programs.enter_context
