"""A folder of hand-ins."""

import pytest


@pytest.fixture
def folder(tmp_path):
    """Anna handed in a folder, Ben a file; there are a link and a list as well."""
    top = tmp_path / "class"
    (top / "anna" / "scripts").mkdir(parents=True)
    (top / "anna" / "scripts" / "robocop_goto_as.py").write_text("one")
    (top / "anna" / "build").mkdir()
    (top / "anna" / "build" / "big").write_text("a build product")
    (top / "ben.py").write_text("two")
    (top / "list.csv").write_text("anna,ben")
    (top / ".hidden.py").write_text("")
    (top / "link.py").symlink_to(top / "ben.py")
    return top
