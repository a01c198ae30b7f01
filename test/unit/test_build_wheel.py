"""Building a wheel where PyPI has only a source release; pip is real, the source release is small."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest
from fake_index import builds, source_release

from aro_robocop_goto_as.bootstrap import build_wheel

WANTED = "pybullet==3.2.7"


@pytest.fixture
def index(tmp_path, monkeypatch):
    """The index; its file `builds` has a line for each build."""
    for name, value in source_release(tmp_path / "index").items():
        monkeypatch.setenv(name, value)
    return tmp_path / "index"


def test_the_wheel_is_built_outside_tmp_with_the_flag_that_gcc_14_needs_and_kept(index, tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("CFLAGS", "-O1")
    assert build_wheel.build(sys.executable, WANTED, tmp_path / "wheels")
    flags, scratch = builds(index)[0].split("|")
    assert flags == "-O1 -Wno-incompatible-pointer-types"
    assert Path(scratch).parent == tmp_path / "wheels"
    assert sorted(path.name for path in (tmp_path / "wheels").iterdir()) == [".lock", "pybullet-3.2.7-py3-none-any.whl"]
    output = capfd.readouterr()
    assert output.err.startswith(f"robocop: building {WANTED} on ") and "this takes about " in output.err


def test_progress_is_shown_with_the_elapsed_time(index, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(build_wheel, "PROGRESS_PERIOD", 0.2)
    monkeypatch.setenv("BUILD_SECONDS", "1")
    assert build_wheel.build(sys.executable, WANTED, tmp_path / "wheels")
    assert f"robocop: building {WANTED}: 0 s\nrobocop: building {WANTED}: " in capfd.readouterr().err


@pytest.mark.parametrize("seconds, text", [(0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 00 s"), (330.0, "5 min 30 s")])
def test_elapsed_time_for_a_person(seconds, text):
    assert build_wheel.duration(seconds) == text


def test_a_build_that_fails_leaves_no_wheel_and_its_error_on_standard_output(index, tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("BUILD_FAILS", "1")
    assert not build_wheel.build(sys.executable, WANTED, tmp_path / "wheels")
    assert [path.name for path in (tmp_path / "wheels").iterdir()] == [".lock"]
    assert "caster.cpp:7: error: no such thing" in capfd.readouterr().out


def test_of_two_builds_at_once_the_second_waits_and_uses_the_wheel_of_the_first(index, tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("BUILD_SECONDS", "1")
    results = []

    def build():
        results.append(build_wheel.build(sys.executable, WANTED, tmp_path / "wheels"))

    threads = [threading.Thread(target=build) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [True, True]
    assert len(builds(index)) == 1
    assert "waiting for another checkout" in capfd.readouterr().err


def test_folder_that_can_not_be_made_is_an_error_with_its_path(index, tmp_path):
    (tmp_path / "file").write_text("")
    command = [sys.executable, "-m", build_wheel.__name__, sys.executable, WANTED, str(tmp_path / "file" / "wheels")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1
    assert f"{tmp_path}/file" in done.stderr and "Traceback" not in done.stderr
