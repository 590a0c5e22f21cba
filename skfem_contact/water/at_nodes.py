"""Forms of water that enters or leaves consolidating ground at nodes, while they are active."""

from __future__ import annotations

from abc import abstractmethod
from copy import copy

from numpy import ndarray
from typing_extensions import Self, override

from ..forms.base import Form, Forms
from ..forms.roles import Couples, Staged, Timed
from .pore_water import PoreWater


class AtNodes(Form, Couples, Staged, Timed):
    """Water that enters or leaves consolidating ground at nodes."""

    kinematics = "small"

    symmetric = True
    second_order = True
    #: Water of the ground, and dofs of its pressures at the nodes.
    water: PoreWater
    _dofs: ndarray
    _duration = 0.0

    @override
    def completed(self, forms: Forms) -> Self:
        return self._in(self.water.completed(forms))

    @override
    def continues(self, old: Form) -> Self:
        super().continues(old)
        assert isinstance(old, AtNodes)
        return self._in(old.water)

    @abstractmethod
    def _in(self, water: PoreWater) -> Self:
        """Return the form with the properties of its ground."""

    @override
    def over(self, duration: float) -> Self:
        new = copy(self)
        new._duration = duration
        return new
