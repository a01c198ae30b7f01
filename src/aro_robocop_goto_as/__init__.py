"""TurtleBot go-to lab: a pybullet simulator, a go-to action server, an RViz bridge.

From a velocity command to odometry, scan, tf and clock:

    ros.sim.command_topics        cmd_vel -> a job for the thread that owns the simulation
    simulation.controllers        the job: applies it, in lockstep at the end of the control tick
    simulation.simulator          a command, clamped by robot.base_controller -> its row of robot.fleet
                                  in each round of the loop: finds the next step on which something is due
    physics.kinematic, bullet     the engine: runs base controllers and motion up to that step
        base_controller.c         command -> command timeout, acceleration limits -> wheel speeds
        kinematic.c, pybullet     wheel speeds + world -> poses, velocities, wheel angles of the fleet
    simulation.agenda             the sensors that are due and subscribed to, and the calls that measure them
        sensors.catalog           the list of the sensors; each is a module with its parameters and its measurement
    simulation.running            the loop around all this: has the simulator advance, hands on what is due
    ros.sim.node                  what the loop hands it on to
        ros.sim.step_topics       which messages are due, put together once as a batch: the clock last
        ros.sim.sensor_messages   at the start: each sensor's topic, and its packed message, bound to a robot's row
        ros.publishing.batch      the batch: batch.c copies these rows into the packed messages and sends them

    rospy serializes the other topics (bumper, camera).

From a goal to its result:

    ros.server.node               goal -> the handout's loop -> cmd_vel, feedback, in the end result and terminal state
        ros.server.ticks          when the next control period begins
        ros.server.inputs         newest odom and scan -> pose, and by goto.obstacle_ahead the clearance
        ros.server.goal_execution decides by the rule; ends a goal that is stuck or late
            goto.rule             one `step` a control period: rotate, move forward, reached or obstacle

    A 2D Nav Goal becomes a goal in ros.client: rviz_bridge, goal_frame (tf2).

From a world file to a scan:

    world.load                    by world.sdf or world.grid_map -> world.model.World
    raycast.cross_section         the world at a sensor's height: segments and circles
    raycast.scenes              + robots and where on them the sensor is -> what its beams can hit
        raycast.beams             lays this out for caster.c, which it loads: exact distances along beams
    sensors.lidar                 noise, range limits -> ranges

Where there is room in that world, and its map: `floor_plan`.

From the system to a browser and back, by viser:

    ros.web.node                  the loop: messages -> the parts of the page, updated one after the other
        ros.web.part              what a part is: its topics, its elements of the panel, its shapes in web.scene
    ros.web.goals, teleop, ...    clicks, buttons, keys -> ros.web.requests -> topics, services
    web.state                     what the parts share, such as the robots, which of them is selected and its pose

From ./robocop COMMAND to the program that does the work:

    robocop                       the shell script: a clean environment, installs and builds, becomes the program
        cli.commands              checks the arguments of those that take many, and chooses what the script starts
    ros.cli.launch                roslaunch, then ros.cli.overview of what it has started
    ros.cli.rviz                  RViz with a configuration of rviz/

Only `ros` imports rospy. Each component of the simulator declares its parameters, in a group of its own, and
`simulation.params` composes the groups. Limits and timeouts are parameters first, so look for them there and in
`config/` before the code. `robot.fleet` holds the state of all robots as arrays, which the C files work on: where a .c
and a .py have one name, C computes, and Python holds the figures and calls C. `compiled` loads the libraries that CMake
builds from these. All readers of user-written files use `reading`. `process` is about operating system processes.
Beside this package, `robocop_hosting` builds and runs other people's packages, and `robocop_grading` judges them.
"""

from pkgutil import extend_path

# catkin keeps the generated messages in a folder of their own. Its devel space joins the two when this package is
# imported by way of it, but not when `robocop_grading`, which lies beside it, was imported first.
__path__ = extend_path(__path__, __name__)
