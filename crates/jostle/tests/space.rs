//! A space against a list of shapes and brute force, through long runs of changes.

use crate::common::SetShapes;
use std::collections::BTreeMap;

use jostle_base::ids::Id;
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Error, Settings};
use jostle_index::geometry::{Shape, overlap};
use jostle_index::query::{self, Circle, Point, Ray, Region};
use jostle_index::{Each, Scalar, Shapes};
use jostle_space::Events;
use jostle_space::Space;
use proptest::prelude::*;

/// One call. Shapes are named by any number, taken modulo those that are there.
#[derive(Clone, Debug)]
enum Call {
    Add(Vec<Row>),
    Move(Vec<(usize, f64, f64)>),
    /// x, y, width, height, radius.
    AddBoxes(Vec<[f64; 5]>),
    /// x, y, width, height.
    MoveToBoxes(Vec<(usize, [f64; 4])>),
    /// To where they are already.
    Stay(Vec<usize>),
    Resize(Vec<(usize, f64, f64, f64)>),
    Filter(Vec<(usize, u32, u32)>),
    Remove(Vec<usize>),
    RemoveAll,
    Update,
    Pairs,
    /// Where, how large, for which categories.
    Ask(f64, f64, f64, Option<u32>),
    BadIds(Id),
    BadValues(usize),
}

/// x, y, radius, half width, half height, category, mask.
type Row = (f64, f64, f64, f64, f64, u32, u32);

fn coordinate() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![8 => -10.0..10.0f64, 4 => (-4i32..4).prop_map(f64::from), 1 => Just(1e30)]
}

fn size() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![6 => 0.0..2.0f64, 2 => Just(0.0), 2 => Just(1.0), 1 => Just(100.0)]
}

/// x, y, width, height.
fn boxes() -> impl Strategy<Value = [f64; 4]> + Clone {
    (coordinate(), coordinate(), size(), size()).prop_map(|(x, y, w, h)| [x, y, w, h])
}

/// Mostly nothing: the radius of a box.
fn flat() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![3 => Just(0.0), 1 => size()]
}

fn bits() -> impl Strategy<Value = u32> + Clone {
    prop_oneof![3 => Just(u32::MAX), 1 => Just(1), 1 => Just(2), 1 => Just(0)]
}

fn call() -> impl Strategy<Value = Call> {
    let row = (coordinate(), coordinate(), size(), size(), size(), bits(), bits());
    let round = row.clone().prop_map(|row| (row.0, row.1, row.2, 0.0, 0.0, 1, u32::MAX));
    let some = 0usize..8;
    prop_oneof![
        2 => prop::collection::vec(row, some.clone()).prop_map(Call::Add),
        3 => prop::collection::vec(round, 0usize..20).prop_map(Call::Add),
        5 => prop::collection::vec((any::<usize>(), coordinate(), coordinate()), 0usize..16)
            .prop_map(Call::Move),
        2 => prop::collection::vec((boxes(), flat()).prop_map(|([x, y, w, h], radius)| [x, y, w, h, radius]), some.clone())
            .prop_map(Call::AddBoxes),
        2 => prop::collection::vec(
            (any::<usize>(), boxes()), some.clone(),
        ).prop_map(Call::MoveToBoxes),
        1 => prop::collection::vec(any::<usize>(), some.clone()).prop_map(Call::Stay),
        1 => prop::collection::vec((any::<usize>(), size(), size(), size()), some.clone())
            .prop_map(Call::Resize),
        1 => prop::collection::vec((any::<usize>(), bits(), bits()), some.clone())
            .prop_map(Call::Filter),
        2 => prop::collection::vec(any::<usize>(), some).prop_map(Call::Remove),
        1 => Just(Call::RemoveAll),
        6 => Just(Call::Update),
        2 => Just(Call::Pairs),
        3 => (coordinate(), coordinate(), size(), prop::option::of(bits()))
            .prop_map(|(x, y, size, mask)| Call::Ask(x, y, size, mask)),
        1 => any::<Id>().prop_map(Call::BadIds),
        1 => any::<usize>().prop_map(Call::BadValues),
    ]
}

/// A space, and what it should be.
struct Trial<T> {
    space: Space<T>,
    shapes: BTreeMap<Id, Shape<T>>,
    /// Pairs of the last update.
    touching: Vec<[Id; 2]>,
    gone: Vec<Id>,
    events: Option<Events>,
}

fn of<T: Scalar>(&(x, y, radius, half_x, half_y, category, mask): &Row) -> Shape<T> {
    let at = T::from_f64;
    let (center, half_size) = ([at(x), at(y)], [at(half_x), at(half_y)]);
    Shape {
        min: center,
        max: center,
        half_size,
        radius: at(radius),
        category,
        mask,
        core: jostle::Core::Box,
    }
}

fn box_of<T: Scalar>(&[x, y, width, height]: &[f64; 4]) -> [T; 4] {
    [x, y, x + width, y + height].map(T::from_f64)
}

/// Puts a shape at a centre: a box becomes its centre and half its size.
fn put<T: Scalar>(shape: &mut Shape<T>, center: [T; 2], half_size: [T; 2]) {
    (shape.min, shape.max, shape.half_size) = (center, center, half_size);
}

fn all_of<T: Scalar>(list: &[Shape<T>]) -> Shapes<T> {
    let filters = [|s: &Shape<T>| s.category, |s: &Shape<T>| s.mask];
    Shapes::new(
        list.iter().map(|shape| shape.min).collect(),
        Each::Rows(list.iter().map(|shape| shape.radius).collect()),
        Some(Each::Rows(list.iter().map(|shape| shape.half_size).collect())),
        Some(filters.map(|bits| Each::Rows(list.iter().map(bits).collect()))),
    )
    .expect("the generated shapes are valid")
}

fn pairs<T: Scalar>(shapes: &BTreeMap<Id, Shape<T>>) -> Vec<[Id; 2]> {
    let mut pairs = Vec::new();
    for (&i, a) in shapes {
        for (&j, b) in shapes.range(i + 1..) {
            let gap = |k: usize| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]);
            let distance = [gap(0), gap(1)];
            let halves = [0, 1].map(|k| a.half_size[k] + b.half_size[k]);
            let agree = a.category & b.mask != 0 && b.category & a.mask != 0;
            if agree
                && overlap([distance[0] - halves[0], distance[1] - halves[1]], a.radius + b.radius)
            {
                pairs.push([i, j]);
            }
        }
    }
    pairs
}

fn without(pairs: &[[Id; 2]], others: &[[Id; 2]]) -> Vec<[Id; 2]> {
    pairs.iter().copied().filter(|pair| others.binary_search(pair).is_err()).collect()
}

impl<T: Scalar> Trial<T> {
    fn new(settings: Settings) -> Self {
        Self {
            space: Space::new(settings).expect("the settings are valid"),
            shapes: BTreeMap::new(),
            touching: Vec::new(),
            gone: Vec::new(),
            events: None,
        }
    }

    /// Ids of shapes that are there, none twice, each with what was drawn for it.
    fn named<'a, V>(&self, drawn: &'a [V], which: impl Fn(&V) -> usize) -> (Vec<Id>, Vec<&'a V>) {
        let ids: Vec<Id> = self.shapes.keys().copied().collect();
        let mut chosen = BTreeMap::new();
        if !ids.is_empty() {
            drawn.iter().for_each(|one| {
                chosen.insert(ids[which(one) % ids.len()], one);
            });
        }
        chosen.into_iter().unzip()
    }

    fn make(&mut self, call: &Call) {
        match call {
            Call::Add(rows) => self.add(&rows.iter().map(of).collect::<Vec<_>>()),
            Call::Move(moves) => {
                let (ids, moves) = self.named(moves, |one| one.0);
                let at = |one: &&(usize, f64, f64)| [T::from_f64(one.1), T::from_f64(one.2)];
                let centers: Vec<_> = moves.iter().map(at).collect();
                self.space.move_to(&ids, &centers).expect("all is well");
                for (id, center) in ids.iter().zip(centers) {
                    let shape = self.shapes.get_mut(id).expect("it is there");
                    if shape.center() != center {
                        let half_size = shape.core_half_size();
                        put(shape, center, half_size);
                    }
                }
            }
            Call::AddBoxes(rows) => self.add_boxes(rows),
            Call::MoveToBoxes(moves) => {
                let (ids, moves) = self.named(moves, |one| one.0);
                let boxes: Vec<[T; 4]> = moves.iter().map(|one| box_of(&one.1)).collect();
                self.space.move_to_boxes(&ids, &boxes).expect("all is well");
                for (id, [min_x, min_y, max_x, max_y]) in ids.iter().zip(boxes) {
                    let shape = self.shapes.get_mut(id).expect("it is there");
                    put(shape, [min_x, min_y], [T::ZERO; 2]);
                    shape.max = [max_x, max_y];
                }
            }
            Call::Stay(which) => {
                let (ids, _) = self.named(which, |one| *one);
                let centers =
                    self.space.read(&ids, |shape| shape.center()).expect("they are there");
                self.space.move_to(&ids, &centers).expect("all is well");
            }
            Call::Resize(sizes) => {
                let (ids, sizes) = self.named(sizes, |one| one.0);
                let of = |one: &&(usize, f64, f64, f64)| {
                    (T::from_f64(one.1), [T::from_f64(one.2), T::from_f64(one.3)])
                };
                let (radii, halves): (Vec<T>, Vec<[T; 2]>) = sizes.iter().map(of).unzip();
                for (row, id) in ids.iter().enumerate() {
                    let shape = self.shapes.get_mut(id).expect("it is there");
                    shape.radius = radii[row];
                    if shape.core_half_size() != halves[row] {
                        put(shape, shape.center(), halves[row]);
                    }
                }
                let (radii, halves) = (Each::Rows(radii), Each::Rows(halves));
                self.space.resize(&ids, Some(&radii), None).expect("all is well");
                self.space.resize(&ids, None, Some(&halves)).expect("all is well");
            }
            Call::Filter(bits) => {
                let (ids, bits) = self.named(bits, |one| one.0);
                let (categories, masks): (Vec<u32>, Vec<u32>) =
                    bits.iter().map(|one| (one.1, one.2)).unzip();
                for (row, id) in ids.iter().enumerate() {
                    let shape = self.shapes.get_mut(id).expect("it is there");
                    (shape.category, shape.mask) = (categories[row], masks[row]);
                }
                let bits = [categories, masks].map(Each::Rows);
                self.space.set_filter(&ids, Some(&bits[0]), Some(&bits[1])).expect("all is well");
            }
            Call::Remove(which) => {
                let (ids, _) = self.named(which, |one| *one);
                self.remove(&ids);
            }
            Call::RemoveAll => {
                let ids = self.space.ids().unwrap();
                self.remove(&ids);
            }
            Call::Update => self.update(),
            Call::Pairs => {
                let mut found = self.space.pairs(None, DEFAULT_MAX_PAIRS).expect("they fit");
                found.sort_unstable();
                assert_eq!(found, pairs(&self.shapes));
            }
            Call::Ask(x, y, size, mask) => {
                let of = T::from_f64;
                self.ask([of(*x), of(*y)], of(*size), *mask);
            }
            Call::BadIds(id) => self.refuse_ids(*id),
            Call::BadValues(which) => self.refuse_values(*which),
        }
        self.check();
    }

    fn add(&mut self, shapes: &[Shape<T>]) {
        let ids = self.space.add(&all_of(shapes)).expect("there is room");
        assert_eq!(ids.len(), shapes.len());
        for (id, shape) in ids.into_iter().zip(shapes) {
            assert!(id >= 0 && !self.gone.contains(&id), "{id} is given twice");
            assert_eq!(self.shapes.insert(id, *shape), None);
        }
    }

    fn add_boxes(&mut self, rows: &[[f64; 5]]) {
        let boxes: Vec<[T; 4]> =
            rows.iter().map(|[x, y, w, h, _]| box_of(&[*x, *y, *w, *h])).collect();
        let radii: Vec<T> = rows.iter().map(|row| T::from_f64(row[4])).collect();
        let shapes = Shapes::from_boxes(boxes.clone(), Each::Rows(radii.clone()), None);
        let ids = self.space.add(&shapes.expect("they are valid")).expect("there is room");
        for ((id, [min_x, min_y, max_x, max_y]), radius) in ids.into_iter().zip(boxes).zip(radii) {
            let (min, max) = ([min_x, min_y], [max_x, max_y]);
            let (half_size, category, mask) = ([T::ZERO; 2], 1, u32::MAX);
            let shape =
                Shape { min, max, half_size, radius, category, mask, core: jostle::Core::Box };
            assert_eq!(self.shapes.insert(id, shape), None);
        }
    }

    fn remove(&mut self, ids: &[Id]) {
        self.space.remove(ids).expect("they are there");
        ids.iter().for_each(|id| assert!(self.shapes.remove(id).is_some()));
        self.gone.extend(ids);
    }

    fn update(&mut self) {
        let now = pairs(&self.shapes);
        if now.len() > 2 {
            // Too little room is refused, or there was enough; nothing is lost either way.
            if let Err(error) = self.space.pairs(None, now.len() - 1) {
                assert_eq!(error, Error::TooManyPairs { max_pairs: now.len() - 1 });
            } else {
                panic!("there are {} pairs", now.len());
            }
        }
        let events = self.space.update(now.len()).expect("they fit");
        assert_eq!(events.entered, without(&now, &self.touching));
        assert_eq!(events.left, without(&self.touching, &now));
        let stayed = without(&now, &events.entered);
        assert_eq!(self.space.stayed(&events).unwrap(), Some(stayed));
        if let Some(old) = self.events.replace(events) {
            assert_eq!(self.space.stayed(&old).unwrap(), None);
        }
        self.touching = now;
    }

    fn ask(&mut self, at: [T; 2], size: T, mask: Option<u32>) {
        let chosen = |shape: &Shape<T>| mask.is_none_or(|mask| mask & shape.category != 0);
        let chosen: Vec<_> = self.shapes.iter().filter(|(_, shape)| chosen(shape)).collect();
        let points = Point::all(&[at, [T::ZERO; 2]]).unwrap();
        let found = self.space.search(&points, mask).unwrap();
        for (question, point) in points.iter().enumerate() {
            let touched = chosen.iter().filter(|(_, shape)| point.overlaps(shape));
            assert!(touched.map(|(id, _)| **id).eq(found.of(question).iter().copied()));
        }
        let circles = Circle::all(&Each::One(at), &Each::One(size)).unwrap();
        let touched = chosen.iter().filter(|(_, shape)| circles[0].overlaps(shape));
        let found = self.space.search(&circles, mask).unwrap();
        assert!(touched.map(|(id, _)| **id).eq(found.ids));

        let mut near: Vec<_> =
            chosen.iter().map(|(id, shape)| (query::distance(at, shape), **id)).collect();
        near.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap().then(a.1.cmp(&b.1)));
        near.resize(3, (T::INFINITY, -1));
        let found = self.space.nearest(&[at], (3, T::INFINITY), mask).unwrap();
        assert!(near.into_iter().eq(found.distances.into_iter().zip(found.ids)));

        let (way, radii) = (Each::One([T::ONE, size]), Each::One(size));
        let rays = Ray::all(&Each::One(at), &way, &radii, T::INFINITY).unwrap();
        let hits =
            chosen.iter().filter_map(|(id, shape)| Some((query::hit(&rays[0], shape)?, **id)));
        let first = hits.min_by(|a, b| a.0.partial_cmp(&b.0).unwrap().then(a.1.cmp(&b.1)));
        let found = self.space.first_hits(&rays, mask).unwrap();
        assert_eq!((found.distances[0], found.ids[0]), first.unwrap_or((T::INFINITY, -1)));
    }

    /// An id of a removed shape and one that was never given are refused, and nothing is done
    /// to those before it.
    fn refuse_ids(&mut self, id: Id) {
        for bad in [Some(id), self.gone.last().copied()].into_iter().flatten() {
            if self.shapes.contains_key(&bad) {
                continue;
            }
            assert!(!self.space.contains(bad));
            let mut ids = self.space.ids().unwrap();
            ids.push(bad);
            let centers = vec![[T::ZERO; 2]; ids.len()];
            let (size, bits) = (Each::One(T::ONE), Each::One(7));
            let told = [
                self.space.move_to(&ids, &centers),
                self.space.move_to_boxes(&ids, &vec![[T::ZERO; 4]; ids.len()]),
                self.space.resize(&ids, Some(&size), None),
                self.space.set_filter(&ids, Some(&bits), None),
                self.space.remove(&ids),
                self.space.read(&ids, |_| ()).map(|_| ()),
            ];
            for error in told {
                let error = error.expect_err("there is no such shape").to_string();
                assert!(error.starts_with(&format!("ids[{}] is {bad}; ", ids.len() - 1)));
            }
        }
    }

    fn refuse_values(&mut self, which: usize) {
        let mut ids = self.space.ids().unwrap();
        if ids.is_empty() {
            return;
        }
        let row = which % ids.len();
        let mut centers = vec![[T::ZERO; 2]; ids.len()];
        centers[row][1] = T::INFINITY;
        let mut radii = vec![T::ONE; ids.len()];
        radii[row] = -T::ONE;
        let mut halves = vec![[T::ONE; 2]; ids.len()];
        halves[row][0] = -T::ONE;
        let (radii, halves) = (Each::Rows(radii), Each::Rows(halves));
        let mut boxes = vec![[T::ZERO; 4]; ids.len()];
        boxes[row][3] = -T::ONE;
        let told = [
            ("boxes", self.space.move_to_boxes(&ids, &boxes)),
            ("positions", self.space.move_to(&ids, &centers)),
            ("radii", self.space.resize(&ids, Some(&radii), None)),
            ("half_sizes", self.space.resize(&ids, Some(&Each::One(T::ONE)), Some(&halves))),
        ];
        for (argument, error) in told {
            let error = error.expect_err("no shape can have this").to_string();
            assert!(error.starts_with(&format!("{argument}[{row}] is ")), "{error}");
        }
        ids.push(ids[row]);
        let error = self.space.remove(&ids).expect_err("it is given twice").to_string();
        assert!(error.ends_with("it is given twice"), "{error}");
    }

    fn check(&mut self) {
        self.space.check().expect("its invariants hold");
        assert_eq!(self.space.len(), self.shapes.len());
        let ids: Vec<Id> = self.shapes.keys().copied().collect();
        let mut found = self.space.ids().unwrap();
        found.sort_unstable();
        assert_eq!(found, ids);
        let shapes = self.space.read(&ids, |shape| shape).expect("they are there");
        assert!(shapes.iter().eq(self.shapes.values()));
    }
}

proptest! {
    #![proptest_config(crate::common::cases(200))]

    #[test]
    fn long_runs_of_calls_agree_with_brute_force(
        calls in prop::collection::vec(call(), 1..60),
        leaf_capacity in 1usize..20,
        threads in 1usize..3,
    ) {
        let settings = Settings { leaf_capacity, threads: Some(threads), ..Settings::default() };
        let (mut single, mut double) = (Trial::<f32>::new(settings), Trial::<f64>::new(settings));
        for call in &calls {
            single.make(call);
            double.make(call);
        }
    }
}

fn discs(centers: &[[f64; 2]], radius: f64) -> Shapes<f64> {
    Shapes::circles(centers.to_vec(), Each::One(radius)).expect("they are valid")
}

/// `side` × `side` points of a lattice.
fn lattice(side: usize) -> Vec<[f64; 2]> {
    (0..side * side).map(|k| [(k % side) as f64, (k / side) as f64]).collect()
}

fn space() -> Space<f64> {
    Space::new(Settings { threads: Some(1), ..Settings::default() }).expect("they are valid")
}

#[test]
fn first_ids_count_from_zero() {
    let mut space = space();
    assert_eq!(space.add(&discs(&lattice(3), 0.0)).unwrap(), (0..9).collect::<Vec<Id>>());
    assert_eq!(space.add(&discs(&lattice(1), 0.0)).unwrap(), [9]);
}

#[test]
fn a_removal_closes_its_pairs_under_the_removed_id() {
    let mut space = space();
    space.add(&discs(&[[0.0, 0.0], [1.0, 0.0], [9.0, 0.0]], 1.0)).unwrap();
    assert_eq!(space.update(9).unwrap().entered, [[0, 1]]);
    space.remove(&[0]).unwrap();
    let new = space.add(&discs(&[[1.0, 0.0]], 1.0)).unwrap()[0];
    let events = space.update(9).unwrap();
    assert_eq!((events.entered, events.left), (vec![[1, new]], vec![[0, 1]]));
    // Its slot is free now, and the next shape in it has another id.
    assert_eq!(space.add(&discs(&[[50.0, 0.0]], 1.0)).unwrap(), [1 << 32]);
}

#[test]
fn what_comes_and_goes_between_two_updates_never_shows() {
    let mut space = space();
    space.add(&discs(&[[0.0, 0.0]], 1.0)).unwrap();
    space.update(9).unwrap();
    let ids = space.add(&discs(&[[0.5, 0.0]], 1.0)).unwrap();
    assert_eq!(space.pairs(None, 9).unwrap(), [[0, 1]]);
    space.remove(&ids).unwrap();
    let events = space.update(9).unwrap();
    assert!(events.entered.is_empty() && events.left.is_empty());
}

#[test]
fn memory_follows_the_living() {
    for updates in [false, true] {
        let mut space = space();
        let mut most = 0;
        for round in 0..400 {
            let ids = space.add(&discs(&lattice(20), 0.6)).unwrap();
            if updates && round % 3 == 0 {
                space.update(DEFAULT_MAX_PAIRS).unwrap();
            }
            if round % 50 == 0 {
                space.pairs(None, DEFAULT_MAX_PAIRS).unwrap();
            }
            space.remove(&ids).unwrap();
            if round == 20 {
                most = space.memory_bytes();
            }
        }
        assert!(space.memory_bytes() <= 2 * most, "{} after {most}", space.memory_bytes());
    }
}

#[test]
fn trees_and_pairs_of_the_removed_are_given_back() {
    let mut space = space();
    let ids = space.add(&discs(&lattice(200), 0.6)).unwrap();
    space.update(DEFAULT_MAX_PAIRS).unwrap();
    let full = space.memory_bytes();
    space.remove(&ids[40..]).unwrap();
    space.update(DEFAULT_MAX_PAIRS).unwrap();
    assert!(space.memory_bytes() < full / 2, "{} of {full}", space.memory_bytes());
}

/// One ship over many bullets, or many shapes in one place: nothing is quadratic but the pairs.
#[test]
fn a_crowd_around_one_shape_is_compared_in_linear_time() {
    let mut space = space();
    let ship = space.add(&discs(&[[50.0, 50.0]], 1000.0)).unwrap();
    let bullets =
        Shapes::new(lattice(300), Each::One(0.1), None, Some([Each::One(2), Each::One(1)]));
    let bullets = space.add(&bullets.unwrap()).unwrap();
    assert_eq!(space.update(DEFAULT_MAX_PAIRS).unwrap().entered.len(), 90_000);
    for step in 1..20 {
        let by = f64::from(step);
        let moved: Vec<_> = lattice(300).iter().map(|[x, y]| [x + by, *y]).collect();
        space.move_to(&bullets, &moved).unwrap();
        let events = space.update(DEFAULT_MAX_PAIRS).unwrap();
        assert!(events.entered.is_empty() && events.left.is_empty());
    }
    space.move_to(&ship, &[[1e6, 0.0]]).unwrap();
    assert_eq!(space.update(DEFAULT_MAX_PAIRS).unwrap().left.len(), 90_000);
}

#[test]
fn threads_change_nothing() {
    let run = |threads| {
        let mut space = Space::new(Settings { threads: Some(threads), ..Settings::default() })
            .expect("they are valid");
        let ids = space.add(&discs(&lattice(200), 0.7)).unwrap();
        let mut told = vec![space.update(DEFAULT_MAX_PAIRS).unwrap()];
        for step in 1..5 {
            let some: Vec<Id> = ids.iter().copied().step_by(step).collect();
            let to: Vec<_> =
                some.iter().map(|&id| [(id % 173) as f64, (id % 211) as f64]).collect();
            space.move_to(&some, &to).unwrap();
            told.push(space.update(DEFAULT_MAX_PAIRS).unwrap());
        }
        (told, space.pairs(None, DEFAULT_MAX_PAIRS).unwrap())
    };
    assert_eq!(run(1), run(2));
}
