//! The tree against brute force, on shapes made to break it.

use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Error, Method, Settings};
use jostle_index::pairs::{Filters, JoinScratch};
use jostle_index::{Columns, Each, Quadtree, Scalar, Shapes, pairs};
use jostle_simd::{self as simd, Instructions};
use proptest::prelude::*;

use crate::common::{Raw, built, settings, shapes};

/// The plainest oracle there is, with the formula of the contract written out.
fn by_the_book<T: Scalar>(a: &Shapes<T>, b: &Shapes<T>, itself: bool) -> Vec<[u32; 2]> {
    let mut all = Vec::new();
    for i in 0..a.len() {
        for j in if itself { i + 1 } else { 0 }..b.len() {
            let (p, q) = (a.shape(i), b.shape(j));
            let larger = |a: T, b: T| if a > b { a } else { b };
            let gap = |k: usize| larger(p.min[k] - q.max[k], q.min[k] - p.max[k]);
            let d = [0, 1].map(|k| gap(k) - (p.half_size[k] + q.half_size[k]));
            let e = d.map(|d| if d > T::ZERO { d } else { T::ZERO });
            let reach = p.radius + q.radius;
            let round = e[0] * e[0] + e[1] * e[1] < reach * reach;
            let square = d[0] < T::ZERO && d[1] < T::ZERO;
            let agree = p.category & q.mask != 0 && q.category & p.mask != 0;
            if (round || square) && agree {
                all.push([i as u32, j as u32]);
            }
        }
    }
    all
}

fn agree<T: Scalar>(shapes: &Raw, settings: Settings) {
    let given = shapes.typed::<T>();
    let expected = by_the_book(&given, &given, true);
    let mut brute =
        pairs::brute(&Columns::of(&given).unwrap(), settings.threads, DEFAULT_MAX_PAIRS).unwrap();
    brute.sort().unwrap();
    assert_eq!(brute.pairs, expected, "brute force");
    for tree in [built(&given, settings), unordered(&given, settings)] {
        for most in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
            // Other tests may set another limit meanwhile: then more than one is tested here.
            simd::limit(most);
            let mut found = pairs::within(&tree, None, DEFAULT_MAX_PAIRS).unwrap();
            found.sort().unwrap();
            assert_eq!(found.pairs, expected, "the tree, with {most:?}");
        }
    }
    let auto = pairs::find(&given, None, settings.threads, DEFAULT_MAX_PAIRS).unwrap();
    let mut auto = auto;
    auto.sort().unwrap();
    assert_eq!(auto.pairs, expected, "the faster of the two");
}

/// A tree with strips in its leaves.
fn unordered<T: Scalar>(shapes: &Shapes<T>, settings: Settings) -> Quadtree<T> {
    let mut tree = Quadtree::default();
    tree.fill_unordered(shapes, settings).unwrap();
    assert_eq!(tree.check(), Ok(()));
    tree
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..crate::common::cases(200) })]

    #[test]
    fn pairs_are_those_of_brute_force(shapes in shapes(), settings in settings()) {
        agree::<f32>(&shapes, settings);
        agree::<f64>(&shapes, settings);
    }

    #[test]
    fn pairs_between_two_trees_are_those_of_brute_force(
        first in shapes(), second in shapes(), settings in settings(),
    ) {
        let (a, b) = (first.typed::<f32>(), second.typed::<f32>());
        let expected = by_the_book(&a, &b, false);
        let tree_b = unordered(&b, Settings::default());
        let mut found = pairs::between(&unordered(&a, settings), &tree_b, None, DEFAULT_MAX_PAIRS).unwrap();
        found.sort().unwrap();
        prop_assert_eq!(&found.pairs, &expected);
        let (tree_a, tree_b) = (built(&a, settings), built(&b, Settings::default()));
        let mut found = pairs::between(&tree_a, &tree_b, None, DEFAULT_MAX_PAIRS).unwrap();
        found.sort().unwrap();
        prop_assert_eq!(&found.pairs, &expected);
        let mut brute = pairs::brute_between(&Columns::of(&a).unwrap(), &Columns::of(&b).unwrap(), [0.0; 2], Filters::Apply, DEFAULT_MAX_PAIRS).unwrap();
        brute.sort().unwrap();
        prop_assert_eq!(&found.pairs, &brute.pairs);
    }

    #[test]
    fn a_shifted_join_is_brute_force_with_the_same_shift(
        shapes in shapes(), settings in settings(), shift in [-120.0f32..120.0, -120.0f32..120.0],
    ) {
        let tree = unordered(&shapes.typed::<f32>(), settings);
        let columns = tree.columns();
        let mut found = pairs::indices_between(&tree, &tree, shift, Filters::Apply, DEFAULT_MAX_PAIRS, &mut JoinScratch::default()).unwrap();
        found.sort().unwrap();
        let brute = pairs::brute_between(columns, columns, shift, Filters::Apply, DEFAULT_MAX_PAIRS).unwrap();
        prop_assert_eq!(found.pairs, brute.pairs);
    }

    #[test]
    fn the_order_of_the_input_does_not_show(shapes in shapes(), seed in any::<u64>()) {
        let given = shapes.typed::<f32>();
        let mut order: Vec<u32> = (0..given.len() as u32).collect();
        let mut state = seed | 1;
        for last in (1..order.len()).rev() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            order.swap(last, (state >> 33) as usize % (last + 1));
        }
        let mixed_up = given.select(&order);
        let straight = built(&given, Settings::default());
        let mixed_up = built(&mixed_up, Settings::default());
        // The same shapes stand at the same places, so pairs come in the same order.
        for place in 0..given.len() {
            prop_assert_eq!(straight.columns().shape(place), mixed_up.columns().shape(place));
        }
        prop_assert_eq!(
            pairs::indices_within(&straight, DEFAULT_MAX_PAIRS, &mut JoinScratch::default()).unwrap(),
            pairs::indices_within(&mixed_up, DEFAULT_MAX_PAIRS, &mut JoinScratch::default()).unwrap()
        );
    }
}

/// Boxes between neighbouring edges, 0.1 apart: none overlaps another, however the edges
/// are rounded.
fn tiles<T: Scalar>(side: u32) -> Shapes<T> {
    let edge = |k: u32| T::from_f64(f64::from(k) * 0.1);
    let tile = |k: u32| {
        let (column, row) = (k % side, k / side);
        [edge(column), edge(row), edge(column + 1), edge(row + 1)]
    };
    Shapes::from_boxes((0..side * side).map(tile).collect(), Each::One(T::ZERO), None).unwrap()
}

fn tiles_touch<T: Scalar>() {
    let tiles = tiles::<T>(30);
    for method in [Method::Brute, Method::Quadtree] {
        let found = pairs::find(&tiles, Some(method), None, DEFAULT_MAX_PAIRS).unwrap();
        assert_eq!(found.pairs, [[0; 2]; 0], "{method:?}");
    }
    // A hair more, and each overlaps its right neighbour, and those beside that.
    let grown: Vec<[T; 4]> = tiles
        .boxes()
        .unwrap()
        .iter()
        .map(|&row| {
            let mut row = row;
            row[2] = row[2] + row[2] * T::EPSILON;
            row
        })
        .collect();
    let grown = Shapes::from_boxes(grown, Each::One(T::ZERO), None).unwrap();
    let found = pairs::find(&grown, None, None, DEFAULT_MAX_PAIRS).unwrap();
    assert_eq!(found.pairs.len(), 30 * 29);
}

#[test]
fn tiles_that_touch_never_overlap() {
    tiles_touch::<f32>();
    tiles_touch::<f64>();
}

#[test]
fn sides_at_zero_of_either_sign_touch() {
    let boxes = vec![[-1.0, 0.0, -0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [-0.0, -1.0, 1.0, -0.0]];
    for limit in [Instructions::Portable, Instructions::Avx2, Instructions::Avx512] {
        simd::limit(limit);
        let shapes = Shapes::<f32>::from_boxes(boxes.clone(), Each::One(0.0), None).unwrap();
        for method in [Method::Brute, Method::Quadtree] {
            let found = pairs::find(&shapes, Some(method), None, DEFAULT_MAX_PAIRS).unwrap();
            assert_eq!(found.pairs, [[0; 2]; 0]);
        }
    }
}

#[test]
fn a_box_may_be_as_large_as_its_type_allows() {
    let largest = f32::MAX / 8.0;
    let boxes =
        vec![[-largest, -largest, largest, largest], [0.0; 4], [f32::MAX, 0.0, f32::MAX, 1.0]];
    let shapes = Shapes::from_boxes(boxes, Each::One(0.0), None).unwrap();
    let tree = built(&shapes, Settings { leaf_capacity: 1, ..Settings::default() });
    assert_eq!(pairs::within(&tree, None, 9).unwrap().pairs, [[0, 1]]);
}

#[test]
fn cells_contain_the_centres_of_boxes() {
    let boxes = vec![
        [0.0, 0.0, 2.0, 2.0],
        [5.0, 1.0, 7.0, 3.0],
        [1.0, 6.0, 3.0, 8.0],
        [-93.0, 6.0, 107.0, 8.0],
    ];
    let shapes = Shapes::<f64>::from_boxes(boxes, Each::One(0.0), None).unwrap();
    let tree = built(&shapes, Settings { leaf_capacity: 1, ..Settings::default() });
    // As for four discs at these middles, however wide one of the boxes is.
    assert_eq!(tree.cells().unwrap()[0], [1.0, 1.0, 9.0, 9.0]);
}

/// Discs of equal radius at given places.
fn discs(places: impl Iterator<Item = [f64; 2]>, radius: f64) -> Shapes<f64> {
    Shapes::circles(places.collect(), Each::One(radius)).unwrap()
}

/// The shapes with another radius in one row.
fn with_radius(shapes: Shapes<f64>, row: usize, radius: f64) -> Shapes<f64> {
    let mut radii = shapes.radii().clone().rows(shapes.len());
    radii[row] = radius;
    Shapes::circles(shapes.centers().to_vec(), Each::Rows(radii)).unwrap()
}

/// Low-discrepancy points of the unit square.
fn spread_out(count: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(|i| {
        [(i as f64 * 0.754_877_666_246_693).fract(), (i as f64 * 0.569_840_290_998_053_2).fract()]
    })
}

fn tests_made(columns: &Shapes<f64>) -> u64 {
    let tree = built(columns, Settings { threads: Some(1), ..Settings::default() });
    pairs::within(&tree, None, DEFAULT_MAX_PAIRS).unwrap().tests
}

#[test]
fn a_dense_cluster_in_a_vast_world_costs_what_it_costs_alone() {
    let cluster = || spread_out(100_000);
    let far = [[-1e7, -1e7], [1e7, 1e7]];
    let alone = tests_made(&discs(cluster(), 0.001));
    let together = tests_made(&discs(cluster().chain(far), 0.001));
    assert!(together < alone * 3 / 2, "{alone} tests became {together}");
}

#[test]
fn coincident_points_have_no_pairs_and_cost_nothing() {
    let points = discs((0..100_000).map(|_| [3.0, -4.0]), 0.0);
    assert_eq!(tests_made(&points), 0);
    // One disc on top of them meets them all, and only the disc is tested.
    let with_a_disc = with_radius(points, 500, 1.0);
    let tree = built(&with_a_disc, Settings::default());
    let found = pairs::within(&tree, None, DEFAULT_MAX_PAIRS).unwrap();
    assert_eq!(found.pairs.len(), 99_999);
    assert!(found.tests < 5_000_000, "{} tests", found.tests);
}

#[test]
fn one_huge_disc_among_many_tiny_ones_costs_one_sweep() {
    let tiny = 100_000;
    let all = with_radius(discs(spread_out(tiny).chain([[0.5, 0.5]]), 1e-6), tiny, 10.0);
    let tree = built(&all, Settings { threads: Some(1), ..Settings::default() });
    let found = pairs::within(&tree, None, DEFAULT_MAX_PAIRS).unwrap();
    assert_eq!(found.pairs.iter().filter(|pair| pair[1] == tiny as u32).count(), tiny);
    assert!(found.tests < 40 * tiny as u64, "{} tests", found.tests);
}

#[test]
fn a_line_of_discs_stays_cheap() {
    let line = discs((0..100_000).map(|i| [f64::from(i), 7.0]), 0.6);
    let made = tests_made(&line);
    assert!(made < 100 * 100_000, "{made} tests");
}

#[test]
fn octaves_of_clusters_keep_memory_and_depth_in_bounds() {
    // Each cluster lies a thousand times nearer to the origin than the one before.
    let scales = (0..40).map(|k| 1e60 * 1e-3f64.powi(k));
    let places: Vec<[f64; 2]> =
        scales.flat_map(|scale| spread_out(200).map(move |p| p.map(|v| v * scale))).collect();
    let tree = built(&discs(places.into_iter(), 0.0), Settings::default());
    assert!(tree.nodes().len() < 3 * tree.len(), "{} nodes", tree.nodes().len());
    assert!(tree.depth() < 400, "depth {}", tree.depth());
}

#[test]
fn bullets_that_ignore_each_other_are_not_tested() {
    let count = 50_000;
    // Bullets are 1 and meet ships, which are 2; the last ten are ships.
    let is_ship = |i: usize| i >= count - 10;
    let filter = [
        Each::Rows((0..count).map(|i| 1 + u32::from(is_ship(i))).collect()),
        Each::Rows((0..count).map(|i| 2 - u32::from(is_ship(i))).collect()),
    ];
    let places = spread_out(count).collect();
    let all = Shapes::new(places, Each::One(0.01), None, Some(filter)).unwrap();
    let tree = built(&all, Settings::default());
    let found = pairs::within(&tree, None, DEFAULT_MAX_PAIRS).unwrap();
    assert!(!found.pairs.is_empty());
    assert!(found.pairs.iter().all(|&[i, j]| is_ship(i as usize) != is_ship(j as usize)));
    assert!(found.tests < 5 * count as u64, "{} tests", found.tests);
}

#[test]
fn too_many_pairs_are_an_error_that_names_the_limit() {
    let all = discs((0..2000).map(|_| [0.0; 2]), 1.0);
    let exact = 2000 * 1999 / 2;
    for threads in [1, 2] {
        let tree = built(&all, Settings { threads: Some(threads), ..Settings::default() });
        assert_eq!(pairs::within(&tree, None, exact).unwrap().pairs.len(), exact);
        for max_pairs in [exact - 1, 1000, 0] {
            let error = Error::TooManyPairs { max_pairs };
            assert_eq!(pairs::within(&tree, None, max_pairs), Err(error.clone()));
            assert_eq!(
                pairs::brute(&Columns::of(&all).unwrap(), Some(threads), max_pairs),
                Err(error)
            );
        }
    }
}

#[test]
fn a_limit_stops_the_search_long_before_the_end() {
    // Five hundred thousand million pairs: only a search that stops returns.
    let all = discs((0..1_000_000).map(|_| [0.0; 2]), 1.0);
    let tree = Quadtree::new(&all, Settings { max_depth: 0, ..Settings::default() }).unwrap();
    assert!(pairs::within(&tree, None, 1_000_000).is_err());
    assert!(pairs::between(&tree, &tree, None, 1_000_000).is_err());
    assert!(pairs::brute(&Columns::of(&all).unwrap(), None, 1_000_000).is_err());
}

#[test]
fn a_small_tree_has_these_boxes() {
    let four = discs([[1.0, 1.0], [6.0, 2.0], [2.0, 7.0], [7.0, 7.0]].into_iter(), 0.5);
    let settings = Settings { leaf_capacity: 1, ..Settings::default() };
    let cells: Vec<[f64; 4]> = built(&four, settings).cells().unwrap();
    // Extent 6, so the side is 8, and the origin a multiple of 1.
    assert_eq!(cells[0], [1.0, 1.0, 9.0, 9.0]);
    assert_eq!(
        cells[1..],
        [[1.0, 1.0, 5.0, 5.0], [5.0, 1.0, 9.0, 5.0], [1.0, 5.0, 5.0, 9.0], [5.0, 5.0, 9.0, 9.0],]
    );
}

#[test]
fn max_depth_counts_subdivisions() {
    let many = discs(spread_out(5000), 0.0);
    for max_depth in [0, 1, 2, 3] {
        let tree = built(&many, Settings { leaf_capacity: 1, max_depth, ..Settings::default() });
        assert_eq!(tree.depth(), max_depth);
        assert_eq!(tree.leaf_count(), 4usize.pow(max_depth as u32));
    }
}

#[test]
fn refusals_name_argument_index_and_value() {
    let refuse = |x: Vec<f32>, radii: Vec<f32>, half: Option<Vec<[f32; 2]>>| {
        let centers = x.into_iter().map(|x| [x, 0.0]).collect();
        let refused = Shapes::new(centers, Each::Rows(radii), half.map(Each::Rows), None);
        refused.unwrap_err().to_string()
    };
    let refused = |row: [f32; 4]| {
        let rows = vec![[0.0, 0.0, 1.0, 1.0], row];
        Shapes::from_boxes(rows, Each::One(0.0), None).unwrap_err().to_string()
    };
    assert_eq!(
        refused([2.0, 0.0, 1.0, 1.0]),
        "boxes[1] is (2, 0, 1, 1); it must be (min_x, min_y, max_x, max_y), \
         no minimum above its maximum"
    );
    assert_eq!(
        refused([0.0, 0.0, f32::NAN, 1.0]),
        "boxes[1] is (0, 0, NaN, 1); all four numbers must be finite"
    );
    assert!(refused([0.0, 0.0, 1.0, f32::INFINITY]).starts_with("boxes[1] is (0, 0, 1, inf); "));
    let half = f32::MAX / 2.0;
    let most = f64::from(f32::MAX) / 4.0;
    let rule = format!("; a box must be at most {most:e} wide and high");
    assert!(refused([-half, 0.0, half, 1.0]).ends_with(&rule));
    assert_eq!(
        refuse(vec![0.0; 3], vec![1.0, 1.0, -0.5], None),
        "radii[2] is -0.5; a radius must be finite and at least 0"
    );
    assert_eq!(
        refuse(vec![0.0, f32::NAN], vec![1.0; 2], None),
        "positions[1] is (NaN, 0); both coordinates must be finite"
    );
    assert_eq!(
        refuse(vec![0.0, f32::INFINITY], vec![1.0; 2], None),
        "positions[1] is (inf, 0); both coordinates must be finite"
    );
    assert_eq!(
        refuse(vec![0.0; 2], vec![1.0], None),
        "radii has 1 rows; it must have 2, one for each shape"
    );
    let negative = Some(vec![[1.0, -1.0]]);
    assert_eq!(
        refuse(vec![0.0], vec![1.0], negative),
        "half_sizes[0] is -1; a half size must be finite and at least 0"
    );
}

#[test]
fn threads_do_not_show_in_the_order_of_pairs() {
    let many = discs(spread_out(40_000), 0.004);
    let found = [1, 2, 8].map(|threads| {
        let tree = built(&many, Settings { threads: Some(threads), ..Settings::default() });
        pairs::within(&tree, None, DEFAULT_MAX_PAIRS).unwrap()
    });
    assert!(found[0].pairs.len() > 10_000);
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
}

/// Centres of 9,000 shapes: spread out evenly, in clusters, in a line, on a lattice whose
/// neighbours touch, and all but a few in one place.
fn crowds() -> [Vec<[f64; 2]>; 5] {
    const COUNT: usize = 4800;
    let mut state = 1u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    let mut place = |side: f64| [random() * side, random() * side];
    let spread = (0..COUNT).map(|_| place(150.0)).collect();
    let clusters = (0..COUNT).map(|index| {
        let ([x, y], corner) = (place(6.0), (index % 12) as f64 * 1000.0);
        [x + corner, y * y + 3.0 * corner]
    });
    let line = (0..COUNT).map(|index| [index as f64 * 0.7, (index % 3) as f64 * 0.25]);
    let lattice = (0..COUNT).map(|index| [(index % 95) as f64, (index / 95) as f64]);
    let crowd =
        (0..COUNT).map(|index| if index % 30 == 0 { [index as f64; 2] } else { [7.0, 1e-3] });
    let clusters = clusters.collect();
    [spread, clusters, line.collect(), lattice.collect(), crowd.take(1500).collect()]
}

#[test]
fn many_shapes_have_the_pairs_of_brute_force() {
    for (kind, centers) in crowds().into_iter().enumerate() {
        let len = centers.len();
        let single: Vec<[f32; 2]> = centers.iter().map(|c| c.map(|v| v as f32)).collect();
        let radii = (0..len).map(|index| [0.5, 0.1, 0.0, 0.9][index % 4]).collect();
        let sizes = (0..len).map(|index| [0.4, [0.3, 0.05][index % 2]]).collect();
        let large = |index: usize| if index == 17 { 40.0 } else { 0.5 };
        let shapes = [
            Shapes::circles(single.clone(), Each::One(0.5)).unwrap(),
            Shapes::circles(single.clone(), Each::Rows(radii)).unwrap(),
            Shapes::circles(single.clone(), Each::Rows((0..len).map(large).collect())).unwrap(),
            Shapes::new(single, Each::One(0.1), Some(Each::Rows(sizes)), None).unwrap(),
        ];
        for (sort, shapes) in shapes.iter().enumerate() {
            agree_on_many(shapes, &format!("centres {kind}, shapes {sort}"));
        }
        agree_on_many(&Shapes::circles(centers, Each::One(0.5)).unwrap(), &format!("{kind}, f64"));
    }
}

fn agree_on_many<T: Scalar>(shapes: &Shapes<T>, what: &str) {
    let columns = Columns::of(shapes).unwrap();
    let mut expected = pairs::brute(&columns, Some(2), DEFAULT_MAX_PAIRS).unwrap();
    expected.sort().unwrap();
    let mut orders = Vec::new();
    for threads in [1, 2, 3, 8] {
        let found = pairs::find(shapes, Some(Method::Quadtree), Some(threads), DEFAULT_MAX_PAIRS);
        let mut found = found.unwrap();
        orders.push(found.pairs.clone());
        found.sort().unwrap();
        assert!(found.pairs == expected.pairs, "{what}, {threads} threads");
    }
    assert!(orders.iter().all(|order| *order == orders[0]), "{what}: threads show");
    for leaf_capacity in [1, 20, 96, 3000] {
        let settings = Settings { leaf_capacity, ..Settings::default() };
        let mut found =
            pairs::within(&unordered(shapes, settings), None, DEFAULT_MAX_PAIRS).unwrap();
        found.sort().unwrap();
        assert!(found.pairs == expected.pairs, "{what}, {leaf_capacity} in a leaf");
    }
}
