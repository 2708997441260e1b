//! Periodic planes and searches within a distance, against brute force over all images.

use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Method, Settings};
use jostle_index::pairs::{self, Filters, JoinScratch};
use jostle_index::query::{self, Circle, Point, Polygon, Ray, Rect, Region};
use jostle_index::{Each, Period, Quadtree, Scalar, Shapes};
use jostle_space::Space;
use jostle_space::Wanted;
use proptest::prelude::*;

use crate::common::{Raw, SetShapes, built, coordinate, settings, shapes, size};

fn side() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => Just(0.0),
        2 => Just(10.0),
        2 => Just(16.0),
        1 => Just(0.1),
        1 => Just(7.3),
        2 => 5.0..60.0f64,
        1 => Just(1e4),
    ]
}

fn typed<T: Scalar>(pairs: &[[f64; 2]]) -> Vec<[T; 2]> {
    pairs.iter().map(|pair| pair.map(T::from_f64)).collect()
}

/// The gap along an axis: the smaller of that of the shapes as they are, and that after the one with
/// the higher centre was moved by minus one period.
fn gap<T: Scalar>(shapes: &Shapes<T>, [i, j]: [usize; 2], axis: usize, side: T) -> T {
    let (a, b) = (shapes.shape(i), shapes.shape(j));
    let half_sum = a.half_size[axis] + b.half_size[axis];
    let of = |a: [T; 2], b: [T; 2]| (b[0] - a[1]).max(a[0] - b[1]) - half_sum;
    let ends = |shape: &jostle_index::Shape<T>| [shape.min[axis], shape.max[axis]];
    let direct = of(ends(&a), ends(&b));
    if side == T::ZERO {
        return direct;
    }
    let is_higher = a.center()[axis] >= b.center()[axis];
    let (high, low) = if is_higher { (ends(&a), ends(&b)) } else { (ends(&b), ends(&a)) };
    direct.min(of([high[0] - side, high[1] - side], low))
}

/// The overlapping pairs `i < j`, sorted.
fn brute_pairs<T: Scalar>(shapes: &Shapes<T>) -> Vec<[u32; 2]> {
    let sides = shapes.period().sides();
    let mut pairs = Vec::new();
    for i in 0..shapes.len() {
        for j in i + 1..shapes.len() {
            let (a, b) = (shapes.shape(i), shapes.shape(j));
            let [dx, dy] = [0, 1].map(|axis| gap(shapes, [i, j], axis, sides[axis]));
            let (ex, ey) = (dx.max(T::ZERO), dy.max(T::ZERO));
            let sum = a.radius + b.radius;
            let overlap = ex * ex + ey * ey < sum * sum || (dx < T::ZERO && dy < T::ZERO);
            let filters = a.category & b.mask != 0 && b.category & a.mask != 0;
            if overlap && filters {
                pairs.push([i as u32, j as u32]);
            }
        }
    }
    pairs
}

fn periodic<T: Scalar>(raw: &Raw, sides: [f64; 2]) -> Shapes<T> {
    let period = Period::new(sides.map(T::from_f64)).expect("valid");
    raw.typed::<T>().in_period(period).expect("valid")
}

fn pairs_agree<T: Scalar>(raw: &Raw, sides: [f64; 2], settings: Settings, distance: f64) {
    let shapes = periodic::<T>(raw, sides);
    let expected = brute_pairs(&shapes);
    for method in [Method::Brute, Method::Quadtree] {
        let found = pairs::find(&shapes, Some(method), Some(1), DEFAULT_MAX_PAIRS);
        let mut found = found.expect("few pairs");
        found.sort().expect("not interrupted");
        assert_eq!(found.pairs, expected, "{method:?}");
    }
    let tree = built(&shapes, settings);
    // Between two trees each pair comes in both orders, and each shape may overlap itself.
    let mut between = pairs::between(&tree, &tree, None, DEFAULT_MAX_PAIRS).expect("few pairs");
    between.pairs.retain(|[i, j]| i < j);
    between.sort().expect("not interrupted");
    assert_eq!(between.pairs, expected);
    let places = pairs::indices_between(
        &tree,
        &tree,
        [T::ZERO; 2],
        Filters::Apply,
        DEFAULT_MAX_PAIRS,
        &mut JoinScratch::default(),
    );
    assert_eq!(places.expect("few pairs").pairs.len() - between_self(&shapes), 2 * expected.len());
    // Within a distance.
    let distance = T::from_f64(distance);
    let grown = shapes.clone().grown(distance).expect("valid");
    let expected = brute_pairs(&grown);
    let mut found = pairs::within(&tree.grown(distance).unwrap(), None, DEFAULT_MAX_PAIRS).unwrap();
    found.sort().expect("not interrupted");
    assert_eq!(found.pairs, expected);
    let rows = query::neighbors(&tree, distance, None).expect("few neighbours");
    let mut lists = vec![Vec::new(); shapes.len()];
    for [i, j] in expected.iter().copied() {
        lists[i as usize].push(j);
        lists[j as usize].push(i);
    }
    for (row, list) in lists.iter_mut().enumerate() {
        list.sort_unstable();
        assert_eq!(rows.of(row), &list[..], "{row}");
    }
    spaces_agree(raw, sides, settings, distance, &lists);
}

/// The number of shapes that pair with themselves between two trees.
fn between_self<T: Scalar>(shapes: &Shapes<T>) -> usize {
    let own = |row: &usize| {
        let shape = shapes.shape(*row);
        let [dx, dy] = [0, 1].map(|axis| gap(shapes, [*row; 2], axis, T::ZERO));
        let filters = shape.category & shape.mask != 0;
        filters && (shape.radius > T::ZERO || (dx < T::ZERO && dy < T::ZERO))
    };
    (0..shapes.len()).filter(own).count()
}

/// A space that has been filled in parts, some of them moved, has the same neighbours.
fn spaces_agree<T: Scalar>(
    raw: &Raw,
    sides: [f64; 2],
    settings: Settings,
    distance: T,
    lists: &[Vec<u32>],
) {
    let period = Period::new(sides.map(T::from_f64)).expect("valid");
    let mut space = Space::with_period(settings, period).expect("valid");
    let shapes = raw.typed::<T>();
    let ids = space.add(&shapes).expect("room");
    space.update(DEFAULT_MAX_PAIRS).expect("few pairs");
    if shapes.boxes().is_none() {
        let third: Vec<_> = ids.iter().copied().step_by(3).collect();
        let places: Vec<[T; 2]> = shapes.centers().iter().copied().step_by(3).collect();
        let elsewhere: Vec<[T; 2]> = places.iter().map(|_| [T::ONE; 2]).collect();
        space.move_to(&third, &elsewhere).expect("valid");
        space.update(DEFAULT_MAX_PAIRS).expect("few pairs");
        space.move_to(&third, &places).expect("valid");
    }
    space.check().expect("the invariants hold");
    let rows = space.neighbors(distance, None).expect("few neighbours");
    for (row, list) in lists.iter().enumerate() {
        let expected: Vec<i64> = list.iter().map(|&other| ids[other as usize]).collect();
        assert_eq!(rows.of(row), &expected[..]);
    }
    let wanted = Wanted { distance, mask: None, max_pairs: DEFAULT_MAX_PAIRS };
    let pairs = space.pairs_within(&wanted).expect("few pairs");
    assert_eq!(2 * pairs.len(), rows.ids.len());
    space.update(DEFAULT_MAX_PAIRS).expect("few pairs");
    let events = space.update(DEFAULT_MAX_PAIRS).expect("few pairs");
    let mut stayed = space.stayed(&events).expect("memory").expect("the last update");
    let mut overlapping = space.pairs(None, DEFAULT_MAX_PAIRS).expect("few pairs");
    stayed.sort_unstable();
    overlapping.sort_unstable();
    assert_eq!(stayed, overlapping);
}

/// A tree and a space with the same shapes in the same plane.
struct Both<T> {
    shapes: Shapes<T>,
    tree: Quadtree<T>,
    space: Space<T>,
}

impl<T: Scalar> Both<T> {
    fn new(raw: &Raw, sides: [f64; 2], settings: Settings) -> Self {
        let shapes = periodic::<T>(raw, sides);
        let mut space = Space::with_period(settings, shapes.period()).expect("valid");
        let raw = raw.typed::<T>();
        let first = raw.len() as u32 / 2;
        for rows in [0..first, first..raw.len() as u32] {
            space.add(&raw.select(&Vec::from_iter(rows))).expect("room");
            space.pairs(Some(0), DEFAULT_MAX_PAIRS).expect("none");
        }
        let tree = built(&shapes, settings);
        Self { shapes, tree, space }
    }

    fn regions_agree<R: Region<T>>(&mut self, regions: &[R]) {
        let hits = query::search(&self.tree, regions, None).expect("few answers");
        let of_space = self.space.search(regions, None).expect("few answers");
        let period = self.shapes.period();
        for (index, region) in regions.iter().enumerate() {
            let images: Vec<R> =
                period.images().map(|shift| region.wrapped(&period).moved(shift)).collect();
            let touches = |row: &u32| {
                let shape = self.shapes.shape(*row as usize);
                images.iter().any(|image| image.overlaps(&shape))
            };
            let expected: Vec<u32> = (0..self.shapes.len() as u32).filter(touches).collect();
            assert_eq!(hits.of(index), expected, "{index}: {}", std::any::type_name::<R>());
            let expected: Vec<i64> = expected.into_iter().map(i64::from).collect();
            assert_eq!(of_space.of(index), expected, "{index}: {}", std::any::type_name::<R>());
        }
    }

    fn nearest_agree(&mut self, points: &[[T; 2]], k: usize) {
        let period = self.shapes.period();
        let reaches: Vec<T> = (0..points.len()).map(|row| T::from_f64(3.0 * row as f64)).collect();
        let reach = Each::Rows(reaches.clone());
        let found = query::nearest(&self.tree, points, (k, reach.clone()), None).expect("valid");
        let of_space = self.space.nearest(points, (k, reach), None).expect("valid");
        assert_eq!((&found.ids, &found.distances), (&of_space.ids, &of_space.distances));
        for (index, point) in points.iter().enumerate() {
            let point = period.wrap(*point);
            let images: Vec<[T; 2]> =
                period.images().map(|[x, y]| [point[0] - x, point[1] - y]).collect();
            let mut all: Vec<(T, i64)> = (0..self.shapes.len())
                .map(|row| {
                    let shape = self.shapes.shape(row);
                    let distances = images.iter().map(|image| query::distance(*image, &shape));
                    (distances.reduce(T::min).expect("nine images"), row as i64)
                })
                .filter(|(distance, _)| *distance <= reaches[index])
                .collect();
            all.sort_by(|a, b| a.0.total_order(&b.0).then(a.1.cmp(&b.1)));
            all.resize(all.len().max(k), (T::INFINITY, -1));
            let (distances, ids): (Vec<T>, Vec<i64>) = all[..k].iter().copied().unzip();
            assert_eq!(found.ids[index * k..(index + 1) * k], ids);
            assert_eq!(found.distances[index * k..(index + 1) * k], distances);
        }
    }

    fn rays_agree(
        &mut self,
        places: &[[T; 2]],
        ways: &[[T; 2]],
        sizes: (&[[T; 2]], &[T]),
        turns: f64,
    ) {
        let period = self.shapes.period();
        let sides = period.sides().map(T::to_f64);
        let shorter = sides.into_iter().filter(|&side| side > 0.0).fold(f64::INFINITY, f64::min);
        let length = T::from_f64(if shorter.is_finite() { turns * shorter } else { 1e3 });
        let (half_sizes, radii) = (Each::Rows(sizes.0.to_vec()), Each::Rows(sizes.1.to_vec()));
        let (ways, length) = (Each::Rows(ways.to_vec()), Each::One(length));
        let make = |places: Vec<[T; 2]>| {
            let places = Each::Rows(places);
            Ray::of_boxes(&places, &ways, (&half_sizes, &radii), &length).expect("valid")
        };
        let rays = make(places.to_vec());
        let found = query::first_hits(&self.tree, &rays, None).expect("valid");
        let all = query::all_hits(&self.tree, &rays, None).expect("valid");
        assert_eq!(self.space.first_hits(&rays, None).expect("valid").ids, found.ids);
        let of_space = self.space.all_hits(&rays, None).expect("valid");
        assert_eq!((&of_space.ids, &of_space.distances), (&all.ids, &all.distances));
        assert_eq!(of_space.normals, all.normals);
        let wrapped: Vec<[T; 2]> = places.iter().map(|place| period.wrap(*place)).collect();
        let far = |axis: usize| if sides[axis] > 0.0 { turns.ceil() as i64 + 3 } else { 0 };
        let mut best: Vec<Vec<Option<T>>> = vec![vec![None; self.shapes.len()]; rays.len()];
        for column in -far(0)..=far(0) {
            for row in -far(1)..=far(1) {
                let shift = [column as f64 * sides[0], row as f64 * sides[1]].map(T::from_f64);
                let moved = wrapped.iter().map(|[x, y]| [*x - shift[0], *y - shift[1]]).collect();
                for (ray, best) in make(moved).iter().zip(&mut best) {
                    for (row, best) in best.iter_mut().enumerate() {
                        let hit = query::hit(ray, &self.shapes.shape(row));
                        let hit = hit.filter(|hit| *hit <= length.at(0));
                        *best = [*best, hit].into_iter().flatten().reduce(T::min);
                    }
                }
            }
        }
        for (ray, best) in best.iter().enumerate() {
            let mut expected: Vec<(T, i64)> =
                (0..).zip(best).filter_map(|(row, hit)| hit.map(|hit| (hit, row))).collect();
            expected.sort_by(|a, b| a.0.total_order(&b.0).then(a.1.cmp(&b.1)));
            let range = all.offsets[ray]..all.offsets[ray + 1];
            let (distances, ids): (Vec<T>, Vec<i64>) = expected.iter().copied().unzip();
            assert_eq!(all.ids[range.clone()], ids, "ray {ray}");
            assert_eq!(all.distances[range.clone()], distances, "ray {ray}");
            let first = expected.first().copied().unwrap_or((T::INFINITY, -1));
            assert_eq!((found.distances[ray], found.ids[ray]), first, "ray {ray}");
            if first.1 >= 0 {
                assert_eq!(found.normals[ray], all.normals[range.start], "ray {ray}");
            }
            normals_face(&all.normals[range], &distances, &ways.at(ray));
        }
    }
}

/// Normals are unit vectors against the direction of the ray.
fn normals_face<T: Scalar>(normals: &[[T; 2]], distances: &[T], way: &[T; 2]) {
    for ([x, y], distance) in normals.iter().zip(distances) {
        let [x, y] = [x.to_f64(), y.to_f64()];
        if *distance == T::ZERO {
            assert_eq!([x, y], [0.0; 2]);
            continue;
        }
        assert!((x.hypot(y) - 1.0).abs() < 1e-5, "{x} {y}");
        let way = way.map(T::to_f64);
        // Rounding of the point of impact turns the normal of a small circle.
        let against = (x * way[0] + y * way[1]) / way[0].hypot(way[1]);
        assert!(against < 1.0 || distance.to_f64() > 1e-3, "{against}");
    }
}

proptest! {
    #![proptest_config(crate::common::cases(60))]

    #[test]
    fn pairs_and_neighbours_in_a_periodic_plane(
        raw in shapes(),
        sides in [side(), side()],
        settings in settings(),
        distance in prop_oneof![Just(0.0), Just(1.0), Just(0.1), 0.0..20.0f64, Just(1e5)],
    ) {
        pairs_agree::<f64>(&raw, sides, settings, distance);
        pairs_agree::<f32>(&raw, sides, settings, distance);
    }

    #[test]
    fn queries_in_a_periodic_plane(
        raw in shapes(),
        sides in [side(), side()],
        settings in settings(),
        asked in prop::collection::vec(
            ([coordinate(), coordinate()], [size(), size()], [-9.0..9.0f64, 0.1..9.0]), 1..6),
        k in 1usize..9,
    ) {
        queries_agree::<f64>(&raw, sides, settings, &asked, k);
        queries_agree::<f32>(&raw, sides, settings, &asked, k);
    }
}

type Asked = ([f64; 2], [f64; 2], [f64; 2]);

/// Whether shapes or regions are many times as large as a period, so that each query meets very many
/// images of each shape.
fn has_too_many_images<T: Scalar>(shapes: &Shapes<T>, sides: [f64; 2], asked: &[Asked]) -> bool {
    let extents = (0..shapes.len()).map(|row| {
        let shape = shapes.shape(row);
        let size = |axis: usize| (shape.max[axis] - shape.min[axis]) + shape.half_size[axis];
        (size(0).max(size(1)) + shape.radius).to_f64()
    });
    let regions = asked.iter().map(|(_, size, _)| size[0].max(size[1]));
    let largest = extents.chain(regions).fold(0.0, f64::max);
    sides.into_iter().any(|side| side > 0.0 && largest > 20.0 * side)
}

fn queries_agree<T: Scalar>(
    raw: &Raw,
    sides: [f64; 2],
    settings: Settings,
    asked: &[Asked],
    k: usize,
) {
    let mut both = Both::<T>::new(raw, sides, settings);
    if has_too_many_images(&both.shapes, sides, asked) {
        return;
    }
    let corners = |([x, y], [w, h], _): &Asked| [*x, *y, x + w, y + h].map(T::from_f64);
    let rects: Vec<[T; 4]> = asked.iter().map(corners).collect();
    both.regions_agree(&Rect::all(&rects).expect("valid"));
    let places = typed::<T>(&asked.iter().map(|one| one.0).collect::<Vec<_>>());
    let sizes = typed::<T>(&asked.iter().map(|one| one.1).collect::<Vec<_>>());
    let ways = typed::<T>(&asked.iter().map(|one| one.2).collect::<Vec<_>>());
    let radii: Vec<T> = sizes.iter().map(|size| size[0]).collect();
    let circles = Circle::all(&Each::Rows(places.clone()), &Each::Rows(radii.clone()));
    both.regions_agree(&circles.expect("valid"));
    both.regions_agree(&Point::all(&places).expect("valid"));
    let polygons = asked.iter().filter_map(|([x, y], [w, h], [p, q])| {
        let corners = [[*x, *y], [x + w, y - h], [x + w + p.abs(), y + q], [x + w, y + h]];
        Polygon::new(&typed::<T>(&corners)).ok()
    });
    let period = both.shapes.period();
    let (fitting, large): (Vec<_>, Vec<_>) =
        polygons.partition(|polygon| polygon.check_period(0, &period).is_ok());
    both.regions_agree(&fitting);
    if !large.is_empty() {
        assert!(query::search(&both.tree, &large, None).is_err());
        assert!(both.space.search(&large, None).is_err());
    }
    both.nearest_agree(&places, k);
    let none = vec![[T::ZERO; 2]; places.len()];
    both.rays_agree(&places, &ways, (&none, &vec![T::ZERO; places.len()]), 1.5);
    both.rays_agree(&places, &ways, (&none, &radii), 1.0);
    both.rays_agree(&places, &ways, (&sizes, &vec![T::ZERO; places.len()]), 0.5);
    both.rays_agree(&places, &ways, (&sizes, &radii), 0.3);
}

#[test]
fn tiles_that_touch_across_the_boundary_do_not_overlap() {
    let ticks: Vec<f64> = (0..=10).map(|k| f64::from(k) * 0.1).collect();
    let boxes: Vec<[f64; 4]> = (0..10)
        .flat_map(|row| (0..10).map(move |column| (row, column)))
        .map(|(row, column)| [ticks[column], ticks[row], ticks[column + 1], ticks[row + 1]])
        .collect();
    let shapes = Shapes::from_boxes(boxes, Each::One(0.0), None).expect("valid");
    let shapes = shapes.in_period(Period::new([1.0, 1.0]).expect("valid")).expect("valid");
    let found = pairs::find(&shapes, Some(Method::Quadtree), None, 1000).expect("few pairs");
    assert_eq!(found.pairs, [[0; 2]; 0]);
    let grown = shapes.grown(1e-9).expect("valid");
    let found = pairs::find(&grown, Some(Method::Quadtree), None, 1000).expect("few pairs");
    // Each tile has eight neighbours.
    assert_eq!(found.pairs.len(), 400);
}

#[test]
fn rays_that_are_too_long_are_refused() {
    let discs = Shapes::circles(vec![[0.0, 0.0]], Each::One(1.0)).expect("valid");
    let shapes = discs.in_period(Period::new([10.0, 0.0]).expect("valid")).expect("valid");
    let tree = Quadtree::new(&shapes, Settings::default()).expect("valid");
    let ray = |length: f64| {
        let (origin, direction) = (Each::One([0.0, 5.0]), Each::One([1.0, 0.0]));
        Ray::all(&origin, &direction, &Each::One(0.0), length).expect("valid")
    };
    let error = query::first_hits(&tree, &ray(f64::INFINITY), None).unwrap_err().to_string();
    assert!(error.starts_with("max_distance is inf; with period=(10, 0)"), "{error}");
    assert_eq!(query::first_hits(&tree, &ray(10_000.0), None).expect("valid").ids, [-1]);
}

#[test]
fn only_images_near_shapes_are_searched() {
    let centers: Vec<[f64; 2]> =
        (0..400).map(|i| [f64::from(i % 20) + 0.5, f64::from(i / 20) + 0.5]).collect();
    let circle = Circle::all(&Each::One([10.0, 10.0]), &Each::One(1.2)).expect("valid");
    let tests = |sides: [f64; 2], moved: Option<[f64; 2]>| {
        let period = Period::new(sides).expect("valid");
        let mut space = Space::with_period(Settings::default(), period).expect("valid");
        let shapes = Shapes::circles(centers.clone(), Each::One(0.1)).expect("valid");
        let ids = space.add(&shapes).expect("valid");
        space.search(&circle, None).expect("few");
        if let Some(center) = moved {
            space.move_to(&ids[..1], &[center]).expect("valid");
        }
        space.search(&circle, None).expect("few").tests
    };
    for moved in [None, Some([10.0, 10.0]), Some([0.0, 19.9])] {
        assert_eq!(tests([20.0, 20.0], moved), tests([0.0, 0.0], moved), "{moved:?}");
    }
}
