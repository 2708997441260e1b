//! `move_and_slide` against brute force: never inside, never through, and in any order.

use crate::common::SetShapes;
use jostle_base::Id;
use jostle_base::Settings;
use jostle_base::settings::DEFAULT_MAX_PAIRS;
use jostle_index::geometry::{Shape, contact, overlap};
use jostle_index::period::Period;
use jostle_index::{Each, Shapes};
use jostle_slide::SlideRules;
use jostle_space::Space;
use proptest::prelude::*;

/// Rules by which slopes of up to 0.8 radians are floors.
fn floors_face(up: [f64; 2]) -> SlideRules<f64> {
    SlideRules { up, floor_angle: 0.8, ..SlideRules::default() }
}

const WALL: u32 = 1;
const WALKER: u32 = 2;

/// Centre, half size and radius.
type Row = ([f64; 2], [f64; 2], f64);

#[derive(Clone, Debug)]
struct Scene {
    obstacles: Vec<Row>,
    walkers: Vec<Row>,
    displacements: Vec<[f64; 2]>,
    /// By how much the first obstacles are moved between calls.
    platforms: Vec<[f64; 2]>,
    up: [f64; 2],
}

fn scenes() -> impl Strategy<Value = Scene> {
    let coordinate = prop_oneof![3 => -20.0..20.0f64, 1 => (-20i32..20).prop_map(f64::from)];
    let half = prop_oneof![2 => 0.2..4.0f64, 1 => Just(1.0), 1 => Just(0.0)];
    let radius = prop_oneof![2 => 0.1..2.0f64, 1 => Just(0.5), 2 => Just(0.0)];
    let obstacle = ([coordinate.clone(), coordinate.clone()], [half.clone(), half], radius);
    let walker =
        prop_oneof![Just(([0.0; 2], 0.5)), Just(([0.4, 0.8], 0.0)), Just(([0.3, 0.2], 0.3)),];
    let walkers = ([coordinate.clone(), coordinate], walker)
        .prop_map(|(center, (half, radius))| (center, half, radius));
    let speed = prop_oneof![2 => -3.0..3.0f64, 1 => Just(0.0), 1 => -1e6..1e6f64];
    let up = prop_oneof![Just([0.0, -1.0]), Just([0.0, 0.0]), Just([3.0, 4.0])];
    let steps = prop::collection::vec([speed.clone(), speed], 12);
    let obstacles = prop::collection::vec(obstacle, 0..60);
    let moved = prop_oneof![1 => Just(0.0), 2 => -2.0..2.0f64];
    let platforms = prop::collection::vec([moved.clone(), moved], 0..20);
    (obstacles, prop::collection::vec(walkers, 1..12), steps, platforms, up).prop_map(
        |(obstacles, walkers, displacements, platforms, up)| Scene {
            obstacles,
            walkers,
            displacements,
            platforms,
            up,
        },
    )
}

fn periods() -> impl Strategy<Value = [f64; 2]> {
    prop_oneof![Just([41.0, 37.5]), Just([40.0, 0.0]), Just([0.0, 12.0]), Just([9.0, 9.0])]
}

fn shape(row: &Row) -> Shape<f64> {
    let &(center, half_size, radius) = row;
    Shape {
        min: center,
        max: center,
        half_size,
        radius,
        category: 1,
        mask: u32::MAX,
        core: jostle::Core::Box,
    }
}

fn overlaps(a: &Shape<f64>, b: &Shape<f64>) -> bool {
    let along = |k: usize| (b.min[k] - a.min[k]).abs() - (a.half_size[k] + b.half_size[k]);
    overlap([along(0), along(1)], a.radius + b.radius)
}

fn add(space: &mut Space<f64>, rows: &[Row], category: u32) -> Vec<Id> {
    let radii = Each::Rows(rows.iter().map(|row| row.2).collect());
    let halves = Each::Rows(rows.iter().map(|row| row.1).collect());
    let filters = Some([Each::One(category), Each::One(u32::MAX)]);
    let centers = rows.iter().map(|row| row.0).collect();
    space.add(&Shapes::new(centers, radii, Some(halves), filters).unwrap()).unwrap()
}

fn add_segments(space: &mut Space<f64>, ends: &[[[f64; 2]; 2]]) -> Vec<Id> {
    let filters = Some([Each::One(WALL), Each::One(u32::MAX)]);
    space.add(&Shapes::from_segments(ends, Each::One(0.0), filters).unwrap()).unwrap()
}

impl Scene {
    /// The obstacles, and the walkers that overlap nothing.
    fn space(&self) -> (Space<f64>, Vec<Id>, Vec<[f64; 2]>) {
        let mut space = Space::new(Settings::default()).unwrap();
        add(&mut space, &self.obstacles, WALL);
        let mut free: Vec<Row> = Vec::new();
        for walker in &self.walkers {
            let all = self.obstacles.iter().chain(&free);
            if !all.into_iter().any(|row| overlaps(&shape(walker), &shape(row))) {
                free.push(*walker);
            }
        }
        let ids = add(&mut space, &free, WALKER);
        let displacements = self.displacements[..ids.len()].to_vec();
        (space, ids, displacements)
    }

    /// The scene in a periodic plane, with the walkers that overlap nothing there; displacements are
    /// shorter than the period.
    fn periodic(&self, sides: [f64; 2]) -> (Space<f64>, Vec<Id>, Vec<[f64; 2]>) {
        let period = Period::new(sides).unwrap();
        let mut space = Space::with_period(Settings::default(), period).unwrap();
        add(&mut space, &self.obstacles, WALL);
        let mut free: Vec<Row> = Vec::new();
        let home = |row: &Row| period.wrap_shape(shape(row));
        for walker in &self.walkers {
            let mut all = self.obstacles.iter().chain(&free);
            if !all.any(|row| period.overlap(&home(walker), &home(row))) {
                free.push(*walker);
            }
        }
        let ids = add(&mut space, &free, WALKER);
        let short =
            |v: [f64; 2]| [0, 1].map(|k| if sides[k] > 0.0 { v[k] % sides[k] } else { v[k] });
        let displacements = self.displacements[..ids.len()].iter().map(|&v| short(v)).collect();
        (space, ids, displacements)
    }

    fn rules(&self, mask: u32, max_slides: usize) -> SlideRules<f64> {
        SlideRules { mask, max_slides, ..floors_face(self.up) }
    }
}

/// Moves the first obstacles as far as they are told to: platforms.
fn move_platforms(scene: &Scene, space: &mut Space<f64>, period: &Period<f64>) -> Vec<Id> {
    let platforms: Vec<Id> = (0..scene.obstacles.len().min(scene.platforms.len()) as Id).collect();
    let mut places = centers(space, &platforms);
    for (place, by) in places.iter_mut().zip(&scene.platforms) {
        *place = period.wrap([place[0] + by[0], place[1] + by[1]]);
    }
    space.move_to(&platforms, &places).unwrap();
    platforms
}

/// In each of four calls, walkers come to overlap nothing that they did not overlap before. Only a
/// platform that has moved by itself may carry or push a walker to where something else stops it.
fn assert_stays_free(
    scene: &Scene,
    mut space: Space<f64>,
    ids: &[Id],
    displacements: &[[f64; 2]],
    period: &Period<f64>,
) -> Result<(), TestCaseError> {
    let mut floors = vec![-1; ids.len()];
    for round in 0..4 {
        let moved = if round == 0 { vec![] } else { move_platforms(scene, &mut space, period) };
        let before = space.pairs(None, DEFAULT_MAX_PAIRS).unwrap();
        let slides = space.move_and_slide(ids, displacements, &scene.rules(u32::MAX, 4)).unwrap();
        for pair in space.pairs(None, DEFAULT_MAX_PAIRS).unwrap() {
            let is_pressed = (0..ids.len()).any(|k| {
                let other = if pair[0] == ids[k] { pair[1] } else { pair[0] };
                let hits = &slides.ids[slides.offsets[k]..slides.offsets[k + 1]];
                pair.contains(&ids[k])
                    && moved.contains(&other)
                    && (floors[k] == other || hits.iter().any(|hit| *hit != other))
            });
            let is_of_walker = pair.iter().any(|id| ids.contains(id));
            prop_assert!(!is_of_walker || before.contains(&pair) || is_pressed, "{pair:?} {round}");
        }
        floors = slides.floor;
    }
    Ok(())
}

fn centers(space: &Space<f64>, ids: &[Id]) -> Vec<[f64; 2]> {
    space.read(ids, |shape| shape.center()).unwrap()
}

/// Moves walkers in a pile, and checks after each call that none overlap.
fn check_pile(
    steps: &[Vec<[f64; 2]>],
    kinds: &[usize],
    is_periodic: bool,
) -> Result<(), TestCaseError> {
    let sides = if is_periodic { [4.0, 0.0] } else { [0.0; 2] };
    let period = Period::new(sides).unwrap();
    let mut space = Space::with_period(Settings::default(), period).unwrap();
    add(&mut space, &[([0.0, 9.5], [20.0, 0.5], 0.0)], WALL);
    if !is_periodic {
        let sides = [([-2.5, 0.0], [0.5, 30.0], 0.0), ([2.5, 0.0], [0.5, 30.0], 0.0)];
        add(&mut space, &sides, WALL);
    }
    let kinds = kinds.iter().map(|&k| [([0.0; 2], 0.8), ([0.7, 0.5], 0.0), ([0.3, 0.4], 0.3)][k]);
    let rows: Vec<Row> = kinds
        .enumerate()
        .map(|(k, (half, radius))| ([[-1.0, 1.0][k % 2], 8.0 - 1.7 * (k / 2) as f64], half, radius))
        .collect();
    let ids = add(&mut space, &rows, WALKER);
    let rules = floors_face([0.0, -1.0]);
    for step in steps {
        space.move_and_slide(&ids, step, &rules).unwrap();
        let pairs = space.pairs(None, DEFAULT_MAX_PAIRS).unwrap();
        prop_assert!(pairs.iter().all(|pair| !ids.contains(&pair[1])), "{pairs:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::common::cases(100))]

    #[test]
    fn a_walker_is_never_inside(scene in scenes()) {
        let (space, ids, displacements) = scene.space();
        assert_stays_free(&scene, space, &ids, &displacements, &Period::default())?;
    }

    /// With one slide the path is straight: it crosses no obstacle.
    #[test]
    fn a_walker_is_never_moved_through(scene in scenes()) {
        let (mut space, ids, displacements) = scene.space();
        let before = centers(&space, &ids);
        space.move_and_slide(&ids, &displacements, &scene.rules(WALL, 1)).unwrap();
        let after = centers(&space, &ids);
        let sizes = space.read(&ids, |shape| (shape.half_size, shape.radius)).unwrap();
        for ((from, to), (half, radius)) in before.iter().zip(&after).zip(sizes) {
            let size = from.iter().chain(to).fold(1.0f64, |most, v| most.max(v.abs()));
            for sample in 0..=500 {
                let share = f64::from(sample) / 500.0;
                let at = [0, 1].map(|k| from[k] + (to[k] - from[k]) * share);
                let body = shape(&(at, half, radius));
                for row in &scene.obstacles {
                    if overlaps(&body, &shape(row)) {
                        let (_, depth) = contact(&body, &shape(row));
                        prop_assert!(depth < 1e-12 * size, "{:?} {}", row, depth);
                    }
                }
            }
        }
    }

    /// A straight path from where it was by the displacement crosses no image of an obstacle, and
    /// ends where the walker is.
    #[test]
    fn a_walker_is_never_moved_through_an_image(scene in scenes(), sides in periods()) {
        let period = Period::new(sides).unwrap();
        let (mut space, ids, displacements) = scene.periodic(sides);
        let before = centers(&space, &ids);
        let slides = space.move_and_slide(&ids, &displacements, &scene.rules(WALL, 1)).unwrap();
        let after = centers(&space, &ids);
        let sizes = space.read(&ids, |shape| (shape.half_size, shape.radius)).unwrap();
        let home: Vec<_> = scene.obstacles.iter().map(|row| period.wrap_shape(shape(row))).collect();
        for (k, (half, radius)) in sizes.into_iter().enumerate() {
            let (from, moved) = (before[k], slides.displacement[k]);
            let size = from.iter().chain(&moved).fold(40.0f64, |most, v| most.max(v.abs()));
            let end = period.minimum_image([0, 1].map(|axis| from[axis] + moved[axis] - after[k][axis]));
            prop_assert!(end[0].abs().max(end[1].abs()) < 1e-13 * size, "{:?}", end);
            let is_whole =
                (0..2).all(|axis| (moved[axis] - displacements[k][axis]).abs() < 1e-13 * size);
            prop_assert!(is_whole || !slides.ids.is_empty());
            for sample in 0..=200 {
                let share = f64::from(sample) / 200.0;
                let at = period.wrap([0, 1].map(|axis| from[axis] + moved[axis] * share));
                let body = shape(&(at, half, radius));
                for obstacle in &home {
                    if period.overlap(&body, obstacle) {
                        let [a, b] = period.nearest_images(&body, obstacle);
                        let (_, depth) = contact(&a, &b);
                        prop_assert!(depth < 1e-12 * size, "{:?} {}", obstacle, depth);
                    }
                }
            }
        }
    }

    /// The same scene moved by any displacement has the same motions.
    #[test]
    fn the_edges_of_a_periodic_plane_are_nowhere(
        scene in scenes(), sides in periods(), shift in [-30i32..30, -30i32..30]
    ) {
        let shift = shift.map(f64::from);
        let mut moved = scene.clone();
        for row in moved.obstacles.iter_mut().chain(&mut moved.walkers) {
            row.0 = [row.0[0] + shift[0], row.0[1] + shift[1]];
        }
        let (mut one, ids, displacements) = scene.periodic(sides);
        let (mut other, others, _) = moved.periodic(sides);
        prop_assume!(ids == others);
        let rules = scene.rules(u32::MAX, 1);
        let slides = one.move_and_slide(&ids, &displacements, &rules).unwrap();
        let again = other.move_and_slide(&ids, &displacements, &rules).unwrap();
        for (a, b) in slides.displacement.iter().zip(&again.displacement) {
            let error = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            // Impacts at a grazing angle multiply rounding errors.
            prop_assert!(error < 1e-4, "{:?} {:?}", a, b);
        }
    }

    /// Walkers that fall onto each other in a narrow pit stand on each other, and overlap nothing.
    #[test]
    fn walkers_in_a_pile_never_overlap(
        steps in prop::collection::vec(prop::collection::vec([-0.6..0.6f64, -0.8..0.6f64], 12), 25),
        kinds in prop::collection::vec(0usize..3, 12),
    ) {
        check_pile(&steps, &kinds, false)?;
    }

    #[test]
    fn walkers_in_a_periodic_pile_never_overlap(
        steps in prop::collection::vec(prop::collection::vec([-0.6..0.6f64, -0.8..0.6f64], 12), 25),
        kinds in prop::collection::vec(0usize..3, 12),
    ) {
        check_pile(&steps, &kinds, true)?;
    }

    /// A box that was moved pushes another one, which is at rest, by the rest of its motion along the
    /// axis on which they meet; a one-way box only one that is above it as the motion begins.
    #[test]
    fn a_box_that_was_moved_pushes_what_is_in_its_way(
        away in [-30.0..30.0f64, -30.0..30.0f64],
        motion in [-50.0..50.0f64, -50.0..50.0f64],
        is_along in 0usize..4,
        one_way in prop_oneof![Just(0), Just(WALL)],
        calls in 1usize..3,
    ) {
        let motion = [0, 1].map(|axis| if is_along == axis { 0.0 } else { motion[axis] });
        let reach = [6.0, 9.0];
        prop_assume!((0..2).any(|axis| away[axis].abs() > reach[axis]));
        let mut space = Space::new(Settings::default()).unwrap();
        let lift = add(&mut space, &[([0.0; 2], [5.0, 1.0], 0.0)], WALL);
        let walker = add(&mut space, &[(away, [1.0, 8.0], 0.0)], WALKER);
        let rules = SlideRules { one_way, ..floors_face([0.0, -1.0]) };
        space.move_and_slide(&walker, &[[0.0; 2]], &rules).unwrap();
        for k in 1..=calls {
            let share = k as f64 / calls as f64;
            space.move_to(&lift, &[motion.map(|v| v * share)]).unwrap();
        }
        let slides = space.move_and_slide(&walker, &[[0.0; 2]], &rules).unwrap();
        // The share of the motion after which the gap along each axis is closed, and opens again.
        let (mut enter, mut leave, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, 0);
        for k in 0..2 {
            let ends = [-reach[k], reach[k]].map(|side| (away[k] + side) / motion[k]);
            let is_inside = away[k].abs() < reach[k];
            let [first, last] = match (motion[k] == 0.0, is_inside) {
                (true, true) => [f64::NEG_INFINITY, f64::INFINITY],
                (true, false) => [f64::INFINITY; 2],
                _ => [ends[0].min(ends[1]), ends[0].max(ends[1])],
            };
            if first > enter {
                (enter, axis) = (first, k);
            }
            leave = leave.min(last);
        }
        let is_met = enter < leave && (0.0..1.0).contains(&enter)
            && (one_way == 0 || away[1] < -reach[1]);
        let mut expected = [0.0; 2];
        if is_met {
            expected[axis] = motion[axis] * (1.0 - enter);
        }
        let found = slides.displacement[0];
        prop_assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{found:?} {expected:?}");
        prop_assert_eq!(slides.ids.len(), usize::from(is_met));
        prop_assert_eq!(slides.on_floor[0], is_met && axis == 1 && motion[1] < 0.0);
    }

    #[test]
    fn the_order_of_walkers_that_do_not_meet_changes_nothing(scene in scenes(), turn in 0usize..12) {
        let (space, ids, displacements) = scene.space();
        for mask in [WALL, u32::MAX] {
            let rules = scene.rules(mask, 4);
            let (mut one, mut other) = (space.clone(), space.clone());
            let slides = one.move_and_slide(&ids, &displacements, &rules).unwrap();
            let start = turn % ids.len().max(1);
            let turned = |k: usize| (k + start) % ids.len();
            let (mut names, mut steps) = (Vec::new(), Vec::new());
            for k in (0..ids.len()).rev().map(turned) {
                names.push(ids[k]);
                steps.push(displacements[k]);
            }
            let again = other.move_and_slide(&names, &steps, &rules).unwrap();
            // Those that met another one depend on the order.
            let mut all = slides.ids.iter().chain(&again.ids);
            if mask == u32::MAX && all.any(|id| ids.contains(id)) {
                continue;
            }
            prop_assert_eq!(centers(&one, &ids), centers(&other, &ids));
        }
    }
}

proptest! {
    // A case takes 50 ms.
    #![proptest_config(crate::common::cases(24))]

    #[test]
    fn a_walker_is_never_inside_in_a_periodic_plane(scene in scenes(), sides in periods()) {
        let (space, ids, displacements) = scene.periodic(sides);
        let period = Period::new(sides).unwrap();
        assert_stays_free(&scene, space, &ids, &displacements, &period)?;
    }
}

/// A floor, a ceiling or a wall of many segments at every angle stops what falls onto it.
#[test]
fn segments_at_every_angle_stop_every_shape() {
    for k in 0..72 {
        let angle = f64::from(k) * std::f64::consts::PI / 36.0;
        let (sin, cos) = angle.sin_cos();
        for row in
            [([0.0; 2], [0.0; 2], 1.0), ([0.0; 2], [0.7, 0.3], 0.0), ([0.0; 2], [0.2, 0.5], 0.3)]
        {
            let mut space = Space::new(Settings::default()).unwrap();
            let at = |along: f64, away: f64| [away * cos - along * sin, away * sin + along * cos];
            let ends: Vec<_> = (-9..9)
                .map(|k| [at(f64::from(k) * 3.0, 5.0), at(f64::from(k + 1) * 3.0, 5.0)])
                .collect();
            let walls = add_segments(&mut space, &ends);
            let ids = add(&mut space, &[row], WALKER);
            let rules = SlideRules { max_slides: 8, ..floors_face([-cos, -sin]) };
            let step = at(3.0, 1e4);
            let slides = space.move_and_slide(&ids, &[step], &rules).unwrap();
            let [x, y] = centers(&space, &ids)[0];
            let reach = row.1[0] * cos.abs() + row.1[1] * sin.abs() + row.2;
            let away = x * cos + y * sin;
            assert!((away - (5.0 - reach)).abs() < 1e-8, "{k} {away} {reach}");
            assert!(
                slides.on_floor[0] && walls.contains(&slides.floor[0]) && !slides.on_wall[0],
                "{k} {row:?} {slides:?}"
            );
        }
    }
}

/// A wall across the edge of a periodic plane stops what comes from the other side.
#[test]
fn segments_have_images() {
    let period = Period::new([20.0, 0.0]).unwrap();
    let mut space = Space::with_period(Settings::default(), period).unwrap();
    add_segments(&mut space, &[[[18.0, 0.0], [24.0, 6.0]], [[103.0, -9.0], [103.0, 9.0]]]);
    let ids =
        add(&mut space, &[([1.0, 9.0], [0.0; 2], 0.5), ([19.0, -5.0], [0.0; 2], 0.5)], WALKER);
    let rules = SlideRules { max_slides: 1, ..floors_face([0.0; 2]) };
    space.move_and_slide(&ids, &[[0.0, -50.0], [12.0, 0.0]], &rules).unwrap();
    let found = centers(&space, &ids);
    let expected = [[1.0, 3.0 + 0.5 * 2f64.sqrt()], [2.5, -5.0]];
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{found:?}");
    }
    let long = Shapes::from_segments(&[[[0.0, 0.0], [20.5, 0.0]]], Each::One(0.0), None).unwrap();
    let error = space.add(&long).unwrap_err().to_string();
    assert!(error.contains("segments[0]") && error.contains("period apart"), "{error}");
}

/// A platform that crosses the edge carries what stands on it, by the minimum image.
#[test]
fn a_platform_carries_across_the_edge() {
    let period = Period::new([20.0, 0.0]).unwrap();
    let mut space = Space::with_period(Settings::default(), period).unwrap();
    let floor = add(&mut space, &[([19.0, 0.0], [3.0, 0.5], 0.0)], WALL);
    let rider = add(&mut space, &[([1.0, -2.0], [0.5, 1.0], 0.0)], WALKER);
    let rules = floors_face([0.0, -1.0]);
    let slides = space.move_and_slide(&rider, &[[0.0, 2.0]], &rules).unwrap();
    assert_eq!(slides.floor, floor);
    space.move_to(&floor, &[[21.0, 0.0]]).unwrap();
    let slides = space.move_and_slide(&rider, &[[0.0, 0.5]], &rules).unwrap();
    assert!((slides.displacement[0][0] - 2.0).abs() < 1e-12, "{slides:?}");
    assert!((centers(&space, &rider)[0][0] - 3.0).abs() < 1e-12);
    let error = space.move_and_slide(&rider, &[[20.5, 0.0]], &rules).unwrap_err().to_string();
    assert!(error.contains("displacements[0]") && error.contains("the period"), "{error}");
    let wide = add(&mut space, &[([0.0, 50.0], [10.5, 1.0], 0.0)], WALKER);
    let error = space.move_and_slide(&wide, &[[1.0, 0.0]], &rules).unwrap_err().to_string();
    assert!(error.contains("wider than the period, which is 20 along x"), "{error}");
}
