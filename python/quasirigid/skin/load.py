"""Prepared skins, read from their files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import ResponseError
from .prepared import PreparedSkin, restore_skin
from .skins import Skin
from .storage import read_prepared, restored_response

if TYPE_CHECKING:
    from collections.abc import Mapping
    from os import PathLike

    from numpy.typing import NDArray

__all__ = ["load_prepared"]


def load_prepared(path: str | PathLike[str]) -> PreparedSkin:
    """Read what `PreparedSkin.save` wrote.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    PreparedSkin
        Equal to the one saved, to the bit. Using it with another surface is an error that says what differs.

    Raises
    ------
    ResponseError
        If the file is missing, cannot be read, is no prepared skin, damaged or from a later version. Nothing
        in it is unpickled, and no more memory is taken than a sound file of its length needs.
    """
    header, stored = read_prepared(path)
    try:
        skin = _described(header, stored)
        return restore_skin(skin, stored)
    except KeyError as error:
        raise ResponseError(f"{path} lacks or misnames a part of a prepared skin: {error}") from error
    except ValueError as error:
        # Whatever a damaged part leads to; its dtype was checked.
        raise ResponseError(f"{path} holds no sound prepared skin: {error}") from error


def _described(header: Mapping[str, Any], stored: Mapping[str, NDArray[Any]]) -> Skin:
    """Return the skin that a header describes."""
    try:
        return Skin(
            shear_modulus=header["shear_modulus"],
            poisson_ratio=header["poisson_ratio"],
            response=restored_response(header, stored),
        )
    except TypeError as error:
        raise ValueError(error) from error
