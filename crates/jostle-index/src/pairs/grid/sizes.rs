//! Shapes with the sizes that a grid sorts with them: none for circles of one radius, a radius,
//! half sizes, or both.

use std::ops::Range;

use super::layout::Layout;
use crate::geometry::Scalar;
use crate::quadtree::partition::{Item, Source};
use crate::shapes::{Each, Shapes};
use jostle_simd::{LANES, Simd, Work};

/// Circles of one radius.
pub(super) const EQUAL: usize = 0;

/// Circles: the radius.
pub(super) const CIRCLES: usize = 1;

/// Rectangles: half width and half height.
pub(super) const RECTANGLES: usize = 2;

/// Rounded rectangles: half width, half height, radius.
pub(super) const ROUNDED: usize = 3;

/// Half the width and the height of the bounding box of a shape.
#[inline(always)]
pub(super) fn half_extent_of<T: Scalar, const SIZES: usize>(sizes: &[T; SIZES]) -> [T; 2] {
    match SIZES {
        EQUAL => [T::ZERO; 2],
        CIRCLES => [sizes[0]; 2],
        RECTANGLES => [sizes[0], sizes[1]],
        _ => [sizes[0] + sizes[2], sizes[1] + sizes[2]],
    }
}

/// Shapes to be sorted into a grid.
pub(super) trait Input<T, const SIZES: usize>: Sync {
    /// Number of shapes.
    fn len(&self) -> usize;
    /// The shape at `index`.
    fn item(&self, index: usize) -> Item<T, SIZES>;
}

/// The shapes of the caller.
pub(super) struct Rows<'a, T> {
    pub(super) centers: &'a [[T; 2]],
    pub(super) radii: &'a Each<T>,
    pub(super) half_sizes: Option<&'a Each<[T; 2]>>,
}

impl<'a, T> Rows<'a, T> {
    /// The centres and the sizes of shapes.
    pub(super) fn of(shapes: &'a Shapes<T>) -> Self {
        let Shapes { centers, radii, half_sizes, .. } = shapes;
        Self { centers, radii, half_sizes: half_sizes.as_ref() }
    }
}

impl<T: Scalar, const SIZES: usize> Input<T, SIZES> for Rows<'_, T> {
    fn len(&self) -> usize {
        self.centers.len()
    }

    #[inline(always)]
    fn item(&self, index: usize) -> Item<T, SIZES> {
        let mut sizes = [T::ZERO; SIZES];
        if SIZES >= RECTANGLES
            && let Some(halves) = self.half_sizes
        {
            [sizes[0], sizes[1]] = halves.at(index);
        }
        if SIZES == CIRCLES || SIZES == ROUNDED {
            sizes[SIZES - 1] = self.radii.at(index);
        }
        Item { key: 0, row: index as u32, center: self.centers[index], sizes }
    }
}

impl<T: Scalar, const SIZES: usize> Input<T, SIZES> for [Item<T, SIZES>] {
    fn len(&self) -> usize {
        <[Item<T, SIZES>]>::len(self)
    }

    #[inline(always)]
    fn item(&self, index: usize) -> Item<T, SIZES> {
        self[index]
    }
}

/// Shapes with the keys of their cells. The key of a large shape is that of the block after the
/// last band.
pub(super) struct Keyed<'a, T, I: ?Sized> {
    pub(super) layout: Layout,
    /// Half the width and the height of the largest small shape.
    pub(super) small: [T; 2],
    pub(super) input: &'a I,
}

impl<T: Scalar, const SIZES: usize, I: Input<T, SIZES> + ?Sized> Source<T, SIZES>
    for Keyed<'_, T, I>
{
    fn len(&self) -> usize {
        self.input.len()
    }

    fn keys(&self, range: Range<usize>, keys: &mut [u32]) {
        T::with_widest(Keys { keyed: self, start: range.start, keys });
    }

    #[inline(always)]
    fn item(&self, index: usize, key: u32) -> Item<T, SIZES> {
        Item { key, ..self.input.item(index) }
    }
}

/// Computes the keys of some shapes.
struct Keys<'a, 'b, T, I: ?Sized, const SIZES: usize> {
    keyed: &'a Keyed<'b, T, I>,
    start: usize,
    keys: &'a mut [u32],
}

impl<T: Scalar, I: Input<T, SIZES> + ?Sized, const SIZES: usize> Work<T>
    for Keys<'_, '_, T, I, SIZES>
{
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<T>>(self, _: S) {
        let Self { keyed, start, keys } = self;
        let (blocks, rest) = keys.as_chunks_mut::<LANES>();
        let rest_start = start + blocks.len() * LANES;
        for (index, keys) in blocks.iter_mut().enumerate() {
            *keys = keys_of(keyed, start + index * LANES);
        }
        for (index, key) in rest.iter_mut().enumerate() {
            [*key] = keys_of(keyed, rest_start + index);
        }
    }
}

/// The keys of the shapes from `start`.
#[inline(always)]
fn keys_of<T: Scalar, I: Input<T, SIZES> + ?Sized, const SIZES: usize, const COUNT: usize>(
    keyed: &Keyed<'_, T, I>,
    start: usize,
) -> [u32; COUNT] {
    let Keyed { layout, small, input } = keyed;
    let (mut along, mut across) = ([0.0; COUNT], [0.0; COUNT]);
    let mut large = [false; COUNT];
    // Loops over arrays of a constant length, without branches inside: the compiler makes vector
    // instructions of them.
    for lane in 0..COUNT {
        let item = input.item(start + lane);
        along[lane] = item.center[layout.axis].to_f64();
        across[lane] = item.center[1 - layout.axis].to_f64();
        let half_extent = half_extent_of(&item.sizes);
        // Half extents are rounded sums, here and where `small` was chosen. So the largest small
        // shape is small here, too.
        large[lane] = SIZES != EQUAL && (half_extent[0] > small[0]) | (half_extent[1] > small[1]);
    }
    let mut keys = layout.keys(&along, &across);
    if SIZES != EQUAL {
        let last = layout.key_of_large();
        for lane in 0..COUNT {
            keys[lane] = if large[lane] { last } else { keys[lane] };
        }
    }
    keys
}
