"""Laboratory tests of a material at a point: their steps, their results and their diagrams."""
from .paths import PathStep, isotropic, oedometer, simple_shear, triaxial
from .result import ElementTest
from .specimen import element_test

__all__ = ["ElementTest", "PathStep", "element_test", "isotropic", "oedometer", "simple_shear", "triaxial"]
