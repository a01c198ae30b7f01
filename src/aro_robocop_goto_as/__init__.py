"""TurtleBot go-to lab: a pybullet simulator, a go-to action server, an RViz bridge.

From a velocity command to odometry, scan, tf and clock:

    ros.sim.robot_inputs          cmd_vel -> ros.sim.node, which posts a job to the loop
    simulation.controllers        applies it, in lockstep at the end of the control tick
    simulation.loop               makes the steps
    simulation.simulator          one step: advance, then measure what is due and subscribed to
        robot.base_controller     command -> limits, command timeout -> wheel speeds
        physics.engine            wheel speeds + world -> robot states, by bullet or kinematic
        sensors                   states, distances -> measurements
    simulation.observations       what the step yielded
    ros.sim.node                  -> robot_topics, transform_topics, moving obstacles, and the clock last
        ros.outbox                all messages of the step in one call of sender.c

From a goal to its result:

    ros.server.goal_server        goal -> the control loop in ros.server.node
    ros.server.goal_execution     one control period of the goal; ends one that is stuck, late or without sensor data
        ros.server.inputs         newest odom and scan -> pose, clearance ahead
        goto                      the handout's rule: rotate, move forward, reached or obstacle
    ros.server.node               -> feedback, cmd_vel, in the end result and terminal state

    A 2D Nav Goal becomes a goal in ros.client: rviz_bridge, goal_frame (tf2), goal_handle.

From a world file to a scan:

    world.load                    by world.sdf or world.grid_map -> world.model.World
    raycast.cross_section         the world at a scanner's height: segments and circles
    raycast.scene                 the cross-sections and all robots, laid out for caster.c
    raycast.scanners              + robot poses -> exact distances along all beams
        raycast.beams             calls caster.c, which caster_library loads
    sensors.lidar                 noise, range limits -> ranges

From the system to a browser and back, by viser:

    ros.web.topics                topics, tf -> ros.web.view -> web.scene, web.page
    web.page                      clicks, buttons, keys -> ros.web.node -> ros.web.commands -> topics, services

From the running system to RViz:

    ros.cli.rviz_scene            topics, tf_static, the world's markers -> rviz.config.Scene
    rviz.config                   + rviz.camera, rviz.displays -> the configuration file that ros.cli.rviz opens

Only `ros`, `bench` and `grading.probe` import rospy. `params` has one frozen dataclass per node; each component of
the simulator gets its own small set from `component_params`. Limits and timeouts are parameters first: look for them
there and in `config/` before the code. `compiled` loads the libraries that CMake makes of caster.c and sender.c,
`process` is about operating system processes, `bootstrap` needs nothing installed, `hosting` builds and runs other
people's packages, `grading` judges them, `bench` measures the simulator.
"""
