//! Forces between kinds of particles within a cutoff, from a table.
//!
//! The force on a particle of kind a by one of kind b is given at equally spaced distances from 0
//! to the cutoff, and linear between. Where the forces of all kinds on each other are equal and
//! opposite, the potential energy is the exact integral of the linear pieces, so that it fits the
//! force to rounding.

use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use super::neighbors::{self, Found, Law, Own, total};
use super::record::{record, refers_to_nothing};
use super::{Force, ForceInput, Partners, Scratch, Virial, check_number, product};
use crate::particles::{FARTHEST, MAX_KINDS};
use jostle_base::bytes::{Reader, Saved, Writer, damaged};
use jostle_base::error::{Error, Result, counted};
use jostle_simd::{LANES, PairIndices, Simd, block};

/// Maximum number of entries of a table. Their indices are exact in float32.
pub const MAX_ENTRIES: usize = 1 << 22;

/// Smallest cutoff.
const MIN_CUTOFF: f32 = 1e-12;

/// Lower limit of squared distances, which prevents a division by 0.
const MIN_SQUARE: f32 = 1e-24;

/// Number of neighbours whose forces are summed in float32; these sums are added in float64.
/// Each lane adds 16 numbers, so the rounding of its sum stays about 10⁻⁶.
const RUN: usize = 16 * LANES;

record! {
    /// Forces between kinds of particles.
    #[derive(Clone, Debug, PartialEq)]
    pub struct PairForce {
        /// The forces.
        pub table: Arc<PairTable>,
    }
}

/// The forces of kinds on each other, by distance.
#[derive(Debug)]
pub struct PairTable {
    kinds: usize,
    points: usize,
    values: Vec<f32>,
    cutoff: f32,
    damping: f32,
    /// Value at the beginning of each segment between two points, and its change along the segment.
    segments: Vec<AtomicU64>,
    /// Potential energy at each point, 0 at the cutoff; empty if there is none.
    potentials: Vec<f64>,
}

impl PartialEq for PairTable {
    fn eq(&self, other: &Self) -> bool {
        let shape = |table: &Self| (table.kinds, table.points, table.cutoff, table.damping);
        shape(self) == shape(other) && self.values == other.values
    }
}

impl PairTable {
    /// `values[(a · kinds + b) · points + k]` is the force on kind a by kind b at the distance
    /// k · cutoff / (points − 1), positive if it is repulsive. `damping` is the force that resists
    /// a relative speed of 1 along the line between two particles at distance 0; it decreases as
    /// (1 − d/cutoff)².
    pub fn new(kinds: usize, values: Vec<f32>, cutoff: f32, damping: f32) -> Result<Self> {
        check_kind_count("table", kinds)?;
        let points = values.len() / (kinds * kinds);
        if points < 2 || values.len() != kinds * kinds * points || values.len() > MAX_ENTRIES {
            let rule = format!(
                "it must have the shape (K, K, m) with m at least 2 and at most {MAX_ENTRIES} entries"
            );
            return Err(Error::of("table", counted(values.len(), "number"), &rule));
        }
        check_entries("table", &values, &[kinds, points])?;
        check_cutoff(cutoff)?;
        check_number("damping", damping, 0.0)?;
        let mut table = Self {
            kinds,
            points,
            values,
            cutoff,
            damping,
            segments: Vec::new(),
            potentials: Vec::new(),
        };
        table.segments = table.lines().flat_map(segments_of).collect();
        if table.is_reciprocal() {
            let step = f64::from(cutoff) / (points - 1) as f64;
            table.potentials = table.lines().flat_map(|line| potentials_of(line, step)).collect();
        }
        Ok(table)
    }

    /// The forces at m points of each pair of kinds.
    fn lines(&self) -> impl Iterator<Item = &[f32]> {
        self.values.chunks(self.points)
    }

    fn line(&self, a: usize, b: usize) -> &[f32] {
        &self.values[(a * self.kinds + b) * self.points..][..self.points]
    }

    /// Number of kinds.
    pub fn kinds(&self) -> usize {
        self.kinds
    }

    /// Number of distances.
    pub fn points(&self) -> usize {
        self.points
    }

    /// The forces.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Distance beyond which there is no force.
    pub fn cutoff(&self) -> f32 {
        self.cutoff
    }

    /// Resistance to relative speed.
    pub fn damping(&self) -> f32 {
        self.damping
    }

    /// Whether all forces are equal and opposite, so that momentum is conserved and, without
    /// damping, energy.
    pub fn is_reciprocal(&self) -> bool {
        let same = |a: usize, b: usize| self.line(a, b) == self.line(b, a);
        (0..self.kinds).all(|a| (0..a).all(|b| same(a, b)))
    }

    /// Potential energy of a particle of kind a and one of kind b at a distance below the cutoff.
    fn potential(&self, a: usize, b: usize, distance: f64) -> f64 {
        let (line, start) = (self.line(a, b), (a * self.kinds + b) * self.points);
        let step = f64::from(self.cutoff) / (self.points - 1) as f64;
        // The energy at the beginning of the segment less the exact integral of the linear force up
        // to here.
        let along = distance / step;
        let segment = (along as usize).min(self.points - 2);
        let share = along - segment as f64;
        let [low, high] = [line[segment], line[segment + 1]].map(f64::from);
        self.potentials[start + segment] - step * share * (low + 0.5 * (high - low) * share)
    }
}

impl PairTable {
    /// The force on a particle of kind a by one of kind b divided by their distance, positive if it is repulsive;
    /// `velocity` is that of the second relative to the first.
    fn force_over_distance(&self, a: usize, b: usize, offset: [f64; 2], velocity: [f64; 2]) -> f64 {
        let square = offset[0] * offset[0] + offset[1] * offset[1];
        let distance = square.max(f64::from(MIN_SQUARE)).sqrt();
        let cutoff = f64::from(self.cutoff);
        let along = distance / cutoff * (self.points - 1) as f64;
        let segment = (along as usize).min(self.points - 2);
        let line = self.line(a, b);
        let [low, high] = [line[segment], line[segment + 1]].map(f64::from);
        let force = low + (high - low) * (along - segment as f64);
        let share = (1.0 - distance / cutoff).max(0.0);
        let rate = (offset[0] * velocity[0] + offset[1] * velocity[1]) / distance;
        (force - f64::from(self.damping) * share * share * rate) / distance
    }
}

/// Refuses a number of kinds that no table has; `argument` is the array that has it.
pub(super) fn check_kind_count(argument: &'static str, kinds: usize) -> Result<()> {
    if (1..=MAX_KINDS).contains(&kinds) {
        return Ok(());
    }
    let rule = format!("there may be 1 to {MAX_KINDS} kinds");
    Err(Error::of(argument, format!("of {}", counted(kinds, "kind")), &rule))
}

/// Refuses entries of an array that are not finite or out of range; `shape` is that of its axes but
/// the first.
pub(super) fn check_entries(argument: &'static str, all: &[f32], shape: &[usize]) -> Result<()> {
    match all.iter().position(|&value| value.is_nan() || value.abs() > FARTHEST) {
        None => Ok(()),
        Some(index) => {
            let rule = format!("it must be finite and within ±{FARTHEST:e}");
            Err(Error::in_array(argument, index, shape, all[index], &rule))
        }
    }
}

/// Refuses a cutoff out of range.
pub(super) fn check_cutoff(cutoff: f32) -> Result<()> {
    if (MIN_CUTOFF..=FARTHEST).contains(&cutoff) {
        return Ok(());
    }
    let rule = format!("it must lie between {MIN_CUTOFF:e} and {FARTHEST:e}");
    Err(Error::of("cutoff", cutoff, &rule))
}

/// The segments of the forces of one pair of kinds.
fn segments_of(line: &[f32]) -> impl Iterator<Item = AtomicU64> {
    line.windows(2).map(|ends| {
        // Both numbers of a segment are in one word, so one load for each lane fetches them. The
        // word is atomic because `gather` takes atomic words.
        let [low, change] = [ends[0], ends[1] - ends[0]].map(|value| u64::from(value.to_bits()));
        AtomicU64::new(low | change << 32)
    })
}

/// Potential energy at the points of one pair of kinds.
fn potentials_of(line: &[f32], step: f64) -> Vec<f64> {
    // Summed from the cutoff, where the energy is 0. Trapezoids are exact for linear pieces.
    let mut all = vec![0.0; line.len()];
    for k in (0..line.len() - 1).rev() {
        all[k] = all[k + 1] + 0.5 * step * (f64::from(line[k]) + f64::from(line[k + 1]));
    }
    all
}

impl PairForce {
    /// Refuses nothing: a table is valid.
    pub fn validate(&self) -> Result<()> {
        Ok(())
    }
}

refers_to_nothing! { Arc<PairTable> }

/// The segments and potentials follow from the rest.
impl Saved for PairTable {
    fn put(&self, to: &mut Writer) {
        let Self { kinds, values, cutoff, damping, segments: _, potentials: _, points: _ } = self;
        kinds.put(to);
        values.put(to);
        to.put([*cutoff, *damping]);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let (kinds, values, [cutoff, damping]) =
            (Saved::get(from)?, Saved::get(from)?, from.get()?);
        Self::new(kinds, values, cutoff, damping).map_err(|error| damaged(&error.to_string()))
    }
}

impl Force for PairForce {
    fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        scratch: &mut Scratch,
        sums: &mut [[f32; 2]],
    ) -> Result<()> {
        let (table, neighbors) = (&*self.table, &mut scratch.neighbors);
        let segments = table.points - 1;
        // The index of the first segment of a kind is a whole number below 2²², exact in float32.
        // So the kinds are a column like the others.
        neighbors.fill(0, |row| (usize::from(bodies.kind(row)) * segments) as f32)?;
        let mut count = 1;
        if table.damping > 0.0 {
            neighbors.fill(1, |row| bodies.velocities[row][0])?;
            neighbors.fill(2, |row| bodies.velocities[row][1])?;
            count = 3;
        }
        neighbors.sum(bodies, table.cutoff, count, table, |row, by| {
            let mass = f64::from(bodies.masses[row]);
            sums[row] = [0, 1].map(|k| sums[row][k] + (by[k] / mass) as f32);
        })
    }

    fn limit(&self, _: &ForceInput<'_>, _: &mut [[f32; 2]]) {}

    /// Half of that of each pair for each of its own bodies; 0 beyond the cutoff, and if the forces are not equal
    /// and opposite.
    fn energy(&self, bodies: &ForceInput<'_>) -> Result<f64> {
        let table = &*self.table;
        if table.potentials.is_empty() {
            return Ok(0.0);
        }
        let mut neighbors = neighbors::Scratch::default();
        neighbors.sort(bodies)?;
        neighbors.fill(0, |row| f32::from(bodies.kind(row)))?;
        neighbors.fill(1, |row| f32::from(bodies.rows[row] < bodies.own_rows))?;
        let [kinds, weights, ..] = neighbors.columns();
        // Every pair is summed twice.
        let [sum] = neighbors.sum_of_pairs(bodies, table.cutoff, |indices, [x, y]| {
            let [a, b] = indices.map(|index| kinds[index] as usize);
            let distance = (x * x + y * y).sqrt();
            [f64::from(weights[indices[0]]) * table.potential(a, b, distance)]
        })?;
        Ok(0.5 * sum)
    }

    /// Half of that of each pair for each of its bodies, so it is also defined if forces are not equal and opposite.
    fn virial(&self, bodies: &ForceInput<'_>) -> Result<Virial> {
        let table = &*self.table;
        let mut neighbors = neighbors::Scratch::default();
        neighbors.sort(bodies)?;
        neighbors.fill(0, |row| f32::from(bodies.kind(row)))?;
        neighbors.fill(1, |row| bodies.velocities[row][0])?;
        neighbors.fill(2, |row| bodies.velocities[row][1])?;
        let [kinds, columns @ ..] = neighbors.columns();
        let [xx, xy, yx, yy] =
            neighbors.sum_of_pairs(bodies, table.cutoff, |indices, offset| {
                let [a, b] = indices.map(|index| kinds[index] as usize);
                let speed = |k: usize| {
                    f64::from(columns[k][indices[1]]) - f64::from(columns[k][indices[0]])
                };
                let factor = table.force_over_distance(a, b, offset, [speed(0), speed(1)]);
                // The force on the first points away from the second if it is positive, and so does the offset to the
                // first.
                let [[xx, xy], [yx, yy]] = product(offset, offset.map(|along| factor * along));
                [xx, xy, yx, yy]
            })?;
        Ok([[xx, xy], [yx, yy]].map(|row| row.map(|sum| 0.5 * sum)))
    }

    fn partners(&self) -> Partners {
        Partners::Neighbors { cutoff: self.table.cutoff, kinds: self.table.kinds }
    }
}

/// The first column has the index of the first segment of the kind of each body among those that
/// act on one kind, the others velocities, if there is damping.
impl Law for PairTable {
    #[inline(always)]
    fn act<S: Simd<f32>>(&self, simd: S, own: Own<'_>, found: &Found) -> [f64; 2] {
        let first = own.of(0) as u32 * self.kinds as u32;
        let least = simd.splat(MIN_SQUARE);
        let mut sum = [0.0f64; 2];
        let mut start = 0;
        while start < found.len {
            let end = found.len.min(start + RUN);
            let mut sums = [simd.splat(0.0); 2];
            while start < end {
                let x = simd.load(block(&found.x, start));
                let y = simd.load(block(&found.y, start));
                let square = simd.add(simd.mul(x, x), simd.mul(y, y));
                // For the body itself the offset is 0, so its finite factor adds nothing.
                let distance = simd.sqrt(simd.max(square, least));
                let inverse = simd.div(simd.splat(1.0), distance);
                let mut force = self.at(simd, first, block(&found.columns[0], start), distance);
                if self.damping > 0.0 {
                    let u = simd.load(block(&found.columns[1], start));
                    let v = simd.load(block(&found.columns[2], start));
                    // Only the relative velocity along the line between the two is damped, so that
                    // angular momentum is conserved.
                    let u = simd.mul(simd.sub(u, simd.splat(own.of(1))), x);
                    let v = simd.mul(simd.sub(v, simd.splat(own.of(2))), y);
                    let by = simd.mul(self.damping_at(simd, distance), simd.add(u, v));
                    force = simd.sub(force, simd.mul(by, inverse));
                }
                let factor = simd.mul(force, inverse);
                // A positive force repels, and the offset points to the neighbour.
                sums[0] = simd.sub(sums[0], simd.mul(factor, x));
                sums[1] = simd.sub(sums[1], simd.mul(factor, y));
                start += LANES;
            }
            // A run of sums in float32 is added up in float64, so the error does not grow with the
            // number of neighbours.
            for k in 0..2 {
                sum[k] += total(simd, sums[k]);
            }
        }
        sum
    }
}

impl PairTable {
    /// damping · (1 − d/cutoff)².
    #[inline(always)]
    fn damping_at<S: Simd<f32>>(&self, simd: S, distance: S::Block) -> S::Block {
        let share = simd.mul(distance, simd.splat(1.0 / self.cutoff));
        let weight = simd.max(simd.sub(simd.splat(1.0), share), simd.splat(0.0));
        simd.mul(simd.mul(weight, weight), simd.splat(self.damping))
    }

    /// The forces on a kind whose first segment is `own`, by neighbours whose first segments among
    /// these are `others`, at some distances.
    #[inline(always)]
    fn at<S: Simd<f32>>(
        &self,
        simd: S,
        own: u32,
        others: &[f32; LANES],
        distance: S::Block,
    ) -> S::Block {
        let last = self.points as i32 - 2;
        let scale = (self.points - 1) as f32 / self.cutoff;
        let mut along = [0.0f32; LANES];
        simd.store(simd.mul(distance, simd.splat(scale)), &mut along);
        let mut indices = [0u32; LANES];
        let mut shares = [0.0f32; LANES];
        for lane in 0..LANES {
            // Rounding may put a distance below the cutoff behind the last segment.
            let segment = (along[lane] as i32).min(last);
            shares[lane] = along[lane] - segment as f32;
            indices[lane] = own + (others[lane] as i32 + segment) as u32;
        }
        let [low, change] = simd.gather(&self.segments, &PairIndices::new([indices; 2]), 0);
        simd.add(low, simd.mul(change, simd.load(&shares)))
    }
}
