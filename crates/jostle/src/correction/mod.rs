//! Position correction: particles that overlap are moved apart, and back inside the walls. Only
//! positions change, so it adds no kinetic energy. Two particles that move share the displacement
//! equally, whatever their masses: otherwise the overlap of light particles between heavy ones
//! would decrease very slowly.

mod pairs;

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::contacts::Contacts;
use crate::container::{Container, size};
use crate::decomposition::Halo;
use crate::error::Result;
use crate::motion::{Motions, Scalars, Vectors, exact};
use crate::pairs::Path;
use crate::parallel::{self, Member, locked};
use crate::particles::Particles;
use crate::trajectory::{Vector, vector};
use crate::walls::Around;
use pairs::{Block, Measure, Separate};

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

/// Share of the square of a distance from walls within which rounding does not matter.
const FREE: f32 = 0.99;

/// Displacements in an iteration, one for so many particles, from which on it is worth to find those
/// that are far from all walls first.
const WORTH_LISTING: usize = 16;

/// Blocks in one task of a thread.
const BLOCKS_OF_A_THREAD: usize = 64;

/// Blocks of a colour that a thread moves apart at a time, at least.
const BLOCKS: usize = 16;

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

/// Scratch.
#[derive(Debug, Default)]
pub struct Correction {
    /// Displacements by the correction; 0 before and after it.
    displacements: Vectors,
    /// The state before the correction.
    positions: Vectors,
    residuals: Vectors,
    /// Scratch: squares of displacements that walls certainly allow, one more for lanes without a pair.
    free_squares: Scalars,
    /// Whether many particles were moved in the last sub-step.
    moved_many: bool,
    /// The contacts of the step.
    blocks: Vec<Block>,
}

impl Correction {
    /// Begins a step.
    pub fn begin_step(&mut self, contacts: &Contacts, particles: &Particles) {
        let all = contacts.blocks.list.iter();
        self.blocks.clear();
        self.blocks.extend(all.map(|of| Block::new(of, &particles.radii)));
    }

    /// Notes in the contacts which of them have overlapped in the step.
    pub fn end_step(&self, contacts: &mut Contacts) {
        for (block, to) in self.blocks.iter().zip(&mut contacts.blocks.list) {
            block.store(to);
        }
    }

    /// Corrects the positions of the particles of `contacts`, and of particles that overlap the
    /// container or a wall.
    pub fn run(
        &mut self,
        contacts: &Contacts,
        motions: &Motions,
        particles: &Particles,
        (container, walls): (&Container, Around<'_>),
        (colours, halo): (usize, Option<Halo<'_>>),
        threads: Option<usize>,
    ) -> Result<()> {
        let radii = &particles.radii;
        let clamp = |place: u32| {
            let position = motions.position(place);
            let allowed = container.clamp(position, radii[place as usize]);
            if allowed != position {
                motions.set_position(place, allowed);
            }
            allowed
        };
        // Nearly all particles are in it, so that they need not be moved.
        let inner = container.inner();
        let move_inside = |index: usize| {
            let position = motions.position(index as u32);
            let is_inside = inner.contains(position, radii[index]) || !particles.movable[index];
            if is_inside { position } else { clamp(index as u32) }
        };
        if !walls.is_empty() {
            parallel::for_rows(threads, particles.len(), |index| {
                let path = Path { position: move_inside(index), displacement: [0.0; 2] };
                let [is_near, _] = walls.may_touch(index as u32, &path, 0.0, None);
                if !is_near || !particles.movable[index] {
                    return;
                }
                let by = pushed_out(walls, motions, index as u32, [0.0; 2]);
                if by != [0.0; 2] {
                    motions.displace(index as u32, by);
                }
            });
        } else if container.has_walls() {
            parallel::for_rows(threads, particles.len(), |index| _ = move_inside(index));
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
        if colours == 0 {
            return Ok(());
        }
        if let Some(halo) = halo {
            // No rank has failed.
            halo.any(false)?;
        }
        self.measure(contacts, motions, particles.len(), threads);
        self.free_squares.resize(particles.len() + 1);
        let (shared, places) = ((colours, halo), particles.len());
        let free = |place: usize| free_square(place, motions, radii, (container, walls));
        if !self.separate_all(contacts, (inside, free, places), shared, threads)? {
            return Ok(());
        }
        let displacements = &self.displacements;
        parallel::for_rows(threads, particles.len(), |place| {
            let place = place as u32;
            let by = displacements.get(place);
            if by != [0.0; 2] {
                motions.displace(place, by);
                clamp(place);
                displacements.set(place, [0.0; 2]);
            }
        });
        Ok(())
    }

    /// Finds the pairs that are near.
    fn measure(
        &mut self,
        contacts: &Contacts,
        motions: &Motions,
        places: usize,
        threads: Option<usize>,
    ) {
        let Self { displacements, positions, residuals, blocks, .. } = self;
        // One more for lanes without a pair.
        for vectors in [displacements, &mut *positions, &mut *residuals] {
            vectors.resize(places + 1);
            vectors.set(places as u32, [0.0; 2]);
        }
        let (positions, residuals) = (&*positions, &*residuals);
        parallel::for_rows(threads, places, |place| {
            let place = place as u32;
            positions.set(place, motions.position(place));
            residuals.set(place, motions.residual(place));
        });
        let of = &contacts.blocks.list;
        let threads = if of.len() <= BLOCKS_OF_A_THREAD { Some(1) } else { threads };
        let parts = blocks.chunks_mut(BLOCKS_OF_A_THREAD).zip(of.chunks(BLOCKS_OF_A_THREAD));
        parallel::for_each(threads, parts, |(blocks, of)| {
            Measure { of, blocks, positions, residuals }.run();
        });
    }

    /// Moves all overlapping pairs apart, in iterations. Returns whether there were any.
    fn separate_all(
        &mut self,
        contacts: &Contacts,
        (inside, free, places): (
            impl Fn(u32, [f32; 2]) -> [f32; 2] + Sync + Send,
            impl Fn(usize) -> f32 + Sync + Send,
            usize,
        ),
        (colours, halo): (usize, Option<Halo<'_>>),
        threads: Option<usize>,
    ) -> Result<bool> {
        let many = places / WORTH_LISTING;
        let moved: [AtomicUsize; ITERATIONS] = Default::default();
        let count_of = |iteration: usize| moved[iteration].load(Ordering::Relaxed);
        let Self { displacements, free_squares, blocks, moved_many, .. } = &*self;
        let stages = Stages { contacts, blocks, displacements, inside: &inside, colours, halo };
        let failed = Mutex::new(Ok(()));
        let run = |member: &Member<'_>| -> Result<()> {
            let mut knows_free = false;
            for (iteration, count) in moved.iter().enumerate() {
                let is_worth = if iteration == 0 { *moved_many } else { count_of(0) >= many };
                if is_worth && !knows_free {
                    for place in member.share(places) {
                        free_squares.set(place as u32, free(place));
                    }
                    member.wait();
                    knows_free = true;
                }
                stages.separate(knows_free.then_some(free_squares), count, member)?;
                let any = count_of(iteration) > 0;
                if !halo.map_or(Ok(any), |halo| halo.any(any))? {
                    break;
                }
            }
            Ok(())
        };
        // Other ranks are waited for after each colour, by one thread.
        let threads = if halo.is_some() { Some(1) } else { threads };
        let lengths = contacts.blocks.colours.iter().map(|colour| colour.all().len());
        let most = lengths.max().unwrap_or(0).div_ceil(BLOCKS);
        parallel::together(threads, most.max(1), |member| {
            if let Err(error) = run(member) {
                *locked(&failed) = Err(error);
            }
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner)?;
        self.moved_many = count_of(0) >= many;
        Ok(count_of(0) > 0 || halo.is_some())
    }
}

/// What the iterations have in common.
struct Stages<'a, I> {
    contacts: &'a Contacts,
    blocks: &'a [Block],
    displacements: &'a Vectors,
    /// The displacement of a particle that the walls allow.
    inside: &'a I,
    colours: usize,
    halo: Option<Halo<'a>>,
}

impl<I: Fn(u32, [f32; 2]) -> [f32; 2] + Sync> Stages<'_, I> {
    /// Moves overlapping pairs apart once, colour after colour, and counts them. All threads call it
    /// and wait for each other after each colour.
    fn separate(
        &self,
        free_squares: Option<&Scalars>,
        count: &AtomicUsize,
        member: &Member<'_>,
    ) -> Result<()> {
        let Self { contacts, displacements, inside, .. } = *self;
        for number in 0..self.colours {
            // Another rank may have more colours.
            if let Some(colour) = contacts.blocks.colours.get(number) {
                let blocks = &self.blocks[colour.all()];
                let parts = member.share(blocks.len().div_ceil(BLOCKS));
                let own = match colour.is_serial {
                    true if member.is_first() => 0..blocks.len(),
                    true => 0..0,
                    false => parts.start * BLOCKS..blocks.len().min(parts.end * BLOCKS),
                };
                let blocks = &blocks[own];
                let moved = Separate { blocks, displacements, free_squares, inside }.run();
                count.fetch_add(moved, Ordering::Relaxed);
            }
            member.wait();
            // Ghosts get the displacements that their own ranks have computed.
            if let Some(halo) = self.halo {
                halo.refresh(|at| displacements.get(at), |at, by| displacements.set(at, by))?;
            }
        }
        Ok(())
    }
}

/// The square of a displacement that walls certainly allow: nearly that of the radius, if the particle
/// is farther away from all walls. Nearly all are.
#[inline(always)]
fn free_square(
    place: usize,
    motions: &Motions,
    radii: &[f32],
    (container, walls): (&Container, Around<'_>),
) -> f32 {
    let (position, radius) = (motions.position(place as u32), radii[place]);
    let is_free = (walls.is_empty() || walls.is_far(place as u32, position, radius))
        && (!container.has_walls() || container.inner().contains(position, 2.0 * radius));
    if is_free { FREE * radius * radius } else { 0.0 }
}

thread_local! {
    /// Scratch of [`pushed_out`], which many threads call.
    static NEAR_WALLS: Cell<Vec<(u32, Vector)>> = const { Cell::new(Vec::new()) };
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
    walls.each(place, area, 0.0, |wall, offset| {
        let seen =
            |position: Vector| walls.position_from(wall, vector(|k| position[k] - offset[k]), 0.0);
        is_free &= !walls.walls.is_near(wall, area.map(seen), radius)
            || walls.walls.is_free(wall, [from, to].map(seen), radius);
    });
    if is_free {
        return by;
    }
    let mut near = NEAR_WALLS.take();
    near.clear();
    walls.each(place, area, most, |wall, offset| near.push((wall, offset)));
    let allowed = walls.push_out(&near, [from, to], radius, most);
    NEAR_WALLS.set(near);
    if allowed == to { by } else { [0, 1].map(|k| (allowed[k] - from[k]) as f32) }
}
