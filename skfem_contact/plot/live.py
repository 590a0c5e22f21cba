"""Pictures that follow an analysis while it runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

from ..display import in_notebook
from ..results.fields import basis_of
from ..results.stage import StageResult
from .contour import contour, cutaway
from .sheet import close

#: Share of the time of a run that its pictures may take.
_SHARE = 0.2


def live(
    quantity: str = "u", *, seconds: float = 1.0, file: str | Path | None = None, **style: Any
) -> Callable[[StageResult], None]:
    """Return an observer that draws a field while an analysis runs.

    It is given to a run, ``model.run(stages, on_increment=plot.live("uy"))``. A notebook shows one
    picture that changes. The end of every stage is drawn, increments now and then: pictures take no
    more than a fifth of the time.

    Parameters
    ----------
    quantity
        Field of :meth:`~skfem_contact.results.StageResult.field`.
    seconds
        Shortest time between two pictures of a stage.
    file
        Name of a picture that is written each time, ``.png``; needed outside of a notebook.
    style
        As for :func:`contour` or, for bodies in space, :func:`cutaway`, but for `file` and `show`.

    Raises
    ------
    ValueError
        No notebook and no file.

    Examples
    --------
    >>> import os, tempfile
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> import skfem_contact.plot as plot
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.), unit_weight=20.)
    >>> model = sc.Model({"block": block}, basis.get_dofs("bottom").all())
    >>> file = os.path.join(tempfile.mkdtemp(), "live.png")
    >>> observer = plot.live("uy", file=file)
    >>> result = model.run([sc.Stage("weight", increments=4)], on_increment=observer)
    """
    if not in_notebook() and file is None:
        raise ValueError(
            "live pictures appear in a notebook; elsewhere give a file=, which is written each time"
        )
    return Live(quantity, seconds, file, style)


class Live:
    """Observer of an analysis that shows and writes its picture."""

    def __init__(
        self,
        quantity: str,
        seconds: float,
        file: str | Path | None,
        style: dict[str, Any],
    ) -> None:
        self._quantity = quantity
        self._seconds = seconds
        self._file = file
        self._style = style
        self._shown: Any = None
        self._next = 0.0

    def __call__(self, stage: StageResult) -> None:
        """Draw an increment if it ends a stage, or if the last picture is old enough."""
        began = perf_counter()
        if stage.fraction < 1.0 and began < self._next:
            return
        draw = contour
        if basis_of(stage).mesh.dim() == 3:
            draw = cutaway
        plotter = draw(stage, self._quantity, **self._style)
        if plotter is not None:
            self._show(plotter._repr_png_())
            close(plotter)
        spent = perf_counter() - began
        self._next = began + spent + max(self._seconds, spent / _SHARE)

    def _show(self, image: bytes) -> None:
        """Write the picture, and show it in place of the last one."""
        if self._file is not None:
            Path(self._file).write_bytes(image)
        if in_notebook():
            from IPython.display import Image, display

            picture = Image(data=image, format="png")
            if self._shown is None:
                self._shown = display(picture, display_id=True)
            else:
                self._shown.update(picture)
