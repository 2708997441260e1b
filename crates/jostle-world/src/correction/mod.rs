//! Position correction: particles that overlap are moved apart, and back inside the walls. Only
//! positions change, so it adds no kinetic energy. Two particles that move share the displacement
//! equally, whatever their masses: otherwise the overlap of light particles between heavy ones
//! would decrease very slowly.

mod enclosure;
mod pairs;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::contacts::{Block, Blocks, Colour, Contacts};
use crate::halo::Halo;
use crate::motion::{Motions, Scalars, Vectors};
use crate::particles::Particles;
use crate::walls::Around;
use enclosure::Enclosure;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::parallel::{self, Member, locked};
use pairs::{Measure, Separate};

/// Overlap to which positions are corrected, as a share of the smaller diameter, so that resting
/// contacts persist. A larger one lets piles overlap more, a smaller one lets contacts come apart
/// by rounding.
const SLOP: f32 = 0.002;

/// Share of the overlap beyond [`SLOP`] that one iteration removes. A larger share moves particles
/// with many contacts too far: with 70 % in four iterations, piles with masses 100:1 overlap by 6.2
/// instead of 1.7 % (`docs/benchmarks-notes.md`).
const SOFTNESS: f32 = 0.35;

/// Largest displacement of a particle in one iteration, as a share of the smaller diameter. A
/// larger one could move it to the other side of a small particle.
const MOST: f32 = 0.1;

/// Gap, as a share of the sum of radii, up to which the correction of other pairs may make two
/// particles overlap. A larger gap keeps more pairs in all iterations, a smaller one misses pairs
/// that are pushed together.
const NEAR: f32 = 0.02;

/// Maximum number of iterations over the near pairs. With 4, a pile of 4,000 discs overlaps by 1.5
/// instead of 0.66 %, in the same time (`docs/benchmarks-notes.md`).
const ITERATIONS: usize = 6;

/// Two particles are moved apart if they overlap by more than this share of the smaller diameter
/// beyond [`SLOP`].
const TOLERANCE: f32 = 0.0004;

/// Overlap, as a share of the smaller diameter, from which on two particles are moved apart.
pub const OVERLAP: f32 = SLOP + TOLERANCE;

/// Displacements in an iteration, one for so many particles, from which on it is worth to find those
/// that are far from all walls first.
const WORTH_LISTING: usize = 16;

/// Blocks in one task of a thread.
const BLOCKS_OF_A_THREAD: usize = 64;

/// Blocks of a colour that a thread moves apart at a time, at least.
const BLOCKS: usize = 16;

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
    /// Scratch: squares of displacements that walls certainly allow, one more for lanes without a pair.
    free_squares: Scalars,
    /// Whether many particles were moved in the last sub-step.
    moved_many: bool,
    /// For each colour, whether any pairs are near, on any process.
    near: Vec<u8>,
}

impl Correction {
    /// Corrects the positions of the particles of `contacts`, and of particles that overlap the
    /// container or a wall.
    pub fn run(
        &mut self,
        contacts: &mut Contacts,
        motions: &Motions,
        particles: &Particles,
        walls: Around<'_>,
        (colours, halo): (usize, &dyn Halo),
        threads: Option<usize>,
    ) -> Result<()> {
        // Velocities are not touched. If overlap were removed by velocities, each correction would
        // add kinetic energy.
        let enclosure = Enclosure { motions, particles, walls };
        enclosure.move_all_inside(threads);
        if colours == 0 {
            return Ok(());
        }
        let pairs = &mut contacts.blocks;
        // Offsets are measured once, from exact positions. The iterations add only differences of
        // displacements to them, which are small and exact enough in float32.
        measure(&mut pairs.list, motions, &particles.radii, threads);
        // Displacements are 0 between calls, so nothing is cleared here: in a pile at rest nearly
        // all stay 0.
        self.displacements.resize_with_spare(particles.len())?;
        self.free_squares.resize(particles.len() + 1)?;
        self.list_near_colours(pairs)?;
        halo.any_bits(&mut self.near)?;
        if self.near.iter().all(|&is_near| is_near == 0) {
            self.moved_many = false;
            return Ok(());
        }
        if !self.separate_all(pairs, &enclosure, (colours, halo), threads)? {
            return Ok(());
        }
        let displacements = &self.displacements;
        parallel::for_rows(threads, particles.len(), |index| {
            let index = index as u32;
            let by = displacements.get(index);
            if by != [0.0; 2] {
                motions.displace(index, by);
                enclosure.clamp(index);
                displacements.set(index, [0.0; 2]);
            }
        });
        Ok(())
    }

    /// Finds for each colour whether any pairs are near.
    fn list_near_colours(&mut self, pairs: &Blocks) -> Result<()> {
        let is_near = |colour: &Colour| pairs.list[colour.all()].iter().any(|of| of.near != 0);
        self.near.clear();
        memory::extend(&mut self.near, pairs.colours.iter().map(|of| u8::from(is_near(of))))
    }

    /// Moves all overlapping pairs apart, in iterations. Returns whether there were any.
    fn separate_all(
        &mut self,
        pairs: &Blocks,
        enclosure: &Enclosure<'_>,
        (colours, halo): (usize, &dyn Halo),
        threads: Option<usize>,
    ) -> Result<bool> {
        let len = enclosure.particles.len();
        // To know which particles are far from walls costs a pass over all of them. It pays only if
        // many are moved; the last sub-step tells what to expect.
        let many = len / WORTH_LISTING;
        let moved: [AtomicUsize; ITERATIONS] = Default::default();
        // Relaxed: threads wait for each other after each colour, and that orders the additions
        // before this load. All threads read the same number, so they end in the same iteration.
        let count_of = |iteration: usize| moved[iteration].load(Ordering::Relaxed);
        let Self { displacements, free_squares, moved_many, near, .. } = &*self;
        let inside = |index: u32, by: [f32; 2]| enclosure.allowed(index, by);
        let stages = Stages { pairs, displacements, inside: &inside, colours, halo, near };
        let failed = Mutex::new(Ok(()));
        let run = |member: &Member<'_>| -> Result<()> {
            let mut knows_free = false;
            for (iteration, count) in moved.iter().enumerate() {
                let is_worth = if iteration == 0 { *moved_many } else { count_of(0) >= many };
                if is_worth && !knows_free {
                    for index in member.share(len) {
                        free_squares.set(index as u32, enclosure.free_square(index as u32));
                    }
                    // All threads write a share of the squares, and each reads those of all.
                    member.wait();
                    knows_free = true;
                }
                stages.separate(knows_free.then_some(free_squares), count, member)?;
                // The end depends on whether anything was moved anywhere. An iteration in which
                // nothing overlaps changes nothing, so the result does not depend on far particles.
                if !halo.any(count_of(iteration) > 0)? {
                    break;
                }
            }
            Ok(())
        };
        // Other processes are waited for after each colour, by one thread.
        let threads = if halo.is_alone() { threads } else { Some(1) };
        let lengths = pairs.colours.iter().map(|colour| colour.all().len());
        let most = lengths.max().unwrap_or(0).div_ceil(BLOCKS);
        parallel::together(threads, most.max(1), |member| {
            if let Err(error) = run(member) {
                *locked(&failed) = Err(error);
            }
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner)?;
        self.moved_many = count_of(0) >= many;
        Ok(count_of(0) > 0 || !halo.is_alone())
    }
}

/// Finds the pairs that are near.
fn measure(blocks: &mut [Block], motions: &Motions, radii: &[f32], threads: Option<usize>) {
    let size = BLOCKS_OF_A_THREAD;
    let threads = if blocks.len() <= size { Some(1) } else { threads };
    parallel::for_each(threads, blocks.chunks_mut(size), |blocks| {
        Measure { blocks, motions, radii }.run();
    });
}

/// What the iterations have in common.
struct Stages<'a, I> {
    pairs: &'a Blocks,
    displacements: &'a Vectors,
    /// The displacement of a particle that the walls allow.
    inside: &'a I,
    colours: usize,
    halo: &'a dyn Halo,
    /// Whether any process has pairs of each colour that are near.
    near: &'a [u8],
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
        let Self { pairs, displacements, inside, .. } = *self;
        for number in 0..self.colours {
            if self.near.get(number) == Some(&0) {
                continue;
            }
            // Another process may have more colours.
            if let Some(colour) = pairs.colours.get(number) {
                let blocks = &pairs.list[colour.all()];
                let parts = member.share(blocks.len().div_ceil(BLOCKS));
                let own = match colour.is_serial {
                    true if member.is_first() => 0..blocks.len(),
                    true => 0..0,
                    false => parts.start * BLOCKS..blocks.len().min(parts.end * BLOCKS),
                };
                let blocks = &blocks[own];
                let moved = Separate { blocks, displacements, free_squares, inside }.run();
                // Relaxed: additions commute, and the barrier below orders them before the count is
                // read.
                count.fetch_add(moved, Ordering::Relaxed);
            }
            // The next colour reads displacements that this one has written, on any thread.
            member.wait();
            // Ghosts get the displacements that their own processes have computed.
            self.halo.refresh(|at| displacements.get(at), |at, by| displacements.set(at, by))?;
        }
        Ok(())
    }
}
