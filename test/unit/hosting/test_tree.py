"""Folders are walked and removed; files are read."""

import os

import pytest

from robocop_hosting import tree
from robocop_hosting.errors import HostingError
from robocop_hosting.tree import read_bytes


def test_pointer_of_git_lfs_is_not_read_as_the_file_that_it_stands_for(tmp_path):
    (tmp_path / "a.py").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0123\nsize 2048\n")
    with pytest.raises(HostingError, match="a.py: this is a pointer of Git LFS, the file itself was not handed in"):
        read_bytes(tmp_path / "a.py")


def test_a_temporary_folder_is_removed_with_its_files():
    with tree.temporary_folder("robocop-test-") as folder:
        (folder / "file").touch()
    assert not folder.exists()


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


def test_file_that_can_not_be_read_is_named(tmp_path):
    (tmp_path / "itself").symlink_to("itself")
    for path in (tmp_path, tmp_path / "itself", tmp_path / "missing"):
        with pytest.raises(HostingError, match=f"{path}: can't be read: "):
            read_bytes(path)
