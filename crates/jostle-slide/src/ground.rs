//! How a shape walks on floors: it keeps to them, climbs steps, and keeps its speed on slopes.
//!
//! A shape walks if it touches something below at the beginning, or meets a floor on its way, and
//! its displacement has no component along `up`. All else is a jump or a fall, which
//! [`Walker::slide`] computes.

use super::rules::{Surface, dot};
use super::walker::{SlideHit, Walker, extent, length};
use jostle_index::geometry::{self, Scalar};

/// The largest gap to a floor that counts as touching it, as a share of the size of the shape.
const TOUCH: f64 = 1.0 / 1024.0;

impl<T: Scalar> Walker<'_, T> {
    /// Moves it by its own displacement, by the rules for floors if there are any.
    pub fn walk(&mut self, displacement: [T; 2]) {
        let rules = self.rules;
        let rise = dot(displacement, rules.up);
        if !rules.is_walking() || rise > self.slop(length(displacement)) {
            return self.slide(displacement);
        }
        // One search for all that follows.
        self.look(self.down(rules.reach() + length(displacement)));
        let support = self.support();
        let floor = support.filter(|hit| rules.kind(hit.normal) == Surface::Floor);
        let across = rules.across(displacement);
        self.remaining = displacement;
        let (mut is_walking, mut is_along) = (support.is_some(), false);
        let mut path = displacement;
        if let Some(floor) = floor.filter(|_| rules.constant_speed) {
            // Gravity is left out: it would lengthen the way down and shorten the way up.
            path = rules.along_floor(across, floor.normal, norm(across));
            is_along = true;
        }
        self.slide_by(path, |walker, left, hit| {
            let speed = if is_along { norm(left) } else { norm(rules.across(left)) };
            match rules.kind(hit.normal) {
                Surface::Wall if is_walking => walker.climb(left),
                Surface::Floor => {
                    is_walking = true;
                    if !rules.constant_speed {
                        return None;
                    }
                    is_along = true;
                    walker.hits.push(hit);
                    walker.remaining = rules.across(walker.remaining);
                    Some(rules.along_floor(across, hit.normal, speed))
                }
                _ => None,
            }
        });
        let fall = if floor.is_some() && rules.constant_speed { -rise } else { T::ZERO };
        if is_walking {
            self.settle(across, fall);
        }
    }

    /// Puts it on a floor below, if there is one near; else it falls by `fall`.
    fn settle(&mut self, across: [T; 2], fall: T) {
        let drop = self.rules.snap.max(fall);
        if drop <= T::ZERO {
            return;
        }
        match self.land(drop, across) {
            Some((floor, _)) => {
                self.hits.push(floor);
                // What a slope has turned upwards would become a hop where the slope ends.
                self.remaining = self.rules.across(self.remaining);
            }
            None => self.slide_by(self.down(fall), |_, _, _| None),
        }
    }

    /// Climbs a step that stops it: up, on by the rest of its displacement, and down onto a floor.
    /// Returns what is left of the rest; None if there is no step, and it has not moved.
    fn climb(&mut self, rest: [T; 2]) -> Option<[T; 2]> {
        let (rules, start, touch) = (self.rules, self.body, self.touch());
        let across = rules.across(rest);
        let length = norm(across);
        if rules.step_height == T::ZERO || length <= self.slop(T::ZERO) {
            return None;
        }
        let highest = self.feet(rules.up) + rules.step_height + touch;
        // Below a ceiling a part of the height may do.
        let rise = self.cast(rules.up.map(|v| v * rules.step_height));
        let height = rise.map_or(T::ONE, |(share, _)| share) * rules.step_height;
        let share = self.cast(across).map_or(T::ONE, |(share, _)| share);
        // Where a higher wall stops it again, it only moves by what rounding has left of the way.
        let is_on = share == T::ONE || share * length > touch;
        // Also onto what is a little lower: what is fast passes a low obstacle in one call.
        let floor = self.land(height + rules.snap.max(touch), across);
        // By the point where it touches the floor: the edge of a higher step would hold what is
        // round when it is raised.
        let Some((floor, _)) = floor.filter(|&(_, level)| is_on && level <= highest) else {
            self.body = start;
            return None;
        };
        self.hits.push(floor);
        self.remaining = rules.across(self.remaining);
        Some(across.map(|v| v * (T::ONE - share)))
    }

    /// Moves it down by at most a distance onto a floor, and returns where along `up` the floor is.
    /// Without one it stays where it is.
    fn land(&mut self, distance: T, ahead: [T; 2]) -> Option<(SlideHit<T>, T)> {
        let (rules, start) = (self.rules, self.body);
        let floor = self.cast(self.down(distance)).and_then(|(share, hit)| {
            match rules.kind(hit.normal) {
                Surface::Floor => Some((hit, self.feet(hit.normal))),
                // A round shape leans on the edge of a step. It is on a floor if there is one next
                // to the edge: ahead, where it climbs, or beside, where it goes down.
                Surface::Wall if dot(hit.normal, rules.up) > T::ZERO => {
                    let edge = std::mem::replace(&mut self.body, start);
                    let above = self.beside(ahead, distance);
                    self.body = edge;
                    let rest = distance * (T::ONE - share);
                    let floor = above.or_else(|| self.beside(hit.normal, rest));
                    self.body = edge;
                    floor
                }
                _ => None,
            }
        });
        if floor.is_none() {
            self.body = start;
        }
        floor
    }

    /// As [`land`](Self::land), at the place that is its radius away.
    fn beside(&mut self, direction: [T; 2], distance: T) -> Option<(SlideHit<T>, T)> {
        let across = self.rules.across(direction);
        let (length, radius) = (norm(across), self.body.radius);
        if length == T::ZERO || radius == T::ZERO {
            return None;
        }
        self.cast(across.map(|v| v / length * radius));
        let (_, hit) = self.cast(self.down(distance))?;
        let is_floor = self.rules.kind(hit.normal) == Surface::Floor;
        is_floor.then(|| (hit, self.feet(hit.normal)))
    }

    /// Where along `up` it touches a floor with this normal.
    fn feet(&self, normal: [T; 2]) -> T {
        let (up, body) = (self.rules.up, &self.body);
        let half = body.half_size[0] * up[0].abs() + body.half_size[1] * up[1].abs();
        dot(body.min, up) - half - body.radius * dot(normal, up)
    }

    /// What it touches below.
    fn support(&mut self) -> Option<SlideHit<T>> {
        let start = self.body;
        let hit = self.cast(self.down(self.touch()));
        self.body = start;
        hit.map(|(_, hit)| hit).filter(|hit| dot(hit.normal, self.rules.up) > T::ZERO)
    }

    /// The largest gap that counts as touching.
    fn touch(&self) -> T {
        let size = extent(&self.body, 0).max(extent(&self.body, 1));
        let slop = |span: T| self.slop(span + span + span + span);
        // At least what rounding may leave between it and the obstacles near it.
        let rounding = self.near.iter().map(|near| {
            let span = |body: &_, outline: &dyn super::Outline<T>| outline.span(body);
            slop(near.facing((&self.period, T::ZERO), &self.body, span))
        });
        size * T::from_f64(TOUCH) + rounding.fold(slop(T::ZERO), T::max)
    }

    fn down(&self, distance: T) -> [T; 2] {
        self.rules.up.map(|v| T::ZERO - v * distance)
    }
}

fn norm<T: Scalar>(v: [T; 2]) -> T {
    geometry::length(v[0].abs(), v[1].abs())
}
