//! The space: its parts, and how shapes are added, moved, changed and removed.

use super::changes::Changes;
use super::floors::Floors;
use super::layers::Layers;
use super::slots::Slots;
use super::touching::Touching;
use super::traces::Traces;
use super::walls::Walls;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::{Scalar, Shape};
use jostle_index::period::Period;
use jostle_index::shapes::{
    Each, Shapes, check_boxes, check_each_half_size, check_finite, check_radii, corners,
};

/// Shapes that change.
///
/// ```
/// # mod jostle {
/// #     pub use jostle_base::{error::Error, settings::Settings};
/// #     pub use jostle_index::{Each, Shapes};
/// #     pub use jostle_space::Space;
/// # }
/// use jostle::{Each, Settings, Shapes, Space};
/// let mut space = Space::new(Settings::default())?;
/// let ids = space.add(&Shapes::circles(vec![[0.0, 0.0], [5.0, 0.0]], Each::One(1.0))?)?;
/// space.move_to(&ids[1..], &[[1.0, 0.0]])?;
/// assert_eq!(space.update(1000)?.entered, [[0, 1]]);
/// # Ok::<(), jostle::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Space<T> {
    pub(super) settings: Settings,
    pub(super) period: Period<T>,
    pub(super) slots: Slots<T>,
    pub(super) layers: Layers<T>,
    pub(super) touching: Touching,
    pub(super) changes: Changes,
    pub(super) floors: Floors<T>,
    pub(super) traces: Traces<T>,
    pub(super) walls: Walls<T>,
}

impl<T: Scalar> Space<T> {
    /// A space without shapes. Refuses settings that no tree can follow.
    pub fn new(settings: Settings) -> Result<Self> {
        Self::with_period(settings, Period::default())
    }

    /// A space without shapes, in a periodic plane: all centres are moved into the first period.
    pub fn with_period(settings: Settings, period: Period<T>) -> Result<Self> {
        settings.validate()?;
        Ok(Self {
            settings,
            period,
            slots: Slots::default(),
            layers: Layers::of(period),
            touching: Touching::default(),
            changes: Changes::default(),
            floors: Floors::default(),
            traces: Traces::default(),
            walls: Walls::default(),
        })
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether a shape has this id.
    pub fn contains(&self, id: Id) -> bool {
        self.slots.slot(id).is_some()
    }

    /// The ids of all shapes, ascending.
    pub fn ids(&self) -> Result<Vec<Id>> {
        self.slots.ids()
    }

    /// The settings of its trees.
    pub fn settings(&self) -> Settings {
        self.settings
    }

    /// The period of the plane.
    pub fn period(&self) -> Period<T> {
        self.period
    }

    /// The results of `read` for the shapes with these ids. Refuses ids that no shape has.
    pub fn read<V>(&self, ids: &[Id], read: impl Fn(Shape<T>) -> V) -> Result<Vec<V>> {
        let slots = self.slots.look_up(ids)?;
        memory::collect(slots.into_iter().map(|slot| read(self.slots.shape(slot))))
    }

    /// Adds shapes; returns their ids. No id is used again.
    pub fn add(&mut self, shapes: &Shapes<T>) -> Result<Vec<Id>> {
        self.slots.check_room(shapes.len())?;
        // All memory is reserved first, so that a failure changes nothing.
        self.slots.reserve(shapes)?;
        self.reserve_changes(shapes.len())?;
        let count = self.slots.count() + shapes.len();
        // Everything that has an entry for each slot grows together, before the first shape is
        // stored. A failure leaves longer columns, which nobody notices.
        self.layers.widen(count)?;
        self.touching.widen(count)?;
        self.changes.widen(count)?;
        let mut ids = memory::with_capacity(shapes.len())?;
        for row in 0..shapes.len() {
            let slot = self.slots.put(&self.period.wrap_shape(shapes.shape(row)));
            // The slot may have belonged to a removed shape, whose motions are not those of the new
            // one.
            self.traces.start(slot);
            self.note(slot);
            ids.push(self.slots.id(slot));
        }
        Ok(ids)
    }

    /// Reserves memory for `more` changed shapes.
    pub(super) fn reserve_changes(&mut self, more: usize) -> Result<()> {
        self.changes.reserve(more)?;
        self.layers.reserve_fresh(more)
    }

    /// Sets the centres of shapes. A shape given as a box is stored as its centre and half its size
    /// from then on, which are rounded. Refuses ids that no shape has or that are given twice, and
    /// centres that are not finite; then nothing changes.
    pub fn move_to(&mut self, ids: &[Id], centers: &[[T; 2]]) -> Result<()> {
        if centers.len() != ids.len() {
            let (found, expected) = (centers.len(), ids.len());
            return Err(Error::Length { argument: "centers", found, expected });
        }
        check_finite("centers", centers)?;
        let period = self.period;
        let set = |slots: &mut Slots<T>, slot, row: usize| {
            slots.set_center(slot, period.wrap(centers[row]))
        };
        self.change(ids, true, set)
    }

    /// Sets the cores of shapes to boxes `[min_x, min_y, max_x, max_y]`; radii stay the same.
    /// Errors as in [`Space::move_to`].
    pub fn move_to_boxes(&mut self, ids: &[Id], boxes: &[[T; 4]]) -> Result<()> {
        if boxes.len() != ids.len() {
            let (found, expected) = (boxes.len(), ids.len());
            return Err(Error::Length { argument: "boxes", found, expected });
        }
        check_boxes("boxes", boxes)?;
        let period = self.period;
        self.change(ids, true, |slots, slot, row| {
            let moved = period.wrap_corners(corners(&boxes[row]));
            slots.set_box(slot, moved)
        })
    }

    /// Sets radii, half sizes or both. Refuses invalid values.
    pub fn resize(
        &mut self,
        ids: &[Id],
        radii: Option<&Each<T>>,
        half_sizes: Option<&Each<[T; 2]>>,
    ) -> Result<()> {
        if let Some(radii) = radii {
            radii.check_len("radii", ids.len())?;
            radii.check(|radii| check_radii("radii", radii))?;
        }
        if let Some(half_sizes) = half_sizes {
            half_sizes.check_len("half_sizes", ids.len())?;
            check_each_half_size("half_sizes", half_sizes)?;
        }
        self.slots.reserve_columns(0, [half_sizes.is_some(), false])?;
        self.change(ids, false, |slots, slot, row| {
            let radius = radii.is_some_and(|radii| slots.set_radius(slot, radii.at(row)));
            let half = half_sizes.is_some_and(|sizes| slots.resize(slot, sizes.at(row)));
            radius || half
        })
    }

    /// Sets categories, masks or both.
    pub fn set_filter(
        &mut self,
        ids: &[Id],
        categories: Option<&Each<u32>>,
        masks: Option<&Each<u32>>,
    ) -> Result<()> {
        for (argument, bits) in [("categories", categories), ("masks", masks)] {
            bits.map_or(Ok(()), |bits| bits.check_len(argument, ids.len()))?;
        }
        self.slots.reserve_columns(0, [false, true])?;
        self.change(ids, false, |slots, slot, row| {
            let old = slots.shape(slot);
            let category = categories.map_or(old.category, |bits| bits.at(row));
            slots.set_filter(slot, [category, masks.map_or(old.mask, |bits| bits.at(row))])
        })
    }

    /// The line segments, which have two ends each.
    pub fn walls(&self) -> &[[[T; 2]; 2]] {
        self.walls.original()
    }

    /// Replaces the line segments. Refuses invalid ones; then nothing changes.
    pub fn set_walls(&mut self, ends: Vec<[[T; 2]; 2]>) -> Result<()> {
        self.walls = Walls::new(ends, &self.period, self.settings)?;
        Ok(())
    }

    /// Removes shapes. Refuses ids that no shape has or that are given twice; then nothing changes.
    pub fn remove(&mut self, ids: &[Id]) -> Result<()> {
        let slots = self.slots.find(ids)?;
        self.reserve_changes(slots.len())?;
        self.slots.reserve_free(slots.len())?;
        self.touching.prepare_has(self.slots.count())?;
        for slot in slots {
            self.slots.remove(slot);
            self.layers.remove(slot);
            self.changes.note(slot);
            // The slot is not used again yet: the next update has to report that the pair has
            // ended, by the id of the removed shape, and the id comes from the generation of its
            // slot.
            if self.touching.has(slot) {
                // The next update reports its pairs by its id.
                self.changes.leaving.push(slot);
            } else {
                self.slots.free(slot);
            }
        }
        Ok(())
    }

    /// Changes shapes; `set` returns whether it has changed one. Motions are recorded.
    fn change(
        &mut self,
        ids: &[Id],
        is_motion: bool,
        set: impl Fn(&mut Slots<T>, u32, usize) -> bool,
    ) -> Result<()> {
        let slots = self.slots.find(ids)?;
        self.reserve_changes(slots.len())?;
        if is_motion {
            self.traces.reserve(slots.len(), self.slots.count())?;
            // A loop of its own is faster than a test in the next one.
            slots.iter().for_each(|&slot| self.traces.note(slot, || self.slots.center(slot)));
        }
        for (row, slot) in slots.into_iter().enumerate() {
            // A value that is set to what it was costs nothing later: the shape stays in its layer,
            // and the next update does not visit it.
            if set(&mut self.slots, slot, row) {
                self.note(slot);
            }
        }
        Ok(())
    }

    /// Records that a shape has changed.
    pub(super) fn note(&mut self, slot: u32) {
        self.changes.note(slot);
        self.layers.freshen(slot);
    }

    /// Allocated bytes, used or not.
    pub fn memory_bytes(&self) -> usize {
        self.slots.memory_bytes()
            + self.layers.memory_bytes()
            + self.touching.memory_bytes()
            + self.changes.memory_bytes()
            + self.floors.memory_bytes()
            + self.traces.memory_bytes()
            + self.walls.memory_bytes()
    }

    /// Checks the invariants, for tests; the error describes the first violated one.
    pub fn check(&self) -> std::result::Result<(), String> {
        self.layers.check(&self.slots)
    }
}
