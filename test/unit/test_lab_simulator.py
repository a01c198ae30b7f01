"""aro_sim's arguments -> the simulator's."""

import runpy

import pytest
from support import ROOT

LAB = ["cmd_vel_timeout:=0.0", "odom_tf:=false"]
simulator_from = runpy.run_path(f"{ROOT}/compat/aro_sim/scripts/lab_simulator.py")["simulator_from"]


@pytest.mark.parametrize("given, labs", [("seed:=7", LAB), ("profile:=turtlebot3_gazebo odom_tf:=true", [])])
def test_the_labs_behaviour_is_set_unless_a_profile_is_given(monkeypatch, given, labs):
    monkeypatch.setenv("ROBOCOP_SIM_ARGS", given)
    words = simulator_from(["world:=empty", "--", "-x", "1"])
    start = ["--no-summary", "aro_robocop_goto_as", "robocop_sim.launch", "world:=empty", "gazebo_services:=true"]
    assert words == [*start, *labs, "spawn:=1.0 0.0 0.0", *given.split()]
