"""The server's view of its inputs changes in one piece: whoever sees a new scan also sees what it means."""

import rospy
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.params import GotoParams
from aro_robocop_goto_as.ros.server.inputs import Inputs


def scan_with(ahead: float) -> LaserScan:
    return LaserScan(angle_increment=0.1, range_max=5.0, ranges=[ahead])


def test_new_scan_is_visible_only_once_it_is_known_whether_it_is_valid(monkeypatch):
    monkeypatch.setattr(rospy, "Subscriber", lambda *arguments: None)
    monkeypatch.setattr("aro_robocop_goto_as.ros.server.inputs._now", lambda: 1.0)
    inputs = Inputs(GotoParams())
    looked = []
    real = inputs._clearance_in

    def look_and_compute(message):
        looked.append(inputs.scan)
        return real(message)

    monkeypatch.setattr(inputs, "_clearance_in", look_and_compute)
    inputs._on_scan(scan_with(2.0))
    assert looked == [None]
    first = inputs.scan
    assert first is not None and inputs.valid_scan is first
    inputs._on_scan(scan_with(float("nan")))
    assert inputs.scan is not first and inputs.valid_scan is first
