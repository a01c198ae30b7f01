"""A hand-in's node in the ordinary simulation, scenario by scenario. The ROS master is the session's own.

main         all scenarios of a job
server       goals sent to a server; bridge: clicks, and an action server for it
run          ticks, and what becomes of the node; recording: what arrives from it
stage        the robot, its topics, simulated time: all that uses the simulation
node         the node's process, and its turns by way of its agent
ros_internals  private parts of rospy: what has been sent, received and made use of
watch        shows the run, in a display
"""
