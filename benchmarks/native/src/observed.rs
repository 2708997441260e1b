//! Quantities that can be measured in any world, to compare the engines.

use std::fmt;

use jostle_base::settings;
use jostle_index::{Each, Shapes, pairs};

use crate::worlds::{Start, State};

/// Discs touch if their distance is at most this multiple of the sum of their radii. So engines
/// with small gaps and with small overlaps at rest are counted in the same way.
const TOUCHING: f32 = 1.02;

/// Quantities of a state.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// Kinetic energy for each unit of mass.
    pub energy: f64,
    /// ⟨v⁴⟩ / ⟨v²⟩²: 4/3 at the start of the scene, 2 in equilibrium.
    pub spread: f64,
    /// Pairs that touch, for each disc.
    pub touching: f64,
    /// Mean overlap of overlapping pairs, as a fraction of the sum of radii.
    pub overlap: f64,
    /// Mean y, in radii of the first disc.
    pub depth: f64,
    /// Whether there is gravity, so that the discs should be at rest.
    pub falls: bool,
}

impl Observed {
    /// Measures a state.
    pub fn of(start: &Start, (positions, velocities): &State) -> Self {
        let count = start.len() as f64;
        let squares = velocities.iter().map(|v| f64::from(v[0]).powi(2) + f64::from(v[1]).powi(2));
        let masses: Vec<f64> = start.radii.iter().map(|&r| f64::from(r).powi(2)).collect();
        let mass: f64 = masses.iter().sum();
        let energy = squares.clone().zip(&masses).map(|(v, m)| 0.5 * v * m).sum::<f64>() / mass;
        let mean = squares.clone().sum::<f64>() / count;
        let spread = squares.map(|v| v * v).sum::<f64>() / count / (mean * mean).max(1e-12);
        let gaps = near(start, positions);
        let overlaps: Vec<f64> = gaps.iter().map(|gap| -gap).filter(|&gap| gap > 0.0).collect();
        let depth = positions.iter().map(|p| f64::from(p[1])).sum::<f64>() / count;
        Self {
            energy,
            spread,
            touching: gaps.len() as f64 / count,
            overlap: overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64,
            depth: depth / f64::from(start.radii[0]),
            falls: start.gravity != [0.0; 2],
        }
    }
}

impl Observed {
    /// The differences from jostle's result in quantities that do not depend on single
    /// trajectories. Moving discs should have the same energy and distribution of speeds; resting
    /// ones the same mean height, and overlaps at most 0.01 larger.
    pub fn differs_from(&self, ours: &Self) -> Option<String> {
        if !ours.falls {
            let (share, spread) = (self.energy / ours.energy, self.spread / ours.spread);
            let alike = (share - 1.0).abs() < 0.05 && (spread - 1.0).abs() < 0.1;
            return (!alike).then(|| format!("has {:.0} % of our energy", 100.0 * share));
        }
        let (theirs, own) = (100.0 * self.overlap, 100.0 * ours.overlap);
        let sunk = 100.0 * (self.depth / ours.depth - 1.0);
        let alike = sunk.abs() < 2.0 && theirs < own + 1.0;
        let words =
            || format!("lies {sunk:.1} % deeper and overlaps by {theirs:.1} not {own:.1} %");
        (!alike).then(words)
    }
}

impl fmt::Display for Observed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { energy, spread, touching, overlap, depth, .. } = self;
        write!(f, "energy {energy:.4}, spread of speeds {spread:.3}, mean y {depth:.2} radii, ")?;
        write!(
            f,
            "{touching:.3} pairs touch for each disc, overlapping by {:.2} %",
            100.0 * overlap
        )
    }
}

/// Gaps between discs that touch, as fractions of the sum of their radii.
fn near(start: &Start, positions: &[[f32; 2]]) -> Vec<f64> {
    let radii = Each::Rows(start.radii.iter().map(|r| r * TOUCHING).collect());
    let shapes = Shapes::circles(positions.to_vec(), radii).expect("finite positions");
    let found = pairs::find(&shapes, None, None, settings::DEFAULT_MAX_PAIRS);
    let gap = |&[i, j]: &[u32; 2]| {
        let (i, j) = (i as usize, j as usize);
        let [a, b] = [positions[i], positions[j]].map(|p| p.map(f64::from));
        let reach = f64::from(start.radii[i]) + f64::from(start.radii[j]);
        (a[0] - b[0]).hypot(a[1] - b[1]) / reach - 1.0
    };
    found.expect("fewer pairs than the limit").pairs.iter().map(gap).collect()
}
