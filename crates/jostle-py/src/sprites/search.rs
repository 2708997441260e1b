//! Who meets whom. The core finds candidates from covers a hair too large; pygame's own
//! comparison, repeated here on exact numbers, has the last word.

use jostle::settings::DEFAULT_MAX_PAIRS;
use jostle::{Columns, Each, Quadtree, Result, Settings, Shapes, pairs};

use super::rules::{Circle, Edges, Kind, Rect, circles_meet};

/// Pairs of rows, sorted, and which of them are sure; None where all are.
pub struct Found {
    pub pairs: Vec<[u32; 2]>,
    pub sure: Option<Vec<bool>>,
}

/// By how much a cover is larger than what it stands for: far more than all the rounding
/// on the way, and too little to matter.
const HAIR: f64 = 1e-9;

/// How large an inexact radius may be beside its float64, as a part of it.
const INEXACT: f64 = 1e-3;

/// Comparisons by brute force that take as long as putting one shape into a tree.
const TESTS_FOR_A_SHAPE: usize = 64;

/// Rectangles, scaled by `ratio`. The left one's kind says how both are compared.
pub fn rects(a: &[Rect], b: Option<&[Rect]>, ratio: f64) -> Result<Option<Found>> {
    let scaled = |rects: &[Rect]| -> Option<Vec<Rect>> {
        rects
            .iter()
            .map(|rect| if ratio == 1.0 { Some(*rect) } else { rect.scaled(ratio) })
            .collect()
    };
    let Some(a) = scaled(a) else { return Ok(None) };
    let b = match b.map(scaled) {
        Some(None) => return Ok(None),
        Some(Some(b)) => Some(b),
        None => None,
    };
    let mut found = Vec::new();
    for kind in [Kind::Int, Kind::Float] {
        let some = a.iter().filter(|rect| rect.kind == kind).count();
        if some == 0 {
            continue;
        }
        let own = |rect: &Rect| if rect.kind == kind { rect.edges() } else { Some(None) };
        let taken = |rect: &Rect| rect.as_kind(kind)?.edges();
        let (lefts, rights): (Option<Vec<_>>, Option<Vec<_>>) = match &b {
            None if some == a.len() => (a.iter().map(own).collect(), Some(Vec::new())),
            other => {
                let b = other.as_ref().unwrap_or(&a);
                (a.iter().map(own).collect(), b.iter().map(taken).collect())
            }
        };
        let (Some(lefts), Some(rights)) = (lefts, rights) else { return Ok(None) };
        let itself = b.is_none() && some == a.len();
        let mut pairs = boxes(&lefts, (!itself).then_some(&rights))?;
        if b.is_none() {
            pairs.retain(|[i, j]| i < j);
        }
        found.append(&mut pairs);
    }
    found.sort_unstable();
    Ok(Some(Found { pairs: found, sure: None }))
}

/// Masks that are near enough to be asked: pygame cuts the distance of two off to whole
/// pixels, so they may be up to one apart.
pub fn masks(a: &[Rect], b: Option<&[Rect]>) -> Result<Option<Found>> {
    let grown = |rect: &Rect| {
        let [x, y, w, h] = rect.sides;
        Some(Edges { min: [x - 1.0, y - 1.0], max: [x + w + 1.0, y + h + 1.0] })
    };
    let all = |rects: &[Rect]| rects.iter().map(grown).collect::<Vec<_>>();
    let mut pairs = boxes(&all(a), b.map(all).as_ref())?;
    pairs.sort_unstable();
    let sure = vec![false; pairs.len()];
    Ok(Some(Found { pairs, sure: Some(sure) }))
}

/// Circles; touching is meeting.
pub fn circles(a: &[Circle], b: Option<&[Circle]>) -> Result<Option<Found>> {
    let covers = |circles: &[Circle]| {
        let centers = circles.iter().map(|circle| circle.center).collect();
        Shapes::circles(centers, Each::Rows(circles.iter().map(reach).collect()))
    };
    let b_covers = b.map(covers).transpose()?;
    let mut judged = Vec::new();
    for pair in candidates(&covers(a)?, b_covers.as_ref())? {
        let [i, j] = pair.map(|row| row as usize);
        match circles_meet(&a[i], &b.unwrap_or(a)[j]) {
            Some(false) => {}
            meet => judged.push((pair, meet.is_some())),
        }
    }
    judged.sort_unstable();
    let (pairs, sure): (Vec<_>, Vec<_>) = judged.into_iter().unzip();
    let doubts = sure.contains(&false);
    Ok(Some(Found { pairs, sure: doubts.then_some(sure) }))
}

/// How far a circle may reach, whatever rounding does.
fn reach(circle: &Circle) -> f64 {
    let slack = if circle.exact { HAIR } else { INEXACT };
    circle.radius.abs() * (1.0 + slack) + 1e-3
}

/// Pairs of boxes that overlap; None is no box.
fn boxes(a: &[Option<Edges>], b: Option<&Vec<Option<Edges>>>) -> Result<Vec<[u32; 2]>> {
    let (rows, covers) = cover(a)?;
    let other = b.map(|b| cover(b)).transpose()?;
    let mut found = candidates(&covers, other.as_ref().map(|(_, covers)| covers))?;
    let (b, other_rows) = match (b, &other) {
        (Some(b), Some((rows, _))) => (b.as_slice(), rows),
        _ => (a, &rows),
    };
    found.retain_mut(|pair| {
        *pair = [rows[pair[0] as usize], other_rows[pair[1] as usize]];
        match (&a[pair[0] as usize], &b[pair[1] as usize]) {
            (Some(a), Some(b)) => a.overlap(b),
            _ => false,
        }
    });
    Ok(found)
}

/// The rows that are boxes, and shapes that cover them.
fn cover(boxes: &[Option<Edges>]) -> Result<(Vec<u32>, Shapes<f64>)> {
    let mut rows = Vec::with_capacity(boxes.len());
    let mut centers = Vec::with_capacity(boxes.len());
    let mut half_sizes = Vec::with_capacity(boxes.len());
    for (row, edges) in boxes.iter().enumerate() {
        let Some(Edges { min, max }) = edges else { continue };
        let slack = |k: usize| HAIR * (min[k].abs() + max[k].abs()) + f64::MIN_POSITIVE;
        rows.push(row as u32);
        centers.push([0, 1].map(|k| (min[k] + max[k]) / 2.0));
        half_sizes.push([0, 1].map(|k| (max[k] - min[k]) / 2.0 + slack(k)));
    }
    Ok((rows, Shapes::new(centers, Each::One(0.0), Some(Each::Rows(half_sizes)), None)?))
}

/// Pairs of shapes that overlap, i < j within one set, in any order.
fn candidates(a: &Shapes<f64>, b: Option<&Shapes<f64>>) -> Result<Vec<[u32; 2]>> {
    let Some(b) = b else {
        return Ok(pairs::find(a, None, None, DEFAULT_MAX_PAIRS)?.pairs);
    };
    let few = a.len().saturating_mul(b.len()) <= TESTS_FOR_A_SHAPE * (a.len() + b.len());
    if few {
        let (a, b) = (Columns::of(a), Columns::of(b));
        return Ok(pairs::brute_between(&a, &b, [0.0; 2], DEFAULT_MAX_PAIRS)?.pairs);
    }
    let settings = Settings::default();
    let (a, b) = (Quadtree::new(a, settings)?, Quadtree::new(b, settings)?);
    Ok(pairs::between(&a, &b, DEFAULT_MAX_PAIRS)?.pairs)
}
