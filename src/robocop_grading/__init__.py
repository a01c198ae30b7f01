"""The grader: runs a student's go-to server and bridge and awards points with reasons.

Data flows in this order; only session/ and agent/ use ROS:

    files/            archives, and folders with archives -> a folder of what was handed in
    submission        path -> the scripts to grade (builds/), built in a sandbox (sandbox/)
    plan              config/grading.yaml -> scenarios, limits, points
    session/          runs the scenarios with the hand-in's node, in the ordinary simulation -> records
    agent/            in the node's process: keeps it in simulated time, and says when its turn is over
    record            the recording of one scenario
    checks/           record -> verdict, one function for each contract of the handout
    judge             records + plan -> grade
    report/           grade -> report.html, report.json, junit.xml, summary.md, classroom.json
    runner, grader    one part, and all of this for one submission
    cli               robocop grade
    classroom/        robocop grade-class: many submissions on dask workers
    sim_with          robocop sim --with: the same builds, started beside the simulator

handout holds the handout's names and figures, and the tolerances around them.
"""
