"""Files that are not SDF, or not safe to parse, are refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sdf_files import raised_by

BROKEN_FRAMES = {  # case: (the whole file, line of the error, what the message must name)
    "not SDF": ("<gazebo version='1.0'/>", 1, ["<gazebo>", "<sdf>"]),
    "a robot's description": ("<?xml version='1.0'?>\n<robot name='r'/>", 2, ["<robot>, expected <sdf>"]),
    "xacro": (
        "<sdf version='1.6' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:wall length='3'/></sdf>",
        2,
        ["<xacro:...>, expected the file that xacro makes of it"],
    ),
    "unsupported version": ("\n<sdf version='1.3'><world name='w'/></sdf>", 2, ["'1.3'", "1.4 and later"]),
    "two worlds": ("<sdf version='1.7'><world name='a'/>\n<world name='b'/></sdf>", 2, ["second <world>"]),
    "light outside of a world": ("<sdf version='1.7'>\n<light name='stray'/></sdf>", 1, ["<sdf> has no <world>"]),
    "world without a name": ("<sdf version='1.7'>\n<world/></sdf>", 2, ["<world> has no name"]),
    "empty file": ("", 1, ["XML"]),
    "undeclared entity": ("<sdf version='1.7'>\n<world name='w'>&x;</world></sdf>", 2, ["'x'", "XML"]),
}


@pytest.mark.parametrize(("text", "line", "named"), BROKEN_FRAMES.values(), ids=BROKEN_FRAMES.keys())
def test_file_that_is_not_a_world_is_refused_with_file_line_and_name(tmp_path, text, line, named):
    path = tmp_path / "w.sdf"
    path.write_text(text, encoding="utf-8")
    message = raised_by(path)
    assert message.startswith(f"{path}:{line}: ")
    assert [name for name in named if name not in message] == []


@pytest.mark.parametrize("dtd", ["", '[<!ENTITY e SYSTEM "file:///etc/hostname">]'])
def test_doctype_is_refused_whatever_it_declares(tmp_path, dtd):
    path = tmp_path / "w.sdf"
    path.write_text(f"<!DOCTYPE sdf {dtd}>\n<sdf version='1.7'><world name='w'/></sdf>", "utf-8")
    message = raised_by(path)
    assert message.startswith(f"{path}: ") and "DOCTYPE" in message


def test_unreadable_file_is_refused_by_name(tmp_path):
    assert "nowhere.sdf" in raised_by(tmp_path / "nowhere.sdf")
    assert str(tmp_path) in raised_by(tmp_path)


@pytest.mark.parametrize("name", ["bludiště č. 1.sdf", "50%25.sdf", "a#b?c:d.sdf"])
def test_special_characters_in_file_names_are_shown_unchanged(tmp_path, name):
    path = tmp_path / name
    path.write_text("<sdf/>", encoding="utf-8")
    assert raised_by(path).startswith(f"{path}:1: ")


@given(st.one_of(st.binary(max_size=60), st.text(max_size=60).map(lambda text: text.encode("utf-8", "replace"))))
def test_arbitrary_content_raises_only_world_errors(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "any.sdf"
    path.write_bytes(content)
    assert raised_by(path).startswith(str(path))
