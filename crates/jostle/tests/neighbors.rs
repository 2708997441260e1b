//! Forces between neighbours: kinds of particles, and flocking. Each against an answer that does not
//! come from the search: sums over all pairs in float64, theory, conservation laws.

use std::sync::Arc;

use jostle_base::Method;
use jostle_base::error::Result;
use jostle_index::Each;
use jostle_scenes::random::Random;
use jostle_simd::{self as simd, Instructions};
use jostle_world::forces::{self, Flocking, ForceInput, Influences, PairForce, PairTable};
use jostle_world::{Changes, Container, Influence, OnTouch, Particles, World, WorldSettings};
use proptest::prelude::*;

use crate::common::worlds::{still, world_of};

const TORUS: Container = Container::Torus { size: [100.0, 80.0] };

/// Bodies with everything that forces between neighbours depend on.
#[derive(Clone, Debug)]
struct State {
    positions: Vec<[f32; 2]>,
    velocities: Vec<[f32; 2]>,
    masses: Vec<f32>,
    kinds: Vec<u8>,
}

impl State {
    fn random(count: usize, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let r = &mut random;
        Self {
            positions: (0..count).map(|_| [r.between(0.0, 100.0), r.between(0.0, 80.0)]).collect(),
            velocities: (0..count).map(|_| r.in_disc().map(|v| 3.0 * v)).collect(),
            masses: (0..count).map(|_| r.between(0.5, 4.0)).collect(),
            kinds: (0..count).map(|_| r.whole(0, 2) as u8).collect(),
        }
    }

    /// The accelerations by a force.
    fn feel(
        &self,
        force: &Influence,
        container: Container,
        method: Method,
        threads: usize,
    ) -> Vec<[f32; 2]> {
        let len = self.positions.len();
        let rows: Vec<u32> = (0..len as u32).collect();
        let bodies = ForceInput {
            positions: &self.positions,
            velocities: &self.velocities,
            masses: &self.masses,
            radii: &vec![0.1; len],
            kinds: &self.kinds,
            movable: &[],
            rows: &rows,
            own_rows: u32::MAX,
            indices: &[],
            container,
            seconds: 0.01,
            method,
            threads: Some(threads),
            extent: None,
        };
        let mut found = Vec::new();
        let influences = Influences::from(vec![force.clone()]);
        influences.accelerate(&bodies, &mut forces::Scratch::default(), &mut found).unwrap();
        found
    }

    fn gathered(&self, order: &[usize]) -> Self {
        Self {
            positions: order.iter().map(|&k| self.positions[k]).collect(),
            velocities: order.iter().map(|&k| self.velocities[k]).collect(),
            masses: order.iter().map(|&k| self.masses[k]).collect(),
            kinds: order.iter().map(|&k| self.kinds[k]).collect(),
        }
    }
}

/// A table without symmetry for three kinds.
fn any_table(cutoff: f32, damping: f32) -> Influence {
    let mut random = Random::new(5);
    let values = (0..9 * 17).map(|_| random.between(-20.0, 20.0)).collect();
    pair(PairTable::new(3, values, cutoff, damping).unwrap())
}

fn pair(table: PairTable) -> Influence {
    Influence::Pair(PairForce { table: Arc::new(table) })
}

fn flocking(cutoff: f32) -> Influence {
    Influence::Flocking(Flocking {
        cutoff,
        separation: 20.0,
        alignment: 2.0,
        cohesion: 0.7,
        max_speed: f32::INFINITY,
        min_speed: 0.0,
    })
}

fn bits(all: &[[f32; 2]]) -> Vec<[u32; 2]> {
    all.iter().map(|pair| pair.map(f32::to_bits)).collect()
}

/// The sum over all others in float64, from the definitions.
fn oracle(state: &State, force: &Influence, container: Container) -> Vec<[f64; 2]> {
    let own = |i: usize| {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for j in (0..state.positions.len()).filter(|&j| j != i) {
            let offset =
                [0, 1].map(|k| f64::from(state.positions[j][k]) - f64::from(state.positions[i][k]));
            let [x, y] = container.period().exact().minimum_image(offset);
            let [u, v] = [0, 1]
                .map(|k| f64::from(state.velocities[j][k]) - f64::from(state.velocities[i][k]));
            let distance = (x * x + y * y).sqrt();
            let by = match force {
                Influence::Pair(PairForce { table }) => {
                    let cutoff = f64::from(table.cutoff());
                    if distance >= cutoff || distance == 0.0 {
                        continue;
                    }
                    let line = (usize::from(state.kinds[i]) * table.kinds()
                        + usize::from(state.kinds[j]))
                        * table.points();
                    let along = distance / cutoff * (table.points() - 1) as f64;
                    let at = (along as usize).min(table.points() - 2);
                    let [low, high] = [0, 1].map(|k| f64::from(table.values()[line + at + k]));
                    let mut repulsion = low + (high - low) * (along - at as f64);
                    let weight = (1.0 - distance / cutoff).powi(2);
                    let lengthening = (u * x + v * y) / distance;
                    repulsion -= f64::from(table.damping()) * weight * lengthening;
                    let mass = f64::from(state.masses[i]);
                    [x, y].map(|k| -repulsion * k / distance / mass)
                }
                Influence::Flocking(flock) => {
                    let [cutoff, separation, alignment, cohesion] =
                        [flock.cutoff, flock.separation, flock.alignment, flock.cohesion]
                            .map(f64::from);
                    if distance >= cutoff {
                        continue;
                    }
                    let away = separation * (1.0 - distance / cutoff) / distance.max(1e-12);
                    [(x, u), (y, v)].map(|(x, u)| alignment * u + cohesion * x - away * x)
                }
                _ => unreachable!("only forces between neighbours"),
            };
            count += 1.0;
            sum = [sum[0] + by[0], sum[1] + by[1]];
        }
        if matches!(force, Influence::Flocking(_)) {
            sum.map(|v| v / f64::max(count, 1.0))
        } else {
            sum
        }
    };
    (0..state.positions.len()).map(own).collect()
}

#[test]
fn a_fast_flock_aligns_by_the_differences_of_velocities() {
    let mut state = State::random(700, 1);
    state.velocities.iter_mut().for_each(|[u, _]| *u += 1e5);
    let force = flocking(20.0);
    let found = state.feel(&force, Container::None, Method::Quadtree, 2);
    for (found, expected) in found.iter().zip(oracle(&state, &force, Container::None)) {
        for k in 0..2 {
            let error = (f64::from(found[k]) - expected[k]).abs();
            assert!(error < 1e-5 * expected[k].abs().max(10.0), "{found:?} {expected:?}");
        }
    }
}

#[test]
fn sums_are_those_over_all_pairs() {
    let state = State::random(700, 1);
    for force in [any_table(9.0, 0.0), any_table(9.0, 3.0), any_table(40.0, 0.5), flocking(8.0)] {
        for container in [Container::None, TORUS] {
            let found = state.feel(&force, container, Method::Quadtree, 2);
            let expected = oracle(&state, &force, container);
            let size = expected.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
            for (row, (found, expected)) in found.iter().zip(&expected).enumerate() {
                for k in 0..2 {
                    let error = (f64::from(found[k]) - expected[k]).abs();
                    assert!(error < 2e-5 * size, "{force:?} {row}: {found:?} {expected:?}");
                }
            }
        }
    }
}

fn hard_positions() -> impl Strategy<Value = Vec<[f32; 2]>> {
    let coordinate = prop_oneof![
        4 => 0f32..80.0,
        2 => (0u8..9).prop_map(|k| f32::from(k) * 9.0),
        1 => Just(0.0f32),
        1 => 0f32..1e-6,
        1 => 79.999f32..80.0,
    ];
    let point = (coordinate.clone(), coordinate).prop_map(|(x, y)| [x, y]);
    prop_oneof![
        8 => prop::collection::vec(point.clone(), 0..120),
        1 => (point.clone(), 1usize..90).prop_map(|(point, count)| vec![point; count]),
        1 => prop::collection::vec((0f32..80.0).prop_map(|x| [x, 40.0]), 1..90),
        1 => prop::collection::vec((-1e15f32..1e15, -1e-15f32..1e-15).prop_map(|(x, y)| [x, y]), 1..60),
    ]
}

proptest! {
    #[test]
    fn nothing_shows_how_neighbors_are_found(
        positions in hard_positions(),
        seed in 0u64..1000,
        cutoff in prop_oneof![Just(9.0f32), Just(40.0), 1e-3f32..40.0],
        is_flock in any::<bool>(),
        damping in prop_oneof![Just(0.0f32), Just(2.0)],
    ) {
        let len = positions.len();
        let state = State { positions, ..State::random(len, seed) };
        let force = if is_flock { flocking(cutoff) } else { any_table(cutoff, damping) };
        let is_on_torus = state.positions.iter().flatten().all(|&v| (0.0..80.0).contains(&v));
        let containers = if is_on_torus { vec![Container::None, TORUS] } else { vec![Container::None] };
        for container in containers {
            let expected = bits(&state.feel(&force, container, Method::Quadtree, 1));
            prop_assert_eq!(&bits(&state.feel(&force, container, Method::Brute, 1)), &expected);
            prop_assert_eq!(&bits(&state.feel(&force, container, Method::Quadtree, 3)), &expected);
            let mut order: Vec<usize> = (0..len).collect();
            order.sort_by_key(|&k| (k as u64 + seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20);
            let other = state.gathered(&order).feel(&force, container, Method::Quadtree, 2);
            for (&row, found) in order.iter().zip(bits(&other)) {
                prop_assert_eq!(found, expected[row]);
            }
            for narrower in [Instructions::Portable, Instructions::Avx2] {
                simd::limit(narrower);
                let found = bits(&state.feel(&force, container, Method::Quadtree, 1));
                simd::limit(Instructions::Avx512);
                prop_assert_eq!(&found, &expected, "{:?}", narrower);
            }
        }
    }
}

// ---- worlds --------------------------------------------------------------------------------------

fn lennard_jones() -> Influence {
    pair(PairTable::lennard_jones(1, &[1.0], &[1.0], 2.5).unwrap())
}

/// A world of particles of mass 1 that pass through each other.
fn world(positions: Vec<[f32; 2]>, velocities: Vec<[f32; 2]>, container: Container) -> World {
    let len = positions.len();
    let mut particles = Particles::new(positions, velocities, vec![0.1; len], 1.0);
    particles.masses = vec![1.0; len];
    let settings = WorldSettings { container, on_touch: OnTouch::Ignore, ..Default::default() };
    world_of(particles, settings)
}

/// A warm Lennard-Jones fluid on a torus.
fn fluid(side: usize) -> World {
    let mut random = Random::new(2);
    let site = |k: usize| [k % side, k / side].map(|v| 0.6 + 1.2 * v as f32);
    let count = side * side;
    let velocities = (0..count).map(|_| random.in_disc().map(|v| 2.0 * v)).collect();
    let size = [1.2 * side as f32; 2];
    let mut world = world((0..count).map(site).collect(), velocities, Container::Torus { size });
    world.set_forces(vec![lennard_jones()]).unwrap();
    world
}

#[test]
fn a_lennard_jones_fluid_conserves_energy_and_momentum() {
    let mut world = fluid(10);
    assert_eq!(world.substeps(), 1);
    let energy = |world: &World| world.kinetic_energy() + world.potential_energy().unwrap();
    let (start, momentum) = (energy(&world), world.momentum());
    let kinetic = world.kinetic_energy();
    assert!(start.abs() > 0.5 * kinetic, "the energy {start} is too small for a relative error");
    for _ in 0..100 {
        world.step(0.002, 100).unwrap();
        let share = (energy(&world) - start).abs() / kinetic;
        assert!(share < 0.001, "{share} at {}", world.time());
    }
    assert!((world.kinetic_energy() / kinetic - 1.0).abs() > 0.01, "nothing has happened");
    for (now, before) in world.momentum().into_iter().zip(momentum) {
        assert!((now - before).abs() < 1e-3);
    }
}

#[test]
fn two_particles_oscillate_with_the_period_of_theory() {
    // Small oscillations about the minimum: U'' = 57.1464 ε/σ², reduced mass 1/2.
    let minimum = 2f32.powf(1.0 / 6.0);
    let mut world =
        world(vec![[0.0; 2], [minimum + 0.002, 0.0]], vec![[0.0; 2]; 2], Container::None);
    world.set_forces(vec![lennard_jones()]).unwrap();
    let period = std::f64::consts::TAU / (57.1464f64 * 2.0).sqrt();
    world.step(period / 1000.0, 500).unwrap();
    let [a, b] = world.bodies().positions().unwrap()[..] else { unreachable!() };
    assert!(((b[0] - a[0] - minimum) / -0.002 - 1.0).abs() < 0.02, "{}", b[0] - a[0] - minimum);
}

#[test]
fn the_potential_is_that_of_lennard_jones() {
    for distance in [0.9f32, 1.0, 1.1225, 1.5, 2.0, 2.499] {
        let mut world = world(vec![[0.0; 2], [distance, 0.0]], vec![[0.0; 2]; 2], Container::None);
        world.set_forces(vec![lennard_jones()]).unwrap();
        let potential = |r: f64| 4.0 * (r.powi(-12) - r.powi(-6));
        let expected = potential(distance.into()) - potential(2.5);
        let error = (world.potential_energy().unwrap() - expected).abs();
        assert!(error < 1e-3 * (1.0 + expected.abs()), "{distance}: {error}");
    }
}

#[test]
fn forces_that_are_not_mutual_have_no_potential() {
    let table = |values| PairTable::new(2, values, 5.0, 0.0).unwrap();
    let mutual = table(vec![0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
    let chasing = table(vec![0.0, 0.0, -1.0, -1.0, 1.0, 1.0, 0.0, 0.0]);
    assert!(mutual.is_reciprocal() && !chasing.is_reciprocal());
    let mut world = world(vec![[0.0; 2], [3.0, 0.0]], vec![[0.0; 2]; 2], Container::None);
    set_kinds(&mut world, vec![0, 1]).unwrap();
    world.set_forces(vec![pair(mutual)]).unwrap();
    assert!((world.potential_energy().unwrap() - 2.0).abs() < 1e-9);
    world.set_forces(vec![pair(chasing)]).unwrap();
    assert_eq!(world.potential_energy().unwrap(), 0.0);
    world.step(0.1, 10).unwrap();
    assert!(
        world
            .bodies()
            .velocities()
            .unwrap()
            .iter()
            .all(|v| (v[0] - 1.0).abs() < 1e-5 && v[1] == 0.0)
    );
}

/// Sets the kinds of all particles.
fn set_kinds(world: &mut World, kinds: Vec<u8>) -> Result<()> {
    let ids = world.bodies().ids()?;
    world.set(&ids, &Changes { kinds: Some(Each::Rows(kinds)), ..Changes::default() })
}

fn colourful(count: usize, on_touch: OnTouch) -> World {
    let places = (0..count).map(|k| [3.0 * k as f32, 0.0]).collect();
    let mut world = world(places, vec![[0.0; 2]; count], Container::None);
    world.configure(WorldSettings { on_touch, ..*world.settings() }).unwrap();
    let table = PairTable::new(5, vec![0.0; 50], 1.0, 0.0).unwrap();
    let kinds = (0..count).map(|k| k as u8 % 5).collect();
    set_kinds(&mut world, kinds).unwrap();
    world.set_forces(vec![pair(table)]).unwrap();
    world
}

#[test]
fn kinds_stay_with_their_particles() {
    let mut world = colourful(5, OnTouch::Ignore);
    world.remove(&[1, 3]).unwrap();
    assert_eq!(world.bodies().kinds().unwrap(), [0, 2, 4]);
    let added = world.add(still(&[[50.0, 0.0]; 2], 1.0));
    assert_eq!(world.bodies().kinds().unwrap(), [0, 2, 4, 0, 0]);
    let ids: Vec<_> = added.unwrap().collect();
    let kinds = |kinds| Changes { kinds: Some(Each::Rows(kinds)), ..Changes::default() };
    world.set(&ids, &kinds(vec![3, 1])).unwrap();
    assert_eq!(world.bodies().kinds().unwrap(), [0, 2, 4, 3, 1]);
    let refused = world.set(&ids, &kinds(vec![1, 5])).unwrap_err().to_string();
    assert_eq!(refused, "kinds[1] is 5; the table has 5 kinds, from 0 to 4");
    assert_eq!(world.bodies().kinds().unwrap(), [0, 2, 4, 3, 1]);
    let again = World::restore(&world.snapshot().unwrap()).unwrap();
    assert_eq!(again.forces().unwrap(), world.forces().unwrap());
}

#[test]
fn a_merged_particle_has_the_kind_of_the_heaviest() {
    for heavier in [0, 1] {
        let mut world = colourful(4, OnTouch::Merge);
        let change = |all: &mut Particles| {
            all.positions[2] = [3.05, 0.0];
            all.masses[1 + heavier] = 2.0;
            Ok(())
        };
        world.edit(change).unwrap();
        world.step(0.01, 1).unwrap();
        assert_eq!(world.bodies().kinds().unwrap(), [0, 1 + heavier as u8, 3]);
    }
}

#[test]
fn a_snapshot_continues_with_the_same_bits() {
    for name in ["life", "flock", "fluid"] {
        let scene = jostle_scenes::find(name).unwrap();
        let mut world = scene.create(Some(300), 3).unwrap();
        world.step(1.0 / 60.0, 20).unwrap();
        let mut again = World::restore(&world.snapshot().unwrap()).unwrap();
        for world in [&mut world, &mut again] {
            world.step(1.0 / 60.0, 20).unwrap();
        }
        assert_eq!(again.state_hash().unwrap(), world.state_hash().unwrap(), "{name}");
    }
}

#[test]
fn coincident_particles_that_differ_in_kind_have_one_order() {
    let run = |order: [usize; 3]| {
        let places = [[5.0f32, 5.0], [5.0, 5.0], [6.0, 5.5]];
        let kinds = [0u8, 2, 1];
        let mut world =
            world(order.map(|k| places[k]).to_vec(), vec![[0.0; 2]; 3], Container::None);
        let kinds = order.map(|k| kinds[k]).to_vec();
        set_kinds(&mut world, kinds).unwrap();
        world.set_forces(vec![any_table(4.0, 0.0)]).unwrap();
        world.step(0.01, 50).unwrap();
        let found = bits(&world.bodies().positions().unwrap());
        order.map(|k| (k, found[order.iter().position(|&o| o == k).unwrap()]))
    };
    let mut first = run([0, 1, 2]);
    let mut second = run([1, 2, 0]);
    first.sort_unstable();
    second.sort_unstable();
    assert_eq!(first, second);
}

#[test]
fn a_flock_keeps_its_limits_of_speed() {
    let scene = jostle_scenes::find("flock").unwrap();
    let mut world = scene.create(Some(500), 0).unwrap();
    for _ in 0..60 {
        world.step(1.0 / 60.0, 1).unwrap();
        for [u, v] in world.bodies().velocities().unwrap() {
            let speed = (u * u + v * v).sqrt();
            assert!((59.99..120.01).contains(&speed), "{speed}");
        }
    }
}

#[test]
fn forces_that_do_not_fit_are_refused() {
    let mut world = colourful(3, OnTouch::Ignore);
    let refused = |world: &mut World, force| world.set_forces(vec![force]).unwrap_err().to_string();
    let table = || PairTable::new(1, vec![1.0, 0.0], 4.0, 0.0).unwrap();
    let before = world.forces().unwrap();
    let unknown = refused(&mut world, pair(table()));
    assert_eq!(unknown, "kinds[1] is 1; the table has 1 kind, from 0 to 0");
    assert_eq!((world.forces().unwrap(), world.bodies().kinds().unwrap()), (before, vec![0, 1, 2]));
    set_kinds(&mut world, vec![0; 3]).unwrap();
    world.set_forces(vec![pair(table())]).unwrap();
    let unknown = set_kinds(&mut world, vec![0, 0, 1]).unwrap_err();
    assert_eq!(unknown.to_string(), "kinds[2] is 1; the table has 1 kind, from 0 to 0");
    let torus = Container::Torus { size: [100.0, 7.0] };
    let small = world.configure(WorldSettings { container: torus, ..*world.settings() });
    assert_eq!(
        small.unwrap_err().to_string(),
        "forces[0] is a force with the cutoff 4; with a period of (100, 7) a cutoff is at most 3.5"
    );
    assert_eq!(world.settings().container, Container::None);
    let wrong = |found: jostle_base::Result<PairTable>| found.unwrap_err().to_string();
    assert!(wrong(PairTable::new(0, vec![], 1.0, 0.0)).contains("1 to 64 kinds"));
    assert!(wrong(PairTable::new(1, vec![0.0], 1.0, 0.0)).contains("(K, K, m)"));
    assert!(
        wrong(PairTable::new(1, vec![0.0, f32::NAN], 1.0, 0.0))
            .starts_with("table[0, 0, 1] is NaN")
    );
    for cutoff in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-20] {
        assert!(wrong(PairTable::new(1, vec![0.0; 2], cutoff, 0.0)).starts_with("cutoff is"));
    }
    assert!(wrong(PairTable::new(1, vec![0.0; 2], 1.0, -1.0)).starts_with("damping is -1"));
    assert!(wrong(PairTable::particle_life(1, &[1.0], 1.0, 1.0, 1.0)).starts_with("core is 1"));
    assert!(
        wrong(PairTable::lennard_jones(1, &[1.0], &[0.0], 1.0)).starts_with("sigma[0, 0] is 0")
    );
}
