"""Files of others are read only if they are ordinary ones in the folder that they have to be in."""

import os

import pytest

from aro_robocop_goto_as.errors import HostingError
from robocop_grading.hosting.files import read_bytes


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
