"""Collapse: factors of safety by strength reduction, limit loads, and their curves."""
