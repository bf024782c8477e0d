//! The linear complementarity problem `w = M z + q`, `w >= 0`, `z >= 0`, `w·z = 0`.
