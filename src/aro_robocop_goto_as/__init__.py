"""TurtleBot go-to lab: a pybullet simulator, a go-to action server, an RViz bridge.

Data flows through the core in this order; no core module imports rospy:

    world       world file -> World
    robot       URDF -> RobotModel
    simtime     steps -> stamps and schedules
    physics     World + wheel speeds -> RobotState          the only module that imports pybullet
    slice       World -> segments and circles at the lidar's height
    raycast     slice + poses -> exact distances along beams
    sensors/    RobotState + distances -> scan, odometry, imu     one sensor a file
    goto        pose, clearance ahead, goal -> velocity, or an outcome     the lab's loop
    drive       velocity command -> limits, time-out -> wheel speeds
    simulator   drive -> physics -> sensors, step by step, in simulated time

`params` holds one frozen dataclass per node, `nodes/` all of rospy.
"""
