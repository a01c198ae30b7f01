"""Commands of a build end, whatever they do, and leave what they have made."""

import os

import pytest

from robocop_grading.errors import GradingError
from robocop_grading.sandbox import build
from robocop_hosting.workspace import output_of


@pytest.fixture
def run(sandbox, tmp_path):
    """Runs a command of a build in the folder workspace: its exit status, output and errors."""
    (tmp_path / "workspace").mkdir()
    return lambda command: output_of(build.runner_in(sandbox, tmp_path / "workspace", []), command, {})


def test_command_writes_to_the_folder_of_the_build(run, tmp_path):
    assert run(["touch", "made"]) == (0, b"", "")
    assert (tmp_path / "workspace" / "made").exists()


@pytest.mark.parametrize(
    "name, make, reason",
    [
        ("pipe", os.mkfifo, "pipe: expected an ordinary file"),
        ("data.bin", lambda path: path.write_bytes(bytes(build.MAX_SOURCE + 1)), "data.bin with 64.0 MB"),
    ],
)
def test_file_that_can_not_be_copied_is_named(name, make, reason, tmp_path):
    (tmp_path / "lab").mkdir()
    make(tmp_path / "lab" / name)
    with pytest.raises(GradingError, match=f"lab/{reason}|largest file in it is .*/{reason}"):
        build.build({"lab": tmp_path / "lab"}, tmp_path / "workspace", {}, [], None)


def test_command_that_waits_for_something_that_does_not_come_is_ended(run, monkeypatch):
    monkeypatch.setattr(build, "BUILD_TIMEOUT", 1.0)
    with pytest.raises(GradingError, match="sleep was not done within 1 s"):
        run(["sleep", "600"])
