"""Submissions that attack the judge come to nothing; run by `./robocop test --all`, where bubblewrap can run."""

import os
import socket

import attacks
import pytest
from graded import PLAN, RIGHT, recorded

BUDGET = 60.0  # [s, wall] for an attack's two scenarios
pytestmark = pytest.mark.xdist_group("hosting")  # they build upon the same workspaces as those who host packages


def attacked(code, folder):
    """The base with an attack in it, in its first scenario: the record of its output, and what cut it short."""
    text = RIGHT["base_server"].read_text()
    names = f"PLAN, FOLDER, PID = {str(PLAN)!r}, {str(folder)!r}, {os.getpid()}\n"
    text = text.replace("if __name__", f"{names}{code}\nif __name__")
    it = recorded(text, folder, only=("left",), budget=BUDGET)
    lines = [line.text for record in it.records.values() for line in record.lines]
    assert not [line for line in lines if "SUCCESS" in line]
    return it, lines


@pytest.mark.parametrize("name", ["FORK_BOMB", "FULL_DISK", "READ", "KILL_ALL", "FORGE", "GIGABYTE_OF_LOG"])
def test_an_attack_comes_to_nothing_and_the_solution_is_graded_all_the_same(name, tmp_path):
    neighbour = tmp_path / "neighbour"
    neighbour.mkdir()
    (neighbour / "solution.py").write_text("secret")
    it, _ = attacked(getattr(attacks, name), tmp_path / "mine")
    assert it.problem == ""
    assert "left" in it.records or not it.records["start"].up, "judged, whatever the node came to"


def test_no_port_outside_is_reached(tmp_path):
    with socket.socket() as outside:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        _, lines = attacked(attacks.OUTSIDE.replace("PORT", str(outside.getsockname()[1])), tmp_path / "mine")
    assert sum("refused" in line for line in lines) == 3


def test_an_endless_loop_is_a_fail_with_a_reason(tmp_path):
    it, _ = attacked(attacks.ENDLESS, tmp_path / "mine")
    assert not it.records["start"].up


def test_who_kills_the_master_and_the_grader_loses_and_the_reason_is_said(tmp_path):
    it, _ = attacked(attacks.KILL_MASTER, tmp_path / "mine")
    assert it.problem.startswith(("the run was cut short during", "time-out"))
