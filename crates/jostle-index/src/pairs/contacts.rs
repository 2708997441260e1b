//! Overlapping pairs with normals and depths.

use super::{Found, between, within};
use crate::geometry::{self, Scalar, Shape};
use crate::period::Period;
use crate::quadtree::Quadtree;
use jostle_base::error::Result;
use jostle_base::interrupt::Pulse;
use jostle_base::memory;

/// Approximate number of values read to compute a contact.
const CONTACT_WORK: usize = 16;

/// Pairs that overlap, with their contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlaps<T, I> {
    /// The pairs `[i, j]`.
    pub pairs: Vec<[I; 2]>,
    /// Unit vectors from `i` to `j`.
    pub normals: Vec<[T; 2]>,
    /// Penetration depths along the normals.
    pub depths: Vec<T>,
    /// One or two points of each contact, as of [`contact_points`](geometry::contact_points); of periodic shapes
    /// those of the image next to `i`.
    pub points: Vec<[[T; 2]; 2]>,
    /// The categories of both shapes.
    pub categories: Vec<[u32; 2]>,
    /// Number of pairs of shapes that were tested.
    pub tests: u64,
}

impl<T: Scalar, I: Copy> Overlaps<T, I> {
    /// The contacts of some pairs, the minimum images in a periodic plane. `shapes` returns the
    /// shapes of a pair.
    pub fn of(
        pairs: Vec<[I; 2]>,
        tests: u64,
        period: &Period<T>,
        shapes: impl Fn([I; 2]) -> [Shape<T>; 2],
    ) -> Result<Self> {
        let mut normals = memory::with_capacity(pairs.len())?;
        let mut depths = memory::with_capacity(pairs.len())?;
        let mut points = memory::with_capacity(pairs.len())?;
        let mut categories = memory::with_capacity(pairs.len())?;
        let mut pulse = Pulse::current();
        for &pair in &pairs {
            pulse.check(CONTACT_WORK)?;
            let [mut a, mut b] = shapes(pair);
            let place = a.min;
            if !period.is_none() {
                // The images by which the pair was found, so the depth is positive for each pair.
                [a, b] = period.nearest_images(&a, &b);
            }
            let (normal, depth) = geometry::contact(&a, &b);
            let both = geometry::contact_points(&a, &b, (normal, depth));
            normals.push(normal);
            depths.push(depth);
            let shift = [place[0] - a.min[0], place[1] - a.min[1]];
            points.push(both.map(|point| [point[0] + shift[0], point[1] + shift[1]]));
            categories.push([a.category, b.category]);
        }
        Ok(Self { pairs, normals, depths, points, categories, tests })
    }
}

/// As [`within`], or as [`between`] if there is an `other` tree, with normals and depths; sorted by
/// first, then by second, if `sorted`.
pub fn overlaps<T: Scalar>(
    tree: &Quadtree<T>,
    other: Option<&Quadtree<T>>,
    (mask, sorted): (Option<u32>, bool),
    max_pairs: usize,
) -> Result<Overlaps<T, u32>> {
    let mut found = match other {
        None => within(tree, mask, max_pairs)?,
        Some(other) => between(tree, other, mask, max_pairs)?,
    };
    if sorted {
        found.sort()?;
    }
    let Found { pairs, tests } = found;
    let indices = [indices_of(tree)?, other.map_or_else(|| Ok(Vec::new()), indices_of)?];
    Overlaps::of(pairs, tests, &tree.period(), |[i, j]| {
        let first = tree.columns().shape(indices[0][i as usize] as usize);
        let second = match other {
            None => tree.columns().shape(indices[0][j as usize] as usize),
            Some(other) => other.columns().shape(indices[1][j as usize] as usize),
        };
        [first, second]
    })
}

/// The index of each row of a tree.
fn indices_of<T: Scalar>(tree: &Quadtree<T>) -> Result<Vec<u32>> {
    let mut indices = memory::filled(tree.len(), 0)?;
    for (index, &row) in (0..).zip(tree.rows()) {
        // The columns of a tree are in Morton order, the pairs are rows. The inverse of the
        // permutation costs one pass; a search for each pair would cost more.
        indices[row as usize] = index;
    }
    Ok(indices)
}
