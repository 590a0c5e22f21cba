"""Linear solvers: which one, direct ones and their ordering, multigrid, elimination down to an interface."""
