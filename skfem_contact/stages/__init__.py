"""Stages of construction: what is there, where it starts, what it leaves."""
