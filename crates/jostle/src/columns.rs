//! Shapes as columns: one array for each number, so that a leaf's shapes lie
//! side by side for vector instructions.

use crate::error::{Error, Result};
use crate::geometry::{Scalar, Shape};
use crate::parallel;
use crate::simd::LANES;


/// What a shape is where nothing is said.
pub const DEFAULT_CATEGORY: u32 = 1;

/// What a shape may pair with where nothing is said: everything.
pub const DEFAULT_MASK: u32 = u32::MAX;

/// Shapes in columns of equal length, with [`LANES`] spare rows behind them, so that a
/// kernel may read a whole block from any row.
///
/// Columns that would say the same for every row are left empty: half sizes
/// where all are circles, filters where everything pairs with everything.
#[derive(Clone, Debug, Default)]
pub struct Columns<T> {
    len: usize,
    /// Centres, x.
    pub x: Vec<T>,
    /// Centres, y.
    pub y: Vec<T>,
    /// Radii.
    pub radius: Vec<T>,
    /// Half widths; empty where every shape is a circle.
    pub half_x: Vec<T>,
    /// Half heights; empty where every shape is a circle.
    pub half_y: Vec<T>,
    /// Categories; empty where everything pairs with everything.
    pub category: Vec<u32>,
    /// Masks; empty where everything pairs with everything.
    pub mask: Vec<u32>,
}

impl<T: Scalar> Columns<T> {
    /// Checks shapes given as slices and stores them.
    ///
    /// `half_sizes` holds half widths and half heights, `filters` categories
    /// and masks. Every slice has the length of `x`.
    pub fn new(
        x: Vec<T>,
        y: Vec<T>,
        radius: Vec<T>,
        half_sizes: Option<[Vec<T>; 2]>,
        filters: Option<[Vec<u32>; 2]>,
    ) -> Result<Self> {
        let len = x.len();
        let [half_x, half_y] = half_sizes.unwrap_or_default();
        let [category, mask] = filters.unwrap_or_default();
        let mut columns = Self { len, x, y, radius, half_x, half_y, category, mask };
        columns.validate()?;
        columns.pad();
        Ok(columns)
    }

    fn validate(&self) -> Result<()> {
        let expected = self.len;
        if expected > u32::MAX as usize / 2 {
            return Err(Error::of("centers", expected, "there may be at most 2147483647 rows"));
        }
        let lengths = [
            ("centers", self.y.len(), false),
            ("radii", self.radius.len(), false),
            ("half_sizes", self.half_x.len(), true),
            ("half_sizes", self.half_y.len(), true),
            ("categories", self.category.len(), true),
            ("masks", self.mask.len(), true),
        ];
        for (argument, found, optional) in lengths {
            if found != expected && !(optional && found == 0) {
                return Err(Error::Length { argument, found, expected });
            }
        }
        check_finite("centers", &self.x, &self.y)?;
        check_size("radii", "a radius", &self.radius)?;
        check_size("half_sizes", "a half size", &self.half_x)?;
        check_size("half_sizes", "a half size", &self.half_y)
    }

    /// Gives every column in use its spare rows.
    fn pad(&mut self) {
        let padded = self.len + LANES;
        self.x.resize(padded, T::ZERO);
        self.y.resize(padded, T::ZERO);
        self.radius.resize(padded, T::ZERO);
        for column in [&mut self.half_x, &mut self.half_y] {
            if !column.is_empty() {
                column.resize(padded, T::ZERO);
            }
        }
        for column in [&mut self.category, &mut self.mask] {
            if !column.is_empty() {
                column.resize(padded, 0);
            }
        }
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether any shape has a half size.
    pub fn has_boxes(&self) -> bool {
        !self.half_x.is_empty()
    }

    /// Whether some pairs are filtered out.
    pub fn has_filters(&self) -> bool {
        !self.category.is_empty()
    }

    /// The shape in `row`.
    #[inline(always)]
    pub fn shape(&self, row: usize) -> Shape<T> {
        let filtered = self.has_filters();
        Shape {
            center: [self.x[row], self.y[row]],
            half_size: if self.has_boxes() {
                [self.half_x[row], self.half_y[row]]
            } else {
                [T::ZERO; 2]
            },
            radius: self.radius[row],
            category: if filtered { self.category[row] } else { DEFAULT_CATEGORY },
            mask: if filtered { self.mask[row] } else { DEFAULT_MASK },
        }
    }

    /// Replaces the contents by the rows `order` of `source`, in that order.
    pub fn gather(&mut self, source: &Self, order: &[u32], threads: Option<usize>) {
        self.len = order.len();
        take(&mut self.x, &source.x, order, threads);
        take(&mut self.y, &source.y, order, threads);
        take(&mut self.radius, &source.radius, order, threads);
        take(&mut self.half_x, &source.half_x, order, threads);
        take(&mut self.half_y, &source.half_y, order, threads);
        take(&mut self.category, &source.category, order, threads);
        take(&mut self.mask, &source.mask, order, threads);
    }

    /// Empties the columns and fills them with `len` rounded boxes; `row` gives
    /// centre, half size and radius. For callers that have checked their numbers.
    pub fn refill(&mut self, len: usize, row: impl Fn(usize) -> ([T; 2], [T; 2], T)) {
        self.len = len;
        for column in
            [&mut self.x, &mut self.y, &mut self.radius, &mut self.half_x, &mut self.half_y]
        {
            column.clear();
            column.reserve(len + LANES);
        }
        for i in 0..len {
            let (center, half_size, radius) = row(i);
            self.x.push(center[0]);
            self.y.push(center[1]);
            self.half_x.push(half_size[0]);
            self.half_y.push(half_size[1]);
            self.radius.push(radius);
        }
        self.pad();
    }
}

/// Replaces a column by the rows `order` of `from`, and spare rows.
fn take<V: Copy + Default + Send + Sync>(
    to: &mut Vec<V>,
    from: &[V],
    order: &[u32],
    threads: Option<usize>,
) {
    if from.is_empty() {
        return to.clear();
    }
    to.resize(order.len() + LANES, V::default());
    parallel::for_chunks(threads, &mut to[..order.len()], |first, chunk| {
        for (value, &row) in chunk.iter_mut().zip(&order[first..]) {
            *value = from[row as usize];
        }
    });
}

/// Refuses a pair of coordinates that is not finite.
pub fn check_finite<T: Scalar>(argument: &'static str, x: &[T], y: &[T]) -> Result<()> {
    let finite = |column: &[T]| column.iter().fold(true, |all, v| all & v.is_finite());
    if finite(x) && finite(y) {
        return Ok(());
    }
    for (index, (&x, &y)) in x.iter().zip(y).enumerate() {
        if !(x.is_finite() && y.is_finite()) {
            let rule = "both coordinates must be finite";
            return Err(Error::at(argument, index, format!("({x}, {y})"), rule));
        }
    }
    Ok(())
}

/// Refuses a size that is negative, not finite or beyond [`Scalar::MAX_SIZE`].
pub fn check_size<T: Scalar>(argument: &'static str, noun: &str, sizes: &[T]) -> Result<()> {
    let fits = |size: T| (size >= T::ZERO) & (size <= T::MAX_SIZE);
    if sizes.iter().fold(true, |all, &size| all & fits(size)) {
        return Ok(());
    }
    for (index, &size) in sizes.iter().enumerate() {
        if !(size >= T::ZERO && size.is_finite()) {
            let rule = format!("{noun} must be finite and at least 0");
            return Err(Error::at(argument, index, size, &rule));
        }
        if size > T::MAX_SIZE {
            let rule = format!("{noun} must be at most {:e}", T::MAX_SIZE.to_f64());
            return Err(Error::at(argument, index, size, &rule));
        }
    }
    Ok(())
}
