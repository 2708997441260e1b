//! Trees over parts of a space: shapes that change often are in small trees, others in large
//! ones. The caller does not have to say which shapes change.
//!
//! A shape that changes leaves its tree and becomes *fresh*; its old copy in the tree is ignored.
//! Fresh shapes are built into a tree of their own. Other trees are merged into it only if there
//! would be too many of about its size, or if most shapes have left a tree. So a tree of shapes
//! that do not change is not rebuilt while others move.
//!
//! J. L. Bentley and J. B. Saxe, *Decomposable Searching Problems I: Static-to-Dynamic
//! Transformation*, Journal of Algorithms 1 (1980), for trees of growing sizes that are merged.

use std::mem;

use super::slots::Slots;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::Pulse;
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::{Bounds, Scalar};
use jostle_index::pairs::{self, Filters, JoinScratch};
use jostle_index::period::Period;
use jostle_index::quadtree::Quadtree;
use jostle_index::shapes::Shapes;

/// Pairs converted between two checks for an interruption.
const CHUNK: usize = 1 << 14;

/// Instead of a layer: there is no shape in the slot.
const NO_SHAPE: u8 = u8::MAX;

/// Instead of a layer: the shape is in none.
const FRESH: u8 = u8::MAX - 1;

/// Maximum number of layers up to [`RATIO`] times as large as a new one, with the new one.
const MAX_SIMILAR: usize = 4;

/// Layers are similar in size up to this factor. So there are at most [`MAX_SIMILAR`] layers for
/// each factor of this in size, and 64 layers in all.
const RATIO: usize = 4;

/// Minimum leaf capacity of a layer. The capacity is that of the settings times the layer's share
/// of all shapes: so the leaves of all layers are about equally wide, and a leaf overlaps few
/// leaves of another layer.
const MIN_LEAF_CAPACITY: usize = 2;

/// If at most one of this number of shapes has not left a layer, the next layer of about its size
/// has leaves [`LARGER`] times as large. It is built and searched for pairs faster, and queries
/// take about as long.
const SHORT_LIVED: usize = 16;

/// Factor of the leaf capacity of layers that most shapes leave soon.
const LARGER: usize = 3;

/// A tree over some slots.
#[derive(Clone, Debug, Default)]
struct Layer<T> {
    tree: Quadtree<T>,
    /// The slot of each row of the tree.
    slots: Vec<u32>,
    /// Number of these slots whose shapes have not left the layer.
    len: usize,
}

impl<T: Scalar> Layer<T> {
    /// Whether no shape has left it.
    fn is_complete(&self) -> bool {
        self.len == self.slots.len()
    }

    /// The slot of the shape at an index of the tree.
    #[inline(always)]
    fn slot_at(&self, index: u32) -> u32 {
        self.slots[self.tree.rows()[index as usize] as usize]
    }
}

/// Settings for a tree of some of all shapes.
///
/// Leaves of all trees cover about equal areas. With the same number of shapes in each leaf those of a small tree would
/// be so wide that each overlaps most leaves of the large ones.
pub(super) fn fitting(settings: Settings, some: usize, all: usize) -> Settings {
    let fitting = settings.leaf_capacity.saturating_mul(some) / all;
    Settings { leaf_capacity: fitting.max(MIN_LEAF_CAPACITY), ..settings }
}

/// Every shape of a space, in one layer or fresh.
#[derive(Clone, Debug)]
pub(super) struct Layers<T> {
    /// Some may be empty, because slots refer to layers by their indices.
    layers: Vec<Layer<T>>,
    /// The index of the layer of each slot, [`FRESH`] or [`NO_SHAPE`].
    layer_of: Vec<u8>,
    /// Slots of shapes that became fresh after the last layer was built; some may be fresh no
    /// longer.
    fresh: Vec<u32>,
    /// Whether each slot is in `fresh`.
    listed: Vec<bool>,
    /// Number of slots in `fresh` whose shapes are still fresh.
    fresh_len: usize,
    shapes: Shapes<T>,
}

impl<T: Scalar> Layers<T> {
    /// No layers, of shapes in a plane with this period.
    pub(super) fn of(period: Period<T>) -> Self {
        Self {
            layers: Vec::new(),
            layer_of: Vec::new(),
            fresh: Vec::new(),
            listed: Vec::new(),
            fresh_len: 0,
            shapes: Shapes::none_in(period),
        }
    }

    /// Increases the number of slots to `slots`.
    pub(super) fn widen(&mut self, slots: usize) -> Result<()> {
        memory::lengthen(&mut self.layer_of, slots, NO_SHAPE)?;
        memory::lengthen(&mut self.listed, slots, false)
    }

    /// Reserves memory for `more` fresh shapes.
    pub(super) fn reserve_fresh(&mut self, more: usize) -> Result<()> {
        memory::reserve(&mut self.fresh, more)
    }

    /// Removes a new or a changed shape from its layer.
    pub(super) fn freshen(&mut self, slot: u32) {
        // Its copy in the tree stays, since a tree cannot lose a shape. `layer_of` no longer names
        // that layer, so whoever finds the copy ignores it (`is_in`).
        self.leave(slot);
        self.layer_of[slot as usize] = FRESH;
        self.fresh_len += 1;
        if !mem::replace(&mut self.listed[slot as usize], true) {
            self.fresh.push(slot);
        }
    }

    /// Removes a shape.
    pub(super) fn remove(&mut self, slot: u32) {
        self.leave(slot);
        self.layer_of[slot as usize] = NO_SHAPE;
    }

    fn leave(&mut self, slot: u32) {
        let index = self.layer_of[slot as usize];
        if index == FRESH {
            self.fresh_len -= 1;
        } else if let Some(layer) = self.layers.get_mut(usize::from(index)) {
            layer.len -= 1;
        }
    }

    /// Whether there is a shape in `slot`.
    pub(super) fn has(&self, slot: u32) -> bool {
        self.layer_of[slot as usize] != NO_SHAPE
    }

    /// Whether the shape in `slot` is fresh.
    fn is_fresh(&self, slot: u32) -> bool {
        self.layer_of[slot as usize] == FRESH
    }

    /// Number of fresh shapes.
    pub(super) fn fresh_len(&self) -> usize {
        self.fresh_len
    }

    /// As [`fresh_len`](Self::fresh_len), with slots that are no longer fresh.
    pub(super) fn fresh_listed(&self) -> usize {
        self.fresh.len()
    }

    /// The slots of the fresh shapes.
    pub(super) fn fresh(&self) -> impl Iterator<Item = u32> {
        self.fresh.iter().copied().filter(|&slot| self.is_fresh(slot))
    }

    /// The tree of a layer, and a function that returns the slot of a row of it; None if the shape
    /// has left the layer.
    pub(super) fn layer(&self, index: usize) -> (&Quadtree<T>, impl Fn(u32) -> Option<u32> + Sync) {
        let Layer { tree, slots, .. } = &self.layers[index];
        let slot = move |row: u32| {
            let slot = slots[row as usize];
            self.is_in(slot, index).then_some(slot)
        };
        (tree, slot)
    }

    /// Indices of the layers with shapes.
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> {
        (0..self.layers.len()).filter(|&index| self.layers[index].len > 0)
    }

    /// The bounds of all shapes; none if there are none.
    pub(super) fn bounds(&self, slots: &Slots<T>) -> Option<Bounds<T>> {
        let layers = self.indices().filter_map(|index| self.layers[index].tree.bounds().first());
        let fresh = self.fresh().map(|slot| Bounds::of(&slots.shape(slot)));
        layers.copied().chain(fresh).reduce(Bounds::join)
    }

    /// Whether the shape in a slot is in a layer.
    #[inline(always)]
    fn is_in(&self, slot: u32, layer: usize) -> bool {
        usize::from(self.layer_of[slot as usize]) == layer
    }

    /// The layer that contains all shapes in these slots; None if there is none, or it has many
    /// others.
    pub(super) fn common_layer(&self, slots: &[u32]) -> Option<usize> {
        // A query before the update may have built a layer of just the shapes that changed. Then no
        // other is needed.
        let index = usize::from(self.layer_of[*slots.first()? as usize]);
        let layer = self.layers.get(index)?;
        let together = slots.iter().all(|&slot| self.is_in(slot, index));
        (together && layer.len <= RATIO * slots.len()).then_some(index)
    }

    /// Builds a layer of all fresh shapes and returns its index; None if no shape is fresh. After
    /// an error the shapes of all layers that were to be merged are fresh.
    pub(super) fn fold(&mut self, slots: &Slots<T>, settings: Settings) -> Result<Option<usize>> {
        // How layers stay few and cheap:
        //
        // Each update makes one new layer, of the shapes that changed. It is merged with older ones
        // only if there are already four of at most four times its size. So a shape that stays
        // where it is takes part in a merge a number of times that grows with the logarithm of the
        // number of shapes, as in Bentley and Saxe's method. A shape that changes in each update is
        // in a small layer, and costs nothing to the others.
        //
        // A layer that most of its shapes have left is merged, too: its tree is searched for copies
        // that are ignored.
        let mut rows = self.take_fresh();
        let any = !rows.is_empty();
        let old = match self.absorb(&mut rows) {
            Ok(old) => old,
            Err(error) => return Err(self.undo(rows, error)),
        };
        let built = self.build(old, rows, slots, settings)?;
        Ok(built.filter(|_| any))
    }

    /// Adds the shapes of the layers that are merged into a new one of `rows`; returns the
    /// largest of these layers, whose memory is reused.
    fn absorb(&mut self, rows: &mut Vec<u32>) -> Result<Layer<T>> {
        let mut old = Layer::default();
        // With more rows further layers are small compared to the new one, so the choice is
        // repeated until it adds none.
        loop {
            let absorbed = self.to_absorb(rows.len());
            if absorbed.is_empty() {
                return Ok(old);
            }
            for index in absorbed {
                memory::reserve(rows, self.layers[index].len)?;
                let layer = mem::take(&mut self.layers[index]);
                if layer.len > 0 {
                    let current = layer.slots.iter().filter(|&&slot| self.is_in(slot, index));
                    rows.extend(current);
                }
                // The memory of the largest one serves for the new tree. In a steady state no
                // update allocates.
                if layer.slots.len() > old.slots.len() {
                    old = layer;
                }
            }
        }
    }

    /// Marks all `rows`, which have left their layers, as fresh.
    fn undo(&mut self, rows: Vec<u32>, error: Error) -> Error {
        // Nothing is lost: these shapes are in no layer any more, but fresh, and the next fold
        // takes them. Queries test fresh shapes one by one, so all answers stay right meanwhile.
        for &slot in &rows {
            self.layer_of[slot as usize] = FRESH;
            self.listed[slot as usize] = true;
        }
        self.fresh_len = rows.len();
        self.fresh = rows;
        error
    }

    /// Puts the shapes in `chosen` into one layer and all others into another.
    pub(super) fn part(
        &mut self,
        chosen: &[u32],
        slots: &Slots<T>,
        settings: Settings,
    ) -> Result<Option<usize>> {
        // The limit on pairs counts what a join of trees finds, with copies that are ignored and
        // pairs of unchanged shapes. With the changed shapes in one layer and all others in another
        // it counts exactly the pairs that are reported. It costs two new trees, so it is done only
        // if the limit was exceeded.
        let mut is_rest: Vec<bool> =
            memory::collect(self.layer_of.iter().map(|&layer| layer != NO_SHAPE))?;
        let mut all: Vec<u32> = memory::with_capacity(slots.len())?;
        let present = (0..).zip(&is_rest).filter(|(_, present)| **present);
        all.extend(present.map(|(slot, _)| slot));
        chosen.iter().for_each(|&slot| is_rest[slot as usize] = false);
        let mut rest: Vec<u32> = memory::with_capacity(slots.len() - chosen.len())?;
        rest.extend(all.iter().filter(|slot| is_rest[**slot as usize]));
        let chosen = memory::collect(chosen.iter().copied())?;
        // A failure from here on leaves all of them fresh.
        // The list is emptied; every shape is in one of the two lists made above.
        self.take_fresh();
        self.layers.clear();
        if let Err(error) = self.build(Layer::default(), rest, slots, settings) {
            return Err(self.undo(all, error));
        }
        let front = self.build(Layer::default(), chosen, slots, settings);
        front.map_err(|error| {
            self.layers.clear();
            self.undo(all, error)
        })
    }

    fn take_fresh(&mut self) -> Vec<u32> {
        let mut rows = mem::take(&mut self.fresh);
        rows.iter().for_each(|&slot| self.listed[slot as usize] = false);
        // Some have been removed since. The list is not searched at each removal.
        if self.fresh_len < rows.len() {
            rows.retain(|&slot| self.is_fresh(slot));
        }
        rows
    }

    /// The layers that are merged into a new one of `len` shapes.
    fn to_absorb(&self, len: usize) -> Vec<usize> {
        let used = |index: &usize| !self.layers[*index].slots.is_empty();
        let all = || (0..self.layers.len()).filter(used);
        let similar = |index: &usize| self.layers[*index].slots.len() <= RATIO * len;
        let crowded = len > 0 && all().filter(similar).count() >= MAX_SIMILAR;
        let outdated =
            |index: &usize| 2 * self.layers[*index].len < self.layers[*index].slots.len();
        all().filter(|index| outdated(index) || crowded && similar(index)).collect()
    }

    /// Builds a layer of `rows` in the memory of an old one. After an error they are fresh.
    fn build(
        &mut self,
        mut old: Layer<T>,
        rows: Vec<u32>,
        slots: &Slots<T>,
        settings: Settings,
    ) -> Result<Option<usize>> {
        if rows.is_empty() {
            return Ok(None);
        }
        // Memory is freed if much more is allocated than needed.
        if old.slots.len() > RATIO * rows.len() {
            old = Layer::default();
        }
        // Shapes probably leave this layer as soon as the one that it replaces.
        // The past predicts the future: if nearly all shapes had left the layer that this one
        // replaces, the new one will be left as soon. Then its construction counts more than
        // queries of it: with larger leaves an update of 100,000 moving discs takes 4.0 instead of
        // 4.9 ms, and queries take 6 to 20 % longer (docs/benchmarks-notes.md).
        let is_like = old.slots.len() >= rows.len() / 2;
        let larger = if is_like && old.len <= old.slots.len() / SHORT_LIVED { LARGER } else { 1 };
        self.fresh = mem::take(&mut old.slots);
        self.fresh.clear();
        let leaf_capacity = settings.leaf_capacity.saturating_mul(larger);
        let settings = fitting(Settings { leaf_capacity, ..settings }, rows.len(), slots.len());
        let gathered = slots.gather(&rows, &mut self.shapes);
        if let Err(error) = gathered.and_then(|()| old.tree.fill_unordered(&self.shapes, settings))
        {
            return Err(self.undo(rows, error));
        }
        if self.shapes.columns_mut().centers.capacity() > 2 * RATIO * rows.len() {
            self.shapes = Shapes::none_in(self.shapes.period());
        }
        let index = self.layers.iter().position(|layer| layer.slots.is_empty());
        let index = index.unwrap_or_else(|| {
            self.layers.push(Layer::default());
            self.layers.len() - 1
        });
        // Four layers for each factor of four in size are at most 64 for 2³¹ shapes, so one byte is
        // enough.
        assert!(index < usize::from(FRESH), "there are {index} layers");
        rows.iter().for_each(|&slot| self.layer_of[slot as usize] = index as u8);
        self.fresh_len = 0;
        self.layers[index] = Layer { tree: old.tree, len: rows.len(), slots: rows };
        Ok(Some(index))
    }

    /// The tree of a layer with radii larger by half of `distance`; None if this is 0.
    pub(super) fn grown(&self, index: usize, distance: T) -> Result<Option<Quadtree<T>>> {
        let tree = &self.layers[index].tree;
        (distance != T::ZERO).then(|| tree.grown(distance)).transpose()
    }

    /// Adds the pairs of shapes of two layers, or of one with itself, as pairs of slots. Their
    /// trees are those in `grown`, if any.
    pub(super) fn join(
        &self,
        [a, b]: [usize; 2],
        grown: [&Option<Quadtree<T>>; 2],
        (mask, max_pairs): (Option<u32>, usize),
        found: &mut Vec<[u32; 2]>,
    ) -> Result<()> {
        let (first, second) = (&self.layers[a], &self.layers[b]);
        let left = max_pairs - found.len();
        let own = grown[0].as_ref().unwrap_or(&first.tree);
        let rows = if a == b {
            pairs::within(own, mask, left)
        } else {
            pairs::between(own, grown[1].as_ref().unwrap_or(&second.tree), mask, left)
        };
        let rows = rows.map_err(|error| error.with_max_pairs(max_pairs))?;
        let mut pulse = Pulse::current();
        for rows in rows.pairs.chunks(CHUNK) {
            pulse.check(rows.len())?;
            memory::reserve(found, rows.len())?;
            let slots =
                rows.iter().map(|&[i, j]| [first.slots[i as usize], second.slots[j as usize]]);
            // Each shape has one valid copy, in the layer that `layer_of` names. So each pair of
            // shapes is found in one join of two layers, however many copies of it there are.
            found.extend(slots.filter(|&[i, j]| self.is_in(i, a) && self.is_in(j, b)));
        }
        Ok(())
    }

    /// As [`Layers::join`]; only pairs of which a slot is `changed`, unless all shapes of the first
    /// layer are.
    pub(super) fn join_changed(
        &self,
        [a, b]: [usize; 2],
        changed: Option<&[bool]>,
        max_pairs: usize,
        scratch: &mut JoinScratch,
        found: &mut Vec<[u32; 2]>,
    ) -> Result<()> {
        let (first, second) = (&self.layers[a], &self.layers[b]);
        let left = max_pairs - found.len();
        let indices = if a == b {
            pairs::indices_within(&first.tree, left, scratch)
        } else {
            let (shift, filters) = ([T::ZERO; 2], Filters::Apply);
            pairs::indices_between(&first.tree, &second.tree, shift, filters, left, scratch)
        };
        let mut pairs = indices.map_err(|error| error.with_max_pairs(max_pairs))?.pairs;
        // Then no copy is out of date, and two random reads for each pair are saved.
        let are_complete = first.is_complete() && second.is_complete();
        let mut pulse = Pulse::current();
        let mut kept = 0;
        for start in (0..pairs.len()).step_by(CHUNK) {
            pulse.check(CHUNK)?;
            for index in start..pairs.len().min(start + CHUNK) {
                let [i, j] = pairs[index];
                let (i, j) = (first.slot_at(i), second.slot_at(j));
                // Written in any case and counted if it is wanted: no branch depends on the pair.
                pairs[kept] = [i, j];
                let both = are_complete || self.is_in(i, a) && self.is_in(j, b);
                let wanted =
                    changed.is_none_or(|changed| changed[i as usize] || changed[j as usize]);
                kept += usize::from(both && wanted);
            }
        }
        pairs.truncate(kept);
        // The first join hands over its list without a copy; mostly it is the longest.
        if found.is_empty() {
            *found = pairs;
            return Ok(());
        }
        memory::reserve(found, pairs.len())?;
        found.append(&mut pairs);
        Ok(())
    }

    /// How many of the shapes in these slots are in each layer.
    pub(super) fn count_in(&self, slots: &[u32]) -> Result<Vec<usize>> {
        let mut counts = memory::filled(self.layers.len(), 0)?;
        for &slot in slots {
            if let Some(count) = counts.get_mut(usize::from(self.layer_of[slot as usize])) {
                *count += 1;
            }
        }
        Ok(counts)
    }

    /// Number of shapes of a layer.
    pub(super) fn len_of(&self, index: usize) -> usize {
        self.layers[index].len
    }

    /// Allocated bytes, used or not.
    pub(super) fn memory_bytes(&self) -> usize {
        let bytes_of = |layer: &Layer<T>| layer.tree.memory_bytes() + 4 * layer.slots.capacity();
        let words = self.fresh.capacity() * 4 + self.layer_of.capacity() + self.listed.capacity();
        self.layers.iter().map(bytes_of).sum::<usize>() + words + self.shapes.memory_bytes()
    }

    /// Checks that every shape is in one layer or fresh, and that all counts are right.
    pub(super) fn check(&self, slots: &Slots<T>) -> std::result::Result<(), String> {
        let mut seen = 0;
        for (number, layer) in self.layers.iter().enumerate() {
            layer.tree.check()?;
            let mut count = 0;
            for (index, &row) in layer.tree.rows().iter().enumerate() {
                let slot = layer.slots[row as usize];
                if !self.is_in(slot, number) {
                    continue;
                }
                count += 1;
                if layer.tree.columns().shape(index) != slots.shape(slot) {
                    return Err(format!("layer {number} holds an old shape of slot {slot}"));
                }
            }
            if count != layer.len {
                return Err(format!("layer {number} holds {count} shapes, not {}", layer.len));
            }
            seen += count;
        }
        if self.fresh().count() != self.fresh_len {
            return Err(format!("{} are said to be fresh", self.fresh_len));
        }
        seen += self.fresh_len;
        if seen == slots.len() { Ok(()) } else { Err(format!("layers hold {seen} shapes")) }
    }
}
