"""Types of the compiled core. All numbers are SI: m, N, Pa, rad, s."""

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._units import LengthUnit

__all__ = [
    "Contact",
    "ContactOptions",
    "LcpOptions",
    "LcpSolution",
    "Obstacle",
    "Skin",
    "Surface",
    "cut_out",
    "definiteness",
    "flat_cap_mask",
    "initial_gaps",
    "press",
    "repair",
    "response_matrix",
    "restore_obstacle",
    "solve_contact",
    "solve_lcp",
]

__version__: str

@final
class Surface:
    def __new__(
        cls, vertices: ArrayLike, faces: ArrayLike, skin_mask: ArrayLike | None = None
    ) -> Surface: ...
    @staticmethod
    def from_mesh(mesh: object, *, unit: LengthUnit = "m", skin_mask: ArrayLike | None = None) -> Surface: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int64]: ...
    @property
    def vertex_normals(self) -> NDArray[np.float64]: ...
    @property
    def vertex_areas(self) -> NDArray[np.float64]: ...
    @property
    def skin_mask(self) -> NDArray[np.bool_]: ...
    @property
    def area(self) -> float: ...
    @property
    def volume(self) -> float: ...
    @property
    def is_closed(self) -> bool: ...
    @property
    def mean_edge_length(self) -> float: ...
    def with_skin_mask(self, skin_mask: ArrayLike) -> Surface: ...
    def moved(self, rotation: ArrayLike, translation: ArrayLike) -> Surface: ...
    def k_ring(self, nodes: ArrayLike, rings: int) -> NDArray[np.int64]: ...
    def patches(self, nodes: ArrayLike) -> list[NDArray[np.int64]]: ...
    def __reduce__(
        self,
    ) -> tuple[type[Surface], tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]]]: ...

@final
class Obstacle:
    @staticmethod
    def mesh(vertices: ArrayLike, faces: ArrayLike, *, check_crossings: bool = True) -> Obstacle: ...
    @staticmethod
    def from_mesh(mesh: object, *, unit: LengthUnit = "m", check_crossings: bool = True) -> Obstacle: ...
    @staticmethod
    def half_space(point: ArrayLike, normal: ArrayLike) -> Obstacle: ...
    @staticmethod
    def sphere(center: ArrayLike, radius: float) -> Obstacle: ...
    @staticmethod
    def box(half_extents: ArrayLike) -> Obstacle: ...
    @staticmethod
    def capsule(a: ArrayLike, b: ArrayLike, radius: float) -> Obstacle: ...
    @staticmethod
    def cylinder(half_height: float, radius: float) -> Obstacle: ...
    def moved(self, rotation: ArrayLike, translation: ArrayLike) -> Obstacle: ...
    def signed_distance(
        self, points: ArrayLike, max_distance: float | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
    @property
    def kind(self) -> str: ...
    @property
    def bounding_box(self) -> NDArray[np.float64] | None: ...
    @property
    def rotation(self) -> NDArray[np.float64]: ...
    @property
    def translation(self) -> NDArray[np.float64]: ...
    def triangles(self) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None: ...
    def __reduce__(self) -> tuple[Any, tuple[str, Any, list[float]]]: ...

@final
class Skin:
    @staticmethod
    def half_space(shear_modulus: float, poisson_ratio: float, pressure: str, gap: str) -> Skin: ...
    @staticmethod
    def gaussian_corrected(
        shear_modulus: float,
        poisson_ratio: float,
        height: float,
        width: float,
        cutoff: float,
        pressure: str,
    ) -> Skin: ...
    @staticmethod
    def layer(
        shear_modulus: float, poisson_ratio: float, thickness: ArrayLike, pressure: str, gap: str
    ) -> Skin: ...
    @staticmethod
    def given(surface: Surface, nodes: ArrayLike, matrix: ArrayLike) -> Skin: ...
    @staticmethod
    def body(
        surface: Surface,
        shear_modulus: float,
        poisson_ratio: float,
        bone: Surface | None,
        fixed: ArrayLike | None,
        nodes: ArrayLike,
        *,
        bone_pressure: bool,
        num_threads: int | None,
        memory_limit: int | None,
        progress: Callable[[str, float], None] | None,
    ) -> Skin: ...
    @staticmethod
    def restore_body(
        surface: Surface,
        shear_modulus: float,
        poisson_ratio: float,
        nodes: ArrayLike,
        displacement: ArrayLike,
        area_vectors: ArrayLike,
        rotation: ArrayLike,
        *,
        bone_pressure: ArrayLike | None,
        solved: bool,
    ) -> Skin: ...
    @staticmethod
    def combined(
        surface: Surface, elsewhere: Skin, parts: Sequence[tuple[str, Skin, list[int], ArrayLike]]
    ) -> Skin: ...
    @staticmethod
    def body_cost(skin_vertices: int, bone_vertices: int, nodes: int) -> tuple[int, float]: ...
    @staticmethod
    def balanced_height(shear_modulus: float, poisson_ratio: float, width: float, cutoff: float) -> float: ...
    def caution(self) -> str | None: ...
    def net_volume(self, surface: Surface, node: int) -> tuple[float, float]: ...
    def prepare(self, surface: Surface, nodes: ArrayLike) -> Skin: ...
    def restore(self, surface: Surface, nodes: ArrayLike, matrix: ArrayLike) -> Skin: ...
    def nodes(self) -> NDArray[np.int64]: ...
    def bone_pressures(self, forces: ArrayLike) -> NDArray[np.float64] | None: ...
    def moved(self, rotation: ArrayLike, translation: ArrayLike) -> Skin: ...
    def check_surface(self, surface: Surface) -> None: ...
    def parts(self) -> dict[str, NDArray[Any]]: ...

@final
class ContactOptions:
    def __new__(
        cls,
        *,
        tolerance: float,
        rings: int | None,
        method: str,
        num_threads: int | None,
        memory_limit: int | None,
        search_distance: float | None,
        condition: bool,
        couple_fingers: bool,
        max_growths: int,
    ) -> ContactOptions: ...
    @staticmethod
    def defaults() -> dict[str, Any]: ...

@final
class Contact:
    def fields(self) -> dict[str, Any]: ...
    def patches(self) -> list[dict[str, Any]]: ...
    def accuracy(self) -> dict[str, Any]: ...
    def drawn(self) -> tuple[NDArray[np.float64], float, float, Surface]: ...
    def obstacle(self) -> Obstacle: ...
    def lcp_solutions(self) -> list[LcpSolution]: ...

def cut_out(
    surface: Surface, tip: int, point: ArrayLike, normal: ArrayLike
) -> tuple[Surface, NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64]]: ...
def definiteness(matrix: ArrayLike) -> dict[str, Any]: ...
def flat_cap_mask(surface: Surface) -> NDArray[np.bool_]: ...
def repair(
    vertices: ArrayLike, faces: ArrayLike, *, weld_tolerance: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], dict[str, int]]: ...
def initial_gaps(
    surface: Surface,
    skin: Skin,
    nodes: ArrayLike,
    distance: Callable[[NDArray[np.float64]], ArrayLike],
) -> NDArray[np.float64]: ...
def response_matrix(
    surface: Surface,
    skin: Skin,
    nodes: ArrayLike,
    directions: ArrayLike | None,
    *,
    tolerance: float,
    num_threads: int | None,
) -> NDArray[np.float64]: ...
def restore_obstacle(kind: str, shape: Any, pose: Sequence[float], /) -> Obstacle: ...
def solve_contact(surface: Surface, obstacle: Obstacle, skin: Skin, options: ContactOptions) -> Contact: ...
def press(
    surface: Surface,
    obstacle: Obstacle,
    skin: Skin,
    direction: ArrayLike,
    *,
    depth: float,
    start: str,
    options: ContactOptions,
) -> Contact: ...

@final
class LcpOptions:
    def __new__(
        cls,
        *,
        max_pivots: int | None,
        pivot_tol: float,
        tolerance: float,
        initial_active: list[int] | None,
        covering: ArrayLike | None,
        total: float | None,
        definiteness: str,
        crash: bool,
        check: str,
        known_p_matrix: bool,
    ) -> LcpOptions: ...
    @staticmethod
    def defaults() -> dict[str, Any]: ...

@final
class LcpSolution:
    def fields(self) -> dict[str, Any]: ...

def solve_lcp(matrix: ArrayLike, q: ArrayLike, method: str, options: LcpOptions) -> LcpSolution: ...
