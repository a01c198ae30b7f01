"""The grader: runs a student's go-to server and bridge and awards points with reasons.

From a hand-in to its grade:

    archive, folder, file
      | files/        unpacked; what was handed in
      | submission    the scripts to grade, built in a sandbox (sandbox/)
      v
    runner            starts a session for each part, in the sandbox's network
      |
    session/          has the simulation: stage (robot, time), topics (sent and heard), server or bridge (scenarios)
      |       ^
      | GO    | MESSAGE ... DONE      one socket to the node's process: until when, messages; what it has published
      v       |
    agent/            in that process: channel (turns), scheduler (one thread at a time, simulated time),
                      connections, grader (rospy's topics and services, and the master, without a network)
      |
      | record        of each scenario: samples of the truth, and everything that came from the node
      v
    judge             records + plan (config/grading.yaml) -> grade, by checks/, one function for each contract
      | report/       report.html, report.json, summary.md, results.json, classroom.json
      v
    grader            all of this for one submission: cli (robocop grade), classroom/ (robocop grade-class)

handout holds the handout's names and figures, and the tolerances around them. How a package is found, built and its
launch file read is in `robocop_hosting`, which `robocop sim --with` uses, too. Only session/ and agent/ use ROS.
"""
