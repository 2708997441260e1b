//! Search of colliding pairs. The core finds candidate pairs of slightly enlarged shapes; pygame's
//! comparison, repeated here on exact numbers, decides.

use jostle_base::Result;
use jostle_base::interrupt::{self, Pulse};
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_base::sorting;
use jostle_index::{Each, Scalar, Shapes, pairs};

use super::rules::{Circle, Edges, Kind, Rect, circles_collide};

/// Sorted pairs of rows, and which of them are certain; None if all are.
pub struct Found {
    pub pairs: Vec<[u32; 2]>,
    pub sure: Option<Vec<bool>>,
}

impl Found {
    /// Pairs none of which is certain.
    fn candidates(pairs: Vec<[u32; 2]>) -> Self {
        let sure = vec![false; pairs.len()];
        Self { pairs, sure: Some(sure) }
    }
}

/// Relative enlargement of shapes, much larger than all rounding errors.
const MARGIN: f64 = 1e-9;

/// Integers up to this, their halves and the results of the core are exact as float32, which is
/// faster.
const SMALL: f64 = 1e6;

/// More than the gap between any two rectangles of float32 numbers.
const LARGEST_GAP: f64 = 2e39;

/// Relative enlargement of radii that are not exact as float64.
const INEXACT_MARGIN: f64 = 1e-3;

/// Approximate number of values read when two sprites are compared.
const PAIR_WORK: usize = 16;

/// Colliding rectangles, scaled by `ratio`. Both are compared in the type of the left one.
pub fn rects(a: &[Rect], b: Option<&[Rect]>, ratio: f64) -> Result<Option<Found>> {
    let edges = |rect: &Rect, kind: Kind| {
        let rect = if ratio == 1.0 { *rect } else { rect.scaled(ratio)? };
        rect.as_kind(kind)?.edges()
    };
    let mut found = Vec::new();
    for kind in [Kind::Int, Kind::Float] {
        let count = a.iter().filter(|rect| rect.kind() == kind).count();
        if count == 0 {
            continue;
        }
        let own = |rect: &Rect| if rect.kind() == kind { edges(rect, kind) } else { Some(None) };
        let all = |rect: &Rect| edges(rect, kind);
        let left = Side { rects: a, edges: &own };
        let right = Side { rects: b.unwrap_or(a), edges: &all };
        let is_same = b.is_none() && count == a.len();
        let Some(mut pairs) = boxes(&left, (!is_same).then_some(&right))? else { return Ok(None) };
        if b.is_none() {
            pairs.retain(|[i, j]| i < j);
        }
        found.append(&mut pairs);
    }
    sorting::sort(&mut found, &mut Pulse::current())?;
    Ok(Some(Found { pairs: found, sure: None }))
}

/// Rectangles that collide or are at most `distance` apart along each axis.
pub fn within(a: &[Rect], b: Option<&[Rect]>, distance: f64) -> Result<Option<Found>> {
    // No gap between two rectangles is larger; the limit prevents overflow of squares.
    let distance = distance.min(LARGEST_GAP);
    // A pixel and a millionth are more than the rounding and truncation of pygame.
    let slack = |k: usize, edges: &Edges| {
        1.0 + 1e-6 * (distance + edges.min[k].abs() + edges.max[k].abs()) + distance / 2.0
    };
    let grown = |rect: &Rect| {
        let edges = rect.bounds()?;
        let more = [slack(0, &edges), slack(1, &edges)];
        let min = [edges.min[0] - more[0], edges.min[1] - more[1]];
        let max = [edges.max[0] + more[0], edges.max[1] + more[1]];
        Some(Some(Edges { min, max }))
    };
    let side = |rects| Side { rects, edges: &grown };
    let Some(near) = boxes(&side(a), b.map(side).as_ref())? else { return Ok(None) };
    let mut pairs = Vec::new();
    let mut pulse = Pulse::current();
    for [i, j] in near {
        pulse.check(PAIR_WORK)?;
        match a[i as usize].within(&b.unwrap_or(a)[j as usize], distance) {
            Some(true) => pairs.push([i, j]),
            Some(false) => {}
            None => return Ok(None),
        }
    }
    sorting::sort(&mut pairs, &mut Pulse::current())?;
    Ok(Some(Found::candidates(pairs)))
}

/// Candidate pairs of masks: pygame truncates the distance of two to whole pixels, so they
/// may be up to one pixel apart.
pub fn masks(a: &[Rect], b: Option<&[Rect]>) -> Result<Option<Found>> {
    let grown = |rect: &Rect| {
        let [x, y, w, h] = rect.sides();
        Some(Some(Edges { min: [x - 1.0, y - 1.0], max: [x + w + 1.0, y + h + 1.0] }))
    };
    let side = |rects| Side { rects, edges: &grown };
    let Some(mut pairs) = boxes(&side(a), b.map(side).as_ref())? else { return Ok(None) };
    sorting::sort(&mut pairs, &mut Pulse::current())?;
    Ok(Some(Found::candidates(pairs)))
}

/// Colliding circles; circles that touch collide. None if only pygame can decide.
pub fn circles(a: &[Circle], b: Option<&[Circle]>) -> Result<Option<Found>> {
    let enlarged = |circles: &[Circle]| {
        let centers = circles.iter().map(|circle| circle.center).collect();
        Shapes::circles(centers, Each::Rows(circles.iter().map(enlarged_radius).collect()))
    };
    let too_large = |circle: &Circle| enlarged_radius(circle) > f64::RADII[1];
    if a.iter().chain(b.unwrap_or_default()).any(too_large) {
        return Ok(None);
    }
    let enlarged_b = b.map(enlarged).transpose()?;
    let mut near = candidates(&enlarged(a)?, enlarged_b.as_ref())?;
    let mut pulse = Pulse::current();
    sorting::sort(&mut near, &mut pulse)?;
    let mut tested = Vec::new();
    for pair in near {
        pulse.check(PAIR_WORK)?;
        let [i, j] = pair.map(|row| row as usize);
        match circles_collide(&a[i], &b.unwrap_or(a)[j]) {
            Some(false) => {}
            result => tested.push((pair, result.is_some())),
        }
    }
    let (pairs, sure): (Vec<_>, Vec<_>) = tested.into_iter().unzip();
    let uncertain = sure.contains(&false);
    Ok(Some(Found { pairs, sure: uncertain.then_some(sure) }))
}

/// The radius of a circle with a margin for rounding.
fn enlarged_radius(circle: &Circle) -> f64 {
    let margin = if circle.exact { MARGIN } else { INEXACT_MARGIN };
    circle.radius.abs() * (1.0 + margin) + 1e-3
}

/// Rectangles and the function that computes their edges: None if only pygame can compute them,
/// Some(None) for a rectangle that collides with nothing.
struct Side<'a> {
    rects: &'a [Rect],
    edges: &'a (dyn Fn(&Rect) -> Option<Option<Edges>> + Sync),
}

impl Side<'_> {
    /// Whether all edges are small integers; None if only pygame can compute them.
    fn are_small(&self) -> Option<bool> {
        let small = |side: f64| side.abs() <= SMALL && side == side.trunc();
        let mut all = true;
        for rect in self.rects {
            if let Some(Edges { min, max }) = (self.edges)(rect)? {
                all &= min.into_iter().chain(max).all(small);
            }
        }
        Some(all)
    }

    /// The rows of rectangles with area, and enlarged shapes for them.
    fn enlarged<T: Scalar>(&self, margin: f64) -> Result<(Vec<u32>, Shapes<T>)> {
        let len = self.rects.len();
        let mut rows = Vec::with_capacity(len);
        let mut centers = Vec::with_capacity(len);
        let mut half_sizes = Vec::with_capacity(len);
        for (row, rect) in self.rects.iter().enumerate() {
            let Some(Some(Edges { min, max })) = (self.edges)(rect) else { continue };
            let slack = |k: usize| margin * (min[k].abs() + max[k].abs() + f64::MIN_POSITIVE);
            rows.push(row as u32);
            centers.push([0, 1].map(|k| T::from_f64((min[k] + max[k]) / 2.0)));
            half_sizes.push([0, 1].map(|k| T::from_f64((max[k] - min[k]) / 2.0 + slack(k))));
        }
        let half_sizes = Some(Each::Rows(half_sizes));
        Ok((rows, Shapes::new(centers, Each::One(T::ZERO), half_sizes, None)?))
    }

    fn collides(&self, own: u32, other: &Self, row: u32) -> bool {
        let own = (self.edges)(&self.rects[own as usize]);
        let edges = (other.edges)(&other.rects[row as usize]);
        matches!((own, edges), (Some(Some(a)), Some(Some(b))) if a.overlap(&b))
    }
}

/// Pairs of rectangles that overlap, in any order; None if only pygame can decide.
fn boxes(a: &Side<'_>, b: Option<&Side<'_>>) -> Result<Option<Vec<[u32; 2]>>> {
    let Some(small_a) = a.are_small() else { return Ok(None) };
    let Some(small_b) = b.map_or(Some(true), Side::are_small) else { return Ok(None) };
    let found =
        if small_a && small_b { boxes_in::<f32>(a, b, 0.0) } else { boxes_in::<f64>(a, b, MARGIN) };
    Ok(Some(found?))
}

fn boxes_in<T: Scalar>(a: &Side<'_>, b: Option<&Side<'_>>, margin: f64) -> Result<Vec<[u32; 2]>> {
    let (rows, shapes) = a.enlarged::<T>(margin)?;
    let other = b.map(|b| b.enlarged::<T>(margin)).transpose()?;
    let mut found = candidates(&shapes, other.as_ref().map(|(_, shapes)| shapes))?;
    let other_rows = other.as_ref().map_or(&rows, |(rows, _)| rows);
    let mut pulse = Pulse::current();
    found.retain_mut(|pair| {
        if pulse.stops(PAIR_WORK) {
            return false;
        }
        *pair = [rows[pair[0] as usize], other_rows[pair[1] as usize]];
        a.collides(pair[0], b.unwrap_or(a), pair[1])
    });
    interrupt::check()?;
    Ok(found)
}

/// One thread: reading the sprites takes longer than the search, and waking another thread takes
/// too long for a frame.
const THREADS: Option<usize> = Some(1);

/// Pairs of shapes that overlap, i < j within one set, in any order.
fn candidates<T: Scalar>(a: &Shapes<T>, b: Option<&Shapes<T>>) -> Result<Vec<[u32; 2]>> {
    let Some(b) = b else {
        return Ok(pairs::find(a, None, THREADS, DEFAULT_MAX_PAIRS)?.pairs);
    };
    Ok(pairs::find_between(a, b, THREADS, DEFAULT_MAX_PAIRS)?.pairs)
}
