"""Collapse: factors of safety by strength reduction, limit loads, and the curves that lead to
them.
"""
