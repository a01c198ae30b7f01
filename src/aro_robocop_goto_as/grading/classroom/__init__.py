"""A whole class: a folder of hand-ins -> a table, an overview, and everybody's report.

    hand_ins   folder -> what was handed in, packed, each with a digest of its content
    worker     packed hand-in -> its report's files; runs on a dask worker, needs no shared disk
    results    the folder of results: what is done already, what a report says, the CSV table
    overview   results -> index.html
    cluster    dask: a cluster of one's own, or the scheduler that a course has already
    main       robocop grade-class
"""
