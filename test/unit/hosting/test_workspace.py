"""What is shown of a build that failed."""

from pathlib import Path

import pytest

from robocop_hosting.workspace import build_once, error_of

WARNING = """-- catkin 0.8.10
CMake Warning at /usr/share/genmsg/cmake/genmsg-extras.cmake:49 (message):
  Unknown message generator specified in ROS_LANG_DISABLE: gennodejs
"""


@pytest.mark.parametrize(
    "error",
    [
        "CMake Error at lab/CMakeLists.txt:12 (ad_message_files):",
        "lab/x.cpp:1:14: error: 'retrn' was not declared in this scope",
        "Traceback (most recent call last):",
    ],
)
def test_log_of_a_failed_build_is_shown_from_the_first_error_with_paths_inside_the_workspace(error: str) -> None:
    log = f"{WARNING}{error.replace('lab', '/build/lab')}\n" + "further\n" * 100
    assert error_of(log, Path("/build")).splitlines()[:2] == [error, "further"]


def test_log_of_a_failed_build_without_an_error_is_shown_by_its_end() -> None:
    assert error_of("line\n" * 100 + "last\n", Path("/build")).splitlines()[-2:] == ["line", "last"]


def test_a_workspace_that_was_moved_is_built_again(tmp_path: Path) -> None:
    built = []

    def use(folder: Path) -> None:
        build_once(folder, "checksums", {}, lambda: built.append(folder) or {})

    here, there = tmp_path / "here", tmp_path / "there"
    (here / "devel").mkdir(parents=True)
    (here / "devel" / "setup.bash").touch()
    use(here)
    use(here)
    here.rename(there)
    use(there)
    assert built == [here, there]
