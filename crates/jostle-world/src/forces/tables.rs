//! Tables of well-known forces between kinds.

use super::check_number;
use super::pair::{PairTable, check_cutoff, check_kind_count};
use crate::particles::FARTHEST;
use jostle_base::error::{Error, Result};

/// Points of a table whose pieces are not straight.
const POINTS: usize = 2049;

/// Maximum number of equal segments that are tried for the corners of a force.
const MAX_SEGMENTS: usize = 400;

/// Share of σ below which the Lennard-Jones force does not increase any more.
const HARDEST: f64 = 0.5;

impl PairTable {
    /// The forces of particle life. Within `core` times the cutoff all kinds repel each other, with
    /// a force that falls from 1 at distance 0 to 0. Beyond it, kind b attracts kind a with
    /// `matrix[a · kinds + b]` in the middle, and with less towards both ends. All forces are
    /// multiplied by `strength`.
    pub fn particle_life(
        kinds: usize,
        matrix: &[f32],
        cutoff: f32,
        core: f32,
        strength: f32,
    ) -> Result<Self> {
        check_each("matrix", kinds, matrix, f32::is_finite, "it must be finite")?;
        if !(0.0..1.0).contains(&core) || core == 0.0 {
            return Err(Error::of("core", core, "it must lie between 0 and 1"));
        }
        check_number("strength", strength, -FARTHEST)?;
        check_cutoff(cutoff)?;
        let (core, strength) = (f64::from(core), f64::from(strength));
        let force = |pull: f32, share: f64| {
            strength
                * if share < core {
                    1.0 - share / core
                } else {
                    let along = (2.0 * share - 1.0 - core).abs();
                    -f64::from(pull) * (1.0 - along / (1.0 - core))
                }
        };
        // Both corners of this force must be points of the table, because a linear piece across a
        // corner cuts it off.
        let segments = segments_with_corners([core, 0.5 + 0.5 * core]);
        let at = |k: usize| k as f64 / segments as f64;
        let line = |&pull: &f32| (0..segments + 1).map(move |k| force(pull, at(k)) as f32);
        Self::new(kinds, matrix.iter().flat_map(line).collect(), cutoff, 0.0)
    }

    /// The Lennard-Jones force 24 ε (2 (σ/d)¹² − (σ/d)⁶)/d, truncated at the cutoff; its potential
    /// is shifted to 0 there. Below σ/2 the force is that at σ/2.
    pub fn lennard_jones(
        kinds: usize,
        epsilon: &[f32],
        sigma: &[f32],
        cutoff: f32,
    ) -> Result<Self> {
        check_not_negative("epsilon", kinds, epsilon)?;
        check_positive("sigma", kinds, sigma)?;
        check_cutoff(cutoff)?;
        let force = |pair: usize, distance: f64| {
            let (epsilon, sigma) = (f64::from(epsilon[pair]), f64::from(sigma[pair]));
            // Particles may be put on each other. Without the limit their first step would have
            // forces that no length of a step resolves.
            let distance = distance.max(HARDEST * sigma);
            let square = (sigma / distance) * (sigma / distance);
            let sixth = square * square * square;
            24.0 * epsilon * (2.0 * sixth * sixth - sixth) / distance
        };
        Self::sampled(kinds, cutoff, 0.0, force)
    }

    /// Soft discs, which repel each other with stiffness times overlap. `diameters[a · kinds + b]`
    /// is the distance below which kinds a and b overlap; the largest is the cutoff.
    pub fn soft_discs(
        kinds: usize,
        stiffness: &[f32],
        diameters: &[f32],
        damping: f32,
    ) -> Result<Self> {
        check_not_negative("stiffness", kinds, stiffness)?;
        check_positive("diameters", kinds, diameters)?;
        let cutoff = diameters.iter().copied().fold(0.0, f32::max);
        check_cutoff(cutoff)?;
        let force = |pair: usize, distance: f64| {
            f64::from(stiffness[pair]) * (f64::from(diameters[pair]) - distance).max(0.0)
        };
        Self::sampled(kinds, cutoff, damping, force)
    }

    /// A table of a function of the pair of kinds and the distance.
    fn sampled(
        kinds: usize,
        cutoff: f32,
        damping: f32,
        force: impl Fn(usize, f64) -> f64,
    ) -> Result<Self> {
        let force = &force;
        let at = |k: usize| f64::from(cutoff) * k as f64 / (POINTS - 1) as f64;
        // From 46 kinds on, the finer table would have too many entries. Then every second point is
        // taken.
        let points = if kinds * kinds * POINTS <= super::pair::MAX_ENTRIES { POINTS } else { 1025 };
        let step = (POINTS - 1) / (points - 1);
        let line = |pair: usize| (0..points).map(move |k| force(pair, at(k * step)) as f32);
        Self::new(kinds, (0..kinds * kinds).flat_map(line).collect(), cutoff, damping)
    }
}

/// The smallest number of equal segments of 0 to 1 that has these corners between them; about that
/// of the best resolution if there is none.
fn segments_with_corners(corners: [f64; 2]) -> usize {
    let is_corner = |segments: usize, corner: f64| {
        let along = corner * segments as f64;
        (along - along.round()).abs() < 1e-4
    };
    let fits = |&segments: &usize| corners.iter().all(|&corner| is_corner(segments, corner));
    (2..MAX_SEGMENTS).find(fits).unwrap_or(MAX_SEGMENTS)
}

/// Refuses lengths that are not finite or not above 0.
fn check_positive(argument: &'static str, kinds: usize, all: &[f32]) -> Result<()> {
    let is_positive = |value: f32| value > 0.0 && value.is_finite();
    check_each(argument, kinds, all, is_positive, "it must be finite and above 0")
}

/// Refuses numbers that are not finite or below 0.
fn check_not_negative(argument: &'static str, kinds: usize, all: &[f32]) -> Result<()> {
    let is_allowed = |value: f32| value >= 0.0 && value.is_finite();
    check_each(argument, kinds, all, is_allowed, "it must be finite and at least 0")
}

/// Refuses an array that has not one allowed number for each pair of kinds.
fn check_each(
    argument: &'static str,
    kinds: usize,
    all: &[f32],
    is_allowed: impl Fn(f32) -> bool,
    rule: &str,
) -> Result<()> {
    check_kind_count(argument, kinds)?;
    if all.len() != kinds * kinds {
        return Err(Error::Length { argument, found: all.len(), expected: kinds * kinds });
    }
    match all.iter().position(|&value| !is_allowed(value)) {
        None => Ok(()),
        Some(index) => Err(Error::in_array(argument, index, &[kinds], all[index], rule)),
    }
}
