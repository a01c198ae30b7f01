"""What `robocop new --gradescope` writes: an autograder, run here with a stand-in for ./robocop."""

import json
import re
import subprocess
import zipfile
from pathlib import Path

import pytest
from support import ROOT

from robocop_grading.new import make_autograder

RESULT = {"score": 5.0}
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
        (tmp_path / "bin" / "robocop").write_text(STAND_IN % (json.dumps(RESULT), does))
        (tmp_path / "bin" / "robocop").chmod(0o755)
        environment = {"PATH": f"{tmp_path}/bin:/usr/bin:/bin", "AUTOGRADER": str(top), "TMPDIR": str(tmp_path)}
        done = subprocess.run(["bash", top / "source" / program], env=environment, capture_output=True, text=True)
        return done.returncode, top

    return run


# What ./robocop does where the sandbox can't run, and with nothing to grade.
REFUSED = 'case "$*" in *--unsafe) write;; *) echo "robocop grade: bubblewrap can\'t run here: no" >&2; exit 2;; esac'
NOTHING = 'echo "robocop grade: nothing to grade" >&2; exit 4'
MISSING = 'echo "robocop grade: python3-seccomp is not installed" >&2; exit 2'
NO_POINTS = {"score": 0, "output": "robocop grade: nothing to grade\n"}


@pytest.mark.parametrize(
    "does, status, result, unsafe",
    [
        pytest.param("write; exit 1", 0, RESULT, [False], id="points, also where checks failed"),
        pytest.param(REFUSED, 0, RESULT, [False, True], id="without the sandbox where it cannot run, and only there"),
        pytest.param(NOTHING, 0, NO_POINTS, [False], id="no points, and the reason"),
        pytest.param("exit 3", 1, None, [False], id="nothing where the machine has no time"),
        pytest.param(MISSING, 1, None, [False], id="nothing where something is not installed"),
        pytest.param("write; exit 3", 1, None, [False], id="nothing where the grader failed"),
    ],
)
def test_gradescope_gets_the_points_or_the_reason(does, status, result, unsafe, autograder):
    done, top = autograder(does)
    path, calls = top / "results" / "results.json", (top / "calls").read_text().splitlines()
    assert done == status and (json.loads(path.read_text()) if path.exists() else None) == result
    expected = rf"grade {top}/submission --report \S+ --seed ([1-9]\d*)( --unsafe)?"
    assert all(re.fullmatch(expected, call) for call in calls)
    assert [call.endswith(" --unsafe") for call in calls] == unsafe


def test_where_robocop_is_installed_setup_does_nothing(autograder):
    status, top = autograder("exit 1", "setup.sh")
    assert status == 0 and not (top / "calls").exists()


def test_zip_has_what_an_installation_needs(tmp_path):
    make_autograder(Path(ROOT), tmp_path / "lab.zip")
    with zipfile.ZipFile(tmp_path / "lab.zip") as archive:
        names = set(archive.namelist())
        executable = archive.getinfo("run_autograder").external_attr >> 16 & 0o111
    assert {"setup.sh", "run_autograder", "robocop/robocop", "robocop/package.xml"} <= names
    assert {"robocop/config/grading.yaml", "robocop/src/robocop_grading/agent/clock.py"} <= names
    assert not any("__pycache__" in name for name in names)
    assert executable
