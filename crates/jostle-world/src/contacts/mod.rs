//! Contacts of candidate pairs that may rest or overlap, with graph colouring.
//!
//! Contacts of one colour share no movable particle, so they are solved in parallel with the same
//! result, whatever their order. Colours are solved in ascending order. Each contact takes the lowest
//! colour that is free, so the low ones have most contacts, and few colours are short.

mod blocks;
mod colouring;
mod sequence;

use std::cmp::Ordering;

use crate::motion::Motions;
use crate::particles::Particles;
use crate::tolerance::gap;
pub use blocks::{Block, Blocks, Colour, Materials, RELAXATION};
use colouring::{Colouring, Edge, prioritize};
use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::error::Result;
use jostle_base::{memory, parallel, plain, reserve, sorting};
use jostle_simd::LANES;
use sequence::Sequence;
pub use sequence::Sequential;

/// Colours of the contacts of a particle at most; its other contacts are solved in sequence.
pub const COLOURS: usize = 64;

/// Masses are uneven if the larger is more than this times the smaller. A smaller ratio gives more
/// particles further iterations. Piles with masses 100:1 in `docs/benchmarks-notes.md` show what
/// these gain and cost.
const UNEVEN: f32 = 6.0;

/// Two particles that touched in the last step, or that it left with an impulse at rest: what is left
/// of a contact between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Indices of the two particles in the world's order.
    pub indices: [u32; 2],
    /// Offset that is added to the second (torus).
    pub image: [f32; 2],
    /// One over the masses; 0 for particles that do not move in the step.
    pub inverse_masses: [f32; 2],
    /// Unit vector from the first to the second.
    pub normal: [f32; 2],
    /// Distance from surface to surface; negative if they overlap.
    pub gap: f32,
    /// Impulse at rest, carried from sub-step to sub-step.
    pub impulse: f32,
    /// Impulse of friction at rest on the second along the normal after a quarter turn, in the
    /// same way.
    pub friction_impulse: f32,
    /// Sums of the impulses of this step along the normal and of friction.
    pub totals: [f32; 2],
    /// Whether the two touched or pushed each other during this step.
    pub touched: bool,
}

plain! {
    Contact {
        indices, image, normal, gap, impulse, friction_impulse, totals, touched;
        inverse_masses
    }
}

/// Kinds of contacts in a colour, in their order.
const KINDS: usize = 3;

/// Those of particles that have contacts of uneven masses.
const UNEVEN_KIND: usize = 0;

/// Those of particles that are near each other as the step begins, and the others. Blocks of the
/// latter often have no contact that rests.
const NEAR_KIND: usize = 1;
const FAR_KIND: usize = 2;

/// Marks pairs of which neither particle moves. They have no contact.
const UNSOLVED: u8 = KINDS as u8;

/// Gap, as a share of the sum of radii, up to which particles are near.
const NEAR: f32 = 0.1;

/// The number of contacts of each kind of each colour.
type Counts = Vec<[usize; KINDS]>;

/// Marks lanes without a contact.
const NONE: u32 = u32::MAX;

/// Blocks that a thread fills at a time. Larger tasks leave threads without work at the end,
/// smaller ones cost more for each task.
const BLOCKS_OF_A_THREAD: usize = 64;

impl Default for Contact {
    /// The normal of coincident centres is +x.
    fn default() -> Self {
        Self {
            indices: [0; 2],
            image: [0.0; 2],
            inverse_masses: [0.0; 2],
            normal: [1.0, 0.0],
            gap: 0.0,
            impulse: 0.0,
            friction_impulse: 0.0,
            totals: [0.0; 2],
            touched: false,
        }
    }
}

/// Whether the masses of two particles that move are very different.
fn are_uneven([a, b]: [f32; 2]) -> bool {
    a.max(b) > UNEVEN * a.min(b)
}

impl Contact {
    /// Whether it rests and presses its particles together.
    #[inline(always)]
    pub fn presses(&self) -> bool {
        self.impulse > 0.0
    }

    /// Adds impulses to the sums of this step.
    #[inline(always)]
    pub fn count(&mut self, impulses: [f32; 2]) {
        self.totals = sum_of_impulses(self.totals, impulses);
    }

    /// Adds the impulses of `next` if it is the same contact. Returns whether it is.
    #[inline(always)]
    fn absorb(&mut self, next: &Self) -> bool {
        let is_same = self.key() == next.key();
        if is_same {
            self.touched |= next.touched;
            self.count(next.totals);
        }
        is_same
    }

    /// Updates normal and gap to the positions in float32.
    pub fn measure(&mut self, motions: &Motions, radii: &[f32]) {
        // Float64 for the difference: the results for the caller must be those of the positions in
        // float32 that the caller sees.
        let [a, b] = self.indices.map(|index| motions.position(index).map(f64::from));
        let offset = [0, 1].map(|k| b[k] - a[k] + f64::from(self.image[k]));
        let [r, s] = self.indices.map(|index| f64::from(radii[index as usize]));
        let (normal, gap) = gap(offset, r + s);
        self.normal = normal.map_or(self.normal, |normal| normal.map(|v| v as f32));
        self.gap = gap as f32;
    }

    /// The order of contacts in the list.
    pub fn compare(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }

    /// What contacts are sorted by.
    fn key(&self) -> ([u32; 2], [u32; 2]) {
        (self.indices, self.image.map(f32::to_bits))
    }

    /// This contact with the smaller index first. The impulse of friction stays the same, because
    /// the normal changes its sign.
    pub fn ascending(self) -> Self {
        let Self { indices: [a, b], image, normal, inverse_masses: [c, d], .. } = self;
        // Each pair has one form, so contacts of both directions are equal and can be merged.
        if a < b {
            return self;
        }
        // 0 − v, so that no image is −0.
        let [image, normal] = [image, normal].map(|vector| vector.map(|v| 0.0 - v));
        Self { indices: [b, a], image, normal, inverse_masses: [d, c], ..self }
    }
}

/// What the order of solving contacts depends on; the same on all processes of a distributed world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactShape {
    /// The number of colours.
    pub colours: usize,
    /// The number of rounds of the contacts that are solved in sequence.
    pub rounds: usize,
    /// Whether any particle has a contact of uneven masses.
    pub has_uneven: bool,
}

impl ContactShape {
    /// The number of colours and rounds.
    pub fn stages(&self) -> usize {
        self.colours + self.rounds
    }
}

/// All contacts of a step.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Those that lasted, in canonical order, between steps.
    list: Vec<Contact>,
    /// All contacts, during a step.
    pub blocks: Blocks,
    /// The lane of each contact, counted over all blocks, in canonical order.
    lanes: Vec<u32>,
    /// The colour and the kind of each pair, in canonical order.
    colours: Vec<u8>,
    kinds: Vec<u8>,
    /// Where the contact of each lane comes from: which list, and which pair of it.
    sources: Vec<[u32; 2]>,
    /// Whether the canonical order is that of the keys: there are no contacts with images.
    is_sorted: bool,
    spare: Vec<Contact>,
    unsorted: Vec<Contact>,
    edges: Vec<Edge>,
    colouring: Colouring,
    sequence: Sequence,
    counts: Counts,
    /// The index that each particle has after others are removed.
    renamed: Vec<u32>,
    /// Whether each particle has a contact of uneven masses; empty if none has.
    uneven: Vec<bool>,
    previous: Previous,
}

impl Saved for Contacts {
    fn put(&self, to: &mut Writer) {
        to.put_count(self.lasting().count());
        self.lasting().for_each(|contact| contact.put(to));
    }
    /// Only the list; [`Contacts::remember`] reads the impulses in it.
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        Ok(Self { list: Saved::get(from)?, ..Self::default() })
    }
}

/// Impulses of resting contacts of the last step, for warm starting.
#[derive(Clone, Debug, Default)]
struct Previous {
    /// `starts[index]..starts[index + 1]` are the contacts whose first is `index`.
    starts: Vec<u32>,
    seconds: Vec<u32>,
    /// Along the normal, and of friction.
    impulses: Vec<[f32; 2]>,
}

impl Previous {
    /// The impulses between two indices of the previous order.
    fn impulses(&self, a: u32, b: u32) -> [f32; 2] {
        let (first, second) = (a.min(b) as usize, a.max(b));
        if first + 1 >= self.starts.len() {
            return [0.0; 2];
        }
        // Compressed rows: the impulses of the step before are found by two loads and a short
        // search, without a hash table.
        let range = self.starts[first] as usize..self.starts[first + 1] as usize;
        // In canonical order, so ascending: one large particle may rest on very many.
        let found = self.seconds[range.clone()].binary_search(&second);
        found.map_or([0.0; 2], |at| self.impulses[range.start + at])
    }
}

impl Contacts {
    /// Takes the pairs of a step: a sorted list for each torus image. [`Contacts::collect`]
    /// follows.
    pub fn colour(
        &mut self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        particles: &Particles,
        threads: Option<usize>,
    ) -> Result<()> {
        let movable = &particles.movable;
        // The order is given. Uneven masses decide the kinds of contacts. Edges have the
        // priorities, which give the colours. Colours and kinds give the numbers of blocks.
        self.find_uneven(lists, &particles.masses, movable)?;
        // Only contacts without images follow the order of the keys. With images the lists are
        // merged by a sort at the end of the step.
        self.is_sorted = lists.iter().skip(1).all(|(_, pairs)| pairs.is_empty());
        self.list_edges(lists, particles, movable, threads)?;
        self.colouring.run(&self.edges, movable, &mut self.colours)?;
        self.count();
        self.sequence.list(lists, &self.colours, &self.kinds)
    }

    /// Makes the contacts of the pairs. `before` has the index of each particle in the order of the
    /// step before. The contacts that are solved in sequence are divided into `rounds` rounds.
    pub fn collect(
        &mut self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        materials: &Materials<'_>,
        before: &[u32],
        rounds: usize,
        threads: Option<usize>,
    ) -> Result<()> {
        // First each contact gets its lane, in canonical order on one thread. Then threads fill the
        // blocks, each its own. So the place of a contact does not depend on threads.
        let rounds = self.sequence.arrange(rounds, &self.colours, &mut self.kinds)?;
        let mut next = self.blocks.arrange(&self.counts, rounds)?;
        reserve!(self.kinds.len(); self.lanes);
        reserve!(self.blocks.list.len() * LANES; self.sources);
        let mut in_sequence = self.sequence.blocks(&self.blocks);
        self.lanes.clear();
        self.list.clear();
        self.sources.clear();
        self.sources.resize(self.blocks.list.len() * LANES, [NONE; 2]);
        let mut colours = self.colours.iter().zip(&self.kinds);
        for (which, (_, pairs)) in (0..).zip(lists) {
            for (pair, (&colour, &kind)) in (0..pairs.len() as u32).zip(&mut colours) {
                if kind == UNSOLVED {
                    continue;
                }
                let lane = if usize::from(colour) < COLOURS {
                    next.take([colour, kind])
                } else {
                    in_sequence.next().unwrap_or_default() * LANES
                };
                self.lanes.push(lane as u32);
                // The lane knows its pair, and not the reverse: a thread that fills a block reads
                // sixteen pairs and writes to its block alone.
                self.sources[lane] = [which, pair];
            }
        }
        let Self { blocks, sources, previous, .. } = self;
        let source = |[which, pair]: [u32; 2]| {
            let (image, pairs) = lists.get(which as usize)?;
            let pair = pairs[pair as usize];
            let here = *image == [0.0; 2];
            let [i, j] = pair.map(|index| before[index as usize]);
            // Warm starting across the seam of a torus is left out: the key of the previous order
            // has no image. Such a contact begins with 0.
            let impulses = if here { previous.impulses(i, j) } else { [0.0; 2] };
            Some((pair, *image, impulses))
        };
        let size = BLOCKS_OF_A_THREAD;
        // One task needs no other thread.
        let threads = if blocks.list.len() <= size { Some(1) } else { threads };
        let parts = blocks.list.chunks_mut(size).zip(sources.chunks(size * LANES));
        parallel::for_each(threads, parts, |(blocks, sources)| {
            for (block, sources) in blocks.iter_mut().zip(sources.chunks(LANES)) {
                block.fill(materials, |lane| source(sources[lane]));
            }
        });
        Ok(())
    }

    /// The contacts that are solved in sequence, of which some may be removed before
    /// [`Contacts::collect`].
    pub fn sequential(&mut self) -> &mut Vec<Sequential> {
        self.sequence.contacts()
    }

    /// Ends the sub-steps of a step in which contacts may rest: adds the impulses of the last one.
    pub fn end_resting(&mut self, has_friction: bool) {
        for block in &mut self.blocks.list {
            block.count(has_friction);
            if !has_friction {
                // Otherwise an impulse from before the friction became 0 would begin the next step.
                block.friction_impulses[1] = [0.0; LANES];
            }
        }
    }

    /// Finds the particles that have contacts of uneven masses.
    fn find_uneven(
        &mut self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        masses: &[f32],
        movable: &[bool],
    ) -> Result<()> {
        self.uneven.clear();
        if lists.iter().all(|(_, pairs)| pairs.is_empty()) {
            return Ok(());
        }
        // Most worlds need no further test. Numbers above 0 have the order of their bits.
        let bits = masses.iter().map(|mass| mass.to_bits());
        let [least, most] = [bits.clone().fold(u32::MAX, u32::min), bits.fold(0, u32::max)];
        // The reserve covers the rounding of the inverse masses that the exact test compares.
        if f32::from_bits(most) <= UNEVEN * f32::from_bits(least) * (1.0 - 4.0 * f32::EPSILON) {
            return Ok(());
        }
        reserve!(movable.len(); self.uneven);
        for &pair in lists.iter().flat_map(|(_, pairs)| pairs) {
            let [a, b] = pair.map(|index| index as usize);
            if movable[a] && movable[b] && are_uneven([1.0 / masses[a], 1.0 / masses[b]]) {
                self.uneven.resize(movable.len(), false);
                (self.uneven[a], self.uneven[b]) = (true, true);
            }
        }
        Ok(())
    }

    /// Whether a particle has a contact of uneven masses in this step.
    pub fn is_uneven(&self, index: u32) -> bool {
        self.uneven.get(index as usize).is_some_and(|&uneven| uneven)
    }

    /// What the order of solving in one process depends on.
    pub fn shape(&self) -> ContactShape {
        ContactShape {
            colours: self.counts.iter().filter(|kinds| **kinds != [0; KINDS]).count(),
            rounds: usize::from(self.sequence.is_any()),
            has_uneven: self.has_uneven(),
        }
    }

    /// Calls `act` with the indices, the colour and the kind of each contact of the step.
    pub fn each_coloured(
        &self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        mut act: impl FnMut([u32; 2], [u8; 2]),
    ) {
        let pairs = lists.iter().flat_map(|(_, pairs)| pairs);
        for ((&pair, &colour), &kind) in pairs.zip(&self.colours).zip(&self.kinds) {
            if kind != UNSOLVED {
                act(pair, [colour, kind]);
            }
        }
    }

    /// Whether any particle has a contact of uneven masses.
    pub fn has_uneven(&self) -> bool {
        !self.uneven.is_empty()
    }

    /// Lists the edges and the kinds of all pairs.
    fn list_edges(
        &mut self,
        lists: &[([f32; 2], Vec<[u32; 2]>)],
        particles: &Particles,
        movable: &[bool],
        threads: Option<usize>,
    ) -> Result<()> {
        let Self { edges, kinds, uneven, .. } = self;
        // All contacts of such a particle get more iterations, and not only the uneven one. The
        // correction of one contact disturbs the others of the same particle.
        let is_uneven = |index: u32| uneven.get(index as usize).is_some_and(|&uneven| uneven);
        let count = lists.iter().map(|(_, pairs)| pairs.len()).sum();
        memory::resize(edges, count, Edge::default())?;
        memory::resize(kinds, count, 0)?;
        let (mut edges, mut kinds) = (&mut edges[..], &mut kinds[..]);
        for (image, pairs) in lists {
            let (own, of) =
                (edges.split_off_mut(..pairs.len()), kinds.split_off_mut(..pairs.len()));
            let (own, of) = (own.unwrap_or_default(), of.unwrap_or_default());
            parallel::for_chunks_of_two(threads, own, of, |first, edges, kinds| {
                let pairs = &pairs[first..][..edges.len()];
                prioritize(particles, pairs, *image, edges);
                for (kind, &indices) in kinds.iter_mut().zip(pairs) {
                    let [a, b] = indices.map(|index| index as usize);
                    *kind = if !(movable[a] || movable[b]) {
                        // Neither moves, so no impulse has an effect. The pair stays in the list,
                        // because pairs, colours and kinds have the same numbers.
                        UNSOLVED
                    } else if indices.into_iter().any(is_uneven) {
                        UNEVEN_KIND as u8
                    } else if are_near(particles, [a, b], *image) {
                        // Pairs near each other are likely to rest. Blocks of them are full of
                        // work, and those of the others are often skipped as a whole.
                        NEAR_KIND as u8
                    } else {
                        FAR_KIND as u8
                    };
                }
            });
        }
        Ok(())
    }

    /// Counts the contacts of each kind of each colour.
    fn count(&mut self) {
        let counts = &mut self.counts;
        counts.clear();
        counts.resize(COLOURS, [0; KINDS]);
        for (&colour, &kind) in self.colours.iter().zip(&self.kinds) {
            if kind != UNSOLVED
                && let Some(kinds) = counts.get_mut(usize::from(colour))
            {
                kinds[usize::from(kind)] += 1;
            }
        }
    }

    /// Swaps the lists with those of `other`, except the impulses for warm starting.
    pub fn exchange(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.list, &mut other.list);
        self.blocks.clear();
    }

    /// Forgets all contacts.
    pub fn forget(&mut self) {
        self.list.clear();
        self.blocks.clear();
        self.previous.starts.clear();
    }

    /// Removes the contacts of removed particles and updates the indices of the others.
    pub fn retain(&mut self, keep: &[bool]) {
        let Self { list, renamed, .. } = self;
        let mut left = 0;
        renamed.clear();
        for &kept in keep {
            renamed.push(left);
            left += u32::from(kept);
        }
        list.retain_mut(|contact| {
            let stays = contact.indices.iter().all(|&index| keep[index as usize]);
            contact.indices = contact.indices.map(|index| renamed[index as usize]);
            stays
        });
        self.blocks.clear();
        self.remember(left as usize);
    }

    /// Reserves memory for [`Contacts::retain`] of `len` particles.
    pub fn reserve_retain(&mut self, len: usize) -> Result<()> {
        reserve!(len; self.renamed);
        Ok(())
    }

    /// Adds contacts; `count` is the number of particles.
    /// There must be memory for them, see [`Contacts::reserve_insert`].
    pub fn insert(&mut self, new: impl Iterator<Item = Contact>, count: usize) {
        self.list.extend(new);
        self.list.iter_mut().for_each(|contact| *contact = contact.ascending());
        self.list.sort_unstable_by_key(Contact::key);
        self.blocks.clear();
        self.remember(count);
    }

    /// Reserves memory for `more` contacts, and for [`Contacts::retain`] without them.
    pub fn reserve_insert(&mut self, more: usize, count: usize) -> Result<()> {
        memory::reserve(&mut self.list, more)?;
        self.reserve_impulses(count, more)?;
        self.reserve_retain(count)
    }

    /// Reserves memory for the impulses of the contacts in the list and of `more`, of `count` particles.
    pub fn reserve_impulses(&mut self, count: usize, more: usize) -> Result<()> {
        let Previous { starts, seconds, impulses } = &mut self.previous;
        let known = self.list.iter().filter(|contact| contact.impulse > 0.0).count();
        // A world without impulses at rest needs none.
        if known + more > 0 {
            reserve!(count + 1; *starts);
            reserve!(known + more; *seconds, *impulses);
        }
        Ok(())
    }

    /// Keeps the contacts that touched during the step or have an impulse, and adds the pairs that
    /// bounced, with the offset of the second and the impulses.
    pub fn keep_lasting(
        &mut self,
        bounced: impl Iterator<Item = ([u32; 2], [f32; 2], [f32; 2])>,
        particles: &Particles,
        indices: usize,
    ) -> Result<()> {
        let Self { list, blocks, lanes, spare, unsorted, .. } = self;
        // The lanes are read in canonical order, so the result is sorted without a sort, although
        // blocks are in the order of colours.
        let lasting = lanes.iter().filter_map(|&lane| {
            let lane = lane as usize;
            blocks.list[lane / LANES].lasting(lane % LANES).map(Contact::ascending)
        });
        spare.clear();
        let bounced = bounced.map(|(pair, image, totals)| {
            let [i, j] = pair.map(|index| index as usize);
            Contact {
                indices: pair,
                image,
                inverse_masses: [particles.inverse_mass(i), particles.inverse_mass(j)],
                totals,
                touched: true,
                ..Contact::default()
            }
        });
        memory::extend(spare, bounced)?;
        sort(spare);
        list.clear();
        // Nothing could rest, as in a gas: the bounces are the list.
        if lanes.is_empty() {
            std::mem::swap(list, spare);
            // Equal keys are neighbours after the sort, in an order of their values, so sums have
            // the same bits on each process.
            list.dedup_by(|next, last| last.absorb(next));
        } else if self.is_sorted {
            merge(lasting, spare, list)?;
        } else {
            unsorted.clear();
            memory::extend(unsorted, lasting)?;
            sort(unsorted);
            merge(unsorted.iter().copied(), spare, list)?;
        }
        self.blocks.clear();
        self.reserve_impulses(indices, 0)?;
        self.remember(indices);
        Ok(())
    }

    /// The contacts of the step that is computed, in blocks.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks.list
    }

    /// Those that touched or have an impulse, in canonical order.
    pub fn lasting(&self) -> impl Iterator<Item = &Contact> {
        self.list.iter().filter(|contact| contact.touched || contact.presses())
    }

    /// All contacts in the list.
    pub fn all(&self) -> &[Contact] {
        &self.list
    }

    /// Calls `act` on every contact, in any order; it may only write the contact.
    pub fn each(&mut self, threads: Option<usize>, act: impl Fn(&mut Contact) + Sync + Send) {
        parallel::for_chunks(threads, &mut self.list, |_, chunk| chunk.iter_mut().for_each(&act));
    }

    /// Stores the resting impulses by index, for warm starting in the next step. Returns the
    /// first contact whose impulse is not finite, if any. There must be memory for them: of
    /// [`Contacts::reserve_impulses`], or of an earlier call with the same contacts.
    pub fn remember(&mut self, indices: usize) -> Option<&Contact> {
        let Self { list, previous: Previous { starts, seconds, impulses }, .. } = self;
        starts.clear();
        seconds.clear();
        impulses.clear();
        let mut overflow = None;
        for contact in &*list {
            // Only reported: what an overflow means is decided by the caller.
            if contact.impulse == f32::INFINITY {
                overflow = overflow.or(Some(contact));
            }
            // Most contacts of a gas have no impulse at rest, and a world without one allocates
            // nothing here.
            if contact.presses() && contact.image == [0.0; 2] {
                if starts.is_empty() {
                    starts.resize(indices + 1, 0);
                }
                starts[contact.indices[0] as usize] += 1;
                seconds.push(contact.indices[1]);
                impulses.push([contact.impulse, contact.friction_impulse]);
            }
        }
        sorting::prefix_sum(starts);
        overflow
    }

    /// Whether any contact has an impulse at rest that the next step begins with.
    pub fn has_impulses(&self) -> bool {
        !self.previous.starts.is_empty()
    }

    /// The contacts whose particles touched or pushed each other, in canonical order, as the last step
    /// left them.
    pub fn touching(&self) -> impl Iterator<Item = &Contact> {
        self.list.iter().filter(|contact| contact.touched)
    }
}

/// The sums of two impulses along two axes, at most the largest number of float32: infinite ones of both
/// signs would give NaN.
pub fn sum_of_impulses(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| (a[k] + b[k]).clamp(f32::MIN, f32::MAX))
}

/// Whether two particles are near each other.
fn are_near(particles: &Particles, [a, b]: [usize; 2], image: [f32; 2]) -> bool {
    let [p, q] = [a, b].map(|index| particles.positions[index]);
    let [x, y] = [0, 1].map(|k| q[k] - p[k] + image[k]);
    // The kind decides only in which block a contact is, so float32 and a rough limit are enough.
    // It follows from the state, so it is the same everywhere.
    let most = (1.0 + NEAR) * (particles.radii[a] + particles.radii[b]);
    x * x + y * y < most * most
}

/// Sorts contacts by their keys. Sums of impulses depend on the order, so equal keys are sorted by
/// these.
fn sort(list: &mut [Contact]) {
    let key = |of: &Contact| (of.key(), of.totals.map(f32::to_bits));
    // A list that is sorted already costs one pass without moves.
    if !list.is_sorted_by_key(key) {
        list.sort_unstable_by_key(key);
    }
}

/// Appends two sorted lists to a third. Of the same contact in both, that of the first list is kept,
/// with the sums of the impulses of both.
fn merge(
    first: impl Iterator<Item = Contact>,
    mut second: &[Contact],
    to: &mut Vec<Contact>,
) -> Result<()> {
    for next in first {
        // Few contacts are in the second list.
        while let Some((earlier, rest)) = second.split_first()
            && earlier.key() < next.key()
        {
            append(*earlier, to)?;
            second = rest;
        }
        append(next, to)?;
    }
    second.iter().try_for_each(|next| append(*next, to))
}

/// Appends a contact to a sorted list, or its impulses to the last contact if that is the same.
#[inline(always)]
fn append(next: Contact, to: &mut Vec<Contact>) -> Result<()> {
    let is_known = to.last_mut().is_some_and(|last| last.absorb(&next));
    if is_known { Ok(()) } else { memory::push(to, next) }
}
