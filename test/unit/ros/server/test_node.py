"""How the server ends."""

import threading
from types import SimpleNamespace

import pytest

from aro_robocop_goto_as.ros.server import node


@pytest.mark.parametrize("hangs", [False, True])
def test_a_server_that_shuts_down_stops_the_robot_also_where_its_goal_hangs(monkeypatch, hangs):
    monkeypatch.setattr(node, "SHUTDOWN_TIMEOUT", 0.0)
    monkeypatch.setattr(node, "SEND_TIME", 0.0)
    sent, ticks, running = [], SimpleNamespace(wake=lambda: None), threading.Lock()
    if hangs:
        running.acquire()
    server = SimpleNamespace(
        stop_reason="", ticks=ticks, execution_lock=running, cmd_vel=SimpleNamespace(publish=sent.append)
    )
    node.GotoNode.shut_down(server)
    assert server.stop_reason == "the server is shutting down"
    assert [(twist.linear.x, twist.angular.z) for twist in sent] == [(0.0, 0.0)]
