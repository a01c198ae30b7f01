"""For all tests: the slow ones run only with --all, SIGINT ends what they start, --busy N runs them beside a load."""

import os
import signal

import processes
import pytest
import waiting
from hypothesis import settings

# A shell without job control starts background jobs with SIGINT ignored, and ignored signals are inherited.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Always the same examples, and no limit on their time: a busy machine must not make a test fail.
settings.register_profile("all", derandomize=True, deadline=None, max_examples=200)
settings.register_profile("selection", settings.get_profile("all"), max_examples=30)


def pytest_addoption(parser):
    """./robocop test --all --busy N"""
    parser.addoption("--all", action="store_true", help="also the tests marked slow, and more examples of properties")
    parser.addoption(
        "--busy", type=int, default=0, metavar="N", help="run beside N endless loops, with longer deadlines"
    )


@pytest.hookimpl(tryfirst=True)  # before pytest-timeout reads its option
def pytest_configure(config):
    count = config.getoption("--busy")
    if count and not hasattr(config, "workerinput"):  # the workers of pytest-xdist inherit the environment
        os.environ[waiting.PATIENCE] = str(1.0 + count / (os.cpu_count() or 1))
        load = processes.busy_processes(count)
        load.__enter__()
        config.add_cleanup(lambda: load.__exit__(None, None, None))
    if config.option.timeout is None:
        config.option.timeout = float(config.getini("timeout")) * waiting.patience()
    settings.load_profile("all" if config.getoption("--all") else "selection")


def pytest_report_header(config):
    return None if config.getoption("--all") else "tests marked slow are left out; --all runs them too"


def pytest_collection_modifyitems(config, items):
    chosen = {item: config.getoption("--all") or not item.get_closest_marker("slow") for item in items}
    config.hook.pytest_deselected(items=[item for item in items if not chosen[item]])
    items[:] = [item for item in items if chosen[item]]
    for item in items:
        limit = item.get_closest_marker("timeout")
        if limit:
            item.add_marker(pytest.mark.timeout(limit.args[0] * waiting.patience()), append=False)
