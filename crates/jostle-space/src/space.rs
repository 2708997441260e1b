//! The space: its parts, and how shapes are added, moved, changed and removed.

use super::changes::Changes;
use super::floors::Floors;
use super::layers::Layers;
use super::rows::Rows;
use super::slots::Slots;
use super::starts::Starts;
use super::touching::Touching;
use super::traces::Traces;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::settings::Settings;
use jostle_index::geometry::{Core, Scalar, Shape};
use jostle_index::period::Period;
use jostle_index::shapes::{
    Each, Shapes, check_boxes, check_each_half_size, check_finite, check_radii, check_segment,
    check_segments, corners, tuple,
};

/// New values of some columns, each with one value for all of some shapes or one for each. None leaves a column as
/// it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShapeChanges<T> {
    /// Centres.
    pub positions: Option<Each<[T; 2]>>,
    /// In place of centres and half sizes, boxes: min x, min y, max x, max y.
    pub boxes: Option<Each<[T; 4]>>,
    /// In place of centres and half sizes, segments: start and end.
    pub segments: Option<Each<[[T; 2]; 2]>>,
    /// Half widths and half heights.
    pub half_sizes: Option<Each<[T; 2]>>,
    /// Radii.
    pub radii: Option<Each<T>>,
    /// Categories.
    pub categories: Option<Each<u32>>,
    /// Masks.
    pub masks: Option<Each<u32>>,
}

impl<T: Scalar> ShapeChanges<T> {
    /// Refuses columns that do not have `len` values, and values out of range.
    fn validate(&self, len: usize, period: &Period<T>) -> Result<()> {
        if let Some(positions) = &self.positions {
            positions.check_len("positions", len)?;
            positions.check(|positions| check_finite("positions", positions))?;
        }
        if let Some(boxes) = &self.boxes {
            boxes.check_len("boxes", len)?;
            boxes.check(|boxes| check_boxes("boxes", boxes))?;
        }
        if let Some(segments) = &self.segments {
            segments.check_len("segments", len)?;
            segments.check(|segments| check_segments("segments", segments, period))?;
        }
        if let Some(half_sizes) = &self.half_sizes {
            half_sizes.check_len("half_sizes", len)?;
            check_each_half_size("half_sizes", half_sizes)?;
        }
        if let Some(radii) = &self.radii {
            radii.check_len("radii", len)?;
            radii.check(|radii| check_radii("radii", radii))?;
        }
        for (argument, bits) in [("categories", &self.categories), ("masks", &self.masks)] {
            bits.as_ref().map_or(Ok(()), |bits| bits.check_len(argument, len))?;
        }
        Ok(())
    }
}

/// Shapes that change.
///
/// ```
/// # mod jostle {
/// #     pub use jostle_base::{error::Error, settings::Settings};
/// #     pub use jostle_index::{Each, Shapes};
/// #     pub use jostle_space::{ShapeChanges, Space};
/// # }
/// use jostle::{Each, Settings, ShapeChanges, Shapes, Space};
/// let mut space = Space::new(Settings::default())?;
/// let ids = space.add(&Shapes::circles(vec![[0.0, 0.0], [5.0, 0.0]], Each::One(1.0))?)?;
/// let to = ShapeChanges { positions: Some(Each::One([1.0, 0.0])), ..ShapeChanges::default() };
/// space.set(&ids[1..], &to)?;
/// assert_eq!(space.update(1000)?.entered, [[0, 1]]);
/// # Ok::<(), jostle::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Space<T> {
    pub(super) settings: Settings,
    pub(super) period: Period<T>,
    pub(super) slots: Slots<T>,
    pub(super) rows: Rows,
    pub(super) layers: Layers<T>,
    pub(super) touching: Touching,
    pub(super) changes: Changes,
    pub(super) floors: Floors<T>,
    pub(super) traces: Traces<T>,
    pub(super) starts: Starts<T>,
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
            rows: Rows::default(),
            layers: Layers::of(period),
            touching: Touching::default(),
            changes: Changes::default(),
            floors: Floors::default(),
            traces: Traces::default(),
            starts: Starts::default(),
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

    /// The ids of all shapes, in the order of adding. The first call after a removal visits all of them.
    pub fn ids(&mut self) -> Result<Vec<Id>> {
        memory::collect(self.rows.ids(&self.slots).iter().copied())
    }

    /// The row of each of these ids in that order. Refuses ids that no shape has.
    pub fn rows_of(&mut self, ids: &[Id]) -> Result<Vec<i64>> {
        self.rows.rows_of(ids, &self.slots)
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
        shapes.check_period(&self.period)?;
        // All memory is reserved first, so that a failure changes nothing.
        self.slots.reserve(shapes)?;
        self.rows.reserve(shapes.len(), &self.slots)?;
        self.reserve_changes(shapes.len())?;
        let count = self.slots.count() + shapes.len();
        // Everything that has an entry for each slot grows together, before the first shape is
        // stored. A failure leaves longer columns, which change no result.
        self.layers.widen(count)?;
        self.touching.widen(count)?;
        self.changes.widen(count)?;
        let mut ids = memory::with_capacity(shapes.len())?;
        for row in 0..shapes.len() {
            let slot = self.slots.put(&self.period.wrap_shape(shapes.shape(row)));
            // The slot may have belonged to a removed shape, whose motions are not those of the new
            // one.
            self.traces.start(slot);
            self.starts.start(slot);
            self.note(slot);
            self.rows.push(self.slots.id(slot));
            ids.push(self.slots.id(slot));
        }
        Ok(ids)
    }

    /// Reserves memory for `more` changed shapes.
    pub(super) fn reserve_changes(&mut self, more: usize) -> Result<()> {
        self.changes.reserve(more)?;
        self.layers.reserve_fresh(more)
    }

    /// Changes columns of shapes. Refuses ids that no shape has or that are given twice, and values out of range;
    /// then nothing changes. A shape given as a box, or a segment of which half sizes are set, is stored as its centre
    /// and half its size once one of these is set to another value.
    pub fn set(&mut self, ids: &[Id], new: &ShapeChanges<T>) -> Result<()> {
        new.validate(ids.len(), &self.period)?;
        if let Some(positions) = &new.positions {
            self.check_moved_segments(ids, positions)?;
        }
        let filters = new.categories.is_some() || new.masks.is_some();
        self.slots
            .reserve_columns(0, [new.half_sizes.is_some(), filters, new.segments.is_some()])?;
        let period = self.period;
        let is_motion = new.positions.is_some() || new.boxes.is_some() || new.segments.is_some();
        self.change(ids, is_motion, |slots, slot, row| {
            let mut changed = false;
            if let Some(boxes) = &new.boxes {
                changed |= slots.set_box(slot, period.wrap_corners(corners(&boxes.at(row))));
            }
            if let Some(segments) = &new.segments {
                let (corners, core) = Core::of_segment(segments.at(row));
                changed |= slots.set_core_within(slot, period.wrap_corners(corners), core);
            }
            if let Some(positions) = &new.positions {
                changed |= slots.set_center(slot, period.wrap(positions.at(row)));
            }
            if let Some(half_sizes) = &new.half_sizes {
                changed |= slots.resize(slot, half_sizes.at(row));
            }
            if let Some(radii) = &new.radii {
                changed |= slots.set_radius(slot, radii.at(row));
            }
            if filters {
                let old = slots.shape(slot);
                let category = new.categories.as_ref().map_or(old.category, |bits| bits.at(row));
                let mask = new.masks.as_ref().map_or(old.mask, |bits| bits.at(row));
                changed |= slots.set_filter(slot, [category, mask]);
            }
            changed
        })
    }

    /// Sets the segments of all shapes, in the order of adding. NaN leaves a shape that is none as it is.
    /// Refuses invalid segments; then nothing changes.
    pub fn set_segments(&mut self, segments: &[[[T; 2]; 2]]) -> Result<()> {
        let all = self.ids()?;
        let shapes = self.read(&all, |shape| shape)?;
        if segments.len() != all.len() {
            let (found, expected) = (segments.len(), all.len());
            return Err(Error::Length { argument: "segments", found, expected });
        }
        let (mut ids, mut ends) = (Vec::new(), Vec::new());
        for (row, segment) in segments.iter().enumerate() {
            let is_none = shapes[row].core == Core::Box;
            if is_none && segment.as_flattened().iter().all(|v| v.to_f64().is_nan()) {
                continue;
            }
            check_segment("segments", row, *segment, &self.period)?;
            memory::push(&mut ids, all[row])?;
            memory::push(&mut ends, *segment)?;
        }
        let segments = Some(Each::Rows(ends));
        self.set(&ids, &ShapeChanges { segments, ..ShapeChanges::default() })
    }

    /// Refuses positions at which an end of a segment is out of the range of numbers.
    fn check_moved_segments(&self, ids: &[Id], positions: &Each<[T; 2]>) -> Result<()> {
        if !self.slots.has_cores() {
            return Ok(());
        }
        for (row, slot) in self.slots.look_up(ids)?.into_iter().enumerate() {
            let (shape, center) = (self.slots.shape(slot), positions.at(row));
            let half = shape.core_half_size();
            let is_finite = |axis: usize| (center[axis].abs() + half[axis]).is_finite();
            if shape.core != Core::Box && !(is_finite(0) && is_finite(1)) {
                let rule = "the ends of its segment must be finite";
                return Err(Error::at("positions", row, tuple(&center), rule));
            }
        }
        Ok(())
    }

    /// Removes shapes. Refuses ids that no shape has or that are given twice; then nothing changes.
    pub fn remove(&mut self, ids: &[Id]) -> Result<()> {
        let slots = self.slots.find(ids)?;
        self.reserve_changes(slots.len())?;
        self.slots.reserve_free(slots.len())?;
        self.touching.prepare_has(self.slots.count())?;
        self.rows.remove_some();
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
            self.starts.reserve(self.slots.count())?;
            // A loop of its own is faster than a test in the next one.
            for &slot in &slots {
                self.traces.note(slot, || self.slots.center(slot));
                self.starts.note(slot, || self.slots.center(slot));
            }
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
            + self.rows.memory_bytes()
            + self.layers.memory_bytes()
            + self.touching.memory_bytes()
            + self.changes.memory_bytes()
            + self.floors.memory_bytes()
            + self.traces.memory_bytes()
            + self.starts.memory_bytes()
    }

    /// Checks the invariants, for tests; the error describes the first violated one.
    pub fn check(&self) -> std::result::Result<(), String> {
        self.layers.check(&self.slots)
    }
}
