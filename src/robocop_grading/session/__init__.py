"""A hand-in's node in the ordinary simulation, scenario by scenario. The ROS master is in the node's process.

From a job to its records, each one uses those below it:

    main               one part of a hand-in
    server, bridge     the scenarios of each part
    run                what both have: ticks, and the record of what comes from the node
    stage              robot, simulated time, and what is published of them (step_messages, scenario_bag)
    node               the node's process, which lives turn by turn: what it sends (channel), what it prints (output)
    topics, services   what node and grader have in common; goals: the action server that a bridge talks to

progress is what the process that grades is told.
"""
