"""Commands of a build end, whatever they do."""

import pytest

from aro_robocop_goto_as.errors import GradingError
from robocop_grading.sandbox import build
from robocop_hosting.workspace import output_of


def test_command_that_waits_for_something_that_does_not_come_is_ended(sandbox, tmp_path, monkeypatch):
    (tmp_path / "workspace").mkdir()
    run = build.runner_in(sandbox, tmp_path / "workspace", [])
    assert output_of(run, ["echo", "done"], {}) == (0, b"done\n", "")
    monkeypatch.setattr(build, "BUILD_TIMEOUT", 1.0)
    with pytest.raises(GradingError, match="sleep was not done within 1 s"):
        output_of(run, ["sleep", "600"], {})
