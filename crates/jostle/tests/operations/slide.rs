//! Shapes that slide along others and along line segments, in two spaces with different histories.
//!
//! One space keeps its trees, the other is made anew from the shapes that are there; both give the same answers. A
//! shape does not pass what a cast of it meets first, and enters nothing.

use crate::common::SetShapes;
use jostle_base::Id;
use jostle_index::query::{self, Ray};
use jostle_index::{Each, Period, Shape, Shapes};
use jostle_slide::SlideRules;
use jostle_space::Slides;
use jostle_space::Space;

use super::driver::{Case, Draw, run};
use super::formulas::overlap;
use super::model::Model;
use super::space::draw_settings;

/// Smaller overlaps and distances are rounding.
const TOLERANCE: f64 = 1e-6;

struct SlideCase {
    kept: Space<f64>,
    other: Space<f64>,
    /// All shapes but the segments.
    model: Model<f64>,
    segments: Vec<Id>,
    /// Whether something has moved other than by sliding since the last call: then it may push.
    is_pushed: bool,
}

impl Case for SlideCase {
    fn new(draw: &mut Draw) -> Self {
        let model = Model::new(draw);
        let spaces =
            [0, 1].map(|_| Space::with_period(draw_settings(draw), model.period).expect("valid"));
        draw.say("new", model.period);
        let [kept, other] = spaces;
        let mut case = Self { kept, other, model, segments: Vec::new(), is_pushed: false };
        (0..3).for_each(|_| case.add(draw));
        case
    }

    fn operate(&mut self, draw: &mut Draw) {
        match draw.below(12) {
            0 => self.add(draw),
            1 => self.move_to(draw),
            2 => self.remove(draw),
            3 => self.replace_segments(draw),
            4 => self.refuse(draw),
            5..7 => self.restore(draw),
            _ => self.slide(draw),
        }
    }
}

impl SlideCase {
    fn add(&mut self, draw: &mut Draw) {
        let size = |draw: &mut Draw| draw.pick(&[0.5, 0.25, 1.0, 0.0, 2.5]);
        let centers: Vec<[f64; 2]> = draw.some(6, |draw| {
            [0, 1].map(
                |_| if draw.one_in(2) { draw.below(12) as f64 } else { draw.between(0.0, 12.0) },
            )
        });
        let halves = centers.iter().map(|_| [size(draw), size(draw)]).collect();
        let radii = centers.iter().map(|_| draw.pick(&[0.0, 0.0, 0.5, 0.3])).collect();
        let categories = centers.iter().map(|_| draw.pick(&[1, 1, 2, 3])).collect();
        let filters = [Each::Rows(categories), Each::One(u32::MAX)];
        let shapes =
            Shapes::new(centers, Each::Rows(radii), Some(Each::Rows(halves)), Some(filters))
                .expect("valid");
        draw.say("add", &shapes);
        let ids = self.kept.add(&shapes).expect("there is room");
        assert_eq!(self.other.add(&shapes).expect("there is room"), ids);
        self.model.add(&ids, &shapes);
    }

    fn move_to(&mut self, draw: &mut Draw) {
        let ids = draw.subset(&self.model.ids(), 3);
        let moved = |shape: &Shape<f64>, by: [f64; 2]| [0, 1].map(|k| shape.min[k] + by[k]);
        let centers: Vec<[f64; 2]> = ids
            .iter()
            .map(|id| {
                moved(&self.model.shapes[id], [draw.between(-1.0, 1.0), draw.between(-1.0, 1.0)])
            })
            .collect();
        draw.say("move_to", (&ids, &centers));
        for space in [&mut self.kept, &mut self.other] {
            space.move_to(&ids, &centers).expect("valid");
        }
        self.is_pushed = true;
        self.read();
    }

    fn remove(&mut self, draw: &mut Draw) {
        let ids = draw.subset(&self.model.ids(), 2);
        draw.say("remove", &ids);
        for space in [&mut self.kept, &mut self.other] {
            space.remove(&ids).expect("they are there");
        }
        self.model.remove(&ids);
    }

    fn replace_segments(&mut self, draw: &mut Draw) {
        // Of different lengths, with common ends.
        let segments: Vec<[[f64; 2]; 2]> = draw.some(4, |draw| {
            let at = [draw.below(8) as f64, draw.below(6) as f64];
            [at, [0, 1].map(|k| at[k] + [2.0, draw.pick(&[0.0, 1.0, -0.5])][k])]
        });
        draw.say("replace_segments", &segments);
        let shapes = Shapes::from_segments(&segments, Each::One(0.0), None).expect("valid");
        let ids = [&mut self.kept, &mut self.other].map(|space| {
            space.remove(&self.segments).expect("they are there");
            space.add(&shapes).expect("there is room")
        });
        assert_eq!(ids[0], ids[1]);
        [self.segments, _] = ids;
    }

    fn refuse(&mut self, draw: &mut Draw) {
        draw.say("refuse", ());
        let (rules, ids) = (
            SlideRules { mask: 1, up: [0.0, -1.0], floor_angle: 0.8, ..SlideRules::default() },
            self.model.ids(),
        );
        let bad = draw.wrong();
        for space in [&mut self.kept, &mut self.other] {
            for &segment in &self.segments {
                assert!(space.move_and_slide(&[segment], &[[0.0; 2]], &rules).is_err());
            }
            assert!(space.move_and_slide(&[-5], &[[0.0; 2]], &rules).is_err());
            assert!(space.move_and_slide(&ids, &vec![[0.0; 2]; ids.len() + 1], &rules).is_err());
            if let Some(&id) = ids.first() {
                assert!(space.move_and_slide(&[id], &[[bad, 0.0]], &rules).is_err());
                assert!(space.move_and_slide(&[id, id], &[[0.0; 2]; 2], &rules).is_err());
            }
        }
        self.read();
    }

    /// The second space is made anew.
    fn restore(&mut self, draw: &mut Draw) {
        let settings = draw_settings(draw);
        draw.say("restore", settings);
        let saved = self.kept.save().expect("there is memory");
        self.other = Space::restore(settings, self.model.period, saved).expect("it was saved");
        self.read();
    }

    fn slide(&mut self, draw: &mut Draw) {
        let period = self.model.period;
        let fits = |shape: &Shape<f64>| {
            (0..2).all(|k| {
                !period.is_along(k)
                    || 2.0 * (shape.core_half_size()[k] + shape.radius) <= period.sides()[k]
            })
        };
        let able: Vec<Id> =
            self.model.shapes.iter().filter(|(_, shape)| fits(shape)).map(|of| *of.0).collect();
        let ids = draw.subset(&able, 3);
        let along = |draw: &mut Draw| match draw.below(8) {
            0..2 => 0.0,
            2..7 => draw.between(-3.0, 3.0),
            _ => draw.pick(&[5.0, -5.0]),
        };
        let displacements: Vec<[f64; 2]> = ids.iter().map(|_| [along(draw), along(draw)]).collect();
        let (mask, slides) = (draw.pick(&[u32::MAX, 1, 2]), draw.pick(&[1, 2, 4]));
        let up = draw.pick(&[[0.0, -1.0], [0.0; 2]]);
        let one_way = draw.pick(&[0, 0, 0, 2]);
        draw.say("slide", (&ids, &displacements, mask, slides, up, one_way));
        let given = SlideRules::default();
        let rules = SlideRules { mask, max_slides: slides, up, floor_angle: 0.8, one_way, ..given };
        let before = self.model.shapes.clone();
        let found = self.kept.move_and_slide(&ids, &displacements, &rules).expect("valid");
        let other = self.other.move_and_slide(&ids, &displacements, &rules).expect("valid");
        assert_eq!(found, other);
        self.read();
        for (row, id) in ids.iter().enumerate() {
            let hits = &found.ids[found.offsets[row]..found.offsets[row + 1]];
            for hit in hits {
                assert!(
                    self.segments.contains(hit)
                        || self
                            .model
                            .shapes
                            .get(hit)
                            .is_some_and(|shape| shape.category & mask != 0)
                );
            }
            let is_free = |id: &Id| {
                before.iter().all(|(other, shape)| {
                    other == id
                        || shape.category & mask == 0
                        || !overlap(&before[id], shape, &period)
                })
            };
            let are_boxes = self.segments.is_empty();
            if !self.is_pushed && are_boxes && ids.len() == 1 && one_way == 0 && is_free(id) {
                self.check_path(&found, displacements[row], &before[id], (*id, mask));
            }
        }
        self.is_pushed = false;
    }

    /// Compares the motion of a shape that was alone with a cast of it against each obstacle.
    fn check_path(
        &self,
        found: &Slides<f64>,
        wanted: [f64; 2],
        start: &Shape<f64>,
        (id, mask): (Id, u32),
    ) {
        let end = &self.model.shapes[&id];
        let obstacles = || {
            self.model
                .shapes
                .iter()
                .filter(|(other, shape)| **other != id && shape.category & mask != 0)
        };
        for (other, shape) in obstacles() {
            assert!(!overlap(end, shape, &self.model.period), "it has entered {other}");
        }
        let [moved, wished] = [found.displacement[0], wanted].map(|[x, y]| x.hypot(y));
        assert!(
            moved <= wished * (1.0 + TOLERANCE) + TOLERANCE,
            "it has moved by {moved} of {wished}"
        );
        if !found.ids.is_empty() || wished == 0.0 || self.model.period != Period::default() {
            return;
        }
        let is_close = |k: usize| (found.displacement[0][k] - wanted[k]).abs() < TOLERANCE;
        assert!(is_close(0) && is_close(1), "it has met nothing: {found:?}");
        for (other, shape) in obstacles() {
            // A path that grazes an obstacle is free.
            let less = |size: f64| (size - TOLERANCE).max(0.0);
            let core = shape.core_half_size();
            let is_thin = core[0].min(core[1]) == 0.0 && shape.radius == 0.0;
            let smaller = Shape {
                min: shape.center(),
                max: shape.center(),
                half_size: core.map(less),
                radius: less(shape.radius),
                ..*shape
            };
            let (halves, radius) =
                (Each::One(start.core_half_size().map(less)), Each::One(less(start.radius)));
            let (at, way) = (Each::One(start.center()), Each::One(wanted));
            let ray =
                Ray::of_boxes(&at, &way, (&halves, &radius), &Each::One(wished)).expect("valid");
            let hit = query::hit(&ray[0], &smaller).filter(|hit| *hit < wished - TOLERANCE);
            assert!(is_thin || hit.is_none(), "it has passed {other} at {hit:?}");
        }
    }

    /// Both spaces have the same shapes; the model takes their places.
    fn read(&mut self) {
        let ids = self.model.ids();
        let [kept, other] = [&self.kept, &self.other].map(|space| {
            space.check().expect("its invariants hold");
            space.read(&ids, |shape| shape).expect("they are there")
        });
        assert_eq!(kept, other);
        for (id, new) in ids.iter().zip(kept) {
            let shape = self.model.shapes.get_mut(id).expect("it is there");
            let same = (shape.core_half_size(), shape.radius, shape.category, shape.mask);
            assert_eq!((new.core_half_size(), new.radius, new.category, new.mask), same);
            *shape = new;
        }
    }
}

#[test]
fn a_slide_depends_on_no_history_and_passes_nothing() {
    run::<SlideCase>(110);
}
