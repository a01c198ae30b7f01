"""Why a task of a cluster has no result."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from aro_robocop_goto_as.errors import NoTimeError
from robocop_grading.classroom import cluster


class Future:
    """dask's, of a task that has ended."""

    def __init__(self, status, error):
        self.status, self.exception = status, lambda: error


@pytest.mark.parametrize(
    "status, error, problem",
    [
        ("finished", None, ""),
        ("error", NoTimeError("the machine is busy"), "no grade: the machine is busy"),
        ("error", ZeroDivisionError("by 0"), "could not be graded: ZeroDivisionError: by 0"),
        ("lost", None, "no grade: the connection to the scheduler was lost"),
    ],
)
def test_each_path_is_told_once_with_what_went_wrong(status, error, problem, monkeypatch):
    monkeypatch.setattr(cluster, "as_completed", lambda futures: list(futures)[::-1])
    paths = [Path("anna"), Path("ben")]
    client = SimpleNamespace(map=lambda task, paths, pure: [Future(status, error) for _ in paths])
    assert list(cluster.done(client, print, paths)) == [(path, problem) for path in paths[::-1]]
