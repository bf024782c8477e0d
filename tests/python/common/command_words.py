"""Words of the command line that work in the folder of the demo."""

from __future__ import annotations

DEMO = ["demo", "--quick", "--out", "demo-output"]


def press_arguments(**changes: str | None) -> list[str]:
    """A press that works in the demo's folder, with options changed or (None) left out."""
    options: dict[str, str | None] = {
        "unit": "m",
        "product-unit": "mm",
        "translate": "0,19.2,-40mm",
        "rotate": "0,90,0deg",
        "direction": "0,0,1",
        "depth": "1.12mm",
        "shear-modulus": "60kPa",
        "poisson-ratio": "0.5",
        "out": "out",
    }
    options |= {name.replace("_", "-"): value for name, value in changes.items()}
    words = [word for name, value in options.items() if value is not None for word in (f"--{name}", value)]
    return ["press", "demo-output/fingertip.ply", "demo-output/handle.stl", *words, "--no-pictures"]


def sweep_arguments(*words: str) -> list[str]:
    """A sweep of the scene of `press_arguments`, whose goal and folder are in `words`."""
    arguments = press_arguments(depth=None, out=None)
    return ["sweep", *arguments[1:-1], *words]
