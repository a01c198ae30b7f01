"""Grades a whole class: a folder of hand-ins -> a table, an overview and a report for each."""
