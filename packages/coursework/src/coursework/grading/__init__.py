"""Safe grading: students' notebooks in, their answers out as plain
data, marks and reports from those.
"""
