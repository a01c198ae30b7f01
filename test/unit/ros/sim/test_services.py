"""The simulator's services, as their threads call them while the owner's thread gets no processor."""

import math
from types import SimpleNamespace
from unittest.mock import MagicMock

import pytest

from aro_robocop_goto_as.ros.sim import services


@pytest.mark.parametrize("asked, factor", [((2.0, 1.0), 1.0), ((2.0, math.nan), 2.0)])
def test_the_last_factor_holds_also_if_the_owner_runs_the_jobs_late(monkeypatch, asked, factor):
    monkeypatch.setattr(services, "rospy", MagicMock())
    monkeypatch.setattr(services, "Server", MagicMock())
    simulation, jobs = MagicMock(), []
    simulation.time_control.pacer.factor = 1.0
    simulation.jobs.post = jobs.append
    offered = services.Services(simulation)
    told = [offered._on_reconfigure(SimpleNamespace(real_time_factor=value), 0) for value in asked]
    assert told[-1].real_time_factor == factor
    for job in jobs:
        job()
    assert simulation.time_control.set_real_time_factor.call_args[0][0] == factor
