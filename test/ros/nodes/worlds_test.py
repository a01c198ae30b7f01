#!/usr/bin/env python3
"""A map as the world is published as by map_server; scans and markers follow models spawned, moved or deleted."""

import os
import unittest

import ros_numpy
import rosgraph
import rospkg
import rospy
from aro_robocop_goto_as.srv import DeleteModel, MoveModel, SpawnModel
from geometry_msgs.msg import Point, Pose
from harness import DEADLINE, SIMULATOR, Recorder, run
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

CRATE = """<sdf version="1.6"><model name="crate"><static>1</static>{}<link name="l"><pose>0 0 0.25 0 0 0</pose>
<collision name="c"><geometry><box><size>0.4 0.4 0.5</size></box></geometry></collision></link></model></sdf>"""

PATROL = """<sdf version="1.6"><model name="patrol"><static>1</static>
<plugin name="p" filename="robocop_motion"><turn>0.5</turn></plugin><link name="l"><pose>0.2 0 0.25 0 0 0</pose>
<collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.5</length></cylinder></geometry></collision>
</link></model></sdf>"""


def at(x, y=0.0):
    return Pose(position=Point(x, y, 0.0))


class Worlds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scan = Recorder("/scan", LaserScan)
        cls.markers = Recorder(f"{SIMULATOR}/world", MarkerArray)

    def call(self, name, kind, *arguments):
        service = f"{SIMULATOR}/{name}"
        rospy.wait_for_service(service, DEADLINE)
        return rospy.ServiceProxy(service, kind)(*arguments)

    def wait_for_range(self, expected):
        """The next scan with this range [m] ahead; those on their way may be from before a change."""
        self.scan.wait_for(lambda m: abs(m.ranges[0] - expected) < 0.06, f"{expected} m ahead", len(self.scan))

    def test_map_is_latched_and_that_of_its_metadata_and_of_static_map(self):
        for namespace in ("", "/other"):
            grid = Recorder(f"{namespace}/map", OccupancyGrid).newest()
            self.assertEqual(grid.info, Recorder(f"{namespace}/map_metadata", MapMetaData).newest())
            rospy.wait_for_service(f"{namespace}/static_map", DEADLINE)
            answer = rospy.ServiceProxy(f"{namespace}/static_map", GetMap)().map
            self.assertGreater(answer.header.stamp, rospy.Time(0))
            self.assertEqual(answer.info, grid.info)
            self.assertEqual((answer.data, answer.header.frame_id), (grid.data, "map"))
            self.assertEqual(set(ros_numpy.numpify(grid).data.ravel()), {-1, 0, 100})
        info = Recorder("/map", OccupancyGrid).newest().info
        self.assertEqual((info.width, info.height, info.resolution), (16, 12, 0.5))
        self.assertEqual((info.origin.position.x, info.origin.position.y), (-4.0, -3.0))

    def test_random_world_is_saved_in_ros_home(self):
        with open(os.path.join(rospkg.get_ros_home(), "random_7.sdf"), encoding="utf-8") as file:
            self.assertIn("seed 7", file.read())

    def test_without_localization_nobody_publishes_map_to_odom(self):
        tf = Recorder("/other/tf", TFMessage)
        static = Recorder("/other/tf_static", TFMessage).newest()
        self.assertEqual([(t.header.frame_id, t.child_frame_id) for t in static.transforms], [("world", "map")])
        sent = {(t.header.frame_id, t.child_frame_id) for m in tf.next(20) for t in m.transforms}
        self.assertEqual(sent, {("odom", "base_footprint")})
        local = Recorder("/tf_static", TFMessage)
        local.wait_for(
            lambda m: any(t.child_frame_id == "odom" for t in m.transforms), "map -> odom where it is static"
        )

    def test_initialpose_is_left_to_others_where_it_is_false_and_without_localization(self):
        Recorder("/scan", LaserScan).next(1)
        Recorder("/other/scan", LaserScan).next(1)  # both simulators run, so they have connected everything
        _, subscribers, services = rosgraph.Master(rospy.get_name()).getSystemState()
        self.assertIn("/robocop_sim/set_pose", [name for name, _ in services])
        self.assertIn("/other/cmd_vel", [name for name, _ in subscribers])
        self.assertEqual([name for name, _ in subscribers if "initialpose" in name], [])

    def test_scans_and_markers_follow_a_model_that_is_spawned_moved_and_deleted(self):
        spawned = self.call("spawn_model", SpawnModel, "", CRATE.format('<plugin name="p"/>'), "", at(1.0))
        self.assertTrue(spawned.success, spawned.message)
        self.assertIn("model 'crate' with 1 collisions; ignored: plugin 'p'", spawned.message)
        self.wait_for_range(0.832)
        self.markers.wait_for(lambda m: [x.type for x in m.markers[1:]] == [Marker.CUBE], "the crate in RViz")
        self.assertTrue(self.call("move_model", MoveModel, "crate", at(2.0)).success)
        self.wait_for_range(1.832)
        start = len(self.markers)
        self.assertTrue(self.call("delete_model", DeleteModel, "crate").success)
        self.wait_for_range(3.532)
        self.markers.wait_for(lambda m: [x.action for x in m.markers] == [Marker.DELETEALL], "nothing in RViz", start)

    def test_late_subscriber_gets_the_whole_world_while_an_obstacle_moves(self):
        early = Recorder("/other/robocop_sim/world", MarkerArray)
        whole = {marker.id for marker in early.newest().markers[1:]}
        rospy.wait_for_service("/other/robocop_sim/spawn_model", DEADLINE)
        spawn = rospy.ServiceProxy("/other/robocop_sim/spawn_model", SpawnModel)
        answer = spawn("", PATROL, "", at(0.5, 0.5))
        self.assertTrue(answer.success, answer.message)
        early.wait_for(lambda m: [x.type for x in m.markers] == [Marker.CYLINDER], "an update of what moves")
        early.close()  # two subscribers of a process share a connection
        late = Recorder("/other/robocop_sim/world", MarkerArray)
        first = late.wait_for(lambda m: m.markers[0].action == Marker.DELETEALL, "the whole world").markers[1:]
        self.assertEqual({marker.id for marker in first}, whole | {max(whole) + 1})

    def test_an_invalid_request_is_refused_with_the_reason_and_changes_nothing(self):
        level = at(1.0)
        leaning = Pose(position=Point(1.0, 0.0, 0.0))
        leaning.orientation.w = 0.5
        for name, kind, arguments, words in (
            ("spawn_model", SpawnModel, ("a", "<sdf", "", level), "xml of the request:1: not well-formed XML"),
            ("spawn_model", SpawnModel, ("a", CRATE.format(""), "", leaning), "quaternion of length 1"),
            ("move_model", MoveModel, ("walls", level), "no model 'walls'; there are:"),
            ("move_model", MoveModel, ("ground_plane", at(float("nan"))), "expected finite numbers"),
        ):
            answer = self.call(name, kind, *arguments)
            self.assertFalse(answer.success, answer.message)
            self.assertIn(words, answer.message)


if __name__ == "__main__":
    run(Worlds)
