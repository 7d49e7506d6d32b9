"""Run apart: notebooks run in isolation, and their answers come out as plain data."""
