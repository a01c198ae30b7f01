"""For all tests: what they start can be interrupted, even where the shell that started the tests ignores it."""

import signal

# A shell without job control starts background jobs with SIGINT ignored, and ignored signals are inherited.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser):
    """./robocop test --all"""
    parser.addoption(
        "--all", action="store_true", help="also what takes long: every solution that the judge is tried on"
    )
