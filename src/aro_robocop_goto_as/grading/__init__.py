"""The judge: somebody's go-to server and bridge -> points, each with its reason.

Data flows in this order; only `probe/` uses ROS:

    submission  path -> what is there to grade, built (building) in a cage (sandbox) under guard
    plan        config/grading.yaml -> scenarios, limits, points
    probe/      drives the scenarios against the submission, in lockstep -> records
    record      what was recorded in one scenario
    checks/     record -> one verdict; one contract of the handout each
    judge       records + plan -> a grade
    report      grade -> report.json, junit.xml, report.html
    exam        all of it for one submission
    main        robocop grade
    classroom/  robocop grade-class: all of it for many, on dask workers
"""
