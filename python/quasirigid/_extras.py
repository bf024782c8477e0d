"""Libraries that the package can use and does not need."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from ._interrupt import heard_interrupt
from .errors import MissingExtraError

__all__ = ["import_extra", "need_matplotlib"]


def import_extra(module: str, use: str, install: str) -> ModuleType:
    """Return an optional library.

    Parameters
    ----------
    module : str
        Its name.
    use : str
        What needs it, in the plural, for the message.
    install : str
        What to pass to `pip install`.

    Raises
    ------
    MissingExtraError
        If it is not installed; the message says how to get it. Of one that is there and cannot be imported,
        it says why.
    """
    try:
        return import_module(module)
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and error.name == module:
            raise MissingExtraError(f"{use} need {module}: pip install {install}") from error
        if heard_interrupt():
            raise KeyboardInterrupt from error
        # Another library is missing or of the wrong version, or an environment variable has a bad value.
        raise MissingExtraError(
            f"{use} need {module}, which is installed and cannot be imported: {error}"
        ) from error


def need_matplotlib() -> None:
    """Refuse pictures where matplotlib is not installed, as `import_extra`."""
    import_extra("matplotlib", "pictures", "'quasirigid[plot]'")
