"""When a goal's cancel is sent."""

from unittest.mock import MagicMock

import pytest
from actionlib import CommState
from geometry_msgs.msg import Point

from aro_robocop_goto_as.ros.client import discovery, sent_goal


@pytest.mark.parametrize("server_kept, callbacks_kept", [(3, 0), (0, 3), (0, 0)])
def test_goal_is_cancelled_when_acknowledged_or_nobody_is_kept_from_that(monkeypatch, server_kept, callbacks_kept):
    client, end, looks, acknowledged = MagicMock(), object(), {"server": 0, "callbacks": 0}, []
    client.pub_goal.impl.connections = [MagicMock(socket=end)]
    handle = client.send_goal.return_value
    handle.get_comm_state.return_value = CommState.ACTIVE
    handle.cancel.side_effect = lambda: acknowledged.append(sent._acknowledged.is_set())

    def look(who, kept):
        """The last one is too late to see a processor waited for, as the goal is acknowledged then."""
        looks[who] += 1
        if looks[who] == kept:
            sent._handle_transition(handle)
        return looks[who] <= kept

    def peer_of(connected, _patience):
        assert connected is end
        return MagicMock(wants_to_run=lambda: look("server", server_kept))

    monkeypatch.setattr(sent_goal, "ACKNOWLEDGE_PATIENCE", 0.05)
    monkeypatch.setattr(sent_goal, "LOOK", 0.001)
    monkeypatch.setattr(discovery, "Peer", peer_of)
    monkeypatch.setattr(discovery, "others_want_to_run", lambda: look("callbacks", callbacks_kept))
    sent = sent_goal.SentGoal(client, Point(), "there")
    sent.cancel()
    assert acknowledged == [server_kept + callbacks_kept > 0]
