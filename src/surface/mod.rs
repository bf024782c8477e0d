//! The skin: a validated triangle mesh with neighbourhoods, areas, normals and patches.
