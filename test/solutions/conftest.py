"""Long tests, and tests that need more privileges than some machines grant, run only with --all."""


def pytest_ignore_collect(collection_path, config):
    """Leave the attacks out of an ordinary run."""
    return True if collection_path.name == "test_attacks.py" and not config.getoption("--all") else None
