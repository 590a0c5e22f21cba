"""Forms: what carries load, and what an analysis may ask of it."""
