"""The sandbox."""

import pytest

from robocop_grading.sandbox.bubblewrap import open_sandbox


@pytest.fixture(scope="session")
def sandbox():
    """The sandbox; GradingError says why this machine can't have one."""
    return open_sandbox(False)
