//! Shapes made to break a tree, for the tests of everything that uses one.
#![allow(dead_code, reason = "every test file takes what it needs")]

pub mod ranks;
pub mod worlds;

use jostle_base::settings::DEFAULT_MAX_DEPTH;
use jostle_base::{Id, Result, Settings};
use jostle_index::{Each, Quadtree, Scalar, Shapes};
use jostle_space::{ShapeChanges, Space};
use proptest::prelude::*;

/// So many random cases, and `JOSTLE_CASES` times as many where that is set, as in `make full`.
pub fn cases(usual: u32) -> ProptestConfig {
    let times = std::env::var("JOSTLE_CASES").map_or(1, |times| times.parse().expect("a number"));
    ProptestConfig::with_cases(usual * times)
}

/// Raw shapes, to be read in either type.
#[derive(Clone, Debug)]
pub struct Raw {
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub radius: Vec<f64>,
    pub half: Option<[Vec<f64>; 2]>,
    /// Widths and heights, where the shapes are boxes with a corner at x, y.
    pub size: Option<[Vec<f64>; 2]>,
    pub filter: Option<[Vec<u32>; 2]>,
}

impl Raw {
    pub fn typed<T: Scalar>(&self) -> Shapes<T> {
        let pairs = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(&a, &b)| [T::from_f64(a), T::from_f64(b)]).collect()
        };
        let radii = self.radius.iter().map(|&v| T::from_f64(v)).collect();
        let filters = self.filter.clone().map(|filter| filter.map(Each::Rows));
        if let Some([width, height]) = &self.size {
            let corner = |row: usize| {
                let (x, y) = (self.x[row], self.y[row]);
                [x, y, x + width[row], y + height[row]].map(T::from_f64)
            };
            let boxes = (0..self.x.len()).map(corner).collect();
            return Shapes::from_boxes(boxes, Each::Rows(radii), filters)
                .expect("the generated boxes are valid");
        }
        let half_sizes = self.half.as_ref().map(|[x, y]| Each::Rows(pairs(x, y)));
        Shapes::new(pairs(&self.x, &self.y), Each::Rows(radii), half_sizes, filters)
            .expect("the generated shapes are valid")
    }
}

/// Coordinates of every kind: ordinary, on the borders of cells, coincident,
/// nearly coincident, huge, tiny.
pub fn coordinate() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        6 => -100.0..100.0f64,
        3 => (-16i32..16).prop_map(f64::from),
        2 => Just(0.0),
        1 => (-8i32..8).prop_map(|k| 7.0 + f64::from(k) * 1e-6),
        1 => prop_oneof![Just(1e30), Just(-1e30), Just(1e-30), Just(-1e-30), Just(1e7), Just(-1e7)],
    ]
}

pub fn size() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        6 => 0.0..10.0f64,
        3 => (0i32..4).prop_map(f64::from),
        2 => Just(0.0),
        1 => prop_oneof![Just(1e-6), Just(1e6), Just(1e3)],
    ]
}

pub fn bits() -> impl Strategy<Value = u32> + Clone {
    prop_oneof![Just(0u32), Just(1), Just(2), Just(3), Just(u32::MAX), any::<u32>()]
}

/// x, y, radius, half width, half height, category, mask.
pub type Row = (f64, f64, f64, f64, f64, u32, u32);

pub fn shapes() -> impl Strategy<Value = Raw> {
    let one = (coordinate(), coordinate(), size(), size(), size(), bits(), bits());
    let count = prop_oneof![0usize..4, 4usize..40, 40usize..250];
    let rows = count.prop_flat_map(move |count| prop::collection::vec(one.clone(), count));
    (rows, 0..4, any::<bool>(), any::<bool>()).prop_map(|(rows, kind, filters, line)| {
        let column = |pick: fn(&Row) -> f64| rows.iter().map(pick).collect::<Vec<f64>>();
        Raw {
            x: column(|row| row.0),
            y: if line { vec![3.0; rows.len()] } else { column(|row| row.1) },
            // Boxes with and without radii.
            radius: if kind == 3 { vec![0.0; rows.len()] } else { column(|row| row.2) },
            half: (kind == 1).then(|| [column(|row| row.3), column(|row| row.4)]),
            size: (kind > 1).then(|| [column(|row| row.3), column(|row| row.4)]),
            filter: filters.then(|| {
                [rows.iter().map(|row| row.5).collect(), rows.iter().map(|row| row.6).collect()]
            }),
        }
    })
}

pub fn settings() -> impl Strategy<Value = Settings> {
    let depth = prop_oneof![Just(0usize), Just(1), Just(2), Just(5), Just(DEFAULT_MAX_DEPTH)];
    (1usize..40, depth, 1usize..4).prop_map(|(leaf_capacity, max_depth, threads)| Settings {
        leaf_capacity,
        max_depth,
        threads: Some(threads),
    })
}

pub fn built<T: Scalar>(shapes: &Shapes<T>, settings: Settings) -> Quadtree<T> {
    let tree = Quadtree::new(shapes, settings).expect("valid settings");
    tree.check().expect("the tree's invariants hold");
    tree
}

/// Changes of one column or two of a space.
pub trait SetShapes<T> {
    fn move_to(&mut self, ids: &[Id], centers: &[[T; 2]]) -> Result<()>;
    fn move_to_boxes(&mut self, ids: &[Id], boxes: &[[T; 4]]) -> Result<()>;
    fn resize(
        &mut self,
        ids: &[Id],
        radii: Option<&Each<T>>,
        half_sizes: Option<&Each<[T; 2]>>,
    ) -> Result<()>;
    fn set_filter(
        &mut self,
        ids: &[Id],
        categories: Option<&Each<u32>>,
        masks: Option<&Each<u32>>,
    ) -> Result<()>;
}

impl<T: Scalar> SetShapes<T> for Space<T> {
    fn move_to(&mut self, ids: &[Id], centers: &[[T; 2]]) -> Result<()> {
        let positions = Some(Each::Rows(centers.to_vec()));
        self.set(ids, &ShapeChanges { positions, ..ShapeChanges::default() })
    }

    fn move_to_boxes(&mut self, ids: &[Id], boxes: &[[T; 4]]) -> Result<()> {
        let boxes = Some(Each::Rows(boxes.to_vec()));
        self.set(ids, &ShapeChanges { boxes, ..ShapeChanges::default() })
    }

    fn resize(
        &mut self,
        ids: &[Id],
        radii: Option<&Each<T>>,
        half_sizes: Option<&Each<[T; 2]>>,
    ) -> Result<()> {
        let (radii, half_sizes) = (radii.cloned(), half_sizes.cloned());
        self.set(ids, &ShapeChanges { radii, half_sizes, ..ShapeChanges::default() })
    }

    fn set_filter(
        &mut self,
        ids: &[Id],
        categories: Option<&Each<u32>>,
        masks: Option<&Each<u32>>,
    ) -> Result<()> {
        let (categories, masks) = (categories.cloned(), masks.cloned());
        self.set(ids, &ShapeChanges { categories, masks, ..ShapeChanges::default() })
    }
}
