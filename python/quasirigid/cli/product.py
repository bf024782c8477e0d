"""The product, from the words of the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..io.record import figure
from .arguments import parse_poisson_ratio
from .quantities import STRESS, QuantityError, parse_positive

if TYPE_CHECKING:
    import quasirigid as qr

__all__ = ["ProductMaterial", "ProductPoissonRatio", "ProductShearModulus", "parse_material"]

ProductShearModulus = Annotated[
    str | None,
    typer.Option(help="Of a product that gives way as a half-space, as in 1MPa. [default: rigid]"),
]
ProductPoissonRatio = Annotated[
    str | None, typer.Option(help="Of such a product, 0 to 0.5; goes with --product-shear-modulus.")
]


@dataclass(frozen=True, kw_only=True)
class ProductMaterial:
    """Elastic constants of a product: G (Pa) and nu; both None of a rigid one."""

    shear_modulus: float | None = None
    poisson_ratio: float | None = None

    def given_to(self, obstacle: qr.Obstacle) -> qr.Obstacle:
        """Return the product with the material."""
        if self.shear_modulus is None or self.poisson_ratio is None:
            return obstacle
        return obstacle.with_material(shear_modulus=self.shear_modulus, poisson_ratio=self.poisson_ratio)

    @property
    def inputs(self) -> dict[str, Any]:
        """Return what was asked for, for the record."""
        return {
            "product_shear_modulus": figure(self.shear_modulus, "Pa"),
            "product_poisson_ratio": figure(self.poisson_ratio, "1"),
        }


def parse_material(shear_modulus: str | None, poisson_ratio: str | None) -> ProductMaterial:
    """Return the material of `--product-shear-modulus` and `--product-poisson-ratio`."""
    if shear_modulus is None and poisson_ratio is None:
        return ProductMaterial()
    if shear_modulus is None or poisson_ratio is None:
        missing = "--product-shear-modulus" if shear_modulus is None else "--product-poisson-ratio"
        raise QuantityError(
            f"a product that gives way needs {missing} too; give both, or neither for a rigid one"
        )
    return ProductMaterial(
        shear_modulus=parse_positive(shear_modulus, STRESS, "--product-shear-modulus"),
        poisson_ratio=parse_poisson_ratio(poisson_ratio, "--product-poisson-ratio"),
    )
