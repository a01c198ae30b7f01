"""A hand-in's node in the ordinary simulation, scenario by scenario. The ROS master is in the node's process.

From a job to its records; each module uses the modules below it:

    server_run, bridge_run   the scenarios of each part
    run                the base of both: ticks, and the record of everything that comes from the node
    stage              robot, simulated time, and their messages (step_messages, scenario_bag)
    node               the node's process, which lives from GO to GO; its socket (channel) and its prints (output)
    topics, services   shared by node and grader; goals: the action server that a bridge talks to
"""
