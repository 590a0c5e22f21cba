"""Formats of files of meshes: each reads a file to its content."""
