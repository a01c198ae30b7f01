"""Long tests, and tests that need more privileges than some machines grant, run only with --all."""

import pytest

LONGEST = 1200  # [s, wall] for a test: a node that is graded takes as long as the machine needs for it


def pytest_ignore_collect(collection_path, config):
    """Leave the attacks out of an ordinary run."""
    return True if collection_path.name == "test_attacks.py" and not config.getoption("--all") else None


def pytest_collection_modifyitems(items):
    for item in items:
        if item.path.parent.name == "solutions" and item.get_closest_marker("timeout") is None:
            item.add_marker(pytest.mark.timeout(LONGEST))
