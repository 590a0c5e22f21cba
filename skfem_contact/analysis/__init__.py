"""Newton's method, load increments and stages: they know forms by their protocol only."""
