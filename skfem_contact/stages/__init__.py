"""Stages of construction: activation, initial states, runs."""
