//! A space: shapes that are added, moved, changed and removed, and the events of their pairs.

use crate::common::SetShapes;
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::{Error, Id, Method, Result, Settings};
use jostle_index::geometry::contact;
use jostle_index::pairs;
use jostle_index::{Each, Quadtree, Scalar, Shape, Shapes};
use jostle_space::Space;
use jostle_space::{Events, Wanted};

use super::driver::{Case, Draw, run};
use super::formulas;
use super::model::{Model, draw_shapes, place, resize};
use super::queries;

pub struct SpaceCase<T> {
    space: Space<T>,
    model: Model<T>,
    /// Pairs at the last update.
    touching: Vec<[Id; 2]>,
    events: Option<Events>,
}

pub fn draw_settings(draw: &mut Draw) -> Settings {
    Settings {
        leaf_capacity: draw.pick(&[1, 2, 5, 16]),
        max_depth: draw.pick(&[0, 2, 64]),
        threads: Some(draw.pick(&[1, 2])),
    }
}

impl<T: Scalar> Case for SpaceCase<T> {
    fn new(draw: &mut Draw) -> Self {
        let (settings, model) = (draw_settings(draw), Model::new(draw));
        draw.say("new", (settings, model.period));
        let space = Space::with_period(settings, model.period).expect("valid");
        Self { space, model, touching: Vec::new(), events: None }
    }

    fn operate(&mut self, draw: &mut Draw) {
        match draw.below(20) {
            0..3 => self.add(draw),
            3..6 => self.move_to(draw),
            6 => self.move_to_boxes(draw),
            7 => self.resize(draw),
            8 => self.set_filter(draw),
            9 => self.remove(draw),
            10..13 => self.update(draw),
            13 => self.find_pairs(draw),
            14 => self.find_neighbors(draw),
            15..17 => queries::ask(&mut self.space, &self.model, draw),
            17 => self.refuse(draw),
            18 => self.save(draw),
            _ => find_pairs_of_tree::<T>(draw),
        }
        self.check();
    }
}

impl<T: Scalar> SpaceCase<T> {
    /// Different ids, sorted in any way.
    fn named(&self, draw: &mut Draw) -> Vec<Id> {
        draw.subset(&self.model.ids(), 8)
    }

    fn add(&mut self, draw: &mut Draw) {
        let most = draw.pick(&[4, 8, 8, 40]);
        let shapes = draw_shapes(draw, most);
        draw.say("add", &shapes);
        let ids = self.space.add(&shapes).expect("there is room");
        self.model.add(&ids, &shapes);
    }

    fn move_to(&mut self, draw: &mut Draw) {
        let ids = self.named(draw);
        let stays = draw.one_in(8);
        let here = self.space.read(&ids, |shape| shape.center()).expect("they are there");
        let centers = if stays { here } else { ids.iter().map(|_| draw.point()).collect() };
        draw.say("move_to", (&ids, &centers));
        self.space.move_to(&ids, &centers).expect("valid");
        let period = self.model.period;
        self.model.change(&ids, |shape, row| place(shape, period.wrap(centers[row])));
    }

    fn move_to_boxes(&mut self, draw: &mut Draw) {
        let ids = self.named(draw);
        let boxes: Vec<[T; 4]> = ids
            .iter()
            .map(|_| {
                let ([x, y], [w, h]) = (draw.point(), [draw.size(), draw.size()]);
                [x, y, x + w, y + h]
            })
            .collect();
        draw.say("move_to_boxes", (&ids, &boxes));
        self.space.move_to_boxes(&ids, &boxes).expect("valid");
        let period = self.model.period;
        self.model.change(&ids, |shape, row| {
            let [left, low, right, high] = boxes[row];
            let [min, max] = period.wrap_corners([[left, low], [right, high]]);
            *shape = Shape { min, max, half_size: [T::ZERO; 2], ..*shape };
        });
    }

    fn resize(&mut self, draw: &mut Draw) {
        let ids = self.named(draw);
        let radii: Vec<T> = ids.iter().map(|_| draw.size()).collect();
        let halves: Vec<[T; 2]> = ids.iter().map(|_| [draw.size(), draw.size()]).collect();
        let which = draw.below(3);
        draw.say("resize", (which, &ids, &radii, &halves));
        let given = [(which < 2).then(|| Each::Rows(radii.clone()))];
        let given_halves = (which > 0).then(|| Each::Rows(halves.clone()));
        self.space.resize(&ids, given[0].as_ref(), given_halves.as_ref()).expect("valid");
        self.model.change(&ids, |shape, row| {
            if which < 2 {
                shape.radius = radii[row];
            }
            if which > 0 {
                resize(shape, halves[row]);
            }
        });
    }

    fn set_filter(&mut self, draw: &mut Draw) {
        let ids = self.named(draw);
        let (category, mask, which) = (draw.bits(), draw.bits(), draw.below(3));
        draw.say("set_filter", (which, &ids, category, mask));
        let given = [which < 2, which > 0];
        let [categories, masks] = [category, mask].map(Each::One);
        let [categories, masks] = [(given[0], categories), (given[1], masks)]
            .map(|(is_given, bits)| is_given.then_some(bits));
        self.space.set_filter(&ids, categories.as_ref(), masks.as_ref()).expect("valid");
        self.model.change(&ids, |shape, _| {
            shape.category = if given[0] { category } else { shape.category };
            shape.mask = if given[1] { mask } else { shape.mask };
        });
    }

    fn remove(&mut self, draw: &mut Draw) {
        let ids = if draw.one_in(10) { self.model.ids() } else { self.named(draw) };
        draw.say("remove", &ids);
        self.space.remove(&ids).expect("they are there");
        self.model.remove(&ids);
    }

    fn update(&mut self, draw: &mut Draw) {
        draw.say("update", ());
        let now = self.model.pairs(T::ZERO, None);
        let without = |pairs: &[[Id; 2]], others: &[[Id; 2]]| -> Vec<[Id; 2]> {
            pairs.iter().copied().filter(|pair| !others.contains(pair)).collect()
        };
        let (entered, left) = (without(&now, &self.touching), without(&self.touching, &now));
        let events = self.space.update(now.len()).expect("they fit");
        assert_eq!((&events.entered, &events.left), (&entered, &left));
        let stayed = without(&now, &entered);
        assert_eq!(self.space.stayed(&events).expect("there is memory"), Some(stayed));
        if let Some(old) = self.events.replace(events) {
            assert_eq!(self.space.stayed(&old).expect("there is memory"), None);
        }
        self.touching = now;
    }

    fn find_pairs(&mut self, draw: &mut Draw) {
        let (mask, distance) = (draw.mask(), draw.pick(&[0.0, 0.0, 0.5, 2.0]));
        let distance = T::from_f64(distance);
        draw.say("pairs", (mask, distance));
        let expected = self.model.pairs(distance, mask);
        let wanted = |max_pairs| Wanted { distance, mask, max_pairs };
        let mut found = self.space.pairs_within(&wanted(expected.len())).expect("they fit");
        found.sort_unstable();
        assert_eq!(found, expected);
        if let Some(max_pairs) = expected.len().checked_sub(1) {
            let refused = self.space.pairs_within(&wanted(max_pairs));
            assert_eq!(refused, Err(Error::TooManyPairs { max_pairs }));
        }
        let contacts = self.space.contacts((mask, true), DEFAULT_MAX_PAIRS).expect("few");
        assert_eq!(contacts.pairs, self.model.pairs(T::ZERO, mask));
        for (row, pair) in contacts.pairs.iter().enumerate() {
            let [a, b] = pair.map(|id| self.model.shapes[&id]);
            let [a, b] = self.model.period.nearest_images(&a, &b);
            assert_eq!((contacts.normals[row], contacts.depths[row]), contact(&a, &b));
        }
    }

    fn find_neighbors(&mut self, draw: &mut Draw) {
        let (mask, distance) = (draw.mask(), T::from_f64(draw.pick(&[0.0, 1.0, 4.0])));
        draw.say("neighbors", (mask, distance));
        let found = self.space.neighbors(distance, mask).expect("few");
        let pairs = self.model.pairs(distance, mask);
        let ids = self.model.ids();
        for (row, id) in ids.iter().enumerate() {
            let is_near = |other: &&Id| pairs.contains(&[*id.min(other), *id.max(other)]);
            let expected: Vec<Id> = ids.iter().filter(is_near).copied().collect();
            assert_eq!(found.of(row), expected);
        }
    }

    /// Wrong arguments are refused, and nothing changes.
    fn refuse(&mut self, draw: &mut Draw) {
        let mut ids = self.named(draw);
        let unknown = if draw.one_in(2) {
            draw.pick(&[-1, Id::MAX, 1 << 40])
        } else {
            self.model.gone.last().copied().unwrap_or(-7)
        };
        let is_id_wrong = draw.one_in(2) || ids.is_empty();
        if is_id_wrong {
            let twice = if ids.is_empty() || draw.one_in(2) { unknown } else { ids[0] };
            ids.push(twice);
        }
        let bad = if is_id_wrong { T::ONE } else { draw.wrong() };
        let row = draw.below(ids.len());
        draw.say("refuse", (&ids, bad));
        let mut centers = vec![[T::ONE; 2]; ids.len()];
        centers[row][1] = bad;
        let mut boxes = vec![[T::ONE; 4]; ids.len()];
        boxes[row][draw.below(4)] = bad;
        let mut radii = vec![T::ONE; ids.len()];
        radii[row] = bad;
        let radii = Each::Rows(radii);
        let results: Vec<Result<()>> = vec![
            self.space.move_to(&ids, &centers),
            self.space.move_to_boxes(&ids, &boxes),
            self.space.resize(&ids, Some(&radii), None),
            self.space.resize(&ids, None, Some(&Each::Rows(centers.clone()))),
        ];
        assert!(results.iter().all(Result::is_err), "{results:?}");
        if is_id_wrong {
            assert!(self.space.remove(&ids).is_err());
            assert!(self.space.set_filter(&ids, Some(&Each::One(5)), None).is_err());
        } else {
            assert!(Shapes::circles(centers, radii).is_err());
            let lengths = self.space.move_to(&ids, &vec![[T::ONE; 2]; ids.len() + 1]);
            assert!(lengths.is_err());
        }
    }

    /// The space continues from what it has saved, or as its copy.
    fn save(&mut self, draw: &mut Draw) {
        let (settings, copies) = (draw_settings(draw), draw.one_in(3));
        draw.say(if copies { "clone" } else { "restore" }, settings);
        if copies {
            self.space = self.space.clone();
            return;
        }
        let saved = self.space.save().expect("there is memory");
        let restored = Space::restore(settings, self.model.period, saved.clone());
        self.space = restored.expect("it was saved");
        assert_eq!(self.space.save().expect("there is memory"), saved);
        self.events = None;
    }

    fn check(&mut self) {
        self.space.check().expect("its invariants hold");
        let ids = self.model.ids();
        assert_eq!(self.space.ids().expect("there is memory"), ids);
        let backwards: Vec<Id> = ids.iter().rev().copied().collect();
        let rows = self.space.rows_of(&backwards).expect("they are there");
        assert!(rows.into_iter().eq((0..ids.len() as i64).rev()));
        assert_eq!((self.space.len(), self.space.is_empty()), (ids.len(), ids.is_empty()));
        let shapes = self.space.read(&ids, |shape| shape).expect("they are there");
        assert!(shapes.iter().eq(ids.iter().map(|id| &self.model.shapes[id])), "{shapes:?}");
        assert!(!self.model.gone.iter().any(|id| self.space.contains(*id)));
    }
}

/// The pairs of new shapes, by all methods.
fn find_pairs_of_tree<T: Scalar>(draw: &mut Draw) {
    let (shapes, period) = (draw_shapes::<T>(draw, 24), Model::<T>::new(draw).period);
    let settings = draw_settings(draw);
    draw.say("pairs of", (&shapes, period, settings));
    let shapes = shapes.in_period(period).expect("valid");
    let rows: Vec<(Id, Shape<T>)> =
        (0..).zip((0..shapes.len()).map(|row| shapes.shape(row))).collect();
    let expected =
        formulas::pairs(rows.iter().map(|(id, shape)| (id, shape)), &period, (T::ZERO, None));
    let sorted = |mut pairs: Vec<[u32; 2]>| -> Vec<[Id; 2]> {
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        pairs.into_iter().map(|pair| pair.map(Id::from)).collect()
    };
    for method in [None, Some(Method::Brute), Some(Method::Quadtree)] {
        let found = pairs::find(&shapes, method, settings.threads, DEFAULT_MAX_PAIRS).expect("few");
        assert_eq!(sorted(found.pairs), expected, "{method:?}");
    }
    let tree = Quadtree::new(&shapes, settings).expect("valid");
    tree.check().expect("its invariants hold");
    let found = pairs::within(&tree, None, DEFAULT_MAX_PAIRS).expect("few");
    assert_eq!(sorted(found.pairs), expected);
}

#[test]
fn a_space_in_float32_is_its_model() {
    run::<SpaceCase<f32>>(360);
}

#[test]
fn a_space_in_float64_is_its_model() {
    run::<SpaceCase<f64>>(360);
}
