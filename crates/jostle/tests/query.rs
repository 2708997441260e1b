//! Every query of a tree against brute force, on hard cases.

use jostle_base::Settings;
use jostle_index::query::{
    self, Circle, FirstHit, Nearest, Neighbors, Point, Polygon, Ray, RayPath, Rect, Region,
};
use jostle_index::{Each, Period, Quadtree, Scalar, Shapes};
use jostle_simd::{self as simd, Instructions};
use proptest::prelude::*;

use crate::common::{Raw, built, coordinate, settings, shapes, size};

/// What is asked: places, sizes, directions and a mask.
#[derive(Clone, Debug)]
struct Asked {
    places: Vec<[f64; 2]>,
    sizes: Vec<[f64; 2]>,
    ways: Vec<[f64; 2]>,
    k: usize,
    reach: f64,
    mask: Option<u32>,
}

fn asked() -> impl Strategy<Value = Asked> {
    let way = prop_oneof![
        4 => (-10.0..10.0f64, -10.0..10.0f64),
        1 => prop_oneof![Just((1.0, 0.0)), Just((0.0, -2.0)), Just((1e-9, 1.0)), Just((-3.0, 3.0))],
        1 => prop_oneof![Just((1e30, 1e30)), Just((-1e-30, 0.0))],
    ];
    let one = (coordinate(), coordinate(), size(), size(), way);
    let mask = prop_oneof![3 => Just(None), 1 => prop_oneof![Just(0), Just(1), Just(2), Just(7)].prop_map(Some)];
    let reach = prop_oneof![3 => Just(f64::INFINITY), 1 => size()];
    (prop::collection::vec(one, 1..8), 1usize..12, reach, mask).prop_map(|(all, k, reach, mask)| {
        Asked {
            places: all.iter().map(|one| [one.0, one.1]).collect(),
            sizes: all.iter().map(|one| [one.2, one.3]).collect(),
            ways: all.iter().map(|one| [one.4.0, one.4.1]).collect(),
            k,
            reach,
            mask,
        }
    })
}

fn typed<T: Scalar>(pairs: &[[f64; 2]]) -> Vec<[T; 2]> {
    pairs.iter().map(|pair| pair.map(T::from_f64)).collect()
}

/// Rows of the shapes that overlap a region, by brute force.
fn touched<T: Scalar>(shapes: &Shapes<T>, region: &impl Region<T>, mask: Option<u32>) -> Vec<u32> {
    let rows = 0..shapes.len();
    let hit = rows.filter(|&row| {
        let shape = shapes.shape(row);
        mask.is_none_or(|mask| mask & shape.category != 0) && region.overlaps(&shape)
    });
    hit.map(|row| row as u32).collect()
}

fn regions_agree<T: Scalar, R: Region<T>>(
    shapes: &Shapes<T>,
    tree: &Quadtree<T>,
    regions: &[R],
    mask: Option<u32>,
) {
    let hits = query::search(tree, regions, mask).expect("few answers");
    assert_eq!(hits.offsets.len(), regions.len() + 1);
    for (index, region) in regions.iter().enumerate() {
        assert_eq!(
            hits.of(index),
            touched(shapes, region, mask),
            "{index}: {}",
            std::any::type_name::<R>()
        );
    }
}

fn all_agree<T: Scalar>(raw: &Raw, settings: Settings, asked: &Asked) {
    let shapes = raw.typed::<T>();
    let tree = built(&shapes, settings);
    let (places, mask) = (typed::<T>(&asked.places), asked.mask);
    let around = asked.places.iter().zip(&asked.sizes);
    let corners =
        |(&[x, y], &[w, h]): (&[f64; 2], &[f64; 2])| [x, y, x + w, y + h].map(T::from_f64);
    let rects: Vec<[T; 4]> = around.clone().map(corners).collect();
    regions_agree(&shapes, &tree, &Rect::all(&rects).expect("valid"), mask);
    let radii = Each::Rows(asked.sizes.iter().map(|size| T::from_f64(size[0])).collect());
    regions_agree(
        &shapes,
        &tree,
        &Circle::all(&Each::Rows(places.clone()), &radii).expect("valid"),
        mask,
    );
    regions_agree(&shapes, &tree, &Point::all(&places).expect("valid"), mask);
    let polygons = around.zip(&asked.ways).filter_map(|((&[x, y], &[w, h]), &[p, q])| {
        let corners = [[x, y], [x + w, y - h], [x + w + p.abs(), y + q], [x + w, y + h]];
        Polygon::new(&typed::<T>(&corners)).ok()
    });
    regions_agree(&shapes, &tree, &polygons.collect::<Vec<_>>(), mask);

    let reach = T::from_f64(asked.reach);
    let found = query::nearest(&tree, &places, (asked.k, reach), mask).expect("valid");
    let brute = |point, best: &mut Nearest<T>| {
        for row in 0..shapes.len() {
            let shape = shapes.shape(row);
            if query::selects(mask, shape.category) {
                best.offer(query::distance(point, &shape), row as u64);
            }
        }
    };
    // Each point alone, so that none has a bound from the one before.
    let mut seen = Neighbors::default();
    for point in &places {
        let distance_of = |_, _| unreachable!("nothing was found before");
        let wanted = (asked.k, &Each::One(reach));
        let one = query::nearest_from(&[*point], wanted, Some(1), brute, distance_of);
        let one = one.expect("valid");
        seen.ids.extend(one.ids);
        seen.distances.extend(one.distances);
    }
    assert_eq!((found.ids, found.distances), (seen.ids, seen.distances));

    for radii in [Each::One(T::ZERO), radii] {
        let rays =
            Ray::all(&Each::Rows(places.clone()), &Each::Rows(typed(&asked.ways)), &radii, reach)
                .expect("valid");
        let found = query::first_hits(&tree, &rays, mask).unwrap();
        let seen =
            query::first_hits_by(&rays, &Period::default(), Some(1), |best: &mut FirstHit<T>| {
                for row in 0..shapes.len() {
                    let shape = shapes.shape(row);
                    if query::selects(mask, shape.category) {
                        best.offer(&shape, row as u64);
                    }
                }
            });
        let seen = seen.unwrap();
        assert_eq!((found.ids, found.distances), (seen.ids, seen.distances));
    }
}

proptest! {
    #![proptest_config(crate::common::cases(200))]

    #[test]
    fn answers_are_those_of_brute_force(raw in shapes(), settings in settings(), asked in asked()) {
        all_agree::<f32>(&raw, settings, &asked);
        all_agree::<f64>(&raw, settings, &asked);
    }
}

fn grid(side: usize) -> Shapes<f64> {
    let place = |k: usize| [(k % side) as f64, (k / side) as f64];
    Shapes::circles((0..side * side).map(place).collect(), Each::One(0.25)).expect("valid")
}

#[test]
fn instructions_and_threads_change_nothing() {
    let shapes = grid(60);
    let points: Vec<[f64; 2]> =
        (0..2000).map(|k| [f64::from(k) * 0.031, f64::from(k * 7 % 600) * 0.1]).collect();
    let ways: Vec<[f64; 2]> = points.iter().map(|p| [p[1] - 29.3, p[0] - 31.1]).collect();
    let answers = |instructions, threads| {
        simd::limit(instructions);
        let tree = built(&shapes, Settings { threads: Some(threads), ..Settings::default() });
        let circles = Circle::all(&Each::Rows(points.clone()), &Each::One(1.3)).expect("valid");
        let rays = Ray::all(
            &Each::Rows(points.clone()),
            &Each::Rows(ways.clone()),
            &Each::One(0.0),
            f64::INFINITY,
        );
        let mut hits = query::first_hits(&tree, &rays.expect("valid"), None).unwrap();
        // A ray that hits nothing has no point, which is NaN and equals nothing.
        let missed = hits.points.iter_mut().filter(|point| point[0].is_nan());
        missed.for_each(|point| *point = [f64::MAX; 2]);
        (
            query::search(&tree, &circles, None).expect("few"),
            query::nearest(&tree, &points, (5, f64::INFINITY), None).expect("valid"),
            hits,
        )
    };
    let first = answers(Instructions::Portable, 1);
    for instructions in [Instructions::Avx2, Instructions::Avx512] {
        for threads in [1, 2, 8] {
            assert_eq!(answers(instructions, threads), first);
        }
    }
}

#[test]
fn equal_distances_go_to_the_smaller_row() {
    let tree = built(&grid(8), Settings { leaf_capacity: 2, ..Settings::default() });
    let found = query::nearest(&tree, &[[3.5, 3.5]], (4, 9.0), None).expect("valid");
    assert_eq!(found.ids, [27, 28, 35, 36]);
    let ray = Ray::all(&Each::One([3.5, -5.0]), &Each::One([0.0, 1.0]), &Each::One(0.5), 99.0);
    assert_eq!(query::first_hits(&tree, &ray.expect("valid"), None).unwrap().ids, [3]);
}

#[test]
fn a_small_window_looks_at_few_shapes() {
    let tree = built(&grid(200), Settings::default());
    let rect = Rect::all(&[[49.8, 49.8, 52.8, 52.8]]).expect("valid");
    let hits = query::search(&tree, &rect, None).expect("few");
    assert_eq!(hits.ids.len(), 15);
    assert!(hits.tests < 600, "{}", hits.tests);
}

#[test]
fn refusals_name_argument_index_and_value() {
    let said = |error: jostle_base::Error| error.to_string();
    let upside_down = [[0.0, 0.0, 1.0, 1.0], [3.0, 0.0, 2.0, 1.0]];
    assert!(said(Rect::all(&upside_down).unwrap_err()).starts_with("rect[1] is (3, 0, 2, 1); "));
    let nowhere = [[0.0, f64::NAN]];
    assert!(said(Point::all(&nowhere).unwrap_err()).starts_with("point[0] is (0, NaN); "));
    let still = Ray::all(&Each::One([0.0; 2]), &Each::Rows(vec![[0.0; 2]]), &Each::One(0.0), 1.0);
    assert!(said(still.unwrap_err()).starts_with("direction[0] is (0, 0); "));
    let dented = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];
    assert!(said(Polygon::new(&dented).unwrap_err()).starts_with("vertices[2] is (1, 1); "));
    let star: Vec<[f64; 2]> = (0..5)
        .map(|k| f64::from(k) * 4.0 * std::f64::consts::PI / 5.0)
        .map(|angle| [angle.cos(), angle.sin()])
        .collect();
    assert!(Polygon::new(&star).is_err());
    let flat = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
    assert!(Polygon::new(&flat).is_err());
}
