"""The grader: runs a student's go-to server and bridge and awards points with reasons.

From a hand-in to its grade:

    archive, folder, file
      | files/        packed; in a sandbox (sandbox/) unpacked
      | preparation   ... built and read there: the submission, that is the scripts to grade
      v
    runner            runs the scenarios of each part
      |
    session/          simulates: stage (robot, time), topics (sent and received), server or bridge (scenarios)
      |       ^
      | GO    | MESSAGE ... DONE      one socket to the node's process: until when, messages; what it has published
      v       |
    agent/            in that process: request_loop (the grader's requests), scheduler (turns, simulated time),
                      connections, ros_graph (rospy's topics and services, and the master, without a network)
      |
      | record        one for each scenario: samples of the truth, and everything that the node sent
      v
    judge             records + plan (config/grading.yaml) -> grade, by checks/, one function for each contract
      | report/       report.html, report.json, results.json, classroom.json
      v
    grader            runs all of this for one submission; called by cli (grade) and classroom/ (grade-class)

handout holds the handout's names and figures, and the tolerances around them. `robocop_hosting` finds a package, builds
it and reads its launch file; `robocop sim --with` uses it, too. Only session/ and agent/ use ROS.
"""
