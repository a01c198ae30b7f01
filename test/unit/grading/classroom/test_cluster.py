"""Why a task of a cluster has no result, or why there is no cluster."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from robocop_grading.classroom import cluster
from robocop_grading.errors import GradingSetupError, UngradableError


@pytest.mark.parametrize(
    "status, error, problem",
    [
        ("finished", None, ""),
        ("error", UngradableError("the machine is busy"), "no grade: the machine is busy"),
        ("error", ZeroDivisionError("by 0"), "could not be graded: ZeroDivisionError: by 0"),
        ("lost", None, "no grade: the connection to the scheduler was lost"),
    ],
)
def test_path_is_told_with_what_went_wrong(status, error, problem, monkeypatch):
    class Future:  # dask's, of a task that has ended
        exception = staticmethod(lambda: error)

    Future.status = status
    monkeypatch.setattr(cluster, "as_completed", list)
    client = SimpleNamespace(map=lambda task, paths, pure: [Future() for _ in paths])
    assert list(cluster.done(client, print, [Path("anna")])) == [(Path("anna"), problem)]


@pytest.mark.filterwarnings("ignore:make_current")
def test_scheduler_that_can_not_be_reached_is_named():
    refused = pytest.raises(GradingSetupError, match="no dask scheduler answers at tls://127.0.0.1:1: ")
    with refused, cluster.connected("tls://127.0.0.1:1", 1):
        pass
