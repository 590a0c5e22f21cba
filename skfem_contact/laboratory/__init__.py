"""Laboratory tests of a material at a point: steps, results, diagrams and measured tests."""

from .measured import Fit, Measured, fit, read_csv
from .paths import PathStep, isotropic, oedometer, simple_shear, triaxial
from .result import ElementTest
from .specimen import element_test

__all__ = [
    "ElementTest",
    "Fit",
    "Measured",
    "PathStep",
    "element_test",
    "fit",
    "isotropic",
    "oedometer",
    "read_csv",
    "simple_shear",
    "triaxial",
]
