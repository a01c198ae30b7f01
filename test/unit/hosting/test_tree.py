"""Folders nested deeper than Python can recurse are walked, refused and removed; only ordinary files are read."""

import os
import subprocess
import sys

import pytest

from robocop_hosting import tree
from robocop_hosting.errors import HostingError
from robocop_hosting.tree import read_bytes

NESTED = "import os\nfor _ in range(1500):\n    os.mkdir('nested')\n    os.chdir('nested')\nopen('file', 'w').close()\n"
TIMEOUT = 60.0  # [s, wall]


@pytest.fixture
def nested(tmp_path):
    """A folder with 1,500 nested ones, whose innermost path is longer than the system takes."""
    folder = tmp_path / "deep"
    folder.mkdir()
    subprocess.run([sys.executable, "-c", NESTED], cwd=folder, check=True, timeout=TIMEOUT)
    yield folder
    subprocess.run(["rm", "-rf", folder], check=True)


def test_pointer_of_git_lfs_is_not_read_as_the_file_that_it_stands_for(tmp_path):
    (tmp_path / "a.py").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 2048\n")
    with pytest.raises(HostingError, match="a.py: this is a pointer of Git LFS, the file itself was not handed in"):
        read_bytes(tmp_path / "a.py")


def test_a_temporary_folder_is_removed_with_its_files():
    with tree.temporary_folder("robocop-test-") as folder:
        (folder / "file").touch()
    assert not folder.exists()


def test_walk_refuses_deeply_nested_folders_without_recursion(nested):
    with pytest.raises(HostingError, match="expected at most 100 nested folders"):
        list(tree.walk(nested))


def test_deeply_nested_folders_are_removed(nested):
    tree.remove(nested)
    assert not nested.exists()


def test_walk_lists_sorted_names_and_does_not_follow_links(tmp_path):
    (tmp_path / "b").mkdir()
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "x.launch").touch()
    (tmp_path / "left_out").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "a")
    levels = [(path.name, folders, files) for path, folders, files in tree.walk(tmp_path, {"left_out"})]
    assert levels == [(tmp_path.name, ["a", "b"], ["link"]), ("a", [], ["x.launch"]), ("b", [], [])]


def test_remove_takes_a_link_and_leaves_what_it_leads_to(tmp_path):
    (tmp_path / "kept").mkdir()
    os.symlink(tmp_path / "kept", tmp_path / "link")
    tree.remove(tmp_path / "link")
    tree.remove(tmp_path / "nothing")
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


@pytest.fixture
def top(tmp_path):
    """A folder, with a secret beside it."""
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "top" / "inner").mkdir(parents=True)
    (tmp_path / "top" / "inner" / "file").write_text("content")
    return tmp_path / "top"


def test_file_in_the_folder_is_read_also_by_way_of_a_link_within_it(top):
    (top / "link").symlink_to("inner/file")
    for path in (top / "inner" / "file", top / "link"):
        assert read_bytes(path, top) == b"content"


@pytest.mark.parametrize("target", ["secret", "top2/file", "missing"])
@pytest.mark.parametrize("kind", ["file", "folder"])
def test_link_that_leads_out_of_the_folder_is_refused(kind, target, top):
    (top.parent / "top2").mkdir()
    (top.parent / "top2" / "file").write_text("secret")
    if kind == "file":
        (top / "link").symlink_to(top.parent / target)
        path = top / "link"
    else:
        (top / "link").symlink_to("../..")
        path = top / "link" / top.parent.name / target
    with pytest.raises(HostingError, match="expected an ordinary file, not a link to one elsewhere"):
        read_bytes(path, top)


def test_what_is_no_ordinary_file_is_refused_without_opening_it(top):
    os.mkfifo(top / "pipe")
    (top / "itself").symlink_to("itself")
    for path in (top / "pipe", top / "inner", top / "itself", top / "missing"):
        with pytest.raises(HostingError, match="expected an ordinary file"):
            read_bytes(path, top)
