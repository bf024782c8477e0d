//! How far the peak pressure stands out from what is around it: on a smooth contact no farther than the pressure is curved there.
//!
//! A curved skin is refined onto smooth triangles, which meet in creases where the given ones are of all shapes. A vertex on
//! one is pressed harder than those beside it, the more so the smaller the cells are.

use crate::contact::outcome::Contact;

/// What the pressure of a smooth contact falls by from its peak to the next vertices, times the vertices under force: π/2 of
/// Hertz's spheres with cells of one size, where r cells in the radius make it 1/(2 r²); twice that of ellipses and uneven cells.
const SMOOTH_PEAK: f64 = 3.0;
/// What the peak errs over what it stands out: fitted to paraboloids of poor triangles and to single bumps, of which a refined mesh
/// shows half.
const AT_CREASES: f64 = 2.0;

impl Contact {
    /// Error of the peak pressure at a crease or a bump of the skin: from how far it is above the mean of those under force beside
    /// it, less what a smooth peak is. Of a contact on a refined part: the whole surface is not made for this.
    pub(crate) fn peak_at_creases(&self) -> f64 {
        let largest = |a: &&usize, b: &&usize| self.pressure[**a].total_cmp(&self.pressure[**b]);
        let Some(&peak) = self.active.iter().max_by(largest) else { return 0.0 };
        let around = self.surface().neighbours(peak).iter().map(|&vertex| self.pressure[vertex as usize]);
        let beside: Vec<f64> = around.filter(|pressure| *pressure > 0.0).collect();
        if beside.is_empty() {
            return 0.0;
        }
        let mean = beside.iter().sum::<f64>() / beside.len() as f64;
        let stands_out = self.pressure[peak] / mean - 1.0 - SMOOTH_PEAK / self.active.len() as f64;
        AT_CREASES * stands_out.max(0.0)
    }
}
