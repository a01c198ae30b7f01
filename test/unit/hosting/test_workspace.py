"""What is shown of a build that failed."""

import os
from pathlib import Path

import pytest

from robocop_hosting.errors import HostingError
from robocop_hosting.workspace import build_once, copy_sources, error_of, folder_for

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
def test_log_of_a_failed_build_is_shown_from_the_first_error_with_paths_inside_the_workspace(error):
    log = f"{WARNING}{error.replace('lab', '/build/lab')}\n" + "further\n" * 100
    assert error_of(log, Path("/build")).splitlines()[:2] == [error, "further"]


def test_log_of_a_failed_build_without_an_error_is_shown_by_its_end():
    assert error_of("line\n" * 100 + "last\n", Path("/build")).splitlines()[-2:] == ["line", "last"]


def test_a_workspace_that_was_moved_is_built_again(tmp_path):
    built = []

    def use(folder):
        build_once(folder, {}, lambda: built.append(folder) or {})

    here, there = tmp_path / "here", tmp_path / "there"
    (here / "devel").mkdir(parents=True)
    (here / "devel" / "setup.bash").touch()
    use(here)
    use(here)
    here.rename(there)
    use(there)
    assert built == [here, there]


def test_a_changed_renamed_or_new_source_file_is_built_in_another_folder(tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    (source / "one").write_text("text")
    folders = [folder_for(tmp_path, source), folder_for(tmp_path, source)]
    (source / "one").write_text("another text")
    folders.append(folder_for(tmp_path, source))
    (source / "one").rename(source / "two")
    folders.append(folder_for(tmp_path, source))
    (source / "three").touch()
    folders.append(folder_for(tmp_path, source))
    assert len({*folders}) == 4 and folders[0] == folders[1]


def test_sources_are_copied_without_links_that_lead_nowhere_as_editors_make_them(tmp_path):
    source = tmp_path / "lab"
    source.mkdir()
    (source / "server.py").touch()
    (source / ".#server.py").symlink_to("somebody@host.123")
    copy_sources({"lab": source}, tmp_path / "workspace")
    assert [path.name for path in (tmp_path / "workspace" / "src" / "lab").iterdir()] == ["server.py"]
    (source / "pipe").mkdir(mode=0)
    os.mkfifo(source / "fifo")
    with pytest.raises(HostingError, match="lab: can't be copied: [^(]*$"):
        copy_sources({"lab": source}, tmp_path / "workspace")
