//! The floors on which shapes stand, so that moving floors carry them.

use super::saved::Saved;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_index::geometry::Scalar;

/// A slot that is no walker.
pub(crate) const NONE: u32 = u32::MAX;

/// The floors on which shapes stood after they moved, so that moving floors carry them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Floors<T> {
    /// On what the shape in each slot stood, if on anything.
    pub all: Vec<Option<Standing<T>>>,
    /// The row of each slot in a call; [`NONE`] between calls.
    pub rows: Vec<u32>,
}

/// The ids of each shape and its floor, and the centres of the floors.
type SavedFloors<T> = (Vec<[Id; 2]>, Vec<[T; 2]>);

impl<T: Scalar> Floors<T> {
    /// Allocated bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        self.all.capacity() * size_of::<Option<Standing<T>>>()
            + self.rows.capacity() * size_of::<u32>()
    }

    /// The ids of each shape that stood on another and of that one, and the centres of the latter.
    pub(crate) fn save(&self) -> Result<SavedFloors<T>> {
        let (mut ids, mut centers) = (Vec::new(), Vec::new());
        for standing in self.all.iter().flatten() {
            memory::push(&mut ids, [standing.id, standing.floor])?;
            memory::push(&mut centers, standing.center)?;
        }
        Ok((ids, centers))
    }

    /// The floors of the result of [`save`](Self::save). Ids of removed shapes have no effect.
    pub(crate) fn restore(saved: &Saved<T>, count: usize) -> Result<Self> {
        let mut floors = Self::default();
        memory::lengthen(&mut floors.all, count, None)?;
        for (&[id, floor], &center) in saved.rides.iter().zip(&saved.ride_centers) {
            // The slot is in the low bits of an id.
            // An id that is out of range, or of a removed shape, is harmless: `SlideCall::standing`
            // compares ids before it uses one.
            if let Some(standing) = floors.all.get_mut(id as u32 as usize) {
                *standing = Some(Standing { id, floor, center });
            }
        }
        Ok(floors)
    }
}

/// A shape, the floor on which it stood, and the centre of the floor then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing<T> {
    /// The id of the shape.
    pub id: Id,
    /// The id of the floor.
    pub floor: Id,
    /// The centre of the floor at that time.
    pub center: [T; 2],
}
