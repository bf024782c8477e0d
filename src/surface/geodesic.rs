//! Which parts of the skin share tissue: the way along the skin against the straight line.

/// Longest way along the skin, over the straight line, between points that share tissue.
///
/// Around a round finger the way is π/2 of the straight line at most, and a path of edges up to 15 % longer than
/// that: 1.81. An oval section of 3 : 2 gives 1.98 between the middles of its flat sides. From one finger to the next
/// the way leads down to the web and up again, many times the gap between them.
pub const LONGEST_DETOUR: f64 = 2.0;

/// Whether two points of the skin answer each other's forces through the tissue between them.
///
/// `along_skin <= LONGEST_DETOUR · straight + slack`: points that are close in space but far along the skin lie on
/// different fingers, with air in between.
///
/// * `along_skin`: distance along the skin (m), as [`Surface::skin_distances`](crate::surface::Surface::skin_distances)
///   gives it; infinite for another component
/// * `straight`: straight-line distance (m)
/// * `slack`: allowance for how coarsely both are known (m), a mesh edge or the size of the sets compared
pub fn shares_tissue(along_skin: f64, straight: f64, slack: f64) -> bool {
    along_skin <= LONGEST_DETOUR * straight + slack
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn opposite_points_of_a_round_finger_share_tissue_and_those_of_two_fingers_do_not() {
        let diameter = 16e-3;
        assert!(shares_tissue(1.15 * 0.5 * PI * diameter, diameter, 0.0));
        // 2 mm of air between two fingers, 30 mm above the web
        assert!(!shares_tissue(2.0 * 30e-3 + 2e-3, 2e-3, 1e-3));
        assert!(!shares_tissue(f64::INFINITY, 1e-3, 1e-3));
    }
}
