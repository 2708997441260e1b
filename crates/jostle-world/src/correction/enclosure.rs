//! The container and the walls during the correction: particles are moved back inside, and
//! displacements are limited to those that the walls allow.

use std::cell::Cell;

use super::MOST;
use crate::container::size;
use crate::motion::{Motions, exact};
use crate::particles::Particles;
use crate::trajectory::{Vector, vector};
use crate::walls::Around;
use jostle_base::parallel;
use jostle_index::pairs::Path;

/// Share of the square of a distance from walls within which rounding does not matter.
const FREE: f32 = 0.99;

/// Smaller radii, as a share of the coordinates, count as this where discs are pushed out of walls.
const WIDE: f64 = 1e-5;

/// What particles must stay inside.
#[derive(Clone, Copy)]
pub(super) struct Enclosure<'a> {
    pub motions: &'a Motions,
    pub particles: &'a Particles,
    pub walls: Around<'a>,
}

impl Enclosure<'_> {
    /// Moves a particle into the container; returns its position. The stored float32 is inside,
    /// too: where rounding to the nearest would not be, the residual has the rest. The exact
    /// position stays where it is if it is inside, so that the slowest discs arrive at the wall.
    pub fn clamp(&self, index: u32) -> [f32; 2] {
        let (position, radius) =
            (self.motions.position(index), self.particles.radii[index as usize]);
        // The test is in float32, which the caller sees. The exact position is changed only if it
        // is outside itself.
        let allowed = self.walls.container.clamp(position, radius);
        if allowed != position {
            let exact =
                self.walls.container.clamp_exactly(self.motions.exact(index), f64::from(radius));
            self.motions.place(index, exact, allowed);
        }
        allowed
    }

    /// Moves all movable particles into the container and out of the walls.
    pub fn move_all_inside(&self, threads: Option<usize>) {
        let Self { motions, particles, walls } = self;
        let container = &walls.container;
        // Nearly all particles are in it, so that they need not be moved.
        let inner = container.inner();
        let move_inside = |index: u32| {
            let (position, at) = (motions.position(index), index as usize);
            let is_inside = inner.contains(position, particles.radii[at]) || !particles.movable[at];
            if is_inside { position } else { self.clamp(index) }
        };
        if !walls.is_empty() {
            parallel::for_rows(threads, particles.len(), |at| {
                let index = at as u32;
                let path = Path { position: move_inside(index), displacement: [0.0; 2] };
                let [is_near, _] = walls.may_touch(index, &path, 0.0, None);
                if !is_near || !particles.movable[at] {
                    return;
                }
                let by = pushed_out(walls, motions, index, [0.0; 2]);
                if by != [0.0; 2] {
                    motions.displace(index, by);
                }
            });
        } else if container.has_sides() {
            parallel::for_rows(threads, particles.len(), |at| _ = move_inside(at as u32));
        }
    }

    /// The displacement that the walls allow a particle that is to move `by`.
    #[inline(always)]
    pub fn allowed(&self, index: u32, by: [f32; 2]) -> [f32; 2] {
        // By reference: a copy of the container, read at once in another width, waits for the copy to be
        // written. With copies, correction in the scene sand took a quarter longer.
        let Self { motions, particles, walls } = self;
        let container = &walls.container;
        let position = motions.position(index);
        // The reserve covers the rounding of the square, the sum and the root.
        let far = (by[0] * by[0] + by[1] * by[1]).sqrt() * (1.0 + 4.0 * f32::EPSILON);
        let is_free = walls.is_empty() || walls.is_far(index, position, far);
        let by = if is_free { by } else { pushed_out(walls, motions, index, by) };
        let wanted = [0, 1].map(|k| position[k] + by[k]);
        let allowed = container.clamp(wanted, particles.radii[index as usize]);
        let is_kept = |k: usize| allowed[k] == wanted[k];
        // Where nothing is clamped the displacement keeps its bits: sum and difference with the
        // position would round it to the spacing there.
        [0, 1].map(|k| if is_kept(k) { by[k] } else { allowed[k] - position[k] })
    }

    /// The square of a displacement that walls certainly allow: nearly that of the radius, or of the known
    /// distance from walls if it is less. 0 near the container.
    #[inline(always)]
    pub fn free_square(&self, index: u32) -> f32 {
        let Self { motions, particles, walls } = self;
        let container = &walls.container;
        let (position, radius) = (motions.position(index), particles.radii[index as usize]);
        // Larger displacements take the exact path. Slow particles are searched for walls in small
        // bounds, so that the known distance is often less than the radius, also far from walls.
        let free = if walls.is_empty() { radius } else { walls.clearance(index, position) };
        let free = free.clamp(0.0, radius);
        let is_inside =
            !container.has_sides() || container.inner().contains(position, radius + free);
        if is_inside { FREE * free * free } else { 0.0 }
    }
}

thread_local! {
    /// Scratch of [`pushed_out`], which many threads call.
    static NEAR_WALLS: Cell<Vec<(u32, Vector)>> = const { Cell::new(Vec::new()) };
}

/// The displacement of a particle that is to move `by`, with the least change that lets it overlap
/// no wall. Its centre crosses none; out of a deep overlap it is moved in several sub-steps.
fn pushed_out(walls: &Around<'_>, motions: &Motions, index: u32, by: [f32; 2]) -> [f32; 2] {
    let radius = f64::from(walls.particles.radii[index as usize]);
    let from = exact(motions.position(index), motions.residual(index));
    let to: Vector = [0, 1].map(|k| from[k] + f64::from(by[k]));
    // Points are moved away from walls, too.
    let most = f64::from(MOST) * 2.0 * radius.max(WIDE * size(from, 0.0));
    // The whole way is tested and not only its end, so that the centre does not jump over a thin
    // wall.
    let area = [vector(|k| from[k].min(to[k])), vector(|k| from[k].max(to[k]))];
    let mut is_free = true;
    walls.each(index, area, 0.0, |wall, offset| {
        let seen =
            |position: Vector| walls.position_from(wall, vector(|k| position[k] - offset[k]), 0.0);
        is_free &= !walls.walls.is_near(wall, area.map(seen), radius)
            || walls.walls.is_free(wall, [from, to].map(seen), radius)
            || !walls.is_solid_for(wall, offset, from, radius);
    });
    if is_free {
        return by;
    }
    // `take` leaves an empty list. The list is put back at the end, so each thread allocates once.
    let mut near = NEAR_WALLS.take();
    near.clear();
    // Where the particle comes from decides for the whole way.
    walls.each(index, area, most, |wall, offset| {
        if walls.is_solid_for(wall, offset, from, radius) {
            near.push((wall, offset));
        }
    });
    let allowed = walls.push_out(&near, [from, to], radius, most);
    NEAR_WALLS.set(near);
    if allowed == to { by } else { [0, 1].map(|k| (allowed[k] - from[k]) as f32) }
}
