"""Surfaces of bodies and rigid obstacles: facets, their shape functions, chains, material points."""
