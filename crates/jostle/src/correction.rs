//! Position correction: particles that overlap are moved apart, and back inside the walls. Only
//! positions change, so it adds no kinetic energy. Two particles that move share the displacement
//! equally, whatever their masses: otherwise the overlap of light particles between heavy ones
//! would decrease very slowly.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::contacts::{COLOURS, Contact, Contacts};
use crate::container::{Container, size};
use crate::motion::{Motions, Vectors, exact};
use crate::parallel;
use crate::particles::Particles;
use crate::trajectory::{Vector, vector};
use crate::walls::Around;

/// Overlap to which positions are corrected, as a share of the smaller diameter, so that resting
/// contacts persist.
const SLOP: f32 = 0.002;

/// Share of the overlap beyond [`SLOP`] that one iteration removes.
const SOFTNESS: f32 = 0.35;

/// Largest displacement of a particle in one iteration, as a share of the smaller diameter. A
/// larger one could move it to the other side of a small particle.
const MOST: f32 = 0.1;

/// Gap, as a share of the sum of radii, up to which the correction of other pairs may make two
/// particles overlap.
const NEAR: f32 = 0.02;

/// Maximum number of iterations over the near pairs.
const ITERATIONS: usize = 6;

/// Two particles are moved apart if they overlap by more than this share of the smaller diameter
/// beyond [`SLOP`].
const TOLERANCE: f32 = 0.001;

/// Pairs that are tested before the first of them is moved apart.
const TESTED_AT_ONCE: usize = 32;

/// Smaller radii, as a share of the coordinates, count as this where discs are pushed out of walls.
const WIDE: f64 = 1e-5;

/// Directions for centres that coincide: sixteen points of the unit circle, in
/// an order that separates neighbours.
const DIRECTIONS: [[f32; 2]; 16] = [
    [1.0, 0.0],
    [-0.707_106_77, 0.707_106_77],
    [0.0, -1.0],
    [0.707_106_77, 0.707_106_77],
    [-1.0, 0.0],
    [0.707_106_77, -0.707_106_77],
    [0.0, 1.0],
    [-0.707_106_77, -0.707_106_77],
    [0.923_879_5, 0.382_683_43],
    [-0.923_879_5, 0.382_683_43],
    [0.382_683_43, -0.923_879_5],
    [0.382_683_43, 0.923_879_5],
    [-0.923_879_5, -0.382_683_43],
    [0.923_879_5, -0.382_683_43],
    [-0.382_683_43, 0.923_879_5],
    [-0.382_683_43, -0.923_879_5],
];

/// Two particles that overlap, or may overlap after the correction of other pairs.
#[derive(Clone, Copy, Debug)]
struct Near {
    places: [u32; 2],
    /// From the first to the second, before the correction.
    offset: [f32; 2],
    reach: f32,
    /// The diameter of the smaller particle.
    diameter: f32,
    /// The share of each in the displacement.
    shares: [f32; 2],
}

/// Scratch.
#[derive(Debug, Default)]
pub struct Correction {
    /// Displacements by the correction; 0 before and after it.
    displacements: Vectors,
    near: Vec<Near>,
    /// Where in `near` each colour ends.
    ends: Vec<usize>,
}

impl Correction {
    /// Corrects the positions of the particles of `contacts`, and of particles that overlap the
    /// container or a wall.
    pub fn run(
        &mut self,
        contacts: &mut Contacts,
        motions: &Motions,
        particles: &Particles,
        (container, walls): (&Container, Around<'_>),
        threads: Option<usize>,
    ) {
        let radii = &particles.radii;
        let clamp = |place: u32| {
            let position = motions.position(place);
            let allowed = container.clamp(position, radii[place as usize]);
            if allowed != position {
                motions.set_position(place, allowed);
            }
        };
        if container.has_walls() {
            parallel::for_rows(threads, particles.len(), |index| {
                if particles.movable[index] {
                    clamp(index as u32);
                }
            });
        }
        if !walls.is_empty() {
            parallel::for_rows(threads, particles.len(), |index| {
                let position = motions.position(index as u32);
                if particles.movable[index] && !walls.is_far(index as u32, position, 0.0) {
                    let by = pushed_out(walls, motions, index as u32, [0.0; 2]);
                    if by != [0.0; 2] {
                        motions.displace(index as u32, by);
                    }
                }
            });
        }
        // The displacement that walls allow.
        let inside = |place: u32, by: [f32; 2]| {
            let position = motions.position(place);
            let far = (by[0] * by[0] + by[1] * by[1]).sqrt() * (1.0 + 4.0 * f32::EPSILON);
            let is_free = walls.is_empty() || walls.is_far(place, position, far);
            let by = if is_free { by } else { pushed_out(walls, motions, place, by) };
            let wanted = [0, 1].map(|k| position[k] + by[k]);
            let allowed = container.clamp(wanted, radii[place as usize]);
            let is_kept = |k: usize| allowed[k] == wanted[k];
            [0, 1].map(|k| if is_kept(k) { by[k] } else { allowed[k] - position[k] })
        };
        self.displacements.resize(particles.len());
        self.list(contacts, motions, radii);
        let mut sweeps = 0;
        while sweeps < ITERATIONS && self.separate(inside, threads) {
            sweeps += 1;
        }
        if sweeps > 0 {
            for place in self.near.iter().flat_map(|near| near.places) {
                let by = self.displacements.get(place);
                if by != [0.0; 2] {
                    motions.displace(place, by);
                    clamp(place);
                    self.displacements.set(place, [0.0; 2]);
                }
            }
        }
    }

    /// Lists the pairs to correct, colour by colour.
    fn list(&mut self, contacts: &mut Contacts, motions: &Motions, radii: &[f32]) {
        self.near.clear();
        self.ends.clear();
        for range in contacts.colours() {
            for contact in &mut contacts.list[range] {
                let Contact { places, image, reach, inverse_masses, .. } = *contact;
                let [a, b] = places.map(|place| motions.position(place));
                let [c, d] = places.map(|place| motions.residual(place));
                let offset = [0, 1].map(|k| (b[k] - a[k] + image[k]) + (d[k] - c[k]));
                let square = offset[0] * offset[0] + offset[1] * offset[1];
                contact.touched |= square < reach * reach;
                let near = (1.0 + NEAR) * reach;
                if square < near * near {
                    let [p, q] = places.map(|place| radii[place as usize]);
                    // Points have no size: that of the other particle counts.
                    let smaller = if p.min(q) > 0.0 { p.min(q) } else { p.max(q) };
                    let shares = match inverse_masses {
                        [0.0, _] => [0.0, 1.0],
                        [_, 0.0] => [1.0, 0.0],
                        _ => [0.5, 0.5],
                    };
                    let diameter = 2.0 * smaller;
                    self.near.push(Near { places, offset, reach, diameter, shares });
                }
            }
            self.ends.push(self.near.len());
        }
    }

    /// Moves those of a few pairs apart that overlap. Returns whether there are any.
    fn separate_some(&self, near: &[Near], inside: &impl Fn(u32, [f32; 2]) -> [f32; 2]) -> bool {
        let mut overlapping = [0; TESTED_AT_ONCE];
        let mut count = 0;
        for (at, near) in near.iter().enumerate() {
            // Without branches, because they would often be predicted wrongly.
            overlapping[count] = at;
            count += usize::from(near.overlaps(&self.displacements));
        }
        for &at in &overlapping[..count] {
            near[at].separate(&self.displacements, inside);
        }
        count > 0
    }

    /// Moves all overlapping pairs apart, colour after colour. Returns whether there are any.
    fn separate(
        &self,
        inside: impl Fn(u32, [f32; 2]) -> [f32; 2] + Sync + Send,
        threads: Option<usize>,
    ) -> bool {
        let any = AtomicBool::new(false);
        let mut start = 0;
        for (colour, &end) in self.ends.iter().enumerate() {
            let near = &self.near[std::mem::replace(&mut start, end)..end];
            if near.is_empty() {
                continue;
            }
            let threads = if colour == COLOURS { Some(1) } else { threads };
            parallel::for_slices(threads, near, |near| {
                let parts = near.chunks(TESTED_AT_ONCE);
                let moved = parts.map(|part| self.separate_some(part, &inside));
                any.fetch_or(moved.fold(false, |any, moves| any | moves), Ordering::Relaxed);
            });
        }
        any.into_inner()
    }
}

impl Near {
    /// The offset at present, and its square.
    #[inline(always)]
    fn offset(&self, displacements: &Vectors) -> ([f32; 2], f32) {
        let [a, b] = self.places.map(|place| displacements.get(place));
        let offset = [0, 1].map(|k| self.offset[k] + (b[k] - a[k]));
        (offset, offset[0] * offset[0] + offset[1] * offset[1])
    }

    /// Whether the two overlap too much.
    #[inline(always)]
    fn overlaps(&self, displacements: &Vectors) -> bool {
        let least = self.reach - (SLOP + TOLERANCE) * self.diameter;
        self.offset(displacements).1 < least * least
    }

    /// Moves two particles apart.
    #[inline(always)]
    fn separate(&self, displacements: &Vectors, inside: &impl Fn(u32, [f32; 2]) -> [f32; 2]) {
        let (offset, square) = self.offset(displacements);
        let length = square.sqrt();
        let normal = if length > 0.0 {
            offset.map(|v| v / length)
        } else {
            DIRECTIONS[self.places[1].abs_diff(self.places[0]) as usize % DIRECTIONS.len()]
        };
        // Of pairs in sequence, those before may have moved these two apart.
        let excess = (self.reach - SLOP * self.diameter - length).max(0.0);
        for (k, sign) in [(0, -1.0), (1, 1.0)] {
            let by = (SOFTNESS * excess * self.shares[k]).min(MOST * self.diameter);
            if by != 0.0 {
                let old = displacements.get(self.places[k]);
                let new = [0, 1].map(|axis| old[axis] + sign * by * normal[axis]);
                displacements.set(self.places[k], inside(self.places[k], new));
            }
        }
    }
}

thread_local! {
    /// Scratch of [`pushed_out`], which many threads call.
    static NEAR_WALLS: Cell<Vec<u32>> = const { Cell::new(Vec::new()) };
}

/// The displacement of a particle that is to move `by`, with the least change that lets it overlap
/// no wall. Its centre crosses none; out of a deep overlap it is moved in several sub-steps.
fn pushed_out(walls: Around<'_>, motions: &Motions, place: u32, by: [f32; 2]) -> [f32; 2] {
    let radius = f64::from(walls.particles.radii[place as usize]);
    let from = exact(motions.position(place), motions.residual(place));
    let to: Vector = [0, 1].map(|k| from[k] + f64::from(by[k]));
    // Points are moved away from walls, too.
    let most = f64::from(MOST) * 2.0 * radius.max(WIDE * size(from, 0.0));
    let area = [vector(|k| from[k].min(to[k])), vector(|k| from[k].max(to[k]))];
    let mut is_free = true;
    walls.each(place, area, 0.0, |wall| {
        let seen = |position: Vector| walls.position_from(wall, position, 0.0);
        is_free &= !walls.walls.is_near(wall, area.map(seen), radius)
            || walls.walls.is_free(wall, [from, to].map(seen), radius);
    });
    if is_free {
        return by;
    }
    let mut near = NEAR_WALLS.take();
    near.clear();
    walls.each(place, area, most, |wall| near.push(wall));
    let allowed = walls.push_out(&near, [from, to], radius, most);
    NEAR_WALLS.set(near);
    if allowed == to { by } else { [0, 1].map(|k| (allowed[k] - from[k]) as f32) }
}
