//! The part of a distributed world that one rank has: its own particles, and ghosts, which are copies
//! of particles of other ranks near them.
//!
//! Own particles are in the first rows, ghosts in the rows after them, from one step to the next.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::iter::repeat_n;
use std::ops::Range;
use std::sync::Mutex;

use super::asleep::Asleep;
use super::carried::Resting;
use super::ids::Ids;
use super::islands::SleepingContact;
use super::search::Lists;
use super::{OnTouch, StepScratch, World};
use crate::contacts::{ContactShape, Contacts};
use crate::container::Container;
use crate::decomposition::{
    Communicator, Group, Halo, RECORD, Scale, Traffic, digest, put_record, read_records,
};
use crate::error::{Error, Result};
use crate::forces::{self, Force, Kinds};
use crate::parallel::locked;
use crate::particles::Particles;
use crate::space::Id;
use crate::table::Table;

/// Steps between two times at which domains are chosen, at least.
const FEWEST_STEPS: u64 = 16;

/// Domains are chosen anew if the rank with most work has more than this times the mean, or if there
/// are more than this times as many ghosts as after the last time.
const MOST_IMBALANCE: f64 = 1.15;
const MOST_GHOSTS: f64 = 1.4;

/// Ghosts of a rank that are few whatever they were before.
const FEW_GHOSTS: f64 = 32.0;

/// A circle that an own particle does not leave in a step, as the other ranks know.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Announced {
    /// Its position at the beginning of the step.
    pub(super) position: [f32; 2],
    /// How far it may get from there.
    pub(super) distance: f32,
}

/// A hash of the contact of an own particle with a ghost.
pub(super) struct PairDigest {
    /// The rows of both.
    rows: [u32; 2],
    movable: [bool; 2],
    hash: u64,
}

/// The distribution of a world over ranks.
#[derive(Debug)]
pub(super) struct Domain {
    pub(super) group: Mutex<Group>,
    /// The id of each row among the particles of all ranks.
    pub(super) ids: Vec<Id>,
    /// The number of own particles.
    pub(super) own: usize,
    /// The id that is given next.
    pub(super) next: Id,
    /// Particles of all ranks.
    pub(super) total: usize,
    /// Those that are awake, and those that sleep.
    pub(super) awake: usize,
    pub(super) asleep: usize,
    /// Whether some sleep and all others are static.
    pub(super) is_still: bool,
    /// The contacts of sleeping islands; those of islands that have been woken in a step that is not
    /// complete, too.
    pub(super) sleeping: Vec<SleepingContact>,
    /// The sleeping particles of other ranks near own ones.
    pub(super) foreign: Asleep,
    /// The names of those of their islands that the step would touch.
    pub(super) touched: Vec<Id>,
    /// How far the particle at each place may get before it leaves its circle.
    pub(super) left: Vec<f32>,
    is_elastic: bool,
    has_friction: bool,
    /// Quantiles of the coordinates of all ranks along each axis.
    pub(super) scales: [Scale; 2],
    /// The AABB of the positions of all ranks, until the first part of the step uses it.
    pub(super) extent: Option<[[f32; 2]; 2]>,
    /// The circle of each own row.
    pub(super) announced: Vec<Announced>,
    /// The rows that are ghosts of each rank.
    pub(super) sent: Vec<Vec<u32>>,
    /// The number of ghosts from each rank.
    pub(super) received: Vec<usize>,
    /// Whether the contacts of the last step are still to be kept.
    pub(super) has_contacts: bool,
    /// Contacts at rest that own particles had after the step before.
    pub(super) resting: Vec<Resting>,
    /// The places of the rows that are sent, and of the ghosts of each rank.
    sent_places: Vec<Vec<u32>>,
    ghost_places: Vec<Vec<u32>>,
    /// The rank of each ghost.
    ghost_ranks: Vec<u32>,
    /// Hashes of the colours of the contacts of each ghost with own particles; by rows.
    pub(super) ghost_pairs: Vec<u64>,
    /// The same of each own row with the ghosts of each rank.
    pub(super) own_pairs: HashMap<(u32, u32), u64>,
    /// Hashes of what happened to each row in the step.
    pub(super) digests: Vec<u64>,
    /// Whether each ghost may meet own particles; by rows.
    pub(super) may_meet: Vec<bool>,
    /// Whether each own row is a ghost of another rank.
    pub(super) is_sent: Vec<bool>,
    /// Whether the particle at each place is an own one.
    is_own: Vec<bool>,
    /// Places of particles that other ranks have too.
    pub(super) shared: Vec<u32>,
    /// Own rows that have got further than announced, and how far.
    pub(super) far: Vec<(u32, f32)>,
    /// Complete steps until now, on all ranks as many.
    pub(super) steps: u64,
    /// Steps that were repeated because ghosts were missing.
    pub(super) repeats: u64,
    /// Factor of the margin with which the next step begins, the same on all ranks.
    pub(super) widening: f64,
    /// Time of this rank for each of its particles, in any unit that all ranks use.
    pub(super) work: f64,
    /// Steps after which domains are chosen anew; None if the imbalance decides.
    pub(super) rebalance_every: Option<u64>,
    /// Whether they are chosen anew in the next step.
    pub(super) is_stale: bool,
    /// The step in which they were chosen, how often they were, and the ghosts of all ranks in the step
    /// after that; 0 if these are not known.
    chosen: u64,
    rebalances: u64,
    usual_ghosts: f64,
}

impl Domain {
    /// What the events of a sub-step share with other ranks.
    pub(super) fn halo(&self) -> Halo<'_> {
        let Self { group, awake, is_own, shared, sent_places, ghost_places, .. } = self;
        Halo { group, total: *awake, is_own, shared, sent: sent_places, ghosts: ghost_places }
    }

    /// Whether domains are chosen in this step; the same on all ranks.
    fn is_due(&self) -> bool {
        self.is_stale || self.rebalance_every.is_some_and(|every| self.steps.is_multiple_of(every))
    }

    /// Finds out from the work of each rank and the ghosts of all whether to choose domains in the next step.
    /// All ranks have the same numbers.
    fn note_load(&mut self, work: impl Iterator<Item = f64> + Clone, ghosts: f64) {
        if self.steps == self.chosen || self.rebalance_every.is_some() {
            return;
        }
        if self.steps < self.chosen + FEWEST_STEPS {
            self.usual_ghosts = self.usual_ghosts.max(ghosts);
            return;
        }
        let (most, sum) = (work.clone().fold(0.0, f64::max), work.clone().sum::<f64>());
        let few = FEW_GHOSTS * work.count() as f64;
        self.is_stale |= most * self.received.len() as f64 > MOST_IMBALANCE * sum
            || ghosts > (MOST_GHOSTS * self.usual_ghosts).max(few);
    }

    /// Whether a row has an own particle.
    #[inline(always)]
    pub(super) fn owns(&self, row: u32) -> bool {
        (row as usize) < self.own
    }

    /// The values of own particles, from those of all places.
    pub(super) fn own_of<V>(
        &self,
        all: impl Iterator<Item = V>,
        rows: &[u32],
    ) -> impl Iterator<Item = V> {
        all.zip(rows).filter(|(_, row)| self.owns(**row)).map(|(value, _)| value)
    }

    /// The id of a row among the particles of all ranks.
    pub(super) fn id(&self, row: u32) -> Id {
        self.ids[row as usize]
    }

    /// The order of two rows in the world.
    pub(super) fn compare(&self, a: u32, b: u32) -> Ordering {
        self.ids[a as usize].cmp(&self.ids[b as usize])
    }

    /// Whether the collisions of all ranks are elastic.
    pub(super) fn is_elastic(&self) -> bool {
        self.is_elastic
    }

    /// Whether any particle of any rank has friction.
    pub(super) fn has_friction(&self) -> bool {
        self.has_friction
    }

    /// Notes how many ghosts came from each rank.
    pub(super) fn note_received(&mut self, received: Vec<usize>) {
        let ranks = (0..).zip(&received);
        self.ghost_ranks = ranks.flat_map(|(rank, &count)| repeat_n(rank, count)).collect();
        self.received = received;
        self.far.clear();
        self.own_pairs.clear();
        let len = self.ids.len();
        for column in [&mut self.digests, &mut self.ghost_pairs] {
            column.clear();
            column.resize(len, 0);
        }
        self.may_meet.clear();
        self.may_meet.resize(len, false);
    }

    /// Lists the places of own and of shared particles.
    pub(super) fn list_places(&mut self, rows: &[u32]) {
        if self.ids.len() == self.own && self.sent.iter().all(Vec::is_empty) {
            self.is_own.clear();
            self.is_own.resize(rows.len(), true);
            self.shared.clear();
            let size = self.sent.len();
            (self.sent_places, self.ghost_places) = (vec![vec![]; size], vec![vec![]; size]);
            return;
        }
        let mut places = vec![0; self.ids.len()];
        (0..).zip(rows).for_each(|(place, &row)| places[row as usize] = place);
        self.sent_places.resize(self.sent.len(), Vec::new());
        for (places_of, rows) in self.sent_places.iter_mut().zip(&self.sent) {
            places_of.clear();
            places_of.extend(rows.iter().map(|&row| places[row as usize]));
        }
        let mut ghosts = places[self.own..].iter().copied();
        let ranks = self.received.iter().map(|&count| ghosts.by_ref().take(count).collect());
        self.ghost_places = ranks.collect();
        let Self { is_own, shared, is_sent, own, .. } = self;
        is_own.clear();
        is_own.extend(rows.iter().map(|&row| (row as usize) < *own));
        shared.clear();
        let is_shared = |row: u32| is_sent.get(row as usize).is_none_or(|&is_sent| is_sent);
        shared.extend((0..).zip(rows).filter(|(_, row)| is_shared(**row)).map(|(place, _)| place));
    }

    /// Hashes of the contacts of own particles with ghosts, and of their colours, which follow from those
    /// of other contacts nearby.
    pub(super) fn digest_colours(
        &self,
        contacts: &Contacts,
        lists: &Lists,
        particles: &Particles,
        rows: &[u32],
    ) -> Vec<PairDigest> {
        let mut found = Vec::new();
        contacts.each_coloured(lists, |places, [colour, kind]| {
            let movable = places.map(|place| particles.movable[place as usize]);
            let rows = places.map(|place| rows[place as usize]);
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

    /// Adds these hashes to those of the step. A rank need not have the neighbours of its particles that
    /// are not movable, so the pairs of these are not compared.
    pub(super) fn add_pair_digests(&mut self, found: Vec<PairDigest>) {
        for PairDigest { rows: [own, ghost], movable, hash } in found {
            if movable[1] {
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

    /// What the order of solving contacts depends on, on all ranks.
    pub(super) fn shape_of_all(&self, own: ContactShape) -> Result<ContactShape> {
        let numbers = [own.colours as f64, f64::from(own.has_uneven), f64::from(own.is_serial)];
        let [colours, has_uneven, is_serial] = locked(&self.group).largest(numbers)?;
        if is_serial > 0.0 {
            let rule = "one of a distributed world may have contacts with 64 others at most";
            return Err(Error::of("radii", "those of a particle with many contacts", rule));
        }
        let colours = colours as usize;
        Ok(ContactShape { colours, has_uneven: has_uneven > 0.0, is_serial: false })
    }

    /// Writes how far own particles may get from where they are before they leave the circles that other
    /// ranks know. Those of which that is not known are noted as far.
    pub(super) fn fill_limits(
        &mut self,
        particles: &Particles,
        rows: &[u32],
        container: &Container,
        scratch: &mut StepScratch,
    ) {
        let StepScratch { limits, reaches, .. } = scratch;
        let has_sleepers = self.asleep > 0;
        limits.clear();
        self.left.clear();
        if self.sent.len() < 2 {
            limits.extend(reaches.iter().filter(|_| has_sleepers));
            return;
        }
        for ((&row, position), &reach) in rows.iter().zip(&particles.positions).zip(&*reaches) {
            let Some(of) = self.announced.get(row as usize) else {
                limits.push(f32::INFINITY);
                self.left.push(f32::INFINITY);
                continue;
            };
            let moved = if *position == of.position {
                0.0
            } else {
                let offset = [0, 1].map(|k| f64::from(position[k]) - f64::from(of.position[k]));
                let [x, y] = container.minimum_image(offset);
                (x.hypot(y) * 1.000_01) as f32
            };
            let left = of.distance - moved;
            if left < reach {
                self.far.push((row, moved + reach));
            }
            self.left.push(left);
            limits.push(if has_sleepers { left.min(reach) } else { left });
        }
    }
}

/// The particles of a rank.
#[derive(Debug)]
pub struct OwnParticles {
    /// Their number, which is that of the first rows.
    pub own: usize,
    /// The ids of all rows.
    pub ids: Vec<Id>,
    /// The number of particles of all ranks.
    pub total: usize,
    /// What this rank has sent.
    pub traffic: Traffic,
    /// Steps that were repeated because ghosts were missing.
    pub repeats: u64,
    /// How often domains were chosen.
    pub rebalances: u64,
}

impl World {
    /// Makes this world a part of a larger one, of which each rank has a part. All ranks have the same
    /// settings, walls and forces, and this rank's particles have these ids in the whole, ascending.
    pub fn distribute(&mut self, communicator: Box<dyn Communicator>, ids: Vec<Id>) -> Result<()> {
        self.check_distributable()?;
        self.wake_all();
        let mut group = Group::new(communicator);
        let total = group.sum([ids.len() as u64])?[0] as usize;
        self.domain = Some(Box::new(Domain {
            group: Mutex::new(group),
            own: ids.len(),
            ids,
            next: total as Id,
            total,
            awake: total,
            asleep: 0,
            is_still: false,
            sleeping: Vec::new(),
            foreign: Asleep::default(),
            touched: Vec::new(),
            left: Vec::new(),
            is_elastic: self.are_own_elastic(),
            has_friction: true,
            scales: Default::default(),
            extent: None,
            announced: Vec::new(),
            sent: Vec::new(),
            received: Vec::new(),
            has_contacts: false,
            resting: Vec::new(),
            sent_places: Vec::new(),
            ghost_places: Vec::new(),
            ghost_ranks: Vec::new(),
            ghost_pairs: Vec::new(),
            own_pairs: HashMap::new(),
            digests: Vec::new(),
            may_meet: Vec::new(),
            is_sent: Vec::new(),
            is_own: Vec::new(),
            shared: Vec::new(),
            far: Vec::new(),
            steps: 0,
            repeats: 0,
            widening: 1.0,
            work: 1.0,
            rebalance_every: None,
            is_stale: true,
            chosen: 0,
            rebalances: 0,
            usual_ghosts: 0.0,
        }));
        Ok(())
    }

    /// Refuses what a distributed world cannot do.
    pub fn check_distributable(&self) -> Result<()> {
        if self.settings.on_touch == OnTouch::Merge {
            let rule = "particles of different ranks do not merge";
            return Err(Error::of("on_touch", "merge", rule));
        }
        for (index, force) in self.forces.iter().enumerate() {
            let name = match force {
                Force::Thermostat(_) | Force::ThermalWalls(_) | Force::Andersen(_) => continue,
                Force::Pair(_) | Force::Flocking(_) => continue,
                Force::Attractor(_) => "an Attractor",
                Force::Gravitation(_) => "Gravitation",
                Force::Springs(_) => "Springs",
                Force::Motor(_) => "a Motor",
            };
            let rule = "a distributed world has PairForce, Flocking, Thermostat, ThermalWalls and \
                        AndersenThermostat only";
            return Err(Error::at("forces", index, name, rule));
        }
        let pairs = forces::pairs(&self.forces).count();
        if pairs <= Kinds::default().len() {
            return Ok(());
        }
        let rule = "a distributed world has two at most";
        Err(Error::of("forces", format!("of {pairs} PairForces"), rule))
    }

    /// The particles of this rank; None if the world is not distributed.
    pub fn own_particles(&self) -> Option<OwnParticles> {
        self.domain.as_ref().map(|domain| OwnParticles {
            own: domain.own,
            ids: domain.ids.clone(),
            total: domain.total,
            traffic: locked(&domain.group).traffic,
            repeats: domain.repeats,
            rebalances: domain.rebalances,
        })
    }

    /// The number of own particles, and that of all ranks.
    pub fn own_and_all(&self) -> (usize, usize) {
        match &self.domain {
            None => (self.len(), self.len()),
            Some(domain) => (domain.own, domain.total),
        }
    }

    /// The number of own particles that are awake.
    pub fn own_awake(&self) -> usize {
        self.own_and_all().0 - self.asleep.len()
    }

    /// The own particles as records, see [`read_records`]; all with their rows as ids, if the world is not
    /// distributed.
    pub fn own_records(&self) -> Vec<u8> {
        let Some(domain) = &self.domain else { return self.records_of(0..self.len()) };
        let mut bytes = Vec::with_capacity(domain.own * RECORD);
        for (place, &row) in self.rows.iter().enumerate().filter(|(_, row)| domain.owns(**row)) {
            put_record(&mut bytes, self.name_of(domain, row), &self.particles, place);
        }
        let discs = &self.asleep.sleepers().discs;
        for at in self.asleep.indices() {
            put_record(&mut bytes, self.name_of(domain, discs.rows[at]), &discs.particles, at);
        }
        bytes
    }

    /// The id and the kinds of a row, for its record.
    pub(super) fn name_of(&self, domain: &Domain, row: u32) -> (Id, Kinds) {
        (domain.id(row), forces::kinds_of(&self.forces, row as usize))
    }

    /// A world with the particles in some rows of this one, and its settings, walls, forces and time.
    pub fn part(&self, rows: Range<usize>) -> Result<Self> {
        self.of_records(&self.records_of(rows))
    }

    fn records_of(&self, rows: Range<usize>) -> Vec<u8> {
        let (all, mut bytes) = (self.particles(), Vec::new());
        let name = |row: usize| (row as Id, forces::kinds_of(&self.forces, row));
        rows.for_each(|row| put_record(&mut bytes, name(row), &all, row));
        bytes
    }

    /// A world with the settings, walls, forces and time of this one, and the particles of some records.
    pub fn of_records(&self, bytes: &[u8]) -> Result<Self> {
        let (particles, _, kinds) = read_records(bytes);
        let mut world = Self::new(particles, self.settings)?;
        world.set_walls(self.walls().to_vec())?;
        let mut forces = self.forces();
        forces::set_kinds(&mut forces, &kinds);
        world.set_forces(forces)?;
        world.set_defaults(self.defaults)?;
        world.time = self.time;
        Ok(world)
    }

    /// Tells how much time this rank needs for each of its particles, from which the next domains
    /// follow. Results do not depend on it.
    pub fn set_work(&mut self, work: f64) {
        if let Some(domain) = &mut self.domain
            && work > 0.0
            && work.is_finite()
        {
            domain.work = work;
        }
    }

    /// Chooses domains anew after so many steps, the same number on all ranks, whatever the imbalance.
    pub fn rebalance_every(&mut self, steps: u64) {
        if let Some(domain) = &mut self.domain {
            domain.rebalance_every = Some(steps.max(1));
        }
    }

    /// Chooses domains anew in the next step.
    pub(super) fn forget_domains(&mut self) {
        if let Some(domain) = &mut self.domain {
            domain.is_stale = true;
        }
    }

    /// The number of particles of all ranks that are awake.
    pub(super) fn count_of_all(&self) -> usize {
        self.domain.as_ref().map_or(self.rows.len(), |domain| domain.awake)
    }

    /// Whether something is so on any rank.
    pub(super) fn any_of_all(&self, own: bool) -> Result<bool> {
        if self.domain.is_none() { Ok(own) } else { Ok(self.sum_of_all([u64::from(own)])? != [0]) }
    }

    /// Waits for all ranks. Returns an error if one has failed.
    pub(super) fn wait_for_all(&self) -> Result<()> {
        self.sum_of_all([]).map(|[]: [u64; 0]| ())
    }

    /// The largest of each number of all ranks.
    pub(super) fn largest_of_all<const N: usize>(&self, own: [f64; N]) -> Result<[f64; N]> {
        match &self.domain {
            None => Ok(own),
            Some(domain) => locked(&domain.group).largest(own),
        }
    }

    /// The sum of each number of all ranks.
    pub(super) fn sum_of_all<const N: usize>(&self, own: [u64; N]) -> Result<[u64; N]> {
        match &self.domain {
            None => Ok(own),
            Some(domain) => locked(&domain.group).sum(own),
        }
    }

    /// The AABB of the centres of all ranks; None if the world is not distributed.
    pub(super) fn extent_of_all(&mut self) -> Result<Option<[[f32; 2]; 2]>> {
        let Some(domain) = &mut self.domain else { return Ok(None) };
        if let Some(known) = domain.extent.take() {
            return Ok(Some(known));
        }
        let [right, bottom, left, top] = self.farthest()?.map(|v| v as f32);
        Ok(Some([[-left, -top], [right, bottom]]))
    }

    /// The largest x, y, −x and −y of all centres.
    pub(super) fn farthest(&self) -> Result<[f64; 4]> {
        let mut most = [f32::MIN; 4];
        let mut take = |&[x, y]: &[f32; 2]| {
            most = [most[0].max(x), most[1].max(y), most[2].max(-x), most[3].max(-y)];
        };
        match &self.domain {
            None => self.particles.positions.iter().for_each(take),
            Some(domain) => {
                domain.own_of(self.particles.positions.iter(), &self.rows).for_each(&mut take);
            }
        }
        self.largest_of_all(most.map(f64::from))
    }

    /// Removes the ghosts.
    pub fn drop_ghosts(&mut self) {
        self.keep_resting();
        let Self { domain, particles, rows, persistent, contacts, ids, .. } = self;
        let (wall_impulses, forces) = (&mut self.wall_impulses, &mut self.forces);
        let Some(domain) = domain else { return };
        let own = domain.own;
        if domain.ids.len() > own {
            let awake = rows.iter().filter(|&&row| domain.owns(row)).count();
            let mut end = rows.len();
            for place in 0..awake {
                if domain.owns(rows[place]) {
                    continue;
                }
                // The last places go to those of ghosts.
                end -= 1;
                while !domain.owns(rows[end]) {
                    end -= 1;
                }
                particles.move_row(end, place);
                persistent.move_row(end, place);
                rows[place] = rows[end];
            }
            particles.resize(awake);
            persistent.resize(awake);
            rows.truncate(awake);
            domain.ids.truncate(own);
            forces::change_kinds(forces, |kinds| kinds.truncate(own));
            wall_impulses.retain(|of| (of.row as usize) < own);
            *ids = Ids::of_rows(own);
        }
        contacts.forget();
        self.forget_places();
    }

    /// Adds particles of other ranks after the own ones, as own ones or as ghosts.
    pub(super) fn append_records(&mut self, bytes: &[Vec<u8>], are_own: bool) {
        let Self { domain, particles, rows, persistent, ids, forces, .. } = self;
        let Some(domain) = domain else { return };
        let first = domain.ids.len();
        for bytes in bytes {
            let (new, new_ids, new_kinds) = read_records(bytes);
            particles.extend(&new);
            domain.ids.extend(new_ids);
            forces::add_kinds(forces, &new_kinds);
        }
        let len = domain.ids.len();
        rows.extend(first as u32..len as u32);
        persistent.resize(rows.len());
        *ids = Ids::of_rows(len);
        if are_own {
            domain.own = len;
        }
        self.forget_places();
    }

    /// Moves particles to the ranks of their domains, if it is time, and finds out what their properties
    /// require. There must be no ghosts.
    pub(super) fn move_to_domains(&mut self) -> Result<()> {
        let is_due = self.domain.as_ref().is_some_and(|domain| domain.is_due());
        if is_due {
            self.rebalance()?;
        }
        self.sum_up_ranks()?;
        // All ranks have done it, or none.
        if let Some(domain) = &mut self.domain
            && is_due
        {
            (domain.is_stale, domain.chosen, domain.usual_ghosts) = (false, domain.steps, 0.0);
            domain.rebalances += 1;
        }
        Ok(())
    }

    /// Finds out what the particles that are awake require on all ranks, and how many these are.
    pub(super) fn sum_up_ranks(&mut self) -> Result<()> {
        let has_friction = self.particles.spins.iter().any(|spin| spin.friction > 0.0);
        let moving = (0..self.rows.len()).any(|place| !self.particles.is_static(place));
        let flags = [!self.are_own_elastic(), has_friction, moving].map(u64::from);
        let counts = [self.rows.len(), self.asleep.len()].map(|count| count as u64);
        let own = [flags[0], flags[1], flags[2], counts[0], counts[1]];
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let load =
            [domain.work * self.rows.len() as f64, domain.received.iter().sum::<usize>() as f64]
                .map(f64::to_bits);
        let all = locked(&domain.group)
            .gather([own[0], own[1], own[2], own[3], own[4], load[0], load[1]])?;
        let sum = |k: usize| all.iter().map(|of| of[k]).sum::<u64>();
        let [inelastic, frictions, moving, awake, asleep] = [0, 1, 2, 3, 4].map(sum);
        let loads = |k: usize| all.iter().map(move |of| f64::from_bits(of[k]));
        domain.note_load(loads(5), loads(6).sum());
        (domain.is_elastic, domain.has_friction) = (inelastic == 0, frictions > 0);
        (domain.awake, domain.asleep) = (awake as usize, asleep as usize);
        domain.is_still = asleep > 0 && moving == 0;
        if frictions > 0 {
            self.particles.spins_mut();
        }
        Ok(())
    }
}

/// Whether a row is one of this rank, and no ghost.
#[inline(always)]
pub(super) fn owns(domain: &Option<Box<Domain>>, row: u32) -> bool {
    domain.as_ref().is_none_or(|domain| domain.owns(row))
}
