//! A vector of numbers that reads like one number.

use std::ops::{Add, Div, Mul, Sub};

use pulp::Simd;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

/// As many numbers as a register of the machine at hand holds.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    pub(crate) v: S::f64s,
}

/// A choice for each lane.
#[derive(Clone, Copy)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    m: S::m64s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, v: S::f64s) -> Self {
        Self { simd, v }
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f64) -> Self {
        Self { simd, v: simd.splat_f64s(value) }
    }

    /// The numbers of a list from `first` on.
    #[inline(always)]
    pub(crate) fn load(simd: S, list: &[f64], first: usize) -> Self {
        Self::new(simd, S::as_simd_f64s(&list[first..first + S::F64_LANES]).0[0])
    }

    /// Writes the lanes to a list from `first` on.
    #[inline(always)]
    pub(crate) fn store(self, list: &mut [f64], first: usize) {
        S::as_mut_simd_f64s(&mut list[first..first + S::F64_LANES]).0[0] = self.v;
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.min_f64s(self.v, other.v))
    }

    /// The smallest of the lanes.
    #[inline(always)]
    pub(crate) fn least(self) -> f64 {
        self.simd.reduce_min_f64s(self.v)
    }

    /// Sum of the lanes.
    #[inline(always)]
    pub(crate) fn total(self) -> f64 {
        self.simd.reduce_sum_f64s(self.v)
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn all(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// `self * b + c`, rounded once where the machine can.
    #[inline(always)]
    pub(crate) fn mul_add(self, b: Self, c: Self) -> Self {
        Self::new(self.simd, self.simd.mul_add_e_f64s(self.v, b.v, c.v))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self::new(self.simd, self.simd.sqrt_f64s(self.v))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        // spelled out, as pulp's own abs and select are not always inlined
        let bits = self.simd.transmute_u64s_f64s(self.v);
        let rest = self.simd.and_u64s(bits, self.simd.splat_u64s(u64::MAX >> 1));
        Self::new(self.simd, self.simd.transmute_f64s_u64s(rest))
    }

    #[inline(always)]
    pub(crate) fn less(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, m: self.simd.less_than_f64s(self.v, other.v) }
    }

    #[inline(always)]
    pub(crate) fn at_most(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, m: self.simd.less_than_or_equal_f64s(self.v, other.v) }
    }

    /// `f` of the bits of every lane.
    #[inline(always)]
    pub(crate) fn map_bits(self, f: impl Fn(u64) -> u64) -> Self {
        let mut bits = self.simd.transmute_u64s_f64s(self.v);
        for b in cast_slice_mut::<S::u64s, u64>(std::slice::from_mut(&mut bits)) {
            *b = f(*b);
        }
        Self::new(self.simd, self.simd.transmute_f64s_u64s(bits))
    }

    /// The first N numbers of the row that `row` finds by the bits of each lane.
    #[inline(always)]
    pub(crate) fn pick_rows<const N: usize, const W: usize>(
        self,
        rows: &[[f64; W]],
        row: impl Fn(u64) -> usize,
    ) -> [Self; N] {
        let mut columns = [self; N];
        for (lane, &bits) in cast_slice::<S::f64s, u64>(std::slice::from_ref(&self.v)).iter().enumerate() {
            let row = &rows[row(bits).min(rows.len() - 1)];
            for n in 0..N {
                cast_slice_mut::<S::f64s, f64>(std::slice::from_mut(&mut columns[n].v))[lane] = row[n];
            }
        }
        columns
    }

    /// A polynomial, coefficients highest first, at least one.
    #[inline(always)]
    pub(crate) fn polynomial<const N: usize>(self, coefficients: [f64; N]) -> Self {
        let mut p = self.all(coefficients[0]);
        for &c in &coefficients[1..] {
            p = p.mul_add(self, self.all(c));
        }
        p
    }
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub(crate) fn pick(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        let (yes, no) = (self.simd.transmute_u64s_f64s(yes.v), self.simd.transmute_u64s_f64s(no.v));
        Lanes::new(self.simd, self.simd.transmute_f64s_u64s(self.simd.select_u64s(self.m, yes, no)))
    }
}

/// Scalar product of two vectors.
#[inline(always)]
pub(crate) fn dot<S: Simd>(a: &[Lanes<S>; 3], b: &[Lanes<S>; 3]) -> Lanes<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

macro_rules! operator {
    ($trait:ident, $method:ident, $simd:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::new(self.simd, self.simd.$simd(self.v, other.v))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);
