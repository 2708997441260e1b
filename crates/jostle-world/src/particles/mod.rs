//! The particles of a world as columns: `fields` has the columns of callers, `limits` checks their values,
//! `changes` writes new ones.

mod changes;
mod fields;
mod limits;

use std::f64::consts::{PI, TAU};

use crate::surface::mean32;
pub use changes::Effect;
pub use fields::{Changes, Field, FieldVisitor, FieldVisitorMut};
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::table::{Table, check_lengths, sparse_value};
use jostle_base::{plain, table};
use jostle_index::shapes::Filter;
pub use limits::{
    FARTHEST, MASS_RANGE, MAX_KINDS, check_angles, check_angular_velocities, check_friction,
    check_kinds, check_kinds_of_table, check_masses, check_radii, check_restitution, check_vectors,
};

/// Friction and rotation of a disc. Its moment of inertia is m r²/2; one of radius 0 does not turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spin {
    /// Coefficient of friction, at least 0; a pair has the geometric mean of its two.
    pub friction: f32,
    /// Angular velocity in radians per second, positive from +x to +y.
    pub velocity: f32,
    /// Angle in radians, see [`wrap_angle`].
    pub angle: f64,
}

impl Spin {
    /// The angle in float32, −π to π without π.
    pub fn rounded_angle(&self) -> f32 {
        // Rounded to float32 an angle below π may be π.
        let (angle, last) = (self.angle as f32, std::f32::consts::PI);
        if angle >= last { -last } else { angle }
    }

    /// With an angle in its range, and without velocity if the radius is 0.
    fn of_disc(self, radius: f32) -> Self {
        let velocity = if radius == 0.0 { 0.0 } else { self.velocity };
        Self { velocity, angle: wrap_angle(self.angle), ..self }
    }
}

plain! { Spin { friction, velocity, angle } }

table! {
    /// Discs with a velocity and a mass, one row each.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct Particles {
        /// Centres.
        pub positions: dense [f32; 2],
        /// What rounding to float32 removed from the centres; the next step adds it to them.
        pub residuals: dense [f32; 2],
        /// In world units per second. Nothing changes those of immovable particles: a particle is kinematic
        /// if it has one or turns, else static.
        pub velocities: dense [f32; 2],
        /// Radii, at least 0.
        pub radii: uniform f32,
        /// Masses, more than 0.
        pub masses: uniform f32,
        /// Coefficients of restitution, 0 to 1; a pair has the geometric mean of its two.
        pub restitution: uniform f32,
        /// Whether contacts and forces can change the velocity of the particle.
        pub movable: dense bool,
        /// Friction and rotation; empty if no disc has friction or an angle, or turns.
        pub spins: sparse Spin,
        /// Categories and masks; empty if all have the default.
        pub filters: sparse Filter,
        /// Whether the particle is a sensor: it touches others, and neither pushes them nor is pushed.
        /// Empty if none is.
        pub sensors: sparse bool,
        /// The kind of the particle, a number below [`MAX_KINDS`]: its row and column in the tables of forces
        /// between kinds. Empty if all are 0.
        pub kinds: sparse u8,
    }
}

impl Particles {
    /// Particles with the article's masses (density × radius²), elastic and movable. Panics without memory.
    pub fn new(
        positions: Vec<[f32; 2]>,
        velocities: Vec<[f32; 2]>,
        radii: Vec<f32>,
        density: f32,
    ) -> Self {
        Self::try_new(positions, velocities, radii, density).expect("there is memory")
    }

    /// As [`Particles::new`]; an error if there is no memory.
    pub fn try_new(
        positions: Vec<[f32; 2]>,
        velocities: Vec<[f32; 2]>,
        radii: Vec<f32>,
        density: f32,
    ) -> Result<Self> {
        let len = positions.len();
        // Without π, as in the article; only ratios of masses matter.
        let masses = memory::collect(radii.iter().map(|r| density * r * r))?;
        let (restitution, movable) = (memory::filled(len, 1.0)?, memory::filled(len, true)?);
        let residuals = memory::filled(len, [0.0; 2])?;
        let others = Self::default();
        Ok(Self { positions, residuals, velocities, radii, masses, restitution, movable, ..others })
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Refuses columns of different lengths and values out of range.
    pub fn validate(&self) -> Result<()> {
        check_lengths(self, self.len(), Self::field_in)?;
        self.check_values()
    }

    /// Friction and rotation of a disc.
    pub fn spin(&self, row: usize) -> Spin {
        sparse_value(&self.spins, row)
    }

    /// Sets the angular velocity of a disc; points do not turn.
    pub fn set_angular_velocity(&mut self, row: usize, velocity: f32) {
        // A point has no moment of inertia, and friction could give it any angular velocity.
        let velocity = if self.radii[row] == 0.0 { 0.0 } else { velocity };
        if self.spin(row).velocity != velocity {
            self.spins_mut()[row].velocity = velocity;
        }
    }

    /// Category and mask of a disc.
    pub fn filter(&self, row: usize) -> Filter {
        sparse_value(&self.filters, row)
    }

    /// Whether a disc is a sensor.
    #[inline(always)]
    pub fn is_sensor(&self, row: usize) -> bool {
        self.sensors.get(row).is_some_and(|&is_sensor| is_sensor)
    }

    /// The kind of a disc.
    pub fn kind(&self, row: usize) -> u8 {
        sparse_value(&self.kinds, row)
    }

    /// Whether any disc has friction.
    pub fn has_friction(&self) -> bool {
        self.spins.iter().any(|spin| spin.friction > 0.0)
    }

    /// Whether two discs that overlap touch: one of them must be movable, or just one a sensor.
    #[inline(always)]
    pub fn may_touch(&self, a: usize, b: usize) -> bool {
        // Two immovable particles cannot push each other, but a sensor among them still detects the
        // other.
        self.movable[a] || self.movable[b] || self.is_sensor(a) != self.is_sensor(b)
    }

    /// Coefficient of friction of two discs.
    #[inline(always)]
    pub fn pair_friction(&self, a: usize, b: usize) -> f32 {
        if self.spins.is_empty() {
            return 0.0;
        }
        mean32(self.spins[a].friction, self.spins[b].friction)
    }

    /// Coefficient of restitution of two discs.
    #[inline(always)]
    pub fn pair_restitution(&self, a: usize, b: usize) -> f32 {
        mean32(self.restitution[a], self.restitution[b])
    }

    /// As [`Particles::spins_mut`]; an error if there is no memory.
    pub fn try_spins_mut(&mut self) -> Result<&mut [Spin]> {
        memory::reserve_len(&mut self.spins, self.positions.len())?;
        Ok(self.spins_mut())
    }

    /// Friction and rotation of all discs, to be changed.
    pub fn spins_mut(&mut self) -> &mut [Spin] {
        self.spins.resize(self.positions.len(), Spin::default());
        &mut self.spins
    }

    /// Categories and masks of all discs, to be changed.
    pub fn filters_mut(&mut self) -> &mut [Filter] {
        self.filters.resize(self.positions.len(), Filter::default());
        &mut self.filters
    }

    /// Which discs are sensors, to be changed.
    pub fn sensors_mut(&mut self) -> &mut [bool] {
        self.sensors.resize(self.positions.len(), false);
        &mut self.sensors
    }

    /// Sets the angular velocities of points to 0. Removes the column of friction and rotation if
    /// all is 0, that of categories and masks if all have the default, and that of sensors if there
    /// are none.
    pub fn simplify(&mut self) {
        // A step tests whether columns are empty, and leaves out what these need.
        for (spin, &radius) in self.spins.iter_mut().zip(&self.radii) {
            *spin = spin.of_disc(radius);
        }
        self.drop_defaults();
    }

    /// Replaces the contents by the rows `order` of `source`, in that order.
    pub fn gather(&mut self, source: &Self, order: &[u32], threads: Option<usize>) {
        Table::gather(self, source, order, threads);
    }

    /// Appends the row `from` of `source`.
    pub fn push(&mut self, source: &Self, from: usize) {
        let len = self.len() + 1;
        self.resize(len);
        self.put(len, len - 1, source, from);
    }

    /// Keeps the rows for which `keep` returns true.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let keep: Vec<bool> = (0..self.len()).map(keep).collect();
        self.keep(&keep);
    }

    /// As [`Particles::extend`]; an error if there is no memory.
    pub fn try_extend(&mut self, other: &Self) -> Result<()> {
        self.reserve(other, self.len() + other.len())?;
        self.extend(other);
        Ok(())
    }

    /// Appends the rows of `other`.
    pub fn extend(&mut self, other: &Self) {
        self.append(self.len(), other, other.len());
    }

    /// Whether nothing can move the particle, and it does not move or turn by itself.
    #[inline]
    pub fn is_static(&self, row: usize) -> bool {
        !self.movable[row] && self.velocities[row] == [0.0; 2] && self.spin(row).velocity == 0.0
    }

    /// One over the mass; 0 for an immovable particle.
    #[inline]
    pub fn inverse_mass(&self, row: usize) -> f32 {
        if self.movable[row] { 1.0 / self.masses[row] } else { 0.0 }
    }
}

/// An angle plus full turns, so that it lies between −π, which is allowed, and π, which is not.
pub fn wrap_angle(angle: f64) -> f64 {
    // The remainder is exact.
    let rest = angle % TAU;
    if rest >= PI {
        rest - TAU
    } else if rest < -PI {
        rest + TAU
    } else {
        rest
    }
}
