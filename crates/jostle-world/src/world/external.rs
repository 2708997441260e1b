//! Accelerations, forces and torques that callers compute themselves. They act until they are replaced. In a distributed
//! world all processes make the same calls, each for its own particles, and there are no ghosts.

use super::World;
use super::bodies::Bodies;
use super::bodies::ids::retain_unless;
use super::distribution::Distribution;
use crate::forces::Influences;
use crate::halo::Halo;
use crate::motion::exact;
use crate::particles::{Particles, check_vectors};
use crate::trajectory::vector;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory::{self, copy_option};
use jostle_base::saved;
use jostle_index::period::Period;

/// Ids, forces on them, and the points at which these act if it is not the centres.
type Given<'a> = (&'a [Id], &'a [[f32; 2]], Option<&'a [[f32; 2]]>);

/// The external accelerations, by row.
#[derive(Debug, Default)]
pub(crate) struct External {
    /// Along x, along y, and angular; None if there are none on any process.
    pub(crate) accelerations: Option<Vec<[f32; 3]>>,
    /// Whether any may be angular, on any process.
    turns: bool,
    /// Those before the attempt at a step.
    before: Option<Vec<[f32; 3]>>,
}

saved! { struct External { accelerations, turns; before } }

impl External {
    /// Whether there are any, on any process.
    pub(crate) fn act(&self) -> bool {
        self.accelerations.is_some()
    }

    /// Whether any may be angular, on any process.
    pub(crate) fn turns(&self) -> bool {
        self.act() && self.turns
    }

    /// Those of all rows; empty if there are none.
    pub(crate) fn all(&self) -> &[[f32; 3]] {
        self.accelerations.as_deref().unwrap_or_default()
    }

    /// That of a row.
    pub(crate) fn of(&self, row: u32) -> [f32; 3] {
        self.all().get(row as usize).copied().unwrap_or_default()
    }

    /// Begins an attempt at a step, which [`External::undo`] takes back.
    pub(crate) fn begin_attempt(&mut self) -> Result<()> {
        copy_option(&mut self.before, self.accelerations.as_deref())
    }

    /// Restores what there was before the attempt.
    pub(crate) fn undo(&mut self) {
        std::mem::swap(&mut self.accelerations, &mut self.before);
    }

    /// Reserves memory for `len` rows.
    pub(crate) fn reserve(&mut self, len: usize) -> Result<()> {
        self.accelerations.iter_mut().try_for_each(|all| memory::reserve_len(all, len))
    }

    /// Changes the number of rows; new ones have no acceleration.
    pub(crate) fn resize(&mut self, len: usize) {
        self.accelerations.iter_mut().for_each(|all| all.resize(len, [0.0; 3]));
    }

    /// Removes some rows.
    pub(crate) fn remove(&mut self, gone: &[bool]) {
        self.accelerations.iter_mut().for_each(|all| retain_unless(all, gone));
    }

    /// Sets that of a row, if there are any.
    pub(crate) fn set(&mut self, row: u32, acceleration: [f32; 3]) {
        if let Some(all) = &mut self.accelerations {
            all[row as usize] = acceleration;
        }
    }

    /// Removes all if they are 0 for all particles of all processes.
    pub(crate) fn end_if_zero(&mut self, halo: &dyn Halo) -> Result<()> {
        let acts = self.all().iter().any(|external| *external != [0.0; 3]);
        if self.act() && !halo.any(acts)? {
            self.accelerations = None;
        }
        Ok(())
    }

    /// Adds the external acceleration of each particle to others, which are by index.
    pub(crate) fn add_to(&self, accelerations: &mut [[f32; 2]], rows: &[u32]) {
        let Some(external) = &self.accelerations else { return };
        for (sum, &row) in accelerations.iter_mut().zip(rows) {
            let own = external[row as usize];
            *sum = [0, 1].map(|k| sum[k] + own[k]);
        }
    }

    /// Gives the smallest row of merging particles the accelerations by all forces and torques on them.
    pub(crate) fn merge(&mut self, particles: &Particles, rows: &[u32], indices: &[usize]) {
        let own = |&index: &usize| {
            ([particles.masses[index], particles.radii[index]], self.of(rows[index]))
        };
        let joint = joint_acceleration(indices.iter().map(own));
        let first = indices.iter().map(|&index| rows[index]).fold(u32::MAX, u32::min);
        self.set(first, joint);
    }

    /// The accelerations with those by some more forces, which act at the centres or at points.
    fn with_forces(
        &self,
        bodies: &Bodies,
        (halo, period): (&dyn Distribution, Period<f64>),
        (ids, newtons, points): Given<'_>,
    ) -> Result<Vec<[f32; 3]>> {
        let rows = bodies.rows_of(ids)?;
        check_vectors("forces", newtons)?;
        check_vectors("points", points.unwrap_or_default())?;
        // Sums are in float64, so that several forces on one particle are rounded once.
        let mut sums: Vec<[f64; 3]> = memory::with_capacity(bodies.len())?;
        sums.extend(self.all().iter().map(|own| own.map(f64::from)));
        sums.resize(bodies.len(), [0.0; 3]);
        let indices = bodies.indices()?;
        for (nth, (&row, force)) in rows.iter().zip(newtons).enumerate() {
            let (all, at) = bodies.disc_at(indices[row as usize] as usize);
            let sum = &mut sums[row as usize];
            let by = change_by(all, at, (*force, points.map(|points| points[nth])), &period);
            *sum = [0, 1, 2].map(|k| sum[k] + by[k]);
        }
        let sums = memory::collect(sums.into_iter().map(|sum| sum.map(|a| a as f32)))?;
        // Forces in range may add up to an acceleration out of range, for instance of a small mass.
        let is_wrong =
            |&row: &u32| check_vectors("forces", &vectors_of(sums[row as usize])).is_err();
        if let Some(index) = rows.iter().position(is_wrong) {
            let what = "acceleration";
            return Err(too_large(bodies, halo, "forces", (index, newtons), rows[index], what));
        }
        Ok(sums)
    }
}

impl World {
    /// The external accelerations in the order of adding, without angular ones; none if there are none.
    pub fn external_accelerations(&self) -> impl ExactSizeIterator<Item = [f32; 2]> {
        self.external.all().iter().map(|&[x, y, _]| [x, y])
    }

    /// All of them in the order of adding, along x, along y and angular; none if there are none.
    pub fn all_external(&self) -> &[[f32; 3]] {
        self.external.all()
    }

    /// Gives each particle an acceleration, beside those of forces and gravity, in place of the external ones
    /// before, angular ones included. Particles that are accelerated wake.
    pub fn set_accelerations(&mut self, accelerations: Vec<[f32; 2]>) -> Result<()> {
        let all = memory::collect(accelerations.into_iter().map(|[x, y]| [x, y, 0.0]));
        let all = tell_error(&*self.halo, all)?;
        self.set_all_external(all)
    }

    /// As [`World::set_accelerations`], with angular ones.
    pub fn set_all_external(&mut self, all: Vec<[f32; 3]>) -> Result<()> {
        let (found, expected) = (all.len(), self.len());
        let checked = if found == expected {
            check_external(&all)
        } else {
            Err(Error::Length { argument: "accelerations", found, expected })
        };
        tell_error(&*self.halo, checked)?;
        replace(self, all)
    }

    /// Ends all external accelerations.
    pub fn clear_accelerations(&mut self) {
        self.external.accelerations = None;
    }

    /// Adds forces on some particles to the external ones. They act at the centres, or at points: then with the torque
    /// about the present centre. Particles of radius 0 do not begin to rotate.
    pub fn add_forces(
        &mut self,
        ids: &[Id],
        newtons: &[[f32; 2]],
        points: Option<&[[f32; 2]]>,
    ) -> Result<()> {
        let rules = (&*self.halo, self.settings.container.period().exact());
        let sums = self.external.with_forces(&self.bodies, rules, (ids, newtons, points));
        let sums = tell_error(&*self.halo, sums)?;
        replace(self, sums)
    }
}

/// The error for a vector of an argument by which a particle would leave the range of numbers.
pub(crate) fn too_large(
    bodies: &Bodies,
    halo: &dyn Distribution,
    argument: &'static str,
    (index, vectors): (usize, &[[f32; 2]]),
    row: u32,
    what: &str,
) -> Error {
    let [x, y] = vectors[index];
    let id = halo.id_among_all(&bodies.ids, row);
    let rule = format!("the {what} of particle {id} would be too large");
    let value = format!("({x}, {y})");
    // In a distributed world the vectors are not the argument of the caller.
    match halo.is_whole() {
        true => Error::at(argument, index, value, &rule),
        false => Error::of(argument, value, &rule),
    }
}

/// Tells the other processes of an error, so that their next call returns one, too.
pub(crate) fn tell_error<V>(halo: &dyn Distribution, checked: Result<V>) -> Result<V> {
    if checked.is_err() {
        halo.fail();
    }
    checked
}

/// Replaces the external accelerations; nothing accelerates immovable particles. Those that are accelerated wake.
fn replace(world: &mut World, mut accelerations: Vec<[f32; 3]>) -> Result<()> {
    for (row, index) in world.bodies.rows_and_indices() {
        if world.bodies.is_immovable(index) {
            accelerations[row as usize] = [0.0; 3];
        }
    }
    let acts = (0..).zip(&accelerations).filter(|(_, external)| **external != [0.0; 3]);
    let mut rows: Vec<u32> = Vec::new();
    let listed = memory::extend(&mut rows, acts.map(|(row, _)| row));
    tell_error(&*world.halo, listed)?;
    // All ranks must make the same stages of a step, so all have external accelerations or
    // none.
    let turns = accelerations.iter().any(|&[_, _, turn]| turn != 0.0);
    let counts = world.halo().sum([!rows.is_empty(), turns].map(u64::from))?;
    let [acts, turns] = counts.map(|count| count > 0);
    if acts {
        world.halo.protocol().wake_edited(world, &mut [], &rows)?;
    }
    world.external.accelerations = acts.then_some(accelerations);
    world.external.turns = turns;
    Ok(())
}

/// Whether anything accelerates particles, apart from gravity and springs.
pub(crate) fn has_accelerations(external: &External, influences: &Influences) -> bool {
    external.act() || influences.has_forces()
}

/// The accelerations of a merged particle by the external forces and torques on its parts, from masses, radii and
/// accelerations of these. The forces act at the joint centre.
pub(crate) fn joint_acceleration(all: impl Iterator<Item = ([f32; 2], [f32; 3])>) -> [f32; 3] {
    let (mut mass, mut square, mut force, mut torque) = (0.0, 0.0, [0.0; 2], 0.0);
    for (of, external) in all {
        let ([own, radius], [x, y, turn]) = (of.map(f64::from), external.map(f64::from));
        mass += own;
        square += radius * radius;
        force = [force[0] + own * x, force[1] + own * y];
        torque += own * radius * radius * turn;
    }
    // Half of the moments of inertia cancels. The areas add up, see `merge`.
    let turn = if square > 0.0 { torque / (mass * square) } else { 0.0 };
    let [x, y] = force.map(|force| force / mass);
    [x, y, turn].map(|a| a as f32)
}

/// The changes of velocity and of angular velocity by an impulse on a particle, or the accelerations by a force. It acts
/// at the centre, or at a point outside of it.
pub(crate) fn change_by(
    all: &Particles,
    at: usize,
    (impulse, point): ([f32; 2], Option<[f32; 2]>),
    period: &Period<f64>,
) -> [f64; 3] {
    let (mass, radius) = (f64::from(all.masses[at]), f64::from(all.radii[at]));
    let [u, v] = impulse.map(f64::from);
    let mut turn = 0.0;
    if let Some(point) = point
        && radius > 0.0
    {
        let center = exact(all.positions[at], all.residuals[at]);
        let [x, y] = period.minimum_image(vector(|k| f64::from(point[k]) - center[k]));
        // The moment of inertia is m r²/2.
        turn = (x * v - y * u) / (0.5 * mass * radius * radius);
    }
    [u / mass, v / mass, turn]
}

/// Refuses accelerations that are not finite or too large.
pub(crate) fn check_external(all: &[[f32; 3]]) -> Result<()> {
    (0..).zip(all).try_for_each(|(row, &of)| {
        check_vectors("accelerations", &vectors_of(of)).map_err(|error| error.in_row(row))
    })
}

/// An external acceleration as vectors whose numbers have limits.
fn vectors_of([x, y, turn]: [f32; 3]) -> [[f32; 2]; 2] {
    [[x, y], [turn, 0.0]]
}
