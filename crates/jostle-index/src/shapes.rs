//! Shapes as the caller gives them, one row each, and the checks of their values.

use crate::geometry::{Core, Scalar, Shape, middle};
use crate::period::Period;
use jostle_base::error::{Error, Result};
use jostle_base::memory;
use jostle_base::plain;

/// The category of a shape without one.
pub const DEFAULT_CATEGORY: u32 = 1;

/// The mask of a shape without one: all categories.
pub const DEFAULT_MASK: u32 = u32::MAX;

/// Categories and mask of a shape: two shapes may pair only if the categories of each have a bit
/// in the mask of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Filter {
    /// Bit set of the categories of the shape.
    pub category: u32,
    /// Bit set of the categories that the shape may pair with.
    pub mask: u32,
}

impl Default for Filter {
    fn default() -> Self {
        Self { category: DEFAULT_CATEGORY, mask: DEFAULT_MASK }
    }
}

plain! { Filter { category, mask } }

/// Maximum number of rows: row numbers fit into 31 bits.
pub const MAX_ROWS: usize = u32::MAX as usize / 2;

/// One value for all rows, or one value for each row.
#[derive(Clone, Debug, PartialEq)]
pub enum Each<V> {
    /// One value for all rows.
    One(V),
    /// One value for each row.
    Rows(Vec<V>),
}

impl<V> Default for Each<V> {
    fn default() -> Self {
        Self::Rows(Vec::new())
    }
}

impl<V> From<V> for Each<V> {
    fn from(value: V) -> Self {
        Self::One(value)
    }
}

impl<V> Each<V> {
    /// Number of rows; None for one value for all.
    #[allow(clippy::len_without_is_empty, reason = "one value for all has no number of rows")]
    pub fn len(&self) -> Option<usize> {
        match self {
            Self::Rows(values) => Some(values.len()),
            Self::One(_) => None,
        }
    }
}

impl<V: Copy + PartialEq> Each<V> {
    /// One value for all if all rows are equal.
    fn simplified(self) -> Self {
        match &self {
            // Only circles of one radius have the fast grid, and callers often pass a column of
            // equal radii. The loop ends at the first difference, so it costs nothing where it does
            // not help.
            Self::Rows(values) if values.iter().any(|value| *value != values[0]) => self,
            Self::Rows(values) => values.first().map_or(Self::default(), |&value| Self::One(value)),
            Self::One(_) => self,
        }
    }
}

impl<V: Copy> Each<V> {
    /// The value of `row`.
    #[inline(always)]
    pub fn at(&self, row: usize) -> V {
        match self {
            Self::One(value) => *value,
            Self::Rows(values) => values[row],
        }
    }

    /// The values of the rows, for writing; one value for all is replaced by no rows.
    pub fn rows_mut(&mut self) -> &mut Vec<V> {
        if let Self::One(_) = self {
            *self = Self::default();
        }
        match self {
            Self::Rows(values) => values,
            Self::One(_) => unreachable!("it has just been replaced"),
        }
    }

    /// The values of some rows, in that order.
    fn select(&self, rows: &[u32]) -> Self {
        match self {
            Self::One(value) => Self::One(*value),
            Self::Rows(_) => Self::Rows(rows.iter().map(|&row| self.at(row as usize)).collect()),
        }
    }

    /// The values of `len` rows.
    pub fn rows(self, len: usize) -> Vec<V> {
        match self {
            Self::One(value) => vec![value; len],
            Self::Rows(values) => values,
        }
    }

    /// Checks every value. An error about the value for all names no row.
    pub fn check(&self, check: impl Fn(&[V]) -> Result<()>) -> Result<()> {
        match self {
            Self::Rows(values) => check(values),
            Self::One(value) => check(&[*value]).map_err(Error::without_row),
        }
    }

    /// Refuses a number of rows other than `expected`.
    pub fn check_len(&self, argument: &'static str, expected: usize) -> Result<()> {
        match self {
            Self::Rows(values) if values.len() != expected => {
                Err(Error::Length { argument, found: values.len(), expected })
            }
            _ => Ok(()),
        }
    }
}

/// Shapes with filters, one row each. All values are valid, and the columns have equal
/// lengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes<T> {
    pub(crate) centers: Vec<[T; 2]>,
    pub(crate) radii: Each<T>,
    pub(crate) half_sizes: Option<Each<[T; 2]>>,
    pub(crate) boxes: Option<Vec<[T; 4]>>,
    pub(crate) cores: Option<Vec<Core>>,
    pub(crate) filters: Option<[Each<u32>; 2]>,
    pub(crate) period: Period<T>,
}

/// The columns of [`Shapes`], for writing.
#[derive(Debug)]
pub struct ShapeColumns<'a, T> {
    /// Centres. That of a box is its [`middle`], used only for the order of the tree.
    pub centers: &'a mut Vec<[T; 2]>,
    /// Radii.
    pub radii: &'a mut Each<T>,
    /// Half widths and half heights; None if every shape is a circle or given as a box.
    pub half_sizes: &'a mut Option<Each<[T; 2]>>,
    /// Min x, min y, max x, max y of every shape; None if all are given by their centres.
    pub boxes: &'a mut Option<Vec<[T; 4]>>,
    /// What each core is within its box; None if all are the boxes. Needs boxes.
    pub cores: &'a mut Option<Vec<Core>>,
    /// Categories and masks; None if all shapes may pair.
    pub filters: &'a mut Option<[Each<u32>; 2]>,
}

impl<T: Scalar> Shapes<T> {
    /// Circles. Refuses invalid values.
    pub fn circles(centers: Vec<[T; 2]>, radii: Each<T>) -> Result<Self> {
        Self::new(centers, radii, None, None)
    }

    /// Rounded boxes with categories and masks. Refuses invalid values.
    pub fn new(
        centers: Vec<[T; 2]>,
        radii: Each<T>,
        half_sizes: Option<Each<[T; 2]>>,
        filters: Option<[Each<u32>; 2]>,
    ) -> Result<Self> {
        let period = Period::default();
        // Positions are checked first, so the first wrong argument in the order of the parameters
        // is reported.
        let (boxes, cores) = (None, None);
        let mut shapes = Self { centers, radii, half_sizes, boxes, cores, filters, period };
        check_finite("positions", &shapes.centers)?;
        shapes.validate("positions")?;
        shapes.radii = shapes.radii.simplified();
        Ok(shapes)
    }

    /// Boxes from `[min_x, min_y, max_x, max_y]` each, rounded if there are radii, with
    /// categories and masks. Refuses invalid values.
    pub fn from_boxes(
        boxes: Vec<[T; 4]>,
        radii: Each<T>,
        filters: Option<[Each<u32>; 2]>,
    ) -> Result<Self> {
        check_boxes("boxes", &boxes)?;
        let centers = memory::collect(boxes.iter().map(middle_of))?;
        let period = Period::default();
        let (half_sizes, boxes, cores) = (None, Some(boxes), None);
        let shapes = Self { centers, radii, half_sizes, boxes, cores, filters, period };
        shapes.validate("boxes")?;
        Ok(shapes)
    }

    /// Line segments from start to end, capsules if there are radii, with categories and masks.
    /// Refuses invalid values.
    pub fn from_segments(
        segments: &[[[T; 2]; 2]],
        radii: Each<T>,
        filters: Option<[Each<u32>; 2]>,
    ) -> Result<Self> {
        check_segments("segments", segments, &Period::default())?;
        let mut boxes = memory::with_capacity(segments.len())?;
        let mut cores = memory::with_capacity(segments.len())?;
        for &segment in segments {
            let ([[min_x, min_y], [max_x, max_y]], core) = Core::of_segment(segment);
            boxes.push([min_x, min_y, max_x, max_y]);
            cores.push(core);
        }
        let centers = memory::collect(boxes.iter().map(middle_of))?;
        let period = Period::default();
        let (half_sizes, boxes, cores) = (None, Some(boxes), Some(cores));
        let shapes = Self { centers, radii, half_sizes, boxes, cores, filters, period };
        shapes.validate("segments")?;
        Ok(shapes)
    }

    /// Checks everything except the positions.
    fn validate(&self, rows: &'static str) -> Result<()> {
        let len = self.len();
        if len > MAX_ROWS {
            return Err(Error::of(rows, len, "there may be at most 2147483647 rows"));
        }
        self.radii.check_len("radii", len)?;
        if let Some([categories, masks]) = &self.filters {
            categories.check_len("categories", len)?;
            masks.check_len("masks", len)?;
        }
        self.radii.check(|radii| check_radii("radii", radii))?;
        let Some(half_sizes) = &self.half_sizes else { return Ok(()) };
        half_sizes.check_len("half_sizes", len)?;
        check_each_half_size("half_sizes", half_sizes)
    }

    /// The shapes in some rows, in that order.
    pub fn select(&self, rows: &[u32]) -> Self {
        let (boxes, cores) = (self.boxes.as_ref(), self.cores.as_ref());
        Self {
            centers: rows.iter().map(|&row| self.centers[row as usize]).collect(),
            radii: self.radii.select(rows),
            half_sizes: self.half_sizes.as_ref().map(|sizes| sizes.select(rows)),
            boxes: boxes.map(|boxes| rows.iter().map(|&row| boxes[row as usize]).collect()),
            cores: cores.map(|cores| rows.iter().map(|&row| cores[row as usize]).collect()),
            filters: self
                .filters
                .as_ref()
                .map(|pair| pair.each_ref().map(|each| each.select(rows))),
            period: self.period,
        }
    }

    /// The same shapes in a periodic plane, with their centres in the first period. Refuses segments
    /// that are longer than a period along an axis.
    pub fn in_period(self, period: Period<T>) -> Result<Self> {
        self.check_period(&period)?;
        Ok(self.wrapped_in(period))
    }

    /// As [`Shapes::in_period`], for segments that are no longer than a period up to rounding.
    pub fn wrapped_in(mut self, period: Period<T>) -> Self {
        self.period = period;
        if period.is_none() {
            return self;
        }
        if let Some(boxes) = &mut self.boxes {
            for (corners, center) in boxes.iter_mut().zip(&mut self.centers) {
                let [[min_x, min_y], [max_x, max_y]] = period.wrap_corners(self::corners(corners));
                *corners = [min_x, min_y, max_x, max_y];
                // Computed again from the moved corners: the tree sorts by the centre and tests the
                // corners, so the two must belong together to the last bit.
                *center = middle_of(corners);
            }
        } else {
            self.centers.iter_mut().for_each(|center| *center = period.wrap(*center));
        }
        self
    }

    /// Refuses segments whose ends are more than a period apart along an axis.
    pub fn check_period(&self, period: &Period<T>) -> Result<()> {
        // Boxes of any size have an answer: the nearest image decides. Of a longer segment an image
        // farther away could be nearer.
        let rows = if self.cores.is_some() && !period.is_none() { self.len() } else { 0 };
        let segments = (0..rows).filter_map(|row| Some((row, self.shape(row).segment()?)));
        for (row, segment) in segments {
            check_segment("segments", row, segment, period)?;
        }
        Ok(())
    }

    /// The same shapes with radii larger by half of `distance`, so that two of them overlap if the
    /// gap between them was less than that. Refuses a distance that is out of range.
    pub fn grown(mut self, distance: T) -> Result<Self> {
        let by = half_of(distance)?;
        if by == T::ZERO {
            return Ok(self);
        }
        self.radii = match self.radii {
            Each::One(radius) => Each::One(radius + by),
            Each::Rows(mut radii) => {
                radii.iter_mut().for_each(|radius| *radius = *radius + by);
                Each::Rows(radii)
            }
        };
        Ok(self)
    }

    /// No shapes, in a periodic plane.
    pub fn none_in(period: Period<T>) -> Self {
        Self { period, ..Self::default() }
    }

    /// The columns, for callers that reuse their memory and write only values that they have checked:
    /// with others the answers are wrong, and searches may panic.
    #[doc(hidden)]
    pub fn columns_mut(&mut self) -> ShapeColumns<'_, T> {
        let Self { centers, radii, half_sizes, boxes, cores, filters, .. } = self;
        ShapeColumns { centers, radii, half_sizes, boxes, cores, filters }
    }

    /// Centres; those of boxes are rounded.
    pub fn centers(&self) -> &[[T; 2]] {
        &self.centers
    }

    /// Radii.
    pub fn radii(&self) -> &Each<T> {
        &self.radii
    }

    /// Half widths and half heights; None if every shape is a circle or given as a box.
    pub fn half_sizes(&self) -> Option<&Each<[T; 2]>> {
        self.half_sizes.as_ref()
    }

    /// Min x, min y, max x, max y of every shape; None if all are given by their centres.
    pub fn boxes(&self) -> Option<&[[T; 4]]> {
        self.boxes.as_deref()
    }

    /// What the core of every shape is within its box; None if all are the boxes.
    pub fn cores(&self) -> Option<&[Core]> {
        self.cores.as_deref()
    }

    /// Whether there are categories and masks.
    pub fn has_filters(&self) -> bool {
        self.filters.is_some()
    }

    /// The period of the plane that they are in. Their centres are in the first period.
    pub fn period(&self) -> Period<T> {
        self.period
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.centers.len()
    }

    /// Allocated bytes, used or not, of centres, radii and boxes.
    pub fn memory_bytes(&self) -> usize {
        let boxes = self.boxes.as_ref().map_or(0, Vec::capacity);
        (3 * self.centers.capacity() + 4 * boxes) * size_of::<T>()
    }

    /// Whether there is no shape.
    pub fn is_empty(&self) -> bool {
        self.centers.is_empty()
    }

    /// The shape in `row`.
    pub fn shape(&self, row: usize) -> Shape<T> {
        let half_size = self.half_sizes.as_ref().map_or([T::ZERO; 2], |sizes| sizes.at(row));
        let center = self.centers[row];
        let [min, max] = self.boxes.as_ref().map_or([center; 2], |boxes| corners(&boxes[row]));
        let filter = |which: usize, default| {
            self.filters.as_ref().map_or(default, |filters| filters[which].at(row))
        };
        Shape {
            min,
            max,
            half_size,
            radius: self.radii.at(row),
            category: filter(0, DEFAULT_CATEGORY),
            mask: filter(1, DEFAULT_MASK),
            core: self.cores.as_ref().map_or(Core::Box, |cores| cores[row]),
        }
    }
}

/// Replaces the filters of [`Shapes`], reusing their memory; no filters become None.
pub fn fill_filters(
    filters: impl ExactSizeIterator<Item = Filter>,
    columns: &mut Option<[Each<u32>; 2]>,
) -> Result<()> {
    if filters.len() == 0 {
        *columns = None;
        return Ok(());
    }
    let [categories, masks] = columns.get_or_insert_default();
    let (categories, masks) = (categories.rows_mut(), masks.rows_mut());
    categories.clear();
    masks.clear();
    jostle_base::reserve!(filters.len(); *categories, *masks);
    for Filter { category, mask } in filters {
        categories.push(category);
        masks.push(mask);
    }
    Ok(())
}

/// Half of the distance of a search for shapes near each other, by which the radius of each is
/// increased. Refuses a distance that is negative, not finite, or out of range.
pub fn half_of<T: Scalar>(distance: T) -> Result<T> {
    let [min, max] = T::RADII;
    let half = distance * T::from_f64(0.5);
    // Half of the smallest number is 0, but it is not a distance of 0, and is refused. NaN fails
    // all comparisons.
    if half == T::ZERO && distance == T::ZERO || (half >= min && half <= max) {
        return Ok(half);
    }
    let [min, max] = [min, max].map(|limit| T::from_f64(2.0) * limit);
    let rule = format!("it must be 0, or between {min:e} and {max:e}");
    Err(Error::of("distance", distance, &rule))
}

/// Lower and upper corner of a box.
#[inline(always)]
pub fn corners<T: Copy>(&[min_x, min_y, max_x, max_y]: &[T; 4]) -> [[T; 2]; 2] {
    [[min_x, min_y], [max_x, max_y]]
}

/// The middle of a box.
pub fn middle_of<T: Scalar>(&[min_x, min_y, max_x, max_y]: &[T; 4]) -> [T; 2] {
    [middle(min_x, max_x), middle(min_y, max_y)]
}

/// Refuses a rectangle that is not finite, or has a minimum above its maximum.
pub fn check_rects<T: Scalar>(argument: &'static str, rows: &[[T; 4]]) -> Result<()> {
    let finite = |row: &[T; 4]| row.iter().all(|v| v.is_finite());
    let good = |row: &[T; 4]| finite(row) && row[0] <= row[2] && row[1] <= row[3];
    let Some(index) = rows.iter().position(|row| !good(row)) else { return Ok(()) };
    let rule = if finite(&rows[index]) {
        "it must be (min_x, min_y, max_x, max_y), no minimum above its maximum"
    } else {
        "all four numbers must be finite"
    };
    Err(Error::at(argument, index, tuple(&rows[index]), rule))
}

/// Refuses boxes that are not valid rectangles, or are larger than half sizes allow.
pub fn check_boxes<T: Scalar>(argument: &'static str, boxes: &[[T; 4]]) -> Result<()> {
    check_rects(argument, boxes)?;
    let half = T::from_f64(0.5);
    // Halves are subtracted, since the width of a box from -1e308 to 1e308 is infinite.
    let fits = |min: T, max: T| max * half - min * half <= T::MAX_SIZE;
    let too_large = |row: &[T; 4]| !(fits(row[0], row[2]) && fits(row[1], row[3]));
    let Some(index) = boxes.iter().position(too_large) else { return Ok(()) };
    let limit = 2.0 * T::MAX_SIZE.to_f64();
    let rule = format!("a box must be at most {limit:e} wide and high");
    Err(Error::at(argument, index, tuple(&boxes[index]), &rule))
}

/// Refuses segments by the rules of [`check_segment`].
pub fn check_segments<T: Scalar>(
    argument: &'static str,
    rows: &[[[T; 2]; 2]],
    period: &Period<T>,
) -> Result<()> {
    (0..).zip(rows).try_for_each(|(row, segment)| check_segment(argument, row, *segment, period))
}

/// Refuses a segment that is not finite, is larger than half sizes allow, or whose ends are more than
/// a period apart along an axis.
pub fn check_segment<T: Scalar>(
    argument: &'static str,
    row: usize,
    segment: [[T; 2]; 2],
    period: &Period<T>,
) -> Result<()> {
    let ([start, end], half) = (segment, T::from_f64(0.5));
    let refused = |rule: &str| Err(Error::at(argument, row, told(segment), rule));
    if !segment.as_flattened().iter().all(|v| v.is_finite()) {
        return refused("both ends must be finite");
    }
    if (0..2).any(|axis| (end[axis] * half - start[axis] * half).abs() > T::MAX_SIZE) {
        let most = 2.0 * T::MAX_SIZE.to_f64();
        return refused(&format!("its ends must be at most {most:e} apart along each axis"));
    }
    if period.is_exceeded_by([0, 1].map(|axis| end[axis] - start[axis])) {
        let sides = tuple(&period.sides());
        return refused(&format!(
            "with period={sides}, its ends must be at most one period apart along each axis"
        ));
    }
    Ok(())
}

/// A segment in the form of two Python tuples.
fn told<T: Scalar>([start, end]: [[T; 2]; 2]) -> String {
    format!("({}, {})", tuple(&start), tuple(&end))
}

/// Numbers in the form of a Python tuple.
pub fn tuple<T: Scalar>(values: &[T]) -> String {
    let number = |v: &T| {
        let size = v.abs().to_f64();
        // The limits of Python's `repr`: a message shows a number as its user would print it.
        if size < 1e16 && (size >= 1e-4 || size == 0.0) { v.to_string() } else { format!("{v:e}") }
    };
    let values: Vec<String> = values.iter().map(number).collect();
    format!("({})", values.join(", "))
}

/// Refuses a pair of coordinates that is not finite.
pub fn check_finite<T: Scalar>(argument: &'static str, centers: &[[T; 2]]) -> Result<()> {
    let finite = |v: &T| v.is_finite();
    // Without an early exit the compiler vectorizes the loop.
    if centers.as_flattened().iter().fold(true, |all, v| all & finite(v)) {
        return Ok(());
    }
    match centers.iter().position(|center| !center.iter().all(finite)) {
        Some(index) => {
            let [x, y] = centers[index];
            let rule = "both coordinates must be finite";
            Err(Error::at(argument, index, format!("({x}, {y})"), rule))
        }
        None => Ok(()),
    }
}

/// Refuses a radius that is not 0 and not within [`Scalar::RADII`].
pub fn check_radii<T: Scalar>(argument: &'static str, radii: &[T]) -> Result<()> {
    let [min, max] = T::RADII;
    let fits = |r: &T| (*r == T::ZERO) | ((*r >= min) & (*r <= max));
    let dtype = if size_of::<T>() == 4 { "float32" } else { "float64" };
    let rule = format!("a radius must be 0, or between {min:e} and {max:e} in {dtype}");
    check_each(argument, "a radius", radii, fits, &rule)
}

/// Refuses the first size that does not fit; `rule` describes the limits of valid sizes.
fn check_each<T: Scalar>(
    argument: &'static str,
    noun: &str,
    sizes: &[T],
    fits: impl Fn(&T) -> bool,
    rule: &str,
) -> Result<()> {
    // Without an early exit the compiler vectorizes the loop.
    if sizes.iter().fold(true, |all, size| all & fits(size)) {
        return Ok(());
    }
    let Some(index) = sizes.iter().position(|size| !fits(size)) else { return Ok(()) };
    let size = sizes[index];
    // The value is a size, but out of range: then the limits help. Otherwise the rule without
    // limits does.
    if size >= T::ZERO && size.is_finite() {
        return Err(Error::at(argument, index, format!("{size:e}"), rule));
    }
    Err(Error::at(argument, index, size, &format!("{noun} must be finite and at least 0")))
}

/// Refuses a half size that is negative, not finite or above [`Scalar::MAX_SIZE`].
pub fn check_each_half_size<T: Scalar>(
    argument: &'static str,
    half_sizes: &Each<[T; 2]>,
) -> Result<()> {
    let fits = |size: &T| (*size >= T::ZERO) & (*size <= T::MAX_SIZE);
    let rule = format!("a half size must be at most {:e}", T::MAX_SIZE.to_f64());
    half_sizes.check(|sizes| {
        let row = || sizes.iter().position(|size| !size.iter().all(fits)).unwrap_or_default();
        let checked = check_each(argument, "a half size", sizes.as_flattened(), fits, &rule);
        checked.map_err(|error| error.in_row(row()))
    })
}
