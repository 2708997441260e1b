//! The part of a distributed world that one rank has: its own particles, and ghosts, which are copies
//! of particles of other ranks near them.
//!
//! Own particles are in the first rows, ghosts in the rows after them, from one step to the next.

use std::any::Any;
use std::collections::HashMap;
use std::iter::repeat_n;
use std::sync::Mutex;

use super::carried::Resting;
use super::islands::SleepingContact;
use super::protocol::Ranks;
use super::{Group, Link, Scale, rounds};
use crate::contacts::{Contact, ContactShape, Contacts, Sequential};
use crate::container::Container;
use crate::halo::{Halo, digest};
use crate::particles::Particles;
use crate::world::bodies::asleep::{Asleep, Sleepers};
use crate::world::bodies::discs::Discs;
use crate::world::distribution::{Agreed, Distribution, Protocol};
use crate::world::reach::ROUNDED_UP;
use crate::world::search::Lists;
use crate::world::{StepScratch, World, WorldSettings};
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel::locked;
use jostle_index::pairs::JoinScratch;
use jostle_index::quadtree::Quadtree;

/// Steps between two times at which domains are chosen, at least.
const FEWEST_STEPS: u64 = 16;

/// Domains are chosen anew if the rank with most work has more than this times the mean, or if there
/// are more than this times as many ghosts as after the last time.
/// They trade the cost of migration against that of waiting for the slowest rank.
const MAX_IMBALANCE: f64 = 1.15;
const MAX_GHOSTS: f64 = 1.4;

/// Ghosts of a rank that are few whatever they were before.
const FEW_GHOSTS: f64 = 32.0;

/// A circle that an own particle does not leave in a step, as the other ranks know.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Announced {
    /// Its position at the beginning of the step.
    pub(crate) position: [f32; 2],
    /// How far it may get from there.
    pub(crate) reach: f32,
}

/// Particles that get further than announced are announced this much further.
const FURTHER: f32 = 1.25;

/// What merging particles change, which [`Protocol::undo`] restores.
#[derive(Debug)]
pub(crate) struct Count {
    ids: Vec<Id>,
    own: usize,
    total: usize,
    awake: usize,
}

/// A hash of the contact of an own particle with a ghost.
pub(crate) struct PairDigest {
    /// The rows of both.
    rows: [u32; 2],
    movable: [bool; 2],
    hash: u64,
}

/// The distribution of a world over ranks.
#[derive(Debug)]
pub(crate) struct Domain {
    pub(crate) group: Mutex<Group>,
    /// The number of ranks.
    pub(crate) ranks: usize,
    /// The id of each row among the particles of all ranks.
    pub(crate) ids: Vec<Id>,
    /// The number of own particles.
    pub(crate) own: usize,
    /// The id that is given next.
    pub(crate) next: Id,
    /// Particles of all ranks.
    pub(crate) total: usize,
    /// Those that are awake, and those that sleep.
    pub(crate) awake: usize,
    pub(crate) asleep: usize,
    /// Whether some sleep and all others are static.
    pub(crate) is_still: bool,
    /// The contacts of sleeping islands; those of islands that have been woken in a step that is not
    /// complete, too.
    pub(crate) sleeping: Vec<SleepingContact>,
    /// The sleeping particles of other ranks near own ones.
    pub(crate) foreign: Asleep,
    /// The names of those of their islands that the step would touch.
    pub(crate) touched: Vec<Id>,
    /// The reach of the particle at each index in its circle, from where it is when a part begins.
    pub(crate) announced_reaches: Vec<f32>,
    pub(crate) is_lossless: bool,
    pub(crate) has_friction: bool,
    /// Quantiles of the coordinates of all ranks along each axis.
    pub(crate) scales: [Scale; 2],
    /// The AABB of the positions of all ranks, until the first part of the step uses it.
    pub(crate) extent: Option<[[f32; 2]; 2]>,
    /// The circle of each own row.
    pub(crate) announced: Vec<Announced>,
    /// The rows that are ghosts of each rank.
    pub(crate) sent: Vec<Vec<u32>>,
    /// The number of ghosts from each rank.
    pub(crate) received: Vec<usize>,
    /// Whether the contacts of the last step are still to be kept.
    pub(crate) has_contacts: bool,
    /// Contacts at rest that own particles had after the step before, and their number when the step
    /// began.
    pub(crate) resting: Vec<Resting>,
    pub(crate) kept: usize,
    /// Whether this rank has all particles as ghosts.
    pub(crate) has_all: bool,
    /// What there was before particles merged in an attempt at a step.
    pub(crate) before: Option<Count>,
    /// The indices of the rows that are sent, and of the ghosts of each rank.
    pub(crate) sent_indices: Vec<Vec<u32>>,
    pub(crate) ghost_indices: Vec<Vec<u32>>,
    /// The rank of each ghost.
    pub(crate) ghost_ranks: Vec<u32>,
    /// Hashes of the colours of the contacts of each ghost with own particles; by rows.
    pub(crate) ghost_pairs: Vec<u64>,
    /// Hashes of the colours of the contacts of each own row with the ghosts of each rank.
    pub(crate) own_pairs: HashMap<(u32, u32), u64>,
    /// Hashes of what happened to each row in the step.
    pub(crate) digests: Vec<u64>,
    /// Whether each ghost may meet own particles; by rows.
    pub(crate) may_meet: Vec<bool>,
    /// Whether each own row is a ghost of another rank.
    pub(crate) is_sent: Vec<bool>,
    /// Whether the particle at each index is an own one.
    pub(crate) is_own: Vec<bool>,
    /// Indices of particles that other ranks have too.
    pub(crate) shared: Vec<u32>,
    /// Own rows that have got further than announced, and how far.
    pub(crate) far: Vec<(u32, f32)>,
    /// Complete steps until now, on all ranks as many.
    pub(crate) steps: u64,
    /// Steps that were repeated because ghosts were missing.
    pub(crate) repeats: u64,
    /// Factor of the margin with which the next step begins, the same on all ranks, and that of this step.
    pub(crate) widening: f64,
    pub(crate) widened: f64,
    /// Distances that own particles got further in this step than announced.
    pub(crate) further: HashMap<Id, f32>,
    /// Whether the ghosts are only those that are near own particles now.
    pub(crate) is_static: bool,
    /// Time of this rank for each of its particles, in any unit that all ranks use.
    pub(crate) work: f64,
    /// Steps after which domains are chosen anew; None if the imbalance decides.
    pub(crate) rebalance_every: Option<u64>,
    /// Whether they are chosen anew in the next step.
    pub(crate) is_stale: bool,
    /// The step in which they were chosen, and how often they were.
    pub(crate) chosen: u64,
    pub(crate) rebalances: u64,
    /// The most ghosts of all ranks in one of the [`FEWEST_STEPS`] steps after that; 0 until the first of these ends.
    pub(crate) usual_ghosts: f64,
}

impl Domain {
    /// Whether domains are chosen in this step; the same on all ranks.
    pub(crate) fn is_due(&self) -> bool {
        self.is_stale || self.rebalance_every.is_some_and(|every| self.steps.is_multiple_of(every))
    }

    /// Finds out from the work of each rank and the ghosts of all whether to choose domains in the next step.
    /// All ranks have the same numbers.
    pub(crate) fn note_load(&mut self, work: impl Iterator<Item = f64> + Clone, ghosts: f64) {
        // With given steps there is nothing to decide.
        if self.steps == self.chosen || self.rebalance_every.is_some() {
            return;
        }
        // The most ghosts that the first steps after a choice of domains have is the usual number,
        // with which later steps are compared.
        if self.steps < self.chosen + FEWEST_STEPS {
            self.usual_ghosts = self.usual_ghosts.max(ghosts);
            return;
        }
        // All ranks compute this from the same gathered numbers in the same order. So they agree
        // without another message.
        let (most, sum) = (work.clone().fold(0.0, f64::max), work.clone().sum::<f64>());
        let few = FEW_GHOSTS * work.count() as f64;
        self.is_stale |= most * self.received.len() as f64 > MAX_IMBALANCE * sum
            || ghosts > (MAX_GHOSTS * self.usual_ghosts).max(few);
    }

    /// Whether there are ghosts. Rows of own particles include those that sleep.
    pub(crate) fn has_ghosts(&self) -> bool {
        self.ids.len() > self.own
    }

    /// Whether a row has an own particle.
    #[inline(always)]
    pub(crate) fn owns(&self, row: u32) -> bool {
        (row as usize) < self.own
    }

    /// The id of a row among the particles of all ranks.
    pub(crate) fn id(&self, row: u32) -> Id {
        self.ids[row as usize]
    }

    /// Notes the distances of particles that have got further than announced.
    pub(crate) fn note_further(&mut self) {
        let Self { far, further, ids, .. } = self;
        for (row, distance) in far.drain(..) {
            // Announced further than it got, because it may get a little further in the next
            // attempt, in which it meets more particles.
            let known = further.entry(ids[row as usize]).or_insert(0.0);
            *known = known.max(distance * FURTHER);
        }
    }

    /// The ids of all rows, and how many particles there are.
    pub(crate) fn count(&self) -> Count {
        let Self { own, total, awake, .. } = *self;
        Count { ids: self.ids.clone(), own, total, awake }
    }

    /// Restores these.
    pub(crate) fn restore(&mut self, Count { ids, own, total, awake }: Count) {
        (self.ids, self.own, self.total, self.awake) = (ids, own, total, awake);
    }

    /// The rank that owns the particle in a row.
    pub(crate) fn rank_of(&self, row: u32) -> usize {
        match (row as usize).checked_sub(self.own) {
            Some(ghost) => self.ghost_ranks[ghost] as usize,
            None => locked(&self.group).rank(),
        }
    }

    /// Notes how many ghosts came from each rank.
    pub(crate) fn note_received(&mut self, received: Vec<usize>) {
        let ranks = (0..).zip(&received);
        self.ghost_ranks = ranks.flat_map(|(rank, &count)| repeat_n(rank, count)).collect();
        self.received = received;
        self.far.clear();
        self.own_pairs.clear();
        // Hashes and marks belong to the ghosts of one exchange.
        let len = self.ids.len();
        for column in [&mut self.digests, &mut self.ghost_pairs] {
            column.clear();
            column.resize(len, 0);
        }
        self.may_meet.clear();
        self.may_meet.resize(len, false);
    }

    /// Lists the indices of own and of shared particles.
    pub(crate) fn list_indices(&mut self, rows: &[u32]) {
        // A rank without ghosts on both sides needs no index by row.
        if !self.has_ghosts() && self.sent.iter().all(Vec::is_empty) {
            self.is_own.clear();
            self.is_own.resize(rows.len(), true);
            self.shared.clear();
            let size = self.sent.len();
            (self.sent_indices, self.ghost_indices) = (vec![vec![]; size], vec![vec![]; size]);
            return;
        }
        let mut indices = vec![0; self.ids.len()];
        (0..).zip(rows).for_each(|(index, &row)| indices[row as usize] = index);
        self.sent_indices.resize(self.sent.len(), Vec::new());
        for (indices_of, rows) in self.sent_indices.iter_mut().zip(&self.sent) {
            indices_of.clear();
            indices_of.extend(rows.iter().map(|&row| indices[row as usize]));
        }
        // Ghosts are in the rows after the own ones, in the order of ranks, as they have arrived.
        // Both sides of an exchange have the same order, so no id travels with the numbers.
        let mut ghosts = indices[self.own..].iter().copied();
        let ranks = self.received.iter().map(|&count| ghosts.by_ref().take(count).collect());
        self.ghost_indices = ranks.collect();
        let Self { is_own, shared, is_sent, own, .. } = self;
        is_own.clear();
        is_own.extend(rows.iter().map(|&row| (row as usize) < *own));
        shared.clear();
        // Rows of ghosts are behind the list of own rows.
        let is_shared = |row: u32| is_sent.get(row as usize).is_none_or(|&is_sent| is_sent);
        shared.extend((0..).zip(rows).filter(|(_, row)| is_shared(**row)).map(|(index, _)| index));
    }

    /// Hashes of the contacts of own particles with ghosts, and of their colours, which follow from those
    /// of other contacts nearby.
    pub(crate) fn digest_colours(
        &self,
        contacts: &Contacts,
        lists: &Lists,
        particles: &Particles,
        rows: &[u32],
    ) -> Vec<PairDigest> {
        let mut found = Vec::new();
        contacts.each_coloured(lists, |indices, [colour, kind]| {
            let movable = indices.map(|index| particles.movable[index as usize]);
            let rows = indices.map(|index| rows[index as usize]);
            // Symmetric in the two particles, because the other rank has them in another order.
            let [a, b] = rows.map(|row| self.ids[row as usize]);
            let colour = u64::from(colour) << 8 | u64::from(kind);
            let hash = digest(digest(digest(1, a.min(b) as u64), a.max(b) as u64), colour);
            match rows.map(|row| self.owns(row)) {
                [true, false] => found.push(PairDigest { rows, movable, hash }),
                [false, true] => {
                    let (rows, movable) = ([rows[1], rows[0]], [movable[1], movable[0]]);
                    found.push(PairDigest { rows, movable, hash });
                }
                _ => {}
            }
        });
        found
    }

    /// Adds these hashes to those of the step. A rank need not have the neighbours of its immovable
    /// particles, so the pairs of these are not compared.
    pub(crate) fn add_pair_digests(&mut self, found: Vec<PairDigest>) {
        for PairDigest { rows: [own, ghost], movable, hash } in found {
            if movable[1] {
                // Sums without overflow checks: each rank finds the contacts in its own order.
                let sum = &mut self.ghost_pairs[ghost as usize];
                *sum = sum.wrapping_add(hash);
            }
            if movable[0] {
                let rank = self.ghost_ranks[ghost as usize - self.own];
                let sum = self.own_pairs.entry((own, rank)).or_default();
                *sum = sum.wrapping_add(hash);
            }
        }
    }

    /// What the order of solving contacts depends on, and the refinement of the sub-steps, on all ranks.
    pub(crate) fn shape_of_all(
        &self,
        own: ContactShape,
        refinement: usize,
    ) -> Result<(ContactShape, usize)> {
        let ContactShape { colours, rounds, has_uneven } = own;
        // Whole numbers below 2⁵³ are exact in float64, so one message takes the largest of all.
        let numbers = [colours, rounds, usize::from(has_uneven), refinement];
        let largest = (self as &dyn Halo).largest(numbers.map(|number| number as f64))?;
        let [colours, rounds, has_uneven, refinement] = largest.map(|number| number as usize);
        Ok((ContactShape { colours, rounds, has_uneven: has_uneven > 0 }, refinement))
    }

    /// Divides the contacts that one process solves in sequence into rounds, in which ranks solve
    /// them at the same time; returns how many there are. Removes those that other ranks solve.
    pub(crate) fn divide(
        &self,
        contacts: &mut Vec<Sequential>,
        movable: &[bool],
        rows: &[u32],
    ) -> Result<usize> {
        // Each rank solves all contacts of its own movable particles, so those between two ranks
        // are solved on both, with the same result.
        let is_own = |&index: &u32| movable[index as usize] && self.owns(rows[index as usize]);
        contacts.retain(|of| of.indices.iter().any(is_own));
        let rank =
            |index: u32| movable[index as usize].then(|| self.rank_of(rows[index as usize]) as u32);
        let link = |of: &Sequential| Link {
            ids: of.indices.map(|index| self.id(rows[index as usize])),
            image: of.image,
            ranks: of.indices.map(rank),
        };
        let links: Vec<Link> = contacts.iter().map(link).collect();
        let (rounds, count) = rounds(&self.group, &links)?;
        contacts.iter_mut().zip(rounds).for_each(|(of, round)| of.round = round);
        Ok(count)
    }

    /// Lets own particles get no farther than the circles that other ranks know. Those of which that is
    /// not known are noted as far.
    pub(crate) fn limit(
        &mut self,
        particles: &Particles,
        rows: &[u32],
        container: &Container,
        scratch: &mut StepScratch,
    ) {
        let StepScratch { watched_reaches, reaches, .. } = scratch;
        self.announced_reaches.clear();
        if self.ranks < 2 {
            return;
        }
        // Where nothing sleeps there are none yet, and nothing gets beyond an infinite one.
        watched_reaches.resize(rows.len(), f32::INFINITY);
        let all = rows.iter().zip(&particles.positions).zip(&*reaches).zip(watched_reaches);
        for (((&row, position), &reach), limit) in all {
            // Ghosts have no circle here: their own rank watches them.
            let Some(of) = self.announced.get(row as usize) else {
                *limit = f32::INFINITY;
                self.announced_reaches.push(f32::INFINITY);
                continue;
            };
            // In later parts of a step the particle is no longer where it was announced.
            let moved = if *position == of.position {
                0.0
            } else {
                let offset = [0, 1].map(|k| f64::from(position[k]) - f64::from(of.position[k]));
                let [x, y] = container.period().exact().minimum_image(offset);
                ((x * x + y * y).sqrt() * ROUNDED_UP) as f32
            };
            let left = of.reach - moved;
            // Bounds beyond the announced circle may overlap particles that this rank does not
            // have. The step is repeated with a wider circle.
            if left < reach {
                self.far.push((row, moved + reach));
            }
            self.announced_reaches.push(left);
            *limit = left.min(*limit);
        }
    }

    /// The domain of a distributed world. Panics for other worlds.
    pub(crate) fn of_mut(halo: &mut dyn Distribution) -> &mut Self {
        (halo as &mut dyn Any).downcast_mut().expect("only ranks have their protocol")
    }
}

impl Halo for Domain {
    fn is_alone(&self) -> bool {
        self.ranks < 2
    }

    fn own(&self) -> &[bool] {
        &self.is_own
    }

    fn shared(&self) -> &[u32] {
        &self.shared
    }

    fn count(&self, _: usize) -> usize {
        self.awake
    }

    fn add_up(&self, numbers: &mut [u64]) -> Result<()> {
        if self.is_alone() {
            return Ok(());
        }
        locked(&self.group).sum(numbers)
    }

    fn take_largest(&self, numbers: &mut [f64]) -> Result<()> {
        if self.is_alone() {
            return Ok(());
        }
        locked(&self.group).largest(numbers)
    }

    fn any_bits(&self, any: &mut Vec<u8>) -> Result<()> {
        if self.is_alone() {
            return Ok(());
        }
        for bytes in locked(&self.group).share(any)? {
            // Ranks may have lists of different lengths. Missing bytes are 0.
            any.resize(any.len().max(bytes.len()), 0);
            any.iter_mut().zip(bytes).for_each(|(any, bits)| *any |= bits);
        }
        Ok(())
    }

    fn exchange(
        &self,
        size: usize,
        put: &dyn Fn(u32, &mut Vec<u8>),
        take: &mut dyn FnMut(u32, &[u8]),
    ) -> Result<()> {
        let bytes_of = |lists: &[Vec<u32>]| -> Vec<usize> {
            lists.iter().map(|indices| indices.len() * size).collect()
        };
        // Both sides know all sizes from the exchange of ghosts, so no sizes are sent.
        let (sent, received) = (bytes_of(&self.sent_indices), bytes_of(&self.ghost_indices));
        let mut to = Vec::with_capacity(sent.iter().sum());
        self.sent_indices.iter().flatten().for_each(|&index| put(index, &mut to));
        let all = locked(&self.group).exchange_known(&to, &sent, &received)?;
        let ghosts = self.ghost_indices.iter().flatten();
        ghosts.zip(all.chunks_exact(size)).for_each(|(&index, bytes)| take(index, bytes));
        Ok(())
    }
}

impl Distribution for Domain {
    fn protocol(&self) -> &'static dyn Protocol {
        &Ranks
    }

    fn is_whole(&self) -> bool {
        false
    }

    fn own_rows(&self) -> u32 {
        self.own as u32
    }

    fn ids(&self) -> &[Id] {
        &self.ids
    }

    fn agreed(&self) -> Option<Agreed> {
        let Self { is_lossless, has_friction, asleep, .. } = *self;
        Some(Agreed { is_lossless, has_friction, any_sleeps: asleep > 0 })
    }

    fn take_extent(&mut self) -> Option<[[f32; 2]; 2]> {
        self.extent.take()
    }

    fn fail(&self) {
        locked(&self.group).fail();
    }

    fn forget_domains(&mut self) {
        self.is_stale = true;
    }

    fn touch_others(
        &mut self,
        circles: &Quadtree<f32>,
        radius: &dyn Fn(u32) -> Option<f32>,
        settings: &WorldSettings,
        scratch: &mut JoinScratch,
    ) -> Result<bool> {
        let mut touched = Vec::new();
        self.foreign.touched(circles, radius, settings, (scratch, &mut touched))?;
        self.touched = self.foreign.names(&touched).collect();
        Ok(!self.touched.is_empty())
    }

    fn keep_contacts(
        &mut self,
        sleepers: &Sleepers,
        contacts: &[(u32, Contact)],
        Discs { particles, rows, .. }: &Discs,
    ) -> Result<bool> {
        let kept = contacts.iter().map(|(island, contact)| {
            let indices = contact.indices.map(|index| index as usize);
            let ids = indices.map(|index| self.ids[rows[index] as usize]);
            let categories = indices.map(|index| particles.filter(index).category);
            let name = sleepers.islands[*island as usize].name;
            SleepingContact::new(name, ids, categories, contact)
        });
        let kept: Vec<SleepingContact> = kept.collect();
        self.sleeping.extend(kept);
        Ok(true)
    }
}

/// The distribution over ranks, if there is one.
pub(super) fn domain_of(world: &World) -> Option<&Domain> {
    (&*world.halo as &dyn Any).downcast_ref()
}

/// The domain of a distributed world. Panics for other worlds.
pub(super) fn domain_of_mut(world: &mut World) -> &mut Domain {
    Domain::of_mut(&mut *world.halo)
}
