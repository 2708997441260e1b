//! What acts on particles, apart from gravity and contacts.
//!
//! Forces accelerate particles ([`Force`]): attractors, gravitation, grabs of one particle, and forces between
//! neighbours, which are those between kinds of particles and flocking. Springs are integrated in parts of a sub-step
//! ([`springs::SpringSolver`]). The thermostat and thermal walls act when particles bounce off walls, Andersen's
//! thermostat at the end of a step. Motors move immovable particles and walls, pumps particles from a drain to a
//! nozzle. A line in `influences` names each,
//! and `record` derives from its fields what snapshots, renumbering and checks need.

pub mod attractor;
pub mod chance;
pub mod flocking;
pub mod grab;
pub mod gravitation;
mod influences;
pub mod motor;
mod neighbors;
pub mod pair;
pub mod pump;
mod record;
mod sorted;
pub mod springs;
mod tables;
pub mod thermal;
pub mod thermostat;

pub use attractor::{Attractor, Law, Pole};
pub use flocking::Flocking;
pub use grab::Grab;
pub use gravitation::Gravitation;
pub use influences::{Influence, Influences, Role};
pub use motor::Motor;
pub use pair::{PairForce, PairTable};
pub use pump::Pump;
pub use record::WallIds;
pub use springs::{Spring, Springs};
pub use thermal::{Andersen, ThermalWalls, WallTemperatures};
pub use thermostat::Thermostat;

use std::cmp::Ordering;
use std::fmt::{Debug, Display};

use crate::container::Container;
use crate::particles::{FARTHEST, check_vectors};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::settings::Method;
use jostle_base::table::sparse_value;
use record::Record;

/// A force: it accelerates particles. The order of every sum depends only on the state.
pub trait Force: Debug + Record {
    /// Adds the acceleration of each body. Those between neighbours find the bodies sorted in `scratch`.
    fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        scratch: &mut Scratch,
        sums: &mut [[f32; 2]],
    ) -> Result<()>;

    /// Changes the sums of the accelerations by all forces.
    fn limit(&self, bodies: &ForceInput<'_>, sums: &mut [[f32; 2]]);

    /// Potential energy of the bodies; 0 if the force has no potential.
    fn energy(&self, bodies: &ForceInput<'_>) -> Result<f64>;

    /// The sum of the tensor products of offset and force over all pairs of bodies: the offset from one to the other,
    /// and the force on the other; 0 if the force is not one between pairs.
    fn virial(&self, _: &ForceInput<'_>) -> Result<Virial> {
        Ok(Virial::default())
    }

    /// On which particles it acts.
    fn partners(&self) -> Partners;
}

/// A sum of tensor products of offsets and forces; the first index is that of the offset.
pub type Virial = [[f64; 2]; 2];

/// The tensor product of an offset and a force.
pub(crate) fn product(offset: [f64; 2], force: [f64; 2]) -> Virial {
    offset.map(|x| force.map(|f| x * f))
}

/// The sum of two virials.
pub(crate) fn sum_of(a: Virial, b: Virial) -> Virial {
    [0, 1].map(|k| [0, 1].map(|l| a[k][l] + b[k][l]))
}

/// The sums of the columns of rows of numbers.
pub(crate) fn total_of<const N: usize>(rows: impl Iterator<Item = [f64; N]>) -> [f64; N] {
    rows.fold([0.0; N], |mut sum, row| {
        sum.iter_mut().zip(row).for_each(|(sum, own)| *sum += own);
        sum
    })
}

/// The particles on which a force acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Partners {
    /// All.
    All,
    /// The particle with this id. It stays awake, and others may sleep.
    One(Id),
    /// Those with a neighbour, if their kinds are below a number.
    Neighbors {
        /// Distance from which on there is no force.
        cutoff: f32,
        /// The number of kinds.
        kinds: usize,
    },
}

impl Partners {
    /// The distance from which on there is no force, if there is one.
    pub fn cutoff(self) -> Option<f32> {
        match self {
            Self::All | Self::One(_) => None,
            Self::Neighbors { cutoff, .. } => Some(cutoff),
        }
    }
}

/// Stands for the index of a particle that is asleep.
pub const ASLEEP: u32 = u32::MAX;

/// The particles as arguments of the forces, in any order.
#[derive(Clone, Copy, Debug)]
pub struct ForceInput<'a> {
    /// Centres.
    pub positions: &'a [[f32; 2]],
    /// Velocities.
    pub velocities: &'a [[f32; 2]],
    /// Masses.
    pub masses: &'a [f32],
    /// Radii.
    pub radii: &'a [f32],
    /// Kinds; empty if all are 0.
    pub kinds: &'a [u8],
    /// Whether forces can move each.
    pub movable: &'a [bool],
    /// The row of each.
    pub rows: &'a [u32],
    /// The rows below this are those of this process; the others are copies.
    pub own_rows: u32,
    /// `indices[row]` is the index of the particle in `row`, or [`ASLEEP`]; may be empty if no
    /// force refers to particles.
    pub indices: &'a [u32],
    /// The container; on a torus, offsets are minimum images.
    pub container: Container,
    /// Seconds for which the accelerations act.
    pub seconds: f32,
    /// How neighbours are found. The result is the same.
    pub method: Method,
    /// Number of threads.
    pub threads: Option<usize>,
    /// The AABB of the bodies of all processes, if the world is distributed.
    pub extent: Option<[[f32; 2]; 2]>,
}

impl ForceInput<'_> {
    /// The kind of a body.
    pub fn kind(&self, body: usize) -> u8 {
        sparse_value(self.kinds, body)
    }

    /// Orders bodies at the same position by everything that forces between neighbours depend on.
    fn compare(&self, a: usize, b: usize) -> Ordering {
        let numbers = |body: usize| {
            let [u, v] = self.velocities[body];
            [u, v, self.masses[body]]
        };
        let pairs = numbers(a).into_iter().zip(numbers(b));
        let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).fold(Ordering::Equal, Ordering::then);
        by_numbers.then_with(|| self.kind(a).cmp(&self.kind(b)))
    }
}

/// Scratch of [`Influences::accelerate`].
#[derive(Debug, Default)]
pub struct Scratch {
    gravitation: gravitation::Scratch,
    neighbors: neighbors::Scratch,
}

/// A number within the limits of a world; 0 for NaN.
fn bounded(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(-FARTHEST, FARTHEST) }
}

/// Refuses a point or a vector that is not finite or out of range.
pub fn check_pair(argument: &'static str, [x, y]: [f32; 2]) -> Result<()> {
    check_vectors(argument, &[[x, y]]).map_err(|_| {
        let rule = format!("both coordinates must be finite and within ±{FARTHEST:e}");
        Error::of(argument, format!("({x}, {y})"), &rule)
    })
}

/// Refuses a number that is not finite or out of range.
fn check_number(argument: &'static str, value: f32, min: f32) -> Result<()> {
    if (min..=FARTHEST).contains(&value) {
        return Ok(());
    }
    let rule = if min == 0.0 {
        format!("it must be finite and between 0 and {FARTHEST:e}")
    } else {
        format!("it must be finite and within ±{FARTHEST:e}")
    };
    Err(Error::of(argument, value, &rule))
}

/// Refuses a list with a value that is given twice.
fn check_distinct<V: Ord + Copy + Display>(argument: &'static str, all: &[V]) -> Result<()> {
    let mut sorted: Vec<(V, usize)> = all.iter().copied().zip(0..).collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|two| two[0].0 == two[1].0) {
        Some(two) => Err(Error::at(argument, two[1].1, two[1].0, "it is given twice")),
        None => Ok(()),
    }
}
