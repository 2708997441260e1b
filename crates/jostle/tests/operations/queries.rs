//! Queries of a space: regions, nearest shapes and casts, against tests of one shape after the other.

use jostle_base::Id;
use jostle_index::query::{self, Circle, Point, Polygon, Ray, RayHits, Rect, Region};
use jostle_index::{Each, Scalar, Shape};
use jostle_space::Space;

use super::driver::Draw;
use super::formulas::overlap;
use super::model::Model;

/// Largest number of images of a region or a ray along an axis, to each side.
const MOST_IMAGES: i32 = 4;

/// Asks one question.
pub fn ask<T: Scalar>(space: &mut Space<T>, model: &Model<T>, draw: &mut Draw) {
    let (mask, count) = (draw.mask(), 1 + draw.below(3));
    let places: Vec<[T; 2]> = (0..count).map(|_| draw.point()).collect();
    let sizes: Vec<[T; 2]> = (0..count).map(|_| [draw.size(), draw.size()]).collect();
    let chosen: Vec<(Id, Shape<T>)> = model
        .shapes
        .iter()
        .map(|(id, shape)| (*id, *shape))
        .filter(|(_, shape)| mask.is_none_or(|mask| mask & shape.category != 0))
        .collect();
    let mut asked = Asked { space, model, mask, chosen };
    match draw.below(6) {
        0 => {
            let rows: Vec<[T; 4]> =
                places.iter().zip(&sizes).map(|(&[x, y], &[w, h])| [x, y, x + w, y + h]).collect();
            draw.say("search rectangles", (&rows, mask));
            asked.search(&Rect::all(&rows).expect("valid"), |row| {
                let [min_x, min_y, max_x, max_y] = rows[row];
                Some(shape_of([min_x, min_y], [max_x, max_y], T::ZERO))
            });
        }
        1 => {
            let radii: Vec<T> = sizes.iter().map(|size| size[0]).collect();
            draw.say("search circles", (&places, &radii, mask));
            let circles = Circle::all(&Each::Rows(places.clone()), &Each::Rows(radii.clone()));
            asked.search(&circles.expect("valid"), |row| {
                Some(shape_of(places[row], places[row], radii[row]))
            });
        }
        2 => {
            draw.say("search points", (&places, mask));
            asked.search(&Point::all(&places).expect("valid"), |_| None);
        }
        3 => {
            let corners = |(&[x, y], &[w, h]): (&[T; 2], &[T; 2])| {
                Polygon::new(&[[x, y], [x + w, y - h], [x + w + h, y + h], [x + w, y + h + w]]).ok()
            };
            draw.say("search polygons", (&places, &sizes, mask));
            let polygons: Vec<Polygon<T>> = places.iter().zip(&sizes).filter_map(corners).collect();
            asked.search(&polygons, |_| None);
        }
        4 => {
            let (k, reach) =
                (draw.below(5), if draw.one_in(2) { T::INFINITY } else { draw.size() });
            draw.say("nearest", (&places, k, reach, mask));
            asked.nearest(&places, k, reach);
        }
        _ => {
            let ways: Vec<[T; 2]> = (0..count)
                .map(|_| {
                    draw.pick(&[[1.0, 0.0], [0.0, -1.0], [-3.0, 4.0], [1e-3, 2.0]]).map(T::from_f64)
                })
                .collect();
            let length = if draw.one_in(3) && model.period.is_none() {
                T::INFINITY
            } else {
                T::from_f64(draw.between(0.0, 12.0))
            };
            // Rays without a size are frequent.
            let has_size = draw.below(3);
            let (mut halves, mut radii) = (vec![[T::ZERO; 2]; count], vec![T::ZERO; count]);
            if has_size > 0 {
                radii = sizes.iter().map(|size| size[0]).collect();
            }
            if has_size > 1 {
                halves = sizes;
            }
            draw.say("cast", (&places, &ways, &halves, &radii, length, mask));
            asked.cast(&places, &ways, (&halves, &radii), length);
        }
    }
}

fn shape_of<T: Scalar>(min: [T; 2], max: [T; 2], radius: T) -> Shape<T> {
    Shape {
        min,
        max,
        half_size: [T::ZERO; 2],
        radius,
        category: 1,
        mask: 1,
        core: jostle::Core::Box,
    }
}

struct Asked<'a, T> {
    space: &'a mut Space<T>,
    model: &'a Model<T>,
    mask: Option<u32>,
    /// The shapes that the mask selects, by ids.
    chosen: Vec<(Id, Shape<T>)>,
}

impl<T: Scalar> Asked<'_, T> {
    /// `formula` gives a region as a shape, if there is one: then its formula of overlaps holds, too.
    fn search<R: Region<T>>(&mut self, regions: &[R], formula: impl Fn(usize) -> Option<Shape<T>>) {
        let (period, found) = (self.model.period, self.space.search(regions, self.mask));
        // Some are too large for the period.
        let refused = regions
            .iter()
            .any(|region| !period.is_none() && region.check_period(0, &period).is_err());
        let Ok(found) = found else { return assert!(refused, "{found:?}") };
        for (row, region) in regions.iter().enumerate() {
            let images: Vec<R> =
                period.images().map(|shift| region.wrapped(&period).moved(shift)).collect();
            let touches = |shape: &Shape<T>| images.iter().any(|image| image.overlaps(shape));
            let chosen = self.chosen.iter();
            let expected: Vec<Id> =
                chosen.filter(|(_, shape)| touches(shape)).map(|of| of.0).collect();
            assert_eq!(found.of(row), expected, "{}", std::any::type_name::<R>());
            if let (Some(formula), true) = (formula(row), period.is_none()) {
                let again =
                    self.chosen.iter().filter(|(_, shape)| overlap(&formula, shape, &period));
                assert!(again.map(|of| of.0).eq(expected));
            }
        }
    }

    fn nearest(&mut self, points: &[[T; 2]], k: usize, reach: T) {
        let found = self.space.nearest(points, (k, reach), self.mask).expect("valid");
        let period = self.model.period;
        for (row, point) in points.iter().enumerate() {
            let [x, y] = period.wrap(*point);
            let images: Vec<[T; 2]> = period.images().map(|by| [x - by[0], y - by[1]]).collect();
            let of = |(id, shape): &(Id, Shape<T>)| {
                let distances = images.iter().map(|image| query::distance(*image, shape));
                (distances.reduce(T::min).expect("one image at least"), *id)
            };
            let near = self.chosen.iter().map(of).filter(|(distance, _)| *distance <= reach);
            let expected = in_order(near.collect());
            let range = row * k..(row + 1) * k;
            let answer = found.distances[range.clone()]
                .iter()
                .copied()
                .zip(found.ids[range].iter().copied());
            let none = std::iter::repeat((T::INFINITY, -1));
            assert!(
                answer.clone().eq(expected.iter().copied().chain(none).take(k)),
                "{:?} {expected:?}",
                answer.collect::<Vec<_>>()
            );
        }
    }

    fn cast(&mut self, places: &[[T; 2]], ways: &[[T; 2]], sizes: (&[[T; 2]], &[T]), length: T) {
        let period = self.model.period;
        let sides = period.sides();
        let (halves, radii) = (Each::Rows(sizes.0.to_vec()), Each::Rows(sizes.1.to_vec()));
        let (ways, length) = (Each::Rows(ways.to_vec()), Each::One(length));
        let make = |places: Vec<[T; 2]>| {
            Ray::of_boxes(&Each::Rows(places), &ways, (&halves, &radii), &length).expect("valid")
        };
        let wrapped: Vec<[T; 2]> = places.iter().map(|&place| period.wrap(place)).collect();
        let far = [0, 1].map(|axis| if sides[axis] > T::ZERO { MOST_IMAGES } else { 0 });
        let reach = |axis: usize| sides[axis].to_f64() * f64::from(MOST_IMAGES - 2);
        let is_far =
            (0..2).any(|axis| period.is_along(axis) && length.at(0).to_f64() > reach(axis));
        let is_large = self
            .chosen
            .iter()
            .map(|(_, shape)| {
                shape.radius + shape.core_half_size()[0].max(shape.core_half_size()[1])
            })
            .chain(sizes.0.iter().map(|half| half[0].max(half[1])))
            .chain(sizes.1.iter().copied())
            .any(|size| size > T::from_f64(3.0));
        if !period.is_none() && (is_far || is_large) {
            // More images would be needed.
            return;
        }
        let mut hits: Vec<Vec<(T, Id)>> = vec![Vec::new(); places.len()];
        let images: Vec<[i32; 2]> =
            (-far[0]..=far[0]).flat_map(|x| (-far[1]..=far[1]).map(move |y| [x, y])).collect();
        let images: Vec<Vec<Ray<T>>> = images
            .into_iter()
            .map(|image| {
                let shift = [0, 1].map(|axis| T::from_f64(f64::from(image[axis])) * sides[axis]);
                make(wrapped.iter().map(|[x, y]| [*x - shift[0], *y - shift[1]]).collect())
            })
            .collect();
        for (row, hits) in hits.iter_mut().enumerate() {
            for (id, shape) in &self.chosen {
                let hit = images.iter().filter_map(|rays| query::hit(&rays[row], shape));
                let first = hit.filter(|hit| *hit <= length.at(0)).reduce(T::min);
                hits.extend(first.map(|distance| (distance, *id)));
            }
        }
        let rays = make(places.to_vec());
        let all = self.space.all_hits(&rays, self.mask).expect("valid");
        let first = self.space.first_hits(&rays, self.mask).expect("valid");
        for (row, hits) in hits.into_iter().enumerate() {
            let expected = in_order(hits);
            let RayHits { ids, distances, offsets, .. } = &all;
            let range = offsets[row]..offsets[row + 1];
            let answer = distances[range.clone()].iter().copied().zip(ids[range].iter().copied());
            assert!(
                answer.clone().eq(expected.iter().copied()),
                "{:?} {expected:?}",
                answer.collect::<Vec<_>>()
            );
            let nearest = expected.first().copied().unwrap_or((T::INFINITY, -1));
            assert_eq!((first.distances[row], first.ids[row]), nearest);
        }
    }
}

/// Nearest first, at equal distances the smaller id.
fn in_order<T: Scalar>(mut all: Vec<(T, Id)>) -> Vec<(T, Id)> {
    all.sort_by(|a, b| a.0.total_order(&b.0).then(a.1.cmp(&b.1)));
    all
}
