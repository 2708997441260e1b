//! Times of impact against an oracle that follows the distance in small steps.

use super::*;
use crate::trajectory::{Limits, Piece};

const LIMITS: Limits = Limits {
    until: 1.0,
    end: 1.0,
    rounding: 1e-9,
    tolerance: 1e-9,
    touching_tolerance: 1e-9,
    deep: f64::INFINITY,
    deep_tolerance: 1e-9,
    bounces: f64::INFINITY,
};

fn walls(all: &[[[f32; 2]; 2]]) -> Walls {
    let all = all.iter().copied().map(Wall::new).collect();
    Walls::new(all, Container::None, Settings::default()).expect("valid")
}

/// The first time at which the distance to a wall is at most the radius; None if there is none
/// before 1.
fn oracle(walls: &Walls, piece: &Piece, radius: f64, gravity: Vector) -> Option<f64> {
    let gap = |time: f64| {
        let at = piece.position_at(time, gravity);
        walls.lines.iter().map(|line| line.distance(at)).fold(f64::MAX, f64::min) - radius
    };
    let steps = 20_000;
    let first = (1..=steps).find(|&k| gap(f64::from(k) / f64::from(steps)) <= 0.0)?;
    let [mut low, mut high] = [first - 1, first].map(|k| f64::from(k) / f64::from(steps));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if gap(middle) <= 0.0 { high = middle } else { low = middle }
    }
    Some(high)
}

#[test]
fn times_of_impact_are_those_of_the_oracle() {
    let mut state = 7u64;
    let mut coordinate = || {
        // A linear congruential generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f32 / (1u32 << 24) as f32 * 6.0 - 3.0
    };
    let mut hits = 0;
    for case in 0..300 {
        let mut point = || [coordinate(), coordinate()];
        let corners = [point(), point(), point(), point()];
        let walls =
            walls(&[[corners[0], corners[1]], [corners[1], corners[2]], [corners[2], corners[3]]]);
        let (position, velocity) = (point().map(f64::from), point().map(|v| 3.0 * f64::from(v)));
        let falls = case % 2 == 0;
        let gravity = if falls { [1.0, -9.0] } else { [0.0; 2] };
        let piece = Piece { position, velocity, falls, ..Piece::default() };
        let radius = 0.3;
        if walls.lines.iter().any(|line| line.distance(position) < radius + 1e-3) {
            continue;
        }
        let found =
            (0..3).filter_map(|k| walls.impact(number_of(k), &piece, radius, gravity, &LIMITS));
        let found = found.map(|impact| impact.time).min_by(f64::total_cmp);
        let expected = oracle(&walls, &piece, radius, gravity);
        hits += usize::from(expected.is_some());
        match (found, expected) {
            (Some(a), Some(b)) => assert!((a - b).abs() < 1e-9, "case {case}: {a} {b}"),
            // A wall that is only grazed.
            (None, Some(b)) => {
                let [at, _] = piece.at(b + 5e-5, gravity);
                let depth = walls.lines.iter().map(|line| radius - line.distance(at));
                assert!(depth.fold(f64::MIN, f64::max) < 1e-5, "case {case}: {b}");
            }
            (Some(a), None) => {
                let [at, _] = piece.at(a, gravity);
                let gap = walls.lines.iter().map(|line| line.distance(at) - radius);
                assert!(gap.fold(f64::MAX, f64::min).abs() < 1e-9, "case {case}: {a}");
            }
            (None, None) => {}
        }
    }
    assert!(hits > 50, "{hits}");
}

#[test]
fn one_part_acts_at_each_joint() {
    let walls =
        walls(&[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [2.0, 3.0]]]);
    let acting = |point: Vector| {
        let contacts = (0..3).filter_map(|k| walls.acting_contact(number_of(k), point, 0.5));
        let touching = contacts.filter(|of| of.gap <= 0.0);
        touching.map(|of| (of.wall - FIRST, of.is_end)).collect::<Vec<_>>()
    };
    assert_eq!(acting([0.5, 0.4]), [(0, false)]);
    assert_eq!(acting([1.0, 0.4]), [(0, false), (1, false)]);
    assert_eq!(acting([-0.1, 0.4]), [(0, true)]);
    assert_eq!(acting([1.5, 0.4]), [(1, false), (2, false)]);
    // The outer side of the corner: its end belongs to the first of the two walls.
    assert_eq!(acting([2.3, -0.3]), [(1, true)]);
    assert_eq!(acting([2.3, 3.3]), [(2, true)]);
}
