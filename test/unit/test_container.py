"""What the container image starts, and how GitHub Classroom grades with it, checked without building the image."""

import base64
import json
import os
import re
import subprocess

import pytest
import yaml
from command import ROOT, dry_run, make_program, robocop

from robocop_grading import new
from robocop_grading.checks import Failed
from robocop_grading.errors import GradingError
from robocop_grading.grades import CheckOutcome, CheckResult, Grade
from robocop_grading.plan_file import load
from robocop_grading.report.write import write
from robocop_grading.sandbox import bubblewrap as sandbox

IMAGE = "my-course/robocop:1"
PASSED = CheckResult("reaches_goal", "server", "The goal is reached.", CheckOutcome.PASSED, 2.0, 2.0, False)
LATE = Failed("at most 1 s", "2 s", 3.5, "<b>late</b>\n\n# heading [link](http://x)")
FAILED = CheckResult("one_ending", "server", "A goal ends once.", CheckOutcome.FAILED, 0.0, 1.0, False, "far", LATE)
GRADE = Grade("anna", (PASSED, FAILED))


def test_image_starts_the_lab_with_a_page():
    words = json.loads(re.search(r"^CMD (.*)", (ROOT / "Dockerfile").read_text(), re.MULTILINE)[1])
    command, _, _ = dry_run(*words)
    assert command.split()[-2:] == ["rviz:=false", "web:=true"]


@pytest.fixture
def package(tmp_path):
    """A new package for GitHub Classroom."""
    new.make(tmp_path / "lab", IMAGE)
    return tmp_path / "lab"


def steps(package):
    """The steps of the package's workflow."""
    workflow = yaml.safe_load((package / ".github" / "workflows" / "classroom.yml").read_text())
    return workflow["jobs"]["run-autograding-tests"]["steps"]


def test_package_is_for_github_only_if_an_image_is_given(package, tmp_path):
    new.make(tmp_path / "plain")
    plain = {path.relative_to(tmp_path / "plain") for path in (tmp_path / "plain").rglob("*")}
    added = {path.relative_to(package) for path in package.rglob("*")} - plain
    assert {str(path) for path in added if path.suffix} - {".github", ".devcontainer"} == {
        ".github/workflows/classroom.yml",
        ".devcontainer/devcontainer.json",
    }
    assert json.loads((package / ".devcontainer" / "devcontainer.json").read_text())["image"] == IMAGE


def run_step(step, folder, docker):
    """Run a step of the workflow with a program in place of docker; its outcome, and GitHub's three files by name."""
    (folder / "bin").mkdir(exist_ok=True)
    make_program(folder / "bin" / "docker", f"#!/bin/sh\n{docker}\n")
    (folder / "repository").mkdir(exist_ok=True)
    files = {name: folder / name for name in ("GITHUB_STEP_SUMMARY", "GITHUB_OUTPUT")}
    environment = {**os.environ, **{name: str(path) for name, path in files.items()}, "RUNNER_TEMP": str(folder)}
    environment["PATH"] = f"{folder / 'bin'}:{environment['PATH']}"
    command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]  # as GitHub's `shell: bash`
    done = subprocess.run(command, cwd=folder / "repository", env=environment, capture_output=True, text=True)
    return done, {name: path.read_text() if path.exists() else "" for name, path in files.items()}


def test_workflow_grades_the_repository_in_the_image_and_fails_with_it(package, tmp_path, monkeypatch):
    grade = next(step for step in steps(package) if step.get("name") == "Grade")
    monkeypatch.setenv("GITHUB_SHA", "0000a" + 35 * "0")
    done, _ = run_step(grade, tmp_path, f'printf "%s\\n" "$@" >{tmp_path}/arguments; echo 3 of 8 points; exit 1')
    assert (done.returncode, done.stdout) == (1, "3 of 8 points\n")
    arguments = (tmp_path / "arguments").read_text().splitlines()
    assert f"{tmp_path}/repository:/submissions/repository:ro" in arguments
    command, path, *options = arguments[arguments.index(IMAGE) + 1 :]
    assert (command, path) == ("grade", "/submissions/repository")
    assert options[options.index("--seed") + 1] == "11", "of the commit: nobody knows it before the push"
    shown = robocop("help").stdout
    assert all(option in shown for option in options if option.startswith("--"))


def test_workflow_shows_the_output_and_passes_the_points_on(package, tmp_path):
    (tmp_path / "made").mkdir()
    (tmp_path / "grade.txt").write_text("1/16 server: start\n<b>late</b>\n\n# heading\nanna: 2 of 3 points\n")
    write(GRADE, load(ROOT / "config" / "grading.yaml"), {}, tmp_path / "made")
    show = next(step for step in steps(package) if step.get("name") == "Show the result")
    done, files = run_step(show, tmp_path, f'cp -r {tmp_path}/made "$3"')
    assert done.returncode == 0, done.stderr
    lines = files["GITHUB_STEP_SUMMARY"].splitlines()
    assert lines == ["    <b>late</b>", "    ", "    # heading", "    anna: 2 of 3 points"], "no text of it is Markdown"
    points = json.loads(base64.b64decode(files["GITHUB_OUTPUT"].partition("points=")[2]))
    assert (points["status"], points["max_score"]) == ("fail", 3.0)
    assert [(test["status"], test["score"]) for test in points["tests"]] == [("pass", 2.0), ("fail", 0.0)]


def test_workflow_shows_why_nothing_could_be_graded(package, tmp_path):
    (tmp_path / "grade.txt").write_text("1/16 server: start\nrobocop grade: catkin_make failed\n")
    show = next(step for step in steps(package) if step.get("name") == "Show the result")
    done, files = run_step(show, tmp_path, "exit 1")
    assert done.returncode == 1
    assert files["GITHUB_STEP_SUMMARY"] == "    robocop grade: catkin_make failed\n" and not files["GITHUB_OUTPUT"]


def test_sandbox_that_can_not_start_in_a_container_names_the_options_of_docker(tmp_path, monkeypatch):
    make_program(tmp_path / "bwrap", "#!/bin/sh\necho 'No permissions to create new namespace' >&2; exit 1\n")
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    monkeypatch.setattr(sandbox, "CONTAINER_MARKS", (str(tmp_path),))
    reason = "No permissions to create new namespace; `docker run --security-opt seccomp=unconfined .*; --unsafe runs"
    with pytest.raises(GradingError, match=reason):
        sandbox.open_sandbox(False)
    monkeypatch.setattr(sandbox, "CONTAINER_MARKS", (str(tmp_path / "nothing"),))
    with pytest.raises(GradingError, match="No permissions to create new namespace; --unsafe runs"):
        sandbox.open_sandbox(False)
