"""Told: pages and tables made of the records."""
