"""Error against run time on the reference problems."""

from __future__ import annotations

import warnings
from typing import Any

from ...errors import QuasirigidWarning
from ..memo import forget
from ..table import Table, TableProgress, table_reporter
from .bodies import body_tasks
from .estimates import estimate_tasks
from .kernels import kernel_tasks, solver_tasks
from .pixels import pixel_tasks
from .rows import mark_knee, refused

__all__ = ["accuracy"]

_PARTS = (kernel_tasks, solver_tasks, pixel_tasks, body_tasks, estimate_tasks)


def accuracy(*, quick: bool = False, progress: TableProgress | bool | None = None) -> Table:
    """Measure error against run time: mesh size, discretization, response, target error and solver.

    On the sphere, the crossed cylinders, the cylinder, the flat punch, the cone and the sphere on a layer,
    whose answers are known, on a sphere with a rigid core against finite elements, and on the built-in
    fingertip against itself on a finer mesh. tamaas is measured beside it where it is installed.

    Parameters
    ----------
    quick : bool
        A small part of it, in some seconds; the whole takes minutes.
    progress : callable or bool, optional
        Called as ``progress(name, done, total)`` after each row; True prints to stderr.

    Returns
    -------
    Table
        One row for each way to solve a problem: nodes, force (N) and its truth, relative errors of force,
        area and largest pressure, the estimate that the contact made, time (s). ``row["limit"]`` bounds the
        error of the force: twice the target error, or on a mesh as it is one cell of the contact's radius.
        ``row["knee"]`` marks where on the sphere a smaller error begins to cost more.

    Notes
    -----
    Times are wall times of this machine as it is now: nothing else should run beside it.

    Examples
    --------
    >>> import quasirigid as qr
    >>> table = qr.accuracy(quick=True)  # doctest: +SKIP
    >>> table.ok, [row["target_error"] for row in table.rows if row["scene"] == "cone"]  # doctest: +SKIP
    (True, [None, 0.02])
    """
    report = table_reporter(progress)
    rows: list[dict[str, Any]] = []
    tasks = [task for part in _PARTS for task in part(quick)]
    try:
        with warnings.catch_warnings():
            # The coarsest meshes say that they are coarse.
            warnings.simplefilter("ignore", QuasirigidWarning)
            for done, (name, work) in enumerate(tasks):
                try:
                    rows.append(work())
                except (KeyboardInterrupt, SystemExit):
                    raise
                except BaseException as error:
                    # A panic of the core is no `Exception`.
                    rows.append(refused(error, scene=name))
                report(name, done + 1, len(tasks))
    finally:
        forget()
    mark_knee([row for row in rows if row["scene"] == "sphere" and row["response"] == "half-space"])
    return Table(name="accuracy", _rows=tuple(rows))
