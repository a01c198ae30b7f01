"""Packages that the plan names are checked or installed once."""

import zipfile

import pytest

from robocop_grading.errors import UngradableError
from robocop_grading.packages import Packages, provide


@pytest.fixture
def wheel(tmp_path):
    """A package of PyPI's kind, with one module."""
    path = tmp_path / "lab_extra-1.0-py3-none-any.whl"
    about = "lab_extra-1.0.dist-info"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("lab_extra.py", "answer = 42\n")
        archive.writestr(f"{about}/METADATA", "Metadata-Version: 2.1\nName: lab_extra\nVersion: 1.0\n")
        archive.writestr(f"{about}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        archive.writestr(f"{about}/RECORD", "")
    return str(path)


def test_package_of_pypi_is_installed_once(wheel, tmp_path, monkeypatch):
    folder = provide(Packages(pypi=(wheel,)), tmp_path)
    assert (folder / "lab_extra.py").read_text() == "answer = 42\n"
    monkeypatch.setattr("robocop_grading.packages._install", lambda *_: pytest.fail("installed again"))
    assert provide(Packages(pypi=(wheel,)), tmp_path) == folder


def test_package_that_can_not_be_installed_is_an_error_with_pips_reason(tmp_path):
    missing = str(tmp_path / "missing-1.0-py3-none-any.whl")
    with pytest.raises(UngradableError, match="the plan's packages can't be installed: .*missing-1.0"):
        provide(Packages(pypi=(missing,)), tmp_path)


def test_package_of_debian_has_to_be_installed(tmp_path):
    assert provide(Packages(debian=("python3-rospy",)), tmp_path) is None
    with pytest.raises(UngradableError, match="are not installed: sudo apt-get install python3-no-such-package"):
        provide(Packages(debian=("python3-rospy", "python3-no-such-package")), tmp_path)
