"""Grades a whole class: a folder of hand-ins -> a table, an overview and a report for each.

hand_ins      folder -> packed hand-ins, each with a digest of its content
worker        packed hand-in -> the files of its report; runs on a dask worker without a shared disk
dask_cluster  the dask workers: local ones, or those of an existing scheduler
results       the folder of results, and the CSV table
overview      results -> index.html
main          robocop grade-class
"""
