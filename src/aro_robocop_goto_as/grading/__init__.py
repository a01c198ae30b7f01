"""The judge: runs a student's go-to server and bridge and awards points with reasons.

Data flows in this order; only probe/ uses ROS:

    submission        path -> the scripts to grade, built (sandboxed_build) in a sandbox under a resource guard
    plan              config/grading.yaml -> scenarios, limits, points
    probe/            runs the scenarios against the submission in lockstep -> records
    record            the recording of one scenario
    checks/           record -> verdict, one function for each contract of the handout
    judge             records + plan -> grade
    report            grade -> report.html, report.json, junit.xml, and by `github` summary.md, classroom.json
    grade_submission  all of this for one submission
    main              robocop grade
    classroom/        robocop grade-class: many submissions on dask workers

handout holds the handout's names and figures, limits the tolerances around them.
"""
