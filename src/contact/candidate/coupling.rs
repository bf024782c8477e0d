//! How much fingers feel of each other through the tissue that they share.

use nalgebra::Vector3;

/// For each two fingers the share of what a kernel passes on from one to the other, from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coupling {
    /// Symmetric, with 1 on the diagonal.
    shares: Vec<Vec<f64>>,
}

impl Coupling {
    /// * `pairs`: the share of two fingers, 0 for all others
    pub fn new(count: usize, pairs: impl IntoIterator<Item = ([usize; 2], f64)>) -> Self {
        let mut shares: Vec<Vec<f64>> =
            (0..count).map(|a| (0..count).map(|b| f64::from(u8::from(a == b))).collect()).collect();
        for ([a, b], share) in pairs {
            shares[a][b] = share;
            shares[b][a] = share;
        }
        Self { shares }
    }

    /// What patches feel of each other through one solid that they press along these ways: all where they press it from
    /// sides that face one way, nothing else, as a half-space has one side.
    pub fn through_solid(ways: &[Vector3<f64>]) -> Self {
        let count = ways.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
        let face_one_way = pairs.filter(|&[a, b]| ways[a].dot(&ways[b]) > 0.0);
        Self::new(count, face_one_way.map(|pair| (pair, 1.0)))
    }

    /// Of one finger.
    pub fn one() -> Self {
        Self::new(1, [])
    }

    /// Of some of the fingers, in that order; one that is not known feels no other.
    pub fn among(&self, fingers: &[usize]) -> Self {
        let row = |&a: &usize| fingers.iter().map(|&b| self.between(a, b)).collect();
        Self { shares: fingers.iter().map(row).collect() }
    }

    pub fn between(&self, a: usize, b: usize) -> f64 {
        let known = || self.shares.get(a).and_then(|row| row.get(b)).copied();
        if a == b { 1.0 } else { known().unwrap_or(0.0) }
    }

    /// The first finger that feels what a finger feels, itself and that one included.
    pub fn same_as(&self, finger: usize) -> usize {
        (0..finger).find(|&other| self.shares[other] == self.shares[finger]).unwrap_or(finger)
    }

    /// Fingers that feel each other or the same others, if only in part.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let count = self.shares.len();
        let mut group: Vec<usize> = (0..count).collect();
        for a in 0..count {
            for b in (a + 1..count).filter(|&b| self.shares[a][b] > 0.0) {
                let (kept, joined) = (group[a].min(group[b]), group[a].max(group[b]));
                group.iter_mut().filter(|group| **group == joined).for_each(|group| *group = kept);
            }
        }
        let members = |first: usize| (0..count).filter(|&finger| group[finger] == first).collect();
        (0..count).filter(|&finger| group[finger] == finger).map(members).collect()
    }

    /// The least share of two fingers, and the largest.
    pub fn extremes(&self) -> [f64; 2] {
        let shares = self.shares.iter().enumerate().flat_map(|(a, row)| &row[a + 1..]).copied();
        [shares.clone().fold(1.0, f64::min), shares.fold(0.0, f64::max)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solid_joins_what_presses_it_from_sides_that_face_one_way() {
        let (up, side) = (Vector3::z(), Vector3::x());
        let solid = Coupling::through_solid(&[up, -up, up + side, side]);
        let felt = |a| [0, 1, 2, 3].map(|b| solid.between(a, b));
        assert_eq!(felt(0), [1.0, 0.0, 1.0, 0.0]);
        assert_eq!(felt(1), [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(felt(2), [1.0, 0.0, 1.0, 1.0]);
        assert_eq!(solid.groups(), [vec![0, 2, 3], vec![1]]);
    }

    #[test]
    fn fingers_are_one_where_all_others_feel_the_same_of_both() {
        let coupling = Coupling::new(5, [([0, 3], 1.0), ([3, 1], 0.5), ([0, 1], 0.5), ([2, 4], 0.0)]);
        assert_eq!((coupling.between(1, 3), coupling.between(3, 2)), (0.5, 0.0));
        assert_eq!([0, 1, 2, 3, 4].map(|finger| coupling.same_as(finger)), [0, 1, 2, 0, 4]);
        assert_eq!(coupling.groups(), [vec![0, 1, 3], vec![2], vec![4]]);
        assert_eq!(coupling.extremes(), [0.0, 1.0]);
        let known = coupling.among(&[1, usize::MAX, 3]);
        assert_eq!([(0, 1), (0, 2), (1, 2), (1, 1)].map(|(a, b)| known.between(a, b)), [0.0, 0.5, 0.0, 1.0]);
        assert_eq!((known.extremes(), Coupling::one().extremes()), ([0.0, 0.5], [1.0, 0.0]));
        // What two feel of a third is not the same: each stays for itself, in one group.
        let chain = Coupling::new(3, [([0, 1], 1.0), ([1, 2], 0.5)]);
        assert_eq!([0, 1, 2].map(|finger| chain.same_as(finger)), [0, 1, 2]);
        assert_eq!(chain.groups(), [[0, 1, 2]]);
    }
}
