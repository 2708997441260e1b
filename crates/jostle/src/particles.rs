//! The particles of a world as columns, and their limits.

use std::f64::consts::{PI, TAU};

use crate::error::{Error, Result};
use crate::parallel;
use crate::shapes::{self, Filter, check_finite};

/// Largest coordinate, component of a velocity, and displacement of a step.
pub const FARTHEST: f32 = 1e18;

/// Range of masses, so that they and their inverses are far from the limits of float32.
pub const MASS_RANGE: [f32; 2] = [1e-30, 1e30];

/// Friction and rotation of a disc. Its moment of inertia is m r²/2; one of radius 0 does not turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spin {
    /// Coefficient of friction, at least 0; a pair has the square root of the product of its two.
    pub friction: f32,
    /// Angular velocity in radians per second, positive from +x to +y.
    pub velocity: f32,
    /// Angle in radians, see [`wrap_angle`].
    pub angle: f64,
}

/// Discs with a velocity and a mass, one row each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// Centres.
    pub positions: Vec<[f32; 2]>,
    /// What rounding to float32 removed from the centres; the next step adds it to them.
    pub residuals: Vec<[f32; 2]>,
    /// In world units per second. Nothing changes those of immovable particles: a particle is kinematic if
    /// it has one or turns, else static.
    pub velocities: Vec<[f32; 2]>,
    /// Radii, at least 0.
    pub radii: Vec<f32>,
    /// Masses, more than 0.
    pub masses: Vec<f32>,
    /// Coefficients of restitution, 0 to 1; a pair has the product of its two.
    pub restitutions: Vec<f32>,
    /// Whether contacts and forces can change the velocity of the particle.
    pub movable: Vec<bool>,
    /// Friction and rotation; empty if no disc has friction or an angle, or turns.
    pub spins: Vec<Spin>,
    /// Categories and masks; empty if all have the default.
    pub filters: Vec<Filter>,
    /// Whether the particle is a sensor: it touches others, and neither pushes them nor is pushed.
    /// Empty if none is.
    pub sensors: Vec<bool>,
}

impl Particles {
    /// Particles with the article's masses (density × radius²), elastic and movable.
    pub fn new(
        positions: Vec<[f32; 2]>,
        velocities: Vec<[f32; 2]>,
        radii: Vec<f32>,
        density: f32,
    ) -> Self {
        let len = positions.len();
        let masses = radii.iter().map(|r| density * r * r).collect();
        let (residuals, restitutions) = (vec![[0.0; 2]; len], vec![1.0; len]);
        let movable = vec![true; len];
        let base = Self { positions, residuals, velocities, radii, masses, ..Self::default() };
        Self { restitutions, movable, ..base }
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
        let expected = self.len();
        let lengths = [
            ("residuals", self.residuals.len()),
            ("velocities", self.velocities.len()),
            ("radii", self.radii.len()),
            ("masses", self.masses.len()),
            ("restitutions", self.restitutions.len()),
            ("movable", self.movable.len()),
        ];
        let spins = (!self.spins.is_empty()).then_some(("friction", self.spins.len()));
        let filters = (!self.filters.is_empty()).then_some(("categories", self.filters.len()));
        let sensors = (!self.sensors.is_empty()).then_some(("sensors", self.sensors.len()));
        for (argument, found) in lengths.into_iter().chain(spins).chain(filters).chain(sensors) {
            if found != expected {
                return Err(Error::Length { argument, found, expected });
            }
        }
        check_vectors("positions", &self.positions)?;
        check_vectors("residuals", &self.residuals)?;
        check_vectors("velocities", &self.velocities)?;
        check_radii(&self.radii)?;
        check_masses(&self.masses)?;
        check_restitutions(&self.restitutions)?;
        check_spins(&self.spins)
    }

    /// Friction and rotation of a disc.
    pub fn spin(&self, row: usize) -> Spin {
        self.spins.get(row).copied().unwrap_or_default()
    }

    /// Sets the angular velocity of a disc; points do not turn.
    pub fn set_angular_velocity(&mut self, row: usize, velocity: f32) {
        let velocity = if self.radii[row] == 0.0 { 0.0 } else { velocity };
        if self.spin(row).velocity != velocity {
            self.spins_mut()[row].velocity = velocity;
        }
    }

    /// Category and mask of a disc.
    pub fn filter(&self, row: usize) -> Filter {
        self.filters.get(row).copied().unwrap_or_default()
    }

    /// Whether a disc is a sensor.
    #[inline(always)]
    pub fn is_sensor(&self, row: usize) -> bool {
        self.sensors.get(row).is_some_and(|&is_sensor| is_sensor)
    }

    /// Whether two discs that overlap touch: one of them must be movable, or just one a sensor.
    #[inline(always)]
    pub fn may_touch(&self, a: usize, b: usize) -> bool {
        self.movable[a] || self.movable[b] || self.is_sensor(a) != self.is_sensor(b)
    }

    /// Coefficient of friction of two discs.
    #[inline(always)]
    pub fn pair_friction(&self, a: usize, b: usize) -> f32 {
        if self.spins.is_empty() {
            return 0.0;
        }
        let [a, b] = [a, b].map(|row| f64::from(self.spins[row].friction));
        (a * b).sqrt() as f32
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
        for (spin, &radius) in self.spins.iter_mut().zip(&self.radii) {
            spin.angle = wrap_angle(spin.angle);
            if radius == 0.0 {
                spin.velocity = 0.0;
            }
        }
        if self.spins.iter().all(|spin| *spin == Spin::default()) {
            self.spins.clear();
        }
        if self.filters.iter().all(|filter| *filter == Filter::default()) {
            self.filters.clear();
        }
        if !self.sensors.contains(&true) {
            self.sensors.clear();
        }
    }

    /// Appends the rows of `other`.
    pub fn extend(&mut self, other: &Self) {
        if !self.spins.is_empty() || !other.spins.is_empty() {
            self.spins_mut();
            self.spins.extend((0..other.len()).map(|row| other.spin(row)));
        }
        if !self.filters.is_empty() || !other.filters.is_empty() {
            self.filters_mut();
            self.filters.extend((0..other.len()).map(|row| other.filter(row)));
        }
        if !self.sensors.is_empty() || !other.sensors.is_empty() {
            self.sensors_mut();
            self.sensors.extend((0..other.len()).map(|row| other.is_sensor(row)));
        }
        self.positions.extend_from_slice(&other.positions);
        self.residuals.extend_from_slice(&other.residuals);
        self.velocities.extend_from_slice(&other.velocities);
        self.radii.extend_from_slice(&other.radii);
        self.masses.extend_from_slice(&other.masses);
        self.restitutions.extend_from_slice(&other.restitutions);
        self.movable.extend_from_slice(&other.movable);
    }

    /// Appends the row `from` of `source`.
    pub fn push(&mut self, source: &Self, from: usize) {
        if !self.spins.is_empty() || !source.spins.is_empty() {
            self.spins_mut();
            self.spins.push(source.spin(from));
        }
        if !self.filters.is_empty() || !source.filters.is_empty() {
            self.filters_mut();
            self.filters.push(source.filter(from));
        }
        if !self.sensors.is_empty() || !source.sensors.is_empty() {
            self.sensors_mut();
            self.sensors.push(source.is_sensor(from));
        }
        self.positions.push(source.positions[from]);
        self.residuals.push(source.residuals[from]);
        self.velocities.push(source.velocities[from]);
        self.radii.push(source.radii[from]);
        self.masses.push(source.masses[from]);
        self.restitutions.push(source.restitutions[from]);
        self.movable.push(source.movable[from]);
    }

    /// Replaces the contents by the rows `order` of `source`, in that order.
    pub fn gather(&mut self, source: &Self, order: &[u32], threads: Option<usize>) {
        parallel::gather(threads, &mut self.positions, &source.positions, order);
        parallel::gather(threads, &mut self.residuals, &source.residuals, order);
        parallel::gather(threads, &mut self.velocities, &source.velocities, order);
        parallel::gather(threads, &mut self.radii, &source.radii, order);
        parallel::gather(threads, &mut self.masses, &source.masses, order);
        parallel::gather(threads, &mut self.restitutions, &source.restitutions, order);
        parallel::gather(threads, &mut self.movable, &source.movable, order);
        if source.spins.is_empty() {
            self.spins.clear();
        } else {
            parallel::gather(threads, &mut self.spins, &source.spins, order);
        }
        if source.filters.is_empty() {
            self.filters.clear();
        } else {
            parallel::gather(threads, &mut self.filters, &source.filters, order);
        }
        if source.sensors.is_empty() {
            self.sensors.clear();
        } else {
            parallel::gather(threads, &mut self.sensors, &source.sensors, order);
        }
    }

    /// Writes the row `from` of `source` over `row`.
    pub fn put(&mut self, row: usize, source: &Self, from: usize) {
        self.positions[row] = source.positions[from];
        self.residuals[row] = source.residuals[from];
        self.velocities[row] = source.velocities[from];
        self.radii[row] = source.radii[from];
        self.masses[row] = source.masses[from];
        self.restitutions[row] = source.restitutions[from];
        self.movable[row] = source.movable[from];
        if !self.spins.is_empty() {
            self.spins[row] = source.spin(from);
        }
        if !self.filters.is_empty() {
            self.filters[row] = source.filter(from);
        }
        if !self.sensors.is_empty() {
            self.sensors[row] = source.is_sensor(from);
        }
    }

    /// Keeps the rows for which `keep` returns true.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        fn filter<V>(column: &mut Vec<V>, keep: &impl Fn(usize) -> bool) {
            let mut row = 0;
            column.retain(|_| {
                row += 1;
                keep(row - 1)
            });
        }
        filter(&mut self.positions, &keep);
        filter(&mut self.residuals, &keep);
        filter(&mut self.velocities, &keep);
        filter(&mut self.radii, &keep);
        filter(&mut self.masses, &keep);
        filter(&mut self.restitutions, &keep);
        filter(&mut self.movable, &keep);
        filter(&mut self.spins, &keep);
        filter(&mut self.filters, &keep);
        filter(&mut self.sensors, &keep);
    }

    /// Whether a row has the same values in `other`.
    pub fn is_same(&self, row: usize, other: &Self) -> bool {
        self.velocities[row] == other.velocities[row]
            && self.spin(row).velocity == other.spin(row).velocity
            && self.is_same_at_rest(row, other)
    }

    /// Whether a row has the same values in `other` apart from the velocities.
    pub fn is_same_at_rest(&self, row: usize, other: &Self) -> bool {
        let vectors = |all: &Self| [all.positions[row], all.residuals[row]];
        let numbers = |all: &Self| [all.radii[row], all.masses[row], all.restitutions[row]];
        let spin = |all: &Self| Spin { velocity: 0.0, ..all.spin(row) };
        vectors(self) == vectors(other)
            && numbers(self) == numbers(other)
            && self.movable[row] == other.movable[row]
            && spin(self) == spin(other)
            && self.filter(row) == other.filter(row)
            && self.is_sensor(row) == other.is_sensor(row)
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

/// Refuses positions or velocities that are not finite or too large.
pub fn check_vectors(argument: &'static str, vectors: &[[f32; 2]]) -> Result<()> {
    for (index, &[x, y]) in vectors.iter().enumerate() {
        check_finite(argument, &[[x, y]]).map_err(|_| {
            Error::at(argument, index, format!("({x}, {y})"), "both coordinates must be finite")
        })?;
        if x.abs() > FARTHEST || y.abs() > FARTHEST {
            let rule = format!("both coordinates must lie within ±{FARTHEST:e}");
            return Err(Error::at(argument, index, format!("({x:e}, {y:e})"), &rule));
        }
    }
    Ok(())
}

/// Refuses invalid radii.
pub fn check_radii(radii: &[f32]) -> Result<()> {
    shapes::check_radii("radii", radii)
}

/// Refuses masses outside [`MASS_RANGE`].
pub fn check_masses(masses: &[f32]) -> Result<()> {
    let [least, most] = MASS_RANGE;
    match masses.iter().position(|m| !(least..=most).contains(m)) {
        Some(index) => {
            let rule = format!("a mass must lie between {least:e} and {most:e}");
            Err(Error::at("masses", index, masses[index], &rule))
        }
        None => Ok(()),
    }
}

/// Refuses restitutions outside 0 to 1.
pub fn check_restitutions(restitutions: &[f32]) -> Result<()> {
    match restitutions.iter().position(|e| !(0.0..=1.0).contains(e)) {
        Some(index) => {
            let rule = "a restitution must lie between 0 and 1";
            Err(Error::at("restitutions", index, restitutions[index], rule))
        }
        None => Ok(()),
    }
}

/// Refuses coefficients of friction that are not finite or below 0.
pub fn check_friction(friction: &[f32]) -> Result<()> {
    match friction.iter().position(|&friction| !(friction >= 0.0 && friction.is_finite())) {
        Some(index) => {
            let rule = "a coefficient of friction must be finite and at least 0";
            Err(Error::at("friction", index, friction[index], rule))
        }
        None => Ok(()),
    }
}

/// Refuses angular velocities that are not finite or too large.
pub fn check_angular_velocities(velocities: &[f32]) -> Result<()> {
    let is_allowed = |velocity: &f32| velocity.abs() <= FARTHEST;
    match velocities.iter().position(|velocity| !is_allowed(velocity)) {
        Some(index) => {
            let rule = format!("an angular velocity must be finite and lie within ±{FARTHEST:e}");
            Err(Error::at("angular_velocities", index, velocities[index], &rule))
        }
        None => Ok(()),
    }
}

/// Refuses angles that are not finite.
pub fn check_angles(angles: &[f32]) -> Result<()> {
    match angles.iter().position(|angle| !angle.is_finite()) {
        Some(index) => Err(Error::at("angles", index, angles[index], "an angle must be finite")),
        None => Ok(()),
    }
}

fn check_spins(spins: &[Spin]) -> Result<()> {
    let column = |of: fn(&Spin) -> f32| spins.iter().map(of).collect::<Vec<f32>>();
    check_friction(&column(|spin| spin.friction))?;
    check_angular_velocities(&column(|spin| spin.velocity))?;
    check_angles(&column(|spin| spin.angle as f32))
}

/// The same angle between −π, which is allowed, and π, which is not.
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
