#!/usr/bin/env python3
"""Calls Gazebo's services about links, joints and physics as lab code does, and prints the responses as JSON."""

import json
import math

import rospy
from gazebo_calls import BOX, ROBOT, call, position
from gazebo_msgs.msg import LinkState, ModelState, ODEJointProperties, ODEPhysics
from gazebo_msgs.srv import (
    ApplyBodyWrench,
    ApplyJointEffort,
    BodyRequest,
    DeleteModel,
    GetJointProperties,
    GetLinkProperties,
    GetLinkState,
    GetModelProperties,
    GetPhysicsProperties,
    JointRequest,
    SetJointProperties,
    SetLinkProperties,
    SetLinkState,
    SetModelConfiguration,
    SetPhysicsProperties,
    SpawnModel,
)
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3, Wrench

URDF = """<robot name="pole"><link name="world"/><link name="pole"><collision><geometry>
<cylinder radius="0.1" length="1"/></geometry></collision></link>
<joint name="foot" type="fixed"><parent link="world"/><child link="pole"/><origin xyz="0 0 0.5"/></joint></robot>"""
SECOND = rospy.Duration(1.0)


def refused():
    """The services that refuse everything: (success, whether the reason names the service) of each."""
    inertia = (Pose(), True) + (1.0,) * 7
    calls = {
        "apply_body_wrench": (
            ApplyBodyWrench,
            (f"{ROBOT}::base_footprint", "", Point(), Wrench(), rospy.Time(), SECOND),
        ),
        "apply_joint_effort": (ApplyJointEffort, ("wheel_left_joint", 1.0, rospy.Time(), SECOND)),
        "get_link_properties": (GetLinkProperties, (f"{ROBOT}::base_footprint",)),
        "set_joint_properties": (SetJointProperties, ("wheel_left_joint", ODEJointProperties())),
        "set_link_properties": (SetLinkProperties, (f"{ROBOT}::base_footprint", *inertia)),
        "set_link_state": (SetLinkState, (LinkState(f"{ROBOT}::base_footprint", Pose(), Twist(), "world"),)),
        "set_model_configuration": (SetModelConfiguration, (ROBOT, "robot_description", ["wheel_left_joint"], [1.0])),
    }
    answers = {name: call(name, kind, *arguments) for name, (kind, arguments) in calls.items()}
    return {name: [answer.success, answer.status_message.startswith(f"{name}: ")] for name, answer in answers.items()}


def physics(**changed):
    now = call("get_physics_properties", GetPhysicsProperties)
    keys = {"time_step": now.time_step, "max_update_rate": now.max_update_rate, "gravity": now.gravity, **changed}
    return call("set_physics_properties", SetPhysicsProperties, *keys.values(), ODEPhysics()).success


def link(name, frame=""):
    answer = call("get_link_state", GetLinkState, name, frame)
    place = answer.link_state.pose.position
    return [answer.success, *(round(value, 3) for value in (place.x, place.y, place.z))]


def main():
    rospy.init_node("gazebo_other_calls")
    answers = {"refused": refused()}
    pose = Pose(Point(2.0, 1.0, 0.0), Quaternion())
    answers["urdf"] = call("spawn_urdf_model", SpawnModel, "pole", URDF, "", pose, "world").success
    answers["urdf of a robot"] = call("spawn_urdf_model", SpawnModel, ROBOT, URDF, "", pose, "world").success
    answers["sdf"] = call("spawn_sdf_model", SpawnModel, "crate", BOX, "", pose, "world").success
    answers["pole"] = link("pole::pole")
    answers["pole from the robot"] = link("pole::pole", f"{ROBOT}::base_footprint")
    answers["wheel"] = link(f"{ROBOT}::wheel_left_link")
    answers["no link"] = link("chair::link")
    of_robot, of_pole = (call("get_model_properties", GetModelProperties, name) for name in (ROBOT, "pole"))
    answers["robot's"] = [of_robot.canonical_body_name, of_robot.joint_names, of_robot.is_static, of_robot.success]
    answers["pole's"] = [of_pole.body_names, of_pole.geom_names, of_pole.is_static, of_pole.success]
    answers["nobody's"] = call("get_model_properties", GetModelProperties, "chair").success
    joint = call("get_joint_properties", GetJointProperties, "wheel_left_joint")
    answers["joint"] = [joint.success, len(joint.position), len(joint.rate)]
    answers["no joint"] = call("get_joint_properties", GetJointProperties, "elbow").success
    call("clear_body_wrenches", BodyRequest, ROBOT)
    call("clear_joint_forces", JointRequest, "wheel_left_joint")

    now = call("get_physics_properties", GetPhysicsProperties)
    answers["physics"] = [now.success, now.pause, round(now.max_update_rate * now.time_step, 6), now.gravity.z < -9.8]
    answers["set"] = [
        physics(max_update_rate=2.0 / now.time_step),
        physics(time_step=0.5),
        physics(gravity=Vector3(0.0, 0.0, -1.6)),
        physics(max_update_rate=-1.0),
        physics(time_step=math.nan),
        physics(gravity=Vector3(math.nan, 0.0, -9.8)),
    ]
    doubled = call("get_physics_properties", GetPhysicsProperties)
    answers["factor"] = round(doubled.max_update_rate * doubled.time_step, 6)
    physics(max_update_rate=1.0 / now.time_step)

    topic = rospy.Publisher("/gazebo/set_model_state", ModelState, queue_size=1, latch=True)
    topic.publish(ModelState("pole", Pose(Point(-2.0, 1.0, 0.0), Quaternion()), Twist(), "world"))
    while position("pole")[:3] != [True, -2.0, 1.0]:
        rospy.rostime.wallsleep(0.01)
    for name in ("pole", "crate"):
        call("delete_model", DeleteModel, name)
    print(json.dumps(answers))


if __name__ == "__main__":
    main()
