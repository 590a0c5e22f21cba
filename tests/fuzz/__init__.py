"""Random small scenes, and what must hold in all of them: ``python -m tests.fuzz --scenes 500
--seed 1``.
"""
