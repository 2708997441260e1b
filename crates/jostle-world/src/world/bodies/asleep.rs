//! Sleeping islands, apart from the columns that a step works on.
//!
//! An island that falls asleep is appended. One that wakes is only marked; the marked ones are
//! removed when they are more than half. So both cost as much as the island is large. Trees over
//! ranges of the particles find those that others touch. The tree of a new range takes in those
//! before that are not much larger, so there are few (the logarithmic method: J. L. Bentley and J. B. Saxe,
//! *Decomposable Searching Problems I*, Journal of Algorithms 1, 1980).

use std::iter;
use std::ops::Range;

use super::discs::Discs;
use crate::contacts::Contact;
use crate::particles::Particles;
use crate::resting::WallImpulse;
use crate::world::search::MAX_CANDIDATES;
use crate::world::settings::WorldSettings;
use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::saved;
use jostle_base::settings::{Method, Settings};
use jostle_base::table::Table;
use jostle_index::pairs::{self, Filters, JoinScratch};
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::{Each, Shapes, fill_filters};

/// Where the parts of an island are in the columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Island {
    pub(crate) particles: Range<u32>,
    pub(crate) contacts: Range<u32>,
    pub(crate) wall_impulses: Range<u32>,
    /// In a distributed world the smallest id of all its particles, some of which may be on other
    /// processes; otherwise 0.
    pub(crate) name: Id,
}

/// Islands with all that they need to continue when they wake.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sleepers {
    pub(crate) discs: Discs,
    /// Those of the last step in which they were awake. Their indices are rows: the other
    /// particle may be immovable, and is awake then.
    pub(crate) contacts: Vec<Contact>,
    /// Those of that step.
    pub(crate) wall_impulses: Vec<WallImpulse>,
    pub(crate) islands: Vec<Island>,
}

saved! { struct Island { particles, contacts, wall_impulses; name } }
saved! { struct Sleepers { discs, contacts, wall_impulses, islands } }

impl Sleepers {
    /// Number of particles.
    fn len(&self) -> usize {
        self.discs.rows.len()
    }

    /// Replaces the contacts by those of each island, which are sorted by islands.
    pub(crate) fn set_contacts(&mut self, of_islands: Vec<(u32, Contact)>) -> Result<()> {
        let mut end = 0;
        for (number, island) in (0..).zip(&mut self.islands) {
            island.contacts = run(&of_islands, end, number);
            end = island.contacts.end;
        }
        self.contacts = memory::collect(of_islands.into_iter().map(|(_, contact)| contact))?;
        Ok(())
    }

    /// Reserves memory for those of `other` in addition.
    fn reserve(&mut self, other: &Self) -> Result<()> {
        let len = self.len() + other.len();
        self.discs.reserve(&other.discs, len)?;
        memory::reserve(&mut self.contacts, other.contacts.len())?;
        memory::reserve(&mut self.wall_impulses, other.wall_impulses.len())?;
        memory::reserve(&mut self.islands, other.islands.len())
    }

    /// Appends islands.
    fn extend(&mut self, other: &Self) {
        let moved = |range: &Range<u32>, by: usize| range.start + by as u32..range.end + by as u32;
        let Self { contacts, wall_impulses, .. } = &*self;
        let [first, first_contact, first_impulse] =
            [self.len(), contacts.len(), wall_impulses.len()];
        self.islands.extend(other.islands.iter().map(|island| Island {
            particles: moved(&island.particles, first),
            contacts: moved(&island.contacts, first_contact),
            wall_impulses: moved(&island.wall_impulses, first_impulse),
            name: island.name,
        }));
        self.discs.append(first, &other.discs, other.len());
        self.contacts.extend_from_slice(&other.contacts);
        self.wall_impulses.extend_from_slice(&other.wall_impulses);
    }

    /// A copy of some islands.
    fn select(&self, islands: impl Iterator<Item = u32>) -> Result<Self> {
        let mut copy = Self::default();
        let mut order = Vec::new();
        let range = |range: &Range<u32>| range.start as usize..range.end as usize;
        for island in islands.map(|number| &self.islands[number as usize]) {
            let starts = [order.len(), copy.contacts.len(), copy.wall_impulses.len()];
            memory::extend(&mut order, island.particles.clone())?;
            memory::append(&mut copy.contacts, &self.contacts[range(&island.contacts)])?;
            let impulses = &self.wall_impulses[range(&island.wall_impulses)];
            memory::append(&mut copy.wall_impulses, impulses)?;
            let ends = [order.len(), copy.contacts.len(), copy.wall_impulses.len()];
            let [particles, contacts, wall_impulses] =
                [0, 1, 2].map(|k| starts[k] as u32..ends[k] as u32);
            let island = Island { particles, contacts, wall_impulses, name: island.name };
            memory::push(&mut copy.islands, island)?;
        }
        copy.discs = self.discs.gathered(&order)?;
        copy.discs.drop_defaults();
        Ok(copy)
    }
}

/// The range of the values of one island, from `start` on, in a list sorted by islands.
pub(crate) fn run<V>(all: &[(u32, V)], start: u32, island: u32) -> Range<u32> {
    let values = all[start as usize..].iter().take_while(|value| value.0 == island);
    start..start + values.count() as u32
}

/// The tree of the circles of some particles.
#[derive(Debug)]
struct Layer {
    /// The number of the first particle.
    first: usize,
    tree: Quadtree<f32>,
}

/// All sleeping islands.
#[derive(Debug, Default)]
pub(crate) struct Asleep {
    /// With islands that are awake, but not removed yet.
    sleepers: Sleepers,
    /// The island of each particle.
    island_of: Vec<u32>,
    /// Whether each island is awake.
    is_awake: Vec<bool>,
    /// The number of particles of islands that are awake.
    awake: usize,
    /// The islands that have been woken since the last call of [`Asleep::forget_woken`].
    woken: Vec<u32>,
    layers: Vec<Layer>,
}

impl Saved for Asleep {
    fn put(&self, to: &mut Writer) {
        match self.copy() {
            Ok(copy) => copy.put(to),
            Err(error) => to.fail(error),
        }
    }
    /// Only the columns; [`Asleep::rebuilt`] has the rest.
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        Ok(Self { sleepers: Saved::get(from)?, ..Self::default() })
    }
}

impl Asleep {
    /// All that follows from the columns, of which no island is awake.
    pub(crate) fn rebuilt(&self, settings: Settings) -> Result<Self> {
        let mut all = Self::default();
        if !self.sleepers.islands.is_empty() {
            all.append(&self.sleepers, settings)?;
        }
        Ok(all)
    }

    /// Number of sleeping particles.
    pub(crate) fn len(&self) -> usize {
        self.sleepers.len() - self.awake
    }

    /// Whether no particle sleeps.
    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The columns, also of islands that are awake.
    pub(crate) fn sleepers(&self) -> &Sleepers {
        &self.sleepers
    }

    /// The numbers of the sleeping islands.
    pub(crate) fn islands(&self) -> impl Iterator<Item = u32> + '_ {
        (0..).zip(&self.is_awake).filter(|(_, is_awake)| !**is_awake).map(|(island, _)| island)
    }

    /// The indices of the sleeping particles in the columns.
    pub(crate) fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        let range = |island: u32| self.sleepers.islands[island as usize].particles.clone();
        self.islands().flat_map(range).map(|at| at as usize)
    }

    /// The trees of the particles, also of those of islands that are awake, and the index in the columns of the
    /// first of each.
    pub(crate) fn trees(&self) -> impl ExactSizeIterator<Item = (&Quadtree<f32>, usize)> {
        self.layers.iter().map(|layer| (&layer.tree, layer.first))
    }

    /// The row of the particle with an index in the columns; None if it is awake.
    pub(crate) fn row(&self, at: usize) -> Option<u32> {
        let is_awake = self.is_awake[self.island_of[at] as usize];
        (!is_awake).then(|| self.sleepers.discs.rows[at])
    }

    /// The rows of the sleeping particles.
    pub(crate) fn rows(&self) -> impl Iterator<Item = u32> + '_ {
        self.indices().map(|at| self.sleepers.discs.rows[at])
    }

    /// The contacts of the sleeping particles; their indices are rows.
    pub(crate) fn contacts(&self) -> impl Iterator<Item = &Contact> {
        let range = |island: u32| self.sleepers.islands[island as usize].contacts.clone();
        self.islands().flat_map(range).map(|at| &self.sleepers.contacts[at as usize])
    }

    /// The impulses that walls gave to the sleeping particles.
    pub(crate) fn wall_impulses(&self) -> impl Iterator<Item = &WallImpulse> {
        let range = |island: u32| self.sleepers.islands[island as usize].wall_impulses.clone();
        self.islands().flat_map(range).map(|at| &self.sleepers.wall_impulses[at as usize])
    }

    /// A copy of the sleeping islands.
    pub(crate) fn copy(&self) -> Result<Sleepers> {
        self.sleepers.select(self.islands())
    }

    /// Appends islands that fall asleep. If there is an error, nothing changes.
    pub(crate) fn append(&mut self, new: &Sleepers, settings: Settings) -> Result<()> {
        let end = self.sleepers.len() + new.len();
        let mut first = self.sleepers.len();
        // The new tree takes in every layer at the end that has at most twice as many particles. So
        // each layer is more than twice as large as the one after it, and there are O(log n) of
        // them. A layer that is taken in grows by half at least, so a particle is in O(log n)
        // builds.
        let mut kept = self.layers.len();
        while kept > 0 && self.layers[kept - 1].tree.len() <= 2 * (end - first) {
            kept -= 1;
            first = self.layers[kept].first;
        }
        let (old, added) = (&self.sleepers.discs.particles, &new.discs.particles);
        let Particles { positions, radii, .. } = old;
        let mut centers = memory::with_capacity(end - first)?;
        centers.extend_from_slice(&positions[first..]);
        centers.extend_from_slice(&added.positions);
        let mut all_radii = memory::with_capacity(end - first)?;
        all_radii.extend_from_slice(&radii[first..]);
        all_radii.extend_from_slice(&added.radii);
        let radii = Each::Rows(all_radii);
        let mut shapes = Shapes::circles(centers, radii)?;
        if !old.filters.is_empty() || !added.filters.is_empty() {
            let filter = |at: usize| match at.checked_sub(old.len()) {
                None => old.filter(at),
                Some(at) => added.filter(at),
            };
            fill_filters((first..end).map(filter), shapes.columns_mut().filters)?;
        }
        let tree = Quadtree::new(&shapes, settings)?;
        self.sleepers.reserve(new)?;
        memory::reserve(&mut self.island_of, new.len())?;
        memory::reserve(&mut self.is_awake, new.islands.len())?;
        // Shapes and tree may fail, so nothing has changed before this line.
        self.layers.truncate(kept);
        self.layers.push(Layer { first, tree });
        for island in &new.islands {
            let number = self.is_awake.len() as u32;
            self.island_of.extend(iter::repeat_n(number, island.particles.len()));
            self.is_awake.push(false);
        }
        self.sleepers.extend(new);
        Ok(())
    }

    /// Lists in `islands`, ascending, the islands of which a particle overlaps one of some circles.
    /// The circles are those in a tree, each with the radius that `radius` returns for its row if that
    /// is smaller; None leaves a circle out. If there are too many pairs to list, all islands are
    /// listed.
    pub(crate) fn touched(
        &self,
        circles: &Quadtree<f32>,
        radius: impl Fn(u32) -> Option<f32>,
        settings: &WorldSettings,
        (join, islands): (&mut JoinScratch, &mut Vec<u32>),
    ) -> Result<()> {
        islands.clear();
        // Both signs of each offset: half of the images are enough for pairs within one tree, but
        // here the two trees differ.
        let images =
            settings.container.period().half_of_images().flat_map(|[x, y]| [[x, y], [-x, -y]]);
        for image in iter::once([0.0; 2]).chain(images) {
            for Layer { first, tree } in &self.layers {
                let max = MAX_CANDIDATES;
                let found = match settings.method {
                    Method::Quadtree => {
                        pairs::indices_between(circles, tree, image, Filters::Apply, max, join)
                    }
                    Method::Brute => {
                        let [circles, others] = [circles, tree].map(Quadtree::columns);
                        pairs::brute_between(circles, others, image, Filters::Apply, max)
                    }
                };
                // To wake too many islands is always right, because a step of particles that are
                // awake needs no list of sleeping ones. So too many pairs are no error here.
                let found = match found {
                    Err(Error::TooManyPairs { .. }) => {
                        islands.clear();
                        return memory::extend(islands, self.islands());
                    }
                    other => other?,
                };
                // The circles of the tree are bounds, whose sizes depend on the speeds of all
                // particles. The smaller circle depends on its own particle alone. So what wakes
                // follows from what is near.
                let overlaps = |pair: &&[u32; 2]| {
                    let Some(radius) = radius(circles.rows()[pair[0] as usize]) else {
                        return false;
                    };
                    let [own, other] = [(circles, pair[0]), (tree, pair[1])]
                        .map(|(tree, index)| tree.columns().shape(index as usize));
                    let [x, y] = [0, 1].map(|k| other.min[k] - own.min[k] + image[k]);
                    let limit = radius + other.radius;
                    x * x + y * y < limit * limit
                };
                let new = found.pairs.iter().filter(overlaps);
                let new =
                    new.map(|pair| self.island_of[first + tree.rows()[pair[1] as usize] as usize]);
                // Islands that are awake stay in the layers until they are removed.
                memory::extend(islands, new.filter(|&island| !self.is_awake[island as usize]))?;
                join.keep(found.pairs);
            }
        }
        islands.sort_unstable();
        islands.dedup();
        Ok(())
    }

    /// The islands that touch one of some rows, which are sorted; ascending.
    pub(crate) fn islands_touching(&self, rows: &[u32]) -> Result<Vec<u32>> {
        let touches = |&island: &u32| {
            let Range { start, end } = self.sleepers.islands[island as usize].contacts.clone();
            let contacts = &self.sleepers.contacts[start as usize..end as usize];
            contacts
                .iter()
                .flat_map(|contact| contact.indices)
                .any(|row| rows.binary_search(&row).is_ok())
        };
        let mut islands = Vec::new();
        memory::extend(&mut islands, self.islands().filter(touches))?;
        Ok(islands)
    }

    /// The names of some islands.
    pub(crate) fn names(&self, islands: &[u32]) -> impl Iterator<Item = Id> {
        islands.iter().map(|&island| self.sleepers.islands[island as usize].name)
    }

    /// The sleeping islands with some names, which are sorted; ascending.
    pub(crate) fn named(&self, names: &[Id]) -> Result<Vec<u32>> {
        let name = |island: u32| self.sleepers.islands[island as usize].name;
        let is_named = |&island: &u32| names.binary_search(&name(island)).is_ok();
        let mut islands = Vec::new();
        memory::extend(&mut islands, self.islands().filter(is_named))?;
        Ok(islands)
    }

    /// The islands of the particles with some indices, ascending.
    pub(crate) fn islands_of(&self, indices: impl Iterator<Item = usize>) -> Result<Vec<u32>> {
        let mut islands = Vec::new();
        memory::extend(&mut islands, indices.map(|at| self.island_of[at]))?;
        islands.sort_unstable();
        islands.dedup();
        Ok(islands)
    }

    /// Copies of some islands.
    pub(crate) fn select(&self, islands: impl Iterator<Item = u32>) -> Result<Sleepers> {
        self.sleepers.select(islands)
    }

    /// Reserves memory for [`Asleep::wake`] of so many islands.
    pub(crate) fn reserve_waking(&mut self, count: usize) -> Result<()> {
        memory::reserve(&mut self.woken, count)
    }

    /// Wakes islands and returns a copy of them.
    pub(crate) fn wake(&mut self, islands: &[u32]) {
        // Nothing is removed: if the step fails, `cancel_waking` only takes back the marks.
        self.mark(islands.iter().copied(), true);
        self.woken.extend_from_slice(islands);
    }

    /// The rows of the islands that have been woken, sorted.
    pub(crate) fn woken_rows(&self) -> impl Iterator<Item = u32> {
        let islands = self.woken.iter().map(|&island| &self.sleepers.islands[island as usize]);
        let indices = islands.flat_map(|island| island.particles.clone());
        indices.map(|at| self.sleepers.discs.rows[at as usize])
    }

    /// Removes the last islands again, of which there are so many, because the step is undone.
    pub(crate) fn withdraw(&mut self, count: usize) {
        let end = self.is_awake.len() as u32;
        // The last islands are those that the step has appended.
        self.mark(end - count as u32..end, true);
    }

    /// Puts the islands that have been woken to sleep again.
    pub(crate) fn cancel_waking(&mut self) {
        let woken = std::mem::take(&mut self.woken);
        self.mark(woken.into_iter(), false);
    }

    fn mark(&mut self, islands: impl Iterator<Item = u32>, is_awake: bool) {
        for island in islands {
            let count = self.sleepers.islands[island as usize].particles.len();
            self.is_awake[island as usize] = is_awake;
            self.awake = if is_awake { self.awake + count } else { self.awake - count };
        }
    }

    /// Makes waking final. Removes the islands that are awake if they are more than half.
    pub(crate) fn forget_woken(&mut self) {
        self.woken.clear();
        // A removal copies all islands that sleep. It waits until more than half of the particles
        // are awake, so its cost is in proportion to the number of particles that have been woken.
        if 2 * self.awake <= self.sleepers.len() {
            return;
        }
        let mut rest = Self::default();
        let settings =
            self.layers.first().map_or(Settings::default(), |layer| layer.tree.settings());
        // If the tree cannot be built, they are removed later.
        let append = |rest: &mut Self| rest.append(&self.copy()?, settings);
        if self.is_empty() || append(&mut rest).is_ok() {
            *self = rest;
        }
    }

    /// Renumbers the rows.
    pub(crate) fn renumber(&mut self, new: &[u32]) {
        let Sleepers { discs: Discs { rows, .. }, contacts, wall_impulses, .. } =
            &mut self.sleepers;
        // Of islands that are awake, rows may be gone. Nothing reads them.
        let renumber = |row: &mut u32| *row = new.get(*row as usize).copied().unwrap_or(0);
        rows.iter_mut().for_each(renumber);
        contacts.iter_mut().flat_map(|contact| &mut contact.indices).for_each(renumber);
        wall_impulses.iter_mut().for_each(|impulse| renumber(&mut impulse.row));
    }
}
