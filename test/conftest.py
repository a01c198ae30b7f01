"""For all tests: the slow ones run only with --all, and SIGINT ends what they start."""

import os
import signal

from hypothesis import settings

# A shell without job control starts background jobs with SIGINT ignored, and ignored signals are inherited.
signal.signal(signal.SIGINT, signal.default_int_handler)

os.environ.setdefault("HYPOTHESIS_STORAGE_DIRECTORY", ".robocop/hypothesis")

# Always the same examples, and no limit on their time: a busy machine must not make a test fail.
settings.register_profile("all", derandomize=True, deadline=None, max_examples=200)
settings.register_profile("selection", settings.get_profile("all"), max_examples=30)


def pytest_addoption(parser):
    """./robocop test --all"""
    parser.addoption("--all", action="store_true", help="also the tests marked slow, and more examples of properties")


def pytest_xdist_auto_num_workers(config):
    """One more than there are processors, as tests often wait; with --all two, for attacks and load tests need room."""
    return 2 if config.getoption("--all") else len(os.sched_getaffinity(0)) + 1


def pytest_configure(config):
    settings.load_profile("all" if config.getoption("--all") else "selection")


def pytest_report_header(config):
    return None if config.getoption("--all") else "tests marked slow are left out; --all runs them too"


def pytest_collection_modifyitems(config, items):
    chosen = {item: config.getoption("--all") or not item.get_closest_marker("slow") for item in items}
    config.hook.pytest_deselected(items=[item for item in items if not chosen[item]])
    items[:] = [item for item in items if chosen[item]]
