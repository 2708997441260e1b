//! Shapes as a structure of arrays, so that vector instructions load the numbers of adjacent
//! shapes at once.

use crate::geometry::{Core, Scalar, Shape};
use crate::shapes::{DEFAULT_CATEGORY, DEFAULT_MASK, Each, Shapes, corners};
use jostle_base::error::Result;
use jostle_base::interrupt;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_simd::LANES;

/// Spare rows after the last shape.
pub const SPARE: usize = 2 * LANES;

/// Shapes in columns of equal length, followed by [`SPARE`] rows, so that a kernel may read a
/// whole block at any row.
///
/// Some columns may be empty: half sizes if all shapes are circles or given as boxes, upper
/// corners if all are given by their centres, cores if all are boxes, filters if all shapes may pair.
#[derive(Clone, Debug, Default)]
pub struct Columns<T> {
    len: usize,
    /// `min` of the shapes, x: the centres, unless there are boxes.
    pub x: Vec<T>,
    /// `min` of the shapes, y: the centres, unless there are boxes.
    pub y: Vec<T>,
    /// `max` of the shapes, x; empty if all are given by their centres.
    pub max_x: Vec<T>,
    /// `max` of the shapes, y; empty if all are given by their centres.
    pub max_y: Vec<T>,
    /// Radii.
    pub radius: Vec<T>,
    /// Half widths; empty if every shape is a circle or a box.
    pub half_x: Vec<T>,
    /// Half heights; empty if every shape is a circle or a box.
    pub half_y: Vec<T>,
    /// What each core is within its box; empty if all are boxes.
    pub core: Vec<Core>,
    /// Categories; empty if all shapes may pair.
    pub category: Vec<u32>,
    /// Masks; empty if all shapes may pair.
    pub mask: Vec<u32>,
}

impl<T: Scalar> Columns<T> {
    /// All shapes in the order of their rows.
    pub fn of(shapes: &Shapes<T>) -> Result<Self> {
        let mut columns = Self { len: shapes.len(), ..Self::default() };
        put_pairs([&mut columns.x, &mut columns.y], shapes.len(), Some(1), |row| {
            shapes.centers[row]
        })?;
        columns.fill(shapes, Some(1), |index| index)?;
        Ok(columns)
    }

    /// The columns x and y of `len` shapes, for writing. [`Columns::fill_rest`] fills the others.
    pub fn centers_mut(&mut self, len: usize) -> Result<[&mut [T]; 2]> {
        self.len = len;
        // A kernel may read a whole block at the last row, and in the strips of a leaf two. What it
        // reads there are numbers of no shape, whose bits are masked out.
        memory::resize(&mut self.x, len + SPARE, T::ZERO)?;
        memory::resize(&mut self.y, len + SPARE, T::ZERO)?;
        Ok([&mut self.x[..len], &mut self.y[..len]])
    }

    /// Fills all columns but the centres with the shapes in `rows`, in that order.
    pub fn fill_rest(
        &mut self,
        shapes: &Shapes<T>,
        rows: &[u32],
        threads: Option<usize>,
    ) -> Result<()> {
        self.fill(shapes, threads, |index| rows[index] as usize)
    }

    /// A copy.
    pub fn copied(&self) -> Result<Self> {
        fn copy<V: Copy>(column: &[V]) -> Result<Vec<V>> {
            memory::collect(column.iter().copied())
        }
        Ok(Self {
            len: self.len,
            x: copy(&self.x)?,
            y: copy(&self.y)?,
            max_x: copy(&self.max_x)?,
            max_y: copy(&self.max_y)?,
            radius: copy(&self.radius)?,
            half_x: copy(&self.half_x)?,
            half_y: copy(&self.half_y)?,
            core: copy(&self.core)?,
            category: copy(&self.category)?,
            mask: copy(&self.mask)?,
        })
    }

    /// Increases all radii.
    pub fn grow(&mut self, by: T) {
        // Without the spare rows, whose values are never used.
        self.radius[..self.len].iter_mut().for_each(|radius| *radius = *radius + by);
    }

    /// Removes all shapes and keeps the capacity.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    fn fill(
        &mut self,
        shapes: &Shapes<T>,
        threads: Option<usize>,
        row: impl Fn(usize) -> usize + Sync + Send,
    ) -> Result<()> {
        let len = self.len;
        let Shapes { radii, half_sizes, boxes, cores, filters, .. } = shapes;
        let pairs = |to: [&mut Vec<T>; 2], from: &[[T; 2]]| {
            put_pairs(to, len, threads, |index| from[row(index)])
        };
        let (lower, upper) = ([&mut self.x, &mut self.y], [&mut self.max_x, &mut self.max_y]);
        if let Some(boxes) = boxes {
            put_pairs(lower, len, threads, |index| corners(&boxes[row(index)])[0])?;
            put_pairs(upper, len, threads, |index| corners(&boxes[row(index)])[1])?;
        } else {
            // An empty column says that upper and lower corner are the same number. So kernels read
            // half as much memory, and can use the faster formulas for centres.
            upper.into_iter().for_each(Vec::clear);
        }
        put_each(&mut self.radius, radii, len, threads, &row)?;
        let half = [&mut self.half_x, &mut self.half_y];
        match half_sizes {
            None => half.into_iter().for_each(Vec::clear),
            Some(Each::Rows(sizes)) => pairs(half, sizes)?,
            Some(Each::One(size)) => put_pairs(half, len, threads, |_| *size)?,
        }
        match cores {
            None => self.core.clear(),
            Some(cores) => {
                let cores = |index: usize| cores[row(index)];
                put(&mut self.core, len, threads, cores)?;
            }
        }
        match filters {
            None => [&mut self.category, &mut self.mask].into_iter().for_each(Vec::clear),
            Some([categories, masks]) => {
                put_each(&mut self.category, categories, len, threads, &row)?;
                put_each(&mut self.mask, masks, len, threads, &row)?;
            }
        }
        Ok(())
    }

    /// Allocated bytes, used or not.
    pub fn memory_bytes(&self) -> usize {
        let [half_x, half_y, max_x, max_y] = [&self.half_x, &self.half_y, &self.max_x, &self.max_y];
        let numbers = [&self.x, &self.y, &self.radius, half_x, half_y, max_x, max_y];
        let cores = self.core.capacity() * size_of::<Core>();
        let bits = self.category.capacity() + self.mask.capacity();
        numbers.map(Vec::capacity).iter().sum::<usize>() * size_of::<T>()
            + bits * size_of::<u32>()
            + cores
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether any shape may have a half size.
    pub fn has_half_sizes(&self) -> bool {
        !self.half_x.is_empty()
    }

    /// Whether shapes are given as boxes.
    #[inline(always)]
    pub fn has_boxes(&self) -> bool {
        !self.max_x.is_empty()
    }

    /// Whether the core of a shape may be something else than its box.
    #[inline(always)]
    pub fn has_cores(&self) -> bool {
        !self.core.is_empty()
    }

    /// `max` of the shapes, x; the centres if no shape is given as a box.
    #[inline(always)]
    pub fn max_x(&self) -> &[T] {
        if self.has_boxes() { &self.max_x } else { &self.x }
    }

    /// `max` of the shapes, y; the centres if no shape is given as a box.
    #[inline(always)]
    pub fn max_y(&self) -> &[T] {
        if self.has_boxes() { &self.max_y } else { &self.y }
    }

    /// Whether there are categories and masks.
    pub fn has_filters(&self) -> bool {
        !self.category.is_empty()
    }

    /// The shape in `row`.
    #[inline(always)]
    pub fn shape(&self, row: usize) -> Shape<T> {
        self.shape_if(row, true)
    }

    /// The shape in `row`. If it is not `round`, its radius is 0 and is not read from memory.
    #[inline(always)]
    pub fn shape_if(&self, row: usize, round: bool) -> Shape<T> {
        let filtered = self.has_filters();
        Shape {
            min: [self.x[row], self.y[row]],
            max: [self.max_x()[row], self.max_y()[row]],
            half_size: if self.has_half_sizes() {
                [self.half_x[row], self.half_y[row]]
            } else {
                [T::ZERO; 2]
            },
            radius: if round { self.radius[row] } else { T::ZERO },
            category: if filtered { self.category[row] } else { DEFAULT_CATEGORY },
            mask: if filtered { self.mask[row] } else { DEFAULT_MASK },
            core: if self.has_cores() { self.core[row] } else { Core::Box },
        }
    }
}

/// Fills a column of `len` values and its spare rows.
#[inline(always)]
fn put_each<V: Copy + Default + Send + Sync>(
    column: &mut Vec<V>,
    values: &Each<V>,
    len: usize,
    threads: Option<usize>,
    row: impl Fn(usize) -> usize + Sync + Send,
) -> Result<()> {
    // Between columns, not within: a column takes a few milliseconds for a million shapes.
    interrupt::check()?;
    memory::resize(column, len + SPARE, V::default())?;
    match values {
        // One value for all still gets a column. Kernels would need a copy of each loop for a
        // single radius, and the column is read in order, which is the cheapest kind of reading.
        Each::One(value) => column[..len].fill(*value),
        Each::Rows(values) => fill(&mut column[..len], threads, |index| values[row(index)]),
    }
    Ok(())
}

/// Fills a column of `len` values and its spare rows, from one value for each.
fn put<V: Copy + Default + Send + Sync>(
    column: &mut Vec<V>,
    len: usize,
    threads: Option<usize>,
    value: impl Fn(usize) -> V + Sync + Send,
) -> Result<()> {
    interrupt::check()?;
    memory::resize(column, len + SPARE, V::default())?;
    fill(&mut column[..len], threads, value);
    Ok(())
}

#[inline(always)]
fn fill<V: Send>(
    column: &mut [V],
    threads: Option<usize>,
    value: impl Fn(usize) -> V + Sync + Send,
) {
    parallel::for_chunks(threads, column, |first, chunk| {
        for (offset, to) in chunk.iter_mut().enumerate() {
            *to = value(first + offset);
        }
    });
}

/// Fills two columns of `len` values, and their spare rows, from pairs.
#[inline(always)]
fn put_pairs<T: Scalar>(
    [x, y]: [&mut Vec<T>; 2],
    len: usize,
    threads: Option<usize>,
    pair: impl Fn(usize) -> [T; 2] + Sync + Send,
) -> Result<()> {
    interrupt::check()?;
    memory::resize(x, len + SPARE, T::ZERO)?;
    memory::resize(y, len + SPARE, T::ZERO)?;
    parallel::for_chunks_of_two(threads, &mut x[..len], &mut y[..len], |first, x, y| {
        for (offset, (x, y)) in x.iter_mut().zip(y).enumerate() {
            [*x, *y] = pair(first + offset);
        }
    });
    Ok(())
}
