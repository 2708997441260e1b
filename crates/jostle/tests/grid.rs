//! The grids for circles and rectangles against brute force.

use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Error, Method};
use jostle_index::pairs::{self, FindScratch};
use jostle_index::{Each, Scalar, Shapes};
use jostle_scenes::random::Random;
use jostle_simd::{self as simd, Instructions};
use proptest::prelude::*;

/// Whether the tree was used for the pairs, which are sorted.
fn find<T: Scalar>(shapes: &Shapes<T>, threads: usize) -> (bool, Vec<[u32; 2]>) {
    let mut scratch = FindScratch::default();
    let threads = Some(threads);
    let found = pairs::find_with(&mut scratch, shapes, None, threads, DEFAULT_MAX_PAIRS);
    let mut found = found.unwrap();
    found.sort().unwrap();
    (!scratch.tree.is_empty(), found.pairs)
}

fn brute<T: Scalar>(shapes: &Shapes<T>) -> Vec<[u32; 2]> {
    let method = Some(Method::Brute);
    let mut found = pairs::find(shapes, method, Some(1), DEFAULT_MAX_PAIRS).unwrap();
    found.sort().unwrap();
    found.pairs
}

/// Circles at random places of a rectangle.
fn circles<T: Scalar>(
    seed: u64,
    count: usize,
    [width, height]: [f32; 2],
    middle: [f64; 2],
    radius: f64,
) -> Shapes<T> {
    let mut random = Random::new(seed);
    let centers = (0..count).map(|_| {
        let place = [random.between(0.0, width), random.between(0.0, height)];
        [0, 1].map(|k| T::from_f64(middle[k] + f64::from(place[k])))
    });
    Shapes::circles(centers.collect(), Each::One(T::from_f64(radius))).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..crate::common::cases(50) })]

    /// Sparse to crowded, square to narrow, far from the origin.
    #[test]
    fn its_pairs_are_those_of_brute_force(
        seed in 0u64..1000,
        count in 301usize..1200,
        proportion in prop_oneof![Just(1.0f32), Just(0.01), Just(40.0), Just(0.0)],
        covered in prop_oneof![Just(0.02f32), 0.1f32..1.0, 1.0f32..20.0],
        offset in prop_oneof![Just(0.0), Just(-1e4), Just(1e6)],
    ) {
        let side = (count as f32 * std::f32::consts::PI / covered).sqrt();
        let extent = [side, side * proportion];
        let one = circles::<f32>(seed, count, extent, [offset, 7.0], 1.0);
        let two = circles::<f64>(seed, count, extent, [7.0, offset], 1.0);
        let expected = (brute(&one), brute(&two));
        for most in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            // Other tests may set another limit meanwhile: then more than one is tested here.
            simd::limit(most);
            prop_assert_eq!(&find(&one, 1).1, &expected.0);
            prop_assert_eq!(&find(&two, 2).1, &expected.1);
        }
    }
}

#[test]
fn bands_of_many_circles_agree_on_all_threads() {
    for extent in [[300.0, 300.0], [2000.0, 40.0]] {
        let shapes = circles::<f32>(3, 40_000, extent, [5.0, -9.0], 0.9);
        let (by_tree, found) = find(&shapes, 1);
        assert!(!by_tree);
        let tree = Some(Method::Quadtree);
        let mut expected = pairs::find(&shapes, tree, Some(1), DEFAULT_MAX_PAIRS).unwrap();
        expected.sort().unwrap();
        assert!(found == expected.pairs);
        assert!(found.len() > 50_000, "{}", found.len());
        assert!(find(&shapes, 8) == (false, found));
    }
}

#[test]
fn circles_that_touch_do_not_overlap() {
    let lattice = |step: f64| {
        let centers = (0..40).flat_map(|i| (0..40).map(move |j| [i, j]));
        let centers = centers.map(|center| center.map(|v| step * f64::from(v)));
        Shapes::circles(centers.collect(), Each::One(0.5)).unwrap()
    };
    assert_eq!(find(&lattice(1.0), 1), (false, Vec::new()));
    assert_eq!(find(&lattice(1.0 - 1e-9), 1).1.len(), 2 * 40 * 39);
}

/// What the sizes of shapes are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sizes {
    Circles,
    Rectangles,
    Rounded,
}

/// Shapes whose sizes are between 1 and `largest`, every octave with the same area, some at the same
/// place and some without a size.
fn mixed<T: Scalar>(seed: u64, count: usize, sizes: Sizes, largest: f32, side: f32) -> Shapes<T> {
    let mut random = Random::new(seed);
    let number = |value: f32| T::from_f64(f64::from(value));
    let mut size = || match random.between(0.0, 1.0) {
        at if at < 0.02 => 0.0,
        at => 1.0 / (1.0 - at * (1.0 - largest.powi(-2))).sqrt(),
    };
    let radii: Vec<T> = (0..count).map(|_| number(size())).collect();
    let halves: Vec<[T; 2]> = (0..count).map(|_| [(); 2].map(|()| number(size()))).collect();
    let mut centers: Vec<[T; 2]> =
        (0..count).map(|_| [(); 2].map(|()| number(random.between(0.0, side)))).collect();
    for row in (0..count.saturating_sub(7)).step_by(97) {
        centers[row + 7] = centers[row];
    }
    let halves = (sizes != Sizes::Circles).then_some(Each::Rows(halves));
    let radii = if sizes == Sizes::Rectangles { Each::One(T::ZERO) } else { Each::Rows(radii) };
    Shapes::new(centers, radii, halves, None).unwrap()
}

/// All kinds of sizes.
const SIZES: [Sizes; 3] = [Sizes::Circles, Sizes::Rectangles, Sizes::Rounded];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..crate::common::cases(50) })]

    /// Equal sizes to many orders of magnitude, sparse to crowded.
    #[test]
    fn pairs_of_different_sizes_are_those_of_brute_force(
        seed in 0u64..1000,
        count in 513usize..1500,
        sizes in prop::sample::select(SIZES.to_vec()),
        largest in prop_oneof![Just(1.5f32), Just(30.0), Just(1e3), Just(1e6)],
        room in prop_oneof![Just(0.3f32), 1.0f32..6.0, Just(40.0)],
        threads in prop::sample::select(vec![1usize, 2, 3, 8]),
    ) {
        let side = room * (count as f32).sqrt();
        let one = mixed::<f32>(seed, count, sizes, largest, side);
        let two = mixed::<f64>(seed, count, sizes, largest, side);
        let expected = (brute(&one), brute(&two));
        for most in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            simd::limit(most);
            prop_assert_eq!(&find(&one, threads).1, &expected.0);
            prop_assert_eq!(&find(&two, threads).1, &expected.1);
        }
    }
}

/// Several grids, many bands, and a few shapes that are larger than all cells.
#[test]
fn many_shapes_of_different_sizes_agree_on_all_threads() {
    for sizes in SIZES {
        let shapes = mixed::<f32>(5, 60_000, sizes, 300.0, 1500.0);
        let (by_tree, found) = find(&shapes, 1);
        assert!(!by_tree, "{sizes:?}");
        let tree = Some(Method::Quadtree);
        let mut expected = pairs::find(&shapes, tree, Some(1), DEFAULT_MAX_PAIRS).unwrap();
        expected.sort().unwrap();
        assert!(found == expected.pairs, "{sizes:?}");
        assert!(found.len() > 40_000, "{}", found.len());
        for threads in [2, 3, 8] {
            assert!(find(&shapes, threads) == (false, found.clone()), "{sizes:?}, {threads}");
        }
    }
}

/// A shape over the whole scene, which a sample does not contain, is no reason for a tree.
#[test]
fn one_shape_may_reach_all_others() {
    let mut shapes = mixed::<f64>(9, 30_000, Sizes::Circles, 2.0, 500.0);
    let Each::Rows(radii) = shapes.columns_mut().radii else { panic!("radii differ") };
    radii[12_345] = 1e4;
    let (by_tree, found) = find(&shapes, 1);
    assert!(!by_tree);
    assert_eq!(found.iter().filter(|pair| pair.contains(&12_345)).count(), 30_000 - 1);
    assert!(found == brute(&shapes));
}

/// Clusters of coincident shapes, which a grid would test pair by pair, and sizes so large that twice
/// as much is infinite.
#[test]
fn shapes_that_no_grid_fits_agree() {
    let mut shapes = mixed::<f64>(11, 2_000, Sizes::Rectangles, 20.0, 600.0);
    for row in 0..1_000 {
        shapes.columns_mut().centers[row] = [300.0 + 1e-9 * row as f64, 300.0];
    }
    let Some(Each::Rows(halves)) = shapes.columns_mut().half_sizes else {
        panic!("half sizes differ")
    };
    halves[..1_000].fill([1e-12; 2]);
    let small = Each::Rows(halves.clone());
    let (by_tree, found) = find(&shapes, 2);
    assert!(by_tree && found == brute(&shapes));
    let huge = |row: usize| [f64::MAX * 0.9, if row.is_multiple_of(9) { 50.0 } else { 1.0 }];
    *shapes.columns_mut().half_sizes = Some(Each::Rows((0..2_000).map(huge).collect()));
    assert!(find(&shapes, 1).1 == brute(&shapes));
    *shapes.columns_mut().radii =
        Each::Rows((0..2_000).map(|row| f64::MAX / f64::from(row + 1)).collect());
    *shapes.columns_mut().half_sizes = Some(small);
    assert!(find(&shapes, 1).1 == brute(&shapes));
}

/// The sample has shapes of both kinds, however they take turns.
#[test]
fn a_pattern_of_the_rows_does_not_matter() {
    for count in (600..2600).step_by(100) {
        let mut shapes =
            mixed::<f64>(2, count, Sizes::Rectangles, 2.0, 11.0 * (count as f32).sqrt());
        let half = |row: usize| if row.is_multiple_of(2) { [25.0, 0.5] } else { [0.5, 25.0] };
        *shapes.columns_mut().half_sizes = Some(Each::Rows((0..count).map(half).collect()));
        let found = pairs::find(&shapes, None, Some(1), DEFAULT_MAX_PAIRS).unwrap();
        assert!(found.tests < 200 * count as u64, "{count}: {}", found.tests);
    }
}

/// A sparse scene would have many empty cells, and a cell of points no size.
#[test]
fn other_shapes_are_searched_by_a_tree() {
    let dense = circles::<f64>(1, 500, [40.0; 2], [0.0; 2], 1.0);
    assert!(!find(&dense, 1).0);
    let filters = Some([Each::One(1), Each::Rows(vec![1; 500])]);
    let mut points = dense.clone();
    *points.columns_mut().radii = Each::One(0.0);
    let mut filtered = dense.clone();
    *filtered.columns_mut().filters = filters;
    let mut far = dense;
    far.columns_mut().centers.iter_mut().for_each(|c| *c = c.map(|v| 1e306 * (v - 20.0)));
    for shapes in [circles::<f64>(1, 500, [4e3; 2], [0.0; 2], 1.0), points, filtered, far] {
        let (by_tree, found) = find(&shapes, 1);
        assert!(by_tree);
        assert_eq!(found, brute(&shapes));
    }
}

#[test]
fn a_limit_stops_the_search() {
    let centers = vec![[3.0f32, 4.0]; 1_000_000];
    let shapes = Shapes::circles(centers, Each::One(1.0)).unwrap();
    for max_pairs in [0, 1000, 1_000_000] {
        let found = pairs::find(&shapes, None, None, max_pairs);
        assert_eq!(found, Err(Error::TooManyPairs { max_pairs }));
    }
    let few = shapes.select(&Vec::from_iter(0..500));
    let exact = 500 * 499 / 2;
    assert_eq!(pairs::find(&few, None, None, exact).unwrap().pairs.len(), exact);
    assert!(pairs::find(&few, None, None, exact - 1).is_err());
}

/// Memory is kept: later searches of the same shapes need no more.
#[test]
fn memory_is_reused() {
    let shapes = circles::<f64>(5, 20_000, [150.0; 2], [0.0; 2], 0.5);
    let mut scratch = FindScratch::default();
    let bytes = [(); 5].map(|()| {
        let found = pairs::find_with(&mut scratch, &shapes, None, Some(1), 1 << 20).unwrap();
        assert!(found.pairs.len() > 10_000);
        scratch.keep(found.pairs);
        scratch.memory_bytes()
    });
    // Two bands take turns, so that both are large enough after two searches.
    assert!(bytes[2..].iter().all(|&of| of == bytes[1]), "{bytes:?}");
    assert!(bytes[1] < 100 * shapes.len());
}
