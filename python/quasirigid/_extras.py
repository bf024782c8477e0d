"""Libraries that the package can use and does not need."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

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
        If it is not installed; the message says how to get it.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        # Of a library that is there and lacks another one, that other one is the news.
        if error.name != module:
            raise
        raise MissingExtraError(f"{use} need {module}: pip install {install}") from error


def need_matplotlib() -> None:
    """Refuse pictures where matplotlib is not installed, as `import_extra`."""
    import_extra("matplotlib", "pictures", "'quasirigid[plot]'")
