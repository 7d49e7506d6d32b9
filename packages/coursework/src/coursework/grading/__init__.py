"""Safe grading: from students' notebooks to answers as plain data, and from those to marks."""
