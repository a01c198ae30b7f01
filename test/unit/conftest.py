"""Fixtures and the time limit of the unit tests; functions that they share are in support.py."""

from pathlib import Path

import pytest
from subscriber_links import connected_by_hand
from support import burger, simulator

__all__ = ["burger", "connected_by_hand", "simulator"]
LIMIT = 60  # [s] a unit test that hangs is ended, and named; --all tries more examples of each property


def pytest_collection_modifyitems(config, items):
    for item in items:
        own = item.get_closest_marker("timeout") is not None
        if Path(__file__).parent in item.path.parents and not own and not config.getoption("--all"):
            item.add_marker(pytest.mark.timeout(LIMIT))
