//! Vector instructions, chosen at run time: the only unsafe code of the package.
//!
//! A kernel tests one shape against its neighbours in memory and writes the pairs without a
//! branch: a mask has the bits of those that overlap, and the register is compressed and stored
//! whole. Products and sums are not fused, so all kernels return the same pairs.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod output;
mod plain;

use std::ops::Range;

pub use output::Output;

/// Spare rows that columns must have at their end, so that a whole register can be read
/// from any row.
pub const SPARE: usize = 16;

/// Shapes in the order of a grid's cells, one array for each number.
#[derive(Debug, Default)]
pub struct Columns {
    /// Number of shapes; the arrays in use have [`SPARE`] more rows.
    len: usize,
    x: Vec<f32>,
    y: Vec<f32>,
    id: Vec<u32>,
    /// Empty if all shapes are discs of one size.
    size: Vec<f32>,
    /// Empty if all shapes are discs.
    half: [Vec<f32>; 2],
}

impl Columns {
    /// Takes over arrays that end in [`SPARE`] unused rows.
    pub fn new(
        x: Vec<f32>,
        y: Vec<f32>,
        id: Vec<u32>,
        size: Vec<f32>,
        half: [Vec<f32>; 2],
    ) -> Self {
        let len = x.len().checked_sub(SPARE).expect("spare rows");
        let fits = |used: usize| used == 0 || used == len + SPARE;
        assert!(y.len() == x.len() && id.len() == x.len());
        assert!(fits(size.len()) && fits(half[0].len()) && half[0].len() == half[1].len());
        Self { len, x, y, id, size, half }
    }

    /// Centres, x, without the spare rows.
    pub fn x(&self) -> &[f32] {
        &self.x[..self.len]
    }

    /// Centres, y, without the spare rows.
    pub fn y(&self) -> &[f32] {
        &self.y[..self.len]
    }

    /// Sizes, without the spare rows.
    pub fn size(&self) -> &[f32] {
        &self.size[..self.len]
    }

    /// Half widths and half heights, without the spare rows; empty for discs.
    pub fn half(&self) -> Option<[&[f32]; 2]> {
        (!self.half[0].is_empty()).then(|| self.half.each_ref().map(|half| &half[..self.len]))
    }

    fn check(&self, row: usize, strip: &Range<usize>, kind: Kind) {
        assert!(row < self.len && strip.end <= self.len);
        assert!(kind == EQUAL || !self.size.is_empty());
        assert!(kind != BOXES || !self.half[0].is_empty());
    }
}

/// The kind of the shapes, which determines the test: one of the constants.
pub type Kind = u8;

/// Discs of one size.
pub const EQUAL: Kind = 0;
/// Discs; `size` is the radius.
pub const DISCS: Kind = 1;
/// Rectangles; `size` is the longer half side.
pub const BOXES: Kind = 2;

/// A width of vector instructions.
pub trait Lanes: Copy {
    /// Adds the pairs of the shape in `row` with those in `strip`; of shapes of different
    /// sizes only the smaller ones, and of those of its own size the ones behind it.
    fn strip<const KIND: Kind>(
        self,
        columns: &Columns,
        row: usize,
        strip: Range<usize>,
        reach_squared: f32,
        output: Output,
    ) -> Output;

    /// As [`Lanes::strip`] for discs of one size and two strips at once.
    #[inline(always)]
    fn two_strips(
        self,
        columns: &Columns,
        row: usize,
        strips: [Range<usize>; 2],
        reach_squared: f32,
        output: Output,
    ) -> Output {
        let [first, second] = strips;
        let output = self.strip::<EQUAL>(columns, row, first, reach_squared, output);
        self.strip::<EQUAL>(columns, row, second, reach_squared, output)
    }
}

/// Work for any width of vector instructions.
pub trait Work {
    /// Its result.
    type Outcome;

    /// Runs it. Must be `#[inline(always)]`, as every function down to the kernels.
    fn run<L: Lanes>(self, lanes: L) -> Self::Outcome;
}

/// The widths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// No vector instructions.
    Plain,
    /// Eight at a time.
    Avx2,
    /// Sixteen at a time, with masks.
    Avx512,
}

impl Level {
    /// The widest of this processor; the variable `JOSTLE_RIVALS_SIMD` (plain, avx2) selects a
    /// smaller one.
    pub fn best() -> Self {
        let asked = std::env::var("JOSTLE_RIVALS_SIMD").unwrap_or_default();
        match asked.as_str() {
            "plain" => Self::Plain,
            "avx2" if Self::Avx2.is_there() => Self::Avx2,
            _ if Self::Avx512.is_there() => Self::Avx512,
            _ if Self::Avx2.is_there() => Self::Avx2,
            _ => Self::Plain,
        }
    }

    /// Whether this processor has it.
    pub fn is_there(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Self::Plain => true,
            Self::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("popcnt")
                    && is_x86_feature_detected!("lzcnt")
            }
            Self::Avx512 => {
                Self::Avx2.is_there()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        };
        #[cfg(not(target_arch = "x86_64"))]
        return self == Self::Plain;
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "no vectors",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }

    /// Runs `work`, compiled for this width.
    pub fn run<W: Work>(self, work: W) -> W::Outcome {
        assert!(self.is_there(), "the processor has no {}", self.name());
        match self {
            Self::Plain => work.run(plain::Plain),
            // SAFETY: the processor has the instructions, which was tested above.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { avx2::run(work) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { avx512::run(work) },
            #[cfg(not(target_arch = "x86_64"))]
            _ => work.run(plain::Plain),
        }
    }
}
