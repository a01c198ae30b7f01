#!/usr/bin/env python3
"""Calls Gazebo's services of a running simulator as lab code does, and prints the responses as JSON."""

import json

import rospy
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import DeleteLight, DeleteModel, GetModelState, GetWorldProperties, SetModelState, SpawnModel
from geometry_msgs.msg import Point, Pose, Twist
from std_srvs.srv import Empty

ROBOT = "turtlebot3_burger"
BOX = """<sdf version="1.6"><model name="box"><link name="link"><collision name="collision"><geometry>
<box><size>0.5 0.5 0.5</size></box></geometry></collision></link></model></sdf>"""


def call(name, kind, *arguments):
    rospy.wait_for_service(f"/gazebo/{name}")
    return rospy.ServiceProxy(f"/gazebo/{name}", kind)(*arguments)


def sim_time():
    return call("get_world_properties", GetWorldProperties).sim_time


def position(name=ROBOT, relative_to="world"):
    answer = call("get_model_state", GetModelState, name, relative_to)
    return [answer.success, round(answer.pose.position.x, 3), round(answer.pose.position.y, 3), answer.status_message]


def set_position(x, y, name=ROBOT, frame="world"):
    state = ModelState(name, Pose(position=Point(x, y, 0.0)), Twist(), frame)
    return call("set_model_state", SetModelState, state)


def spawn(name, xml, x):
    return call("spawn_sdf_model", SpawnModel, name, xml, "", Pose(position=Point(x, 0.0, 0.0)), "world")


def main():
    rospy.init_node("gazebo_calls")
    answers = {"light": call("delete_light", DeleteLight, "sun").success}
    world = call("get_world_properties", GetWorldProperties)
    answers["models"] = world.model_names
    call("pause_physics", Empty)
    before = sim_time()
    answers["set"] = set_position(0.5, -0.25).success
    answers["position"] = position()
    answers["relative"] = position(relative_to=ROBOT)
    answers["paused"] = sim_time() == before
    call("unpause_physics", Empty)
    while sim_time() == before:
        rospy.rostime.wallsleep(0.01)
    answers["moved by itself"] = set_position(0.5, 0.0, frame=ROBOT).success
    answers["then"] = position()
    answers["spawned"] = spawn("table", BOX, 2.0).success
    answers["spawned twice"] = spawn("table", BOX, 2.0).success
    answers["spawned nonsense"] = spawn("chair", "<sdf", 2.0).status_message[:12]
    answers["table"] = position("table")
    answers["table moved"] = set_position(1.0, 1.0, name="table").success and position("table")
    topic = rospy.Publisher("/gazebo/set_model_state", ModelState, queue_size=1, latch=True)
    topic.publish(ModelState("table", Pose(position=Point(-2.0, 1.0, 0.0)), Twist(), "world"))
    while position("table")[:3] != [True, -2.0, 1.0]:
        rospy.rostime.wallsleep(0.01)
    answers["deleted"] = call("delete_model", DeleteModel, "table").success
    answers["deleted a robot"] = call("delete_model", DeleteModel, ROBOT).success
    answers["unknown"] = position("table")
    answers["unknown set"] = set_position(0.0, 0.0, name="table").status_message
    for name in ("reset_world", "reset_simulation"):
        call(name, Empty)
        answers[name] = position()
    answers["time"] = sim_time() >= before
    print(json.dumps(answers))


if __name__ == "__main__":
    main()
