"""Hands from files: glTF with a skin, or a mesh with its rig beside it."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..._check import as_path
from ..._units import metres_in
from ...errors import HandError, QuasirigidError, SizeWarning
from ...io.read import read_mesh
from ..hand import Hand
from .glb import read_glb

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from ..._arrays import Floats
    from ..._units import LengthUnit

__all__ = ["read_hand"]

_LENGTHS = (0.05, 0.4)  # m, from wrist to middle tip: from newborns to beyond the largest adults


def read_hand(
    path: str | PathLike[str], *, rig: str | PathLike[str] | None = None, unit: LengthUnit = "m"
) -> Hand:
    """Read a hand with its joints and weights.

    Parameters
    ----------
    path : path
        A glTF 2.0 file with one skin (.glb or .gltf), or a mesh (.ply, .stl, .obj).
    rig : path, optional
        The .npz of a mesh. The one beside it when left out: the longest name that the mesh's begins with,
        followed by ``_rig.npz``.
    unit : {"m", "cm", "mm", "inch"}
        Unit of a mesh and its rig; glTF is in metres.

    Returns
    -------
    Hand
        At rest, in the frame of the file.

    Raises
    ------
    HandError
        No skin or several in a glTF file, joints that are not WebXR's, doubled points whose weights differ, a
        node with an uneven or mirrored scale, a rig without weights for as many vertices; the message names
        the file.
    MeshFileError
        The file cannot be read.
    SurfaceError
        The skin is no surface.

    Warns
    -----
    SizeWarning
        The hand is shorter than 0.05 m or longer than 0.4 m, from wrist to middle tip: check the unit.

    Notes
    -----
    A rig holds ``joint_names`` (J,), ``parents`` (J,; -1 for the root), ``rest`` (J, 4, 4), and for each mesh
    one pair ``<mesh>_joint`` and ``<mesh>_weight`` (n, k), found by the number of vertices; ``side`` ("right"
    or "left") is optional, the joints tell it.

    Of glTF, bit-equal points are welded, as texture seams need. WebXR's joints hang on each other as there,
    joints of the file that stand between them included. All get frames of this package: +y to the next
    joint, +x the axis of flexion as the file has it. Which hand it is shows in the place of the thumb. Scales
    of its bind matrices and nodes count.
    """
    file = as_path("path", path)
    try:
        if file.suffix.lower() in (".glb", ".gltf"):
            if rig is not None:
                raise HandError("rig belongs to a mesh, glTF has its own")
            with np.errstate(invalid="ignore"):  # signalling nan of single precision: refused as nan
                hand = read_glb(file)
        else:
            hand = _read_mesh_with_rig(file, None if rig is None else as_path("rig", rig), unit)
    except QuasirigidError as error:
        if str(file) in str(error):
            raise
        raise type(error)(f"{file}: {error}") from None
    least, most = _LENGTHS
    if not least <= hand.length <= most:
        warnings.warn(
            f"{file}: the hand is {hand.length:.4g} m long from wrist to middle tip, outside {least} to "
            f"{most} m: is it in another unit? `unit` is that of mesh and rig, glTF's is the metre",
            SizeWarning,
            stacklevel=2,
        )
    return hand


def _read_mesh_with_rig(file: Path, rig: Path | None, unit: LengthUnit) -> Hand:
    vertices, faces = read_mesh(file, unit=unit)
    rig = _rig_beside(file) if rig is None else rig
    arrays = _load(rig)
    names, parents, rest = (_entry(arrays, name, rig) for name in ("joint_names", "parents", "rest"))
    joints, weights = _weights_for(len(vertices), arrays, rig)
    side: Any = str(arrays["side"]) if "side" in arrays else None
    try:
        frames: Floats = np.array(rest, dtype=np.float64)
        if unit != "m" and frames.ndim == 3:
            frames[:, :3, 3] *= metres_in(unit, HandError)
        return Hand(
            vertices,
            faces,
            joint_names=[str(name) for name in np.ravel(names)],
            parents=parents,
            rest=frames,
            joints=joints,
            weights=weights,
            side=side,
        )
    except QuasirigidError:
        raise
    except (TypeError, ValueError) as error:
        # Arrays of another kind: of a file, that is the file's fault.
        raise HandError(f"{rig}: {error}") from None


def _rig_beside(file: Path) -> Path:
    rigs = [
        one for one in file.parent.glob("*_rig.npz") if file.stem.startswith(one.name[: -len("_rig.npz")])
    ]
    if not rigs:
        raise HandError(f"{file}: no rig beside it ({file.stem}_rig.npz or a shorter name): give `rig`")
    return max(rigs, key=lambda one: len(one.name))


def _load(rig: Path) -> dict[str, NDArray[Any]]:
    try:
        with rig.open("rb") as stream, np.load(stream, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    except OSError as error:
        raise HandError(f"{rig}: {error.strerror or error}") from None
    except Exception:  # damaged archives raise many kinds
        raise HandError(f"{rig}: no file of arrays, expected the .npz of a rig") from None


def _entry(arrays: dict[str, NDArray[Any]], name: str, rig: Path) -> NDArray[Any]:
    if name not in arrays:
        raise HandError(f"{rig}: it has no {name!r}, but {', '.join(sorted(arrays)) or 'nothing'}")
    return arrays[name]


def _weights_for(count: int, arrays: dict[str, NDArray[Any]], rig: Path) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return joints and weights (n, k) of the mesh with so many vertices."""
    sizes = {
        name[: -len("_joint")]: len(rows)
        for name, rows in arrays.items()
        if name.endswith("_joint") and rows.ndim
    }
    fitting = [name for name, size in sizes.items() if size == count]
    if len(fitting) != 1:
        known = ", ".join(f"{name} ({size} vertices)" for name, size in sizes.items()) or "none"
        raise HandError(
            f"{rig}: {len(fitting)} sets of weights fit a mesh of {count} vertices; it holds {known}"
        )
    weights = _entry(arrays, f"{fitting[0]}_weight", rig)
    return arrays[f"{fitting[0]}_joint"], weights
