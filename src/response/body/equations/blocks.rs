//! Blocks of the equations from the moments of a triangle's hats, for several triangles at once.

/// Position of entry 3 a + b in a packed symmetric matrix.
pub(crate) const PACKED_ENTRY: [usize; 9] = [0, 1, 2, 1, 3, 4, 2, 4, 5];

/// `T` of one corner's hats from their moments, lane by lane.
pub(crate) fn traction_blocks<const L: usize>(
    (isotropic, outer, skew): (f64, f64, f64),
    moments: &[[f64; L]; 15],
    normal: &[[f64; L]; 3],
) -> [[f64; L]; 9] {
    let mut blocks = [[0.0; L]; 9];
    let (d, e) = (&moments[6..12], &moments[12..15]);
    for a in 0..3 {
        for b in 0..3 {
            for l in 0..L {
                blocks[3 * a + b][l] = outer * d[PACKED_ENTRY[3 * a + b]][l]
                    + skew * (e[a][l] * normal[b][l] - normal[a][l] * e[b][l]);
            }
        }
    }
    for l in 0..L {
        let trace = isotropic * (d[0][l] + d[3][l] + d[5][l]);
        blocks[0][l] += trace;
        blocks[4][l] += trace;
        blocks[8][l] += trace;
    }
    blocks
}

/// Packed `U` of one corner's hats from their moments, lane by lane.
pub(crate) fn displacement_blocks<const L: usize>(
    (isotropic, outer): (f64, f64),
    moments: &[[f64; L]; 15],
) -> [[f64; L]; 6] {
    let mut blocks = [[0.0; L]; 6];
    for c in 0..6 {
        for l in 0..L {
            blocks[c][l] = outer * moments[c][l];
        }
    }
    for l in 0..L {
        let trace = isotropic * (moments[0][l] + moments[3][l] + moments[5][l]);
        blocks[0][l] += trace;
        blocks[3][l] += trace;
        blocks[5][l] += trace;
    }
    blocks
}
