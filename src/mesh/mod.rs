//! Checks, neighbourhoods and repair of raw triangle meshes, shared by skin and product.
