"""TurtleBot go-to lab: a pybullet simulator, a go-to action server, an RViz bridge.

Data flows through the core in this order; no core module imports rospy:

    world       world file -> World: sdf* Gazebo's, map_file and maps map_server's, random_world; shapes what it is of
    robot       URDF -> RobotModel; models its figures
    simtime     steps -> stamps and schedules
    physics     World + wheel speeds -> RobotState, by Bullet     bullet_shapes its shapes
    kinematics  the same, as ideal drives                         sweep how far a disc comes
    slice       World -> segments and circles at one height       tiles those near a place
    raycast     slice + poses -> exact distances along beams
    sensors/    RobotState + distances -> scan, odometry, imu, ...     one sensor a file; renderer draws for cameras
    goto        pose, clearance ahead, goal -> velocity, or an outcome     the lab's loop
    drive       velocity command -> limits, time-out -> wheel speeds
    simulator   drive -> physics -> sensors, step by step, in simulated time
    lockstep    whom simulated time waits for

`params` holds one frozen dataclass per node, `nodes/` all of rospy. Around them: `hosting/` builds and runs other
people's packages, `grading/` judges them, `bench/` measures the simulator.
"""
