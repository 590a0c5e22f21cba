"""Meshes: bodies joined without welding, files read with their tags, and what is refused."""
