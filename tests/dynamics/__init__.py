"""Tests of inertia, damping, records and modes."""
