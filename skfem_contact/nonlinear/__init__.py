"""Equilibrium of an increment: Newton's method, line searches, and how large increments are."""
