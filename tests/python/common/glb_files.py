"""GLB files with another description, and the parts of one."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hands import GLB
from shared_meshes import hand_file


def glb_with(change: Callable[[dict[str, Any]], None], folder: Path, of: Path | None = None) -> Path:
    """Write the published hand, or that of a file, with another description."""
    source = (of or hand_file(GLB[1], ".glb")).read_bytes()
    length = struct.unpack_from("<I", source, 12)[0]
    description = json.loads(source[20 : 20 + length])
    change(description)
    text = json.dumps(description).encode()
    text += b" " * (-len(text) % 4)
    rest = source[20 + length :]
    path = folder / "hand.glb"
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    path.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + rest)
    return path


def glb_parts(path: Path) -> tuple[dict[str, Any], bytearray]:
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + size]), bytearray(data[28 + size :])
