"""What `robocop new --gradescope` writes: an autograder, run here with a stand-in for ./robocop."""

import json
import subprocess
import zipfile
from pathlib import Path

import pytest
from support import ROOT

from robocop_grading.new import make_autograder

RESULT = '{"score": 5.0}'
# Writes its arguments, and does what the test says.
STAND_IN = """#!/usr/bin/env bash
echo "$*" >>"$AUTOGRADER/calls"
report=$4
write() { echo '%s' >"$report/results.json"; }
%s
"""


@pytest.fixture
def autograder(tmp_path):
    """Gradescope's folder with the unpacked zip; runs run_autograder with a stand-in, and gives its status."""
    make_autograder(Path(ROOT), tmp_path / "lab.zip")
    top = tmp_path / "autograder"
    with zipfile.ZipFile(tmp_path / "lab.zip") as archive:
        archive.extractall(top / "source")

    def run(does, program="run_autograder"):
        (tmp_path / "bin").mkdir()
        (tmp_path / "bin" / "robocop").write_text(STAND_IN % (RESULT, does))
        (tmp_path / "bin" / "robocop").chmod(0o755)
        environment = {"PATH": f"{tmp_path}/bin:/usr/bin:/bin", "AUTOGRADER": str(top), "TMPDIR": str(tmp_path)}
        done = subprocess.run(["bash", top / "source" / program], env=environment, capture_output=True, text=True)
        return done.returncode, top

    return run


def results(top):
    return json.loads((top / "results" / "results.json").read_text())


def test_points_reach_gradescope_also_where_checks_failed(autograder):
    status, top = autograder("write; exit 1")
    assert status == 0 and results(top) == {"score": 5.0}
    assert (top / "calls").read_text().startswith(f"grade {top}/submission --report ")


def test_sandbox_is_left_out_only_where_it_cannot_run(autograder):
    refused = "robocop grade: bubblewrap can't run here: no namespaces"
    status, top = autograder(f'case "$*" in *--unsafe) write;; *) echo "{refused}" >&2; exit 1;; esac')
    assert status == 0 and results(top) == {"score": 5.0}
    first, second = (top / "calls").read_text().splitlines()
    assert "--unsafe" not in first and second.endswith("--unsafe")


def test_hand_in_that_is_nothing_gets_no_points_and_the_reason(autograder):
    status, top = autograder('echo "robocop grade: nothing to grade" >&2; exit 1')
    assert status == 0 and results(top) == {"score": 0, "output": "robocop grade: nothing to grade\n"}


def test_where_the_machine_has_no_time_there_is_no_result(autograder):
    status, top = autograder("exit 3")
    assert status == 1 and not (top / "results" / "results.json").exists()


def test_where_robocop_is_installed_setup_does_nothing(autograder):
    status, top = autograder("exit 1", "setup.sh")
    assert status == 0 and not (top / "calls").exists()


def test_zip_has_what_an_installation_needs(tmp_path):
    make_autograder(Path(ROOT), tmp_path / "lab.zip")
    with zipfile.ZipFile(tmp_path / "lab.zip") as archive:
        names = set(archive.namelist())
        executable = archive.getinfo("run_autograder").external_attr >> 16 & 0o111
    assert {"setup.sh", "run_autograder", "robocop/robocop", "robocop/package.xml"} <= names
    assert {"robocop/config/grading_texts.yaml", "robocop/src/robocop_grading/agent/clock.py"} <= names
    assert not any("__pycache__" in name for name in names)
    assert executable
