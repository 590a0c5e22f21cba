"""Surfaces of bodies and rigid obstacles: facets, shape functions, chains, material points."""
