"""Frictional contact, soil plasticity and staged analysis for scikit-fem."""

__version__ = "0.1.0"
