"""The report on what is installed."""

import sys

from aro_robocop_goto_as.cli import doctor
from aro_robocop_goto_as.ros import graph


def test_the_fork_of_pybullet_without_numpy_is_named_and_nothing_is_missing(tmp_path, monkeypatch):
    (tmp_path / "pybullet.py").write_text("def isNumpyEnabled():\n    return 0\n")
    (tmp_path / "pybullet_arm64-3.2.8.dist-info").mkdir()
    (tmp_path / "pybullet_arm64-3.2.8.dist-info" / "METADATA").write_text("Name: pybullet-arm64\nVersion: 3.2.8\n")
    for stamp in doctor.STAMPS:
        (tmp_path / stamp).parent.mkdir(exist_ok=True)
        (tmp_path / stamp).write_text("")
    (tmp_path / "venv" / "bin").mkdir()
    python = tmp_path / "venv" / "bin" / "python"
    # -S: without the venv in which the tests run, and its pybullet
    python.write_text(f'#!/bin/sh\nPYTHONPATH={tmp_path}:$PYTHONPATH exec {sys.executable} -S "$@"\n')
    python.chmod(0o755)
    rows, problems = doctor.examine("checkout", str(tmp_path), "", "", {"run": ""})
    assert dict(rows)["pybullet"] == "3.2.8 of pybullet-arm64, without NumPy"
    assert [what for what, _ in problems if "virtual environment" in what] == []


def test_several_publishers_of_cmd_vel_are_named(monkeypatch):
    monkeypatch.setattr(graph, "master_answers", lambda: True)
    monkeypatch.setattr(graph, "running_node", lambda *_: "a simulator is already running")
    monkeypatch.setattr(graph, "running_publishers", lambda _: {"/cmd_vel": ["/a", "/b"], "/red/cmd_vel": ["/c"]})
    state, problem = doctor.master_row()
    assert state.endswith("; a simulator is already running; /cmd_vel is published by /a and /b") and not problem
