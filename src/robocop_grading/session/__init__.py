"""A hand-in's node in the ordinary simulation, scenario by scenario. The ROS master is the session's own.

main         all scenarios of a job
server       goals sent to a server; bridge: clicks, and an action server for it
run          what both do: ticks, what becomes of the node, and what arrives from it -> records
stage        the robot, its topics, simulated time: all that uses the simulation
node         the node's process, and its turns by way of its agent
ros_internals  private parts of rospy: what has been sent, received and made use of
watch        shows the run, in a display
"""
