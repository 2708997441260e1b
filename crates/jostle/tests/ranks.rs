//! Distributed worlds, whose ranks are threads here.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{self, ThreadId};

use crate::common::ranks::{ThreadRank, ranks};
use crate::common::worlds::{bouncing, boxed, inside, world_of};
use jostle_base::{Error, Id};
use jostle_scenes::{STEP, find};
use jostle_world::ranks;
use jostle_world::ranks::read_records;
use jostle_world::{Communicator, Container, OnTouch, Particles, Stage, World, WorldSettings};

/// A gas on a lattice with pseudo-random velocities.
fn gas(count: usize) -> Particles {
    let side = (count as f64).sqrt().ceil() as usize;
    let places: Vec<[f32; 2]> =
        (0..count).map(|k| [k % side, k / side].map(|cell| 2.5 * cell as f32)).collect();
    let velocity =
        |k: usize| [0.0, 0.5].map(|shift| (k as f32 * 0.618 + shift).fract() * 30.0 - 15.0);
    Particles::new(places, (0..count).map(velocity).collect(), vec![1.0; count], 1.0)
}

/// The particles whose number divided by `size` leaves `rank`, with their ids.
fn share(all: &Particles, rank: usize, size: usize) -> (Particles, Vec<Id>) {
    let rows: Vec<usize> = (rank..all.len()).step_by(size).collect();
    let column = |of: &dyn Fn(usize) -> [f32; 2]| rows.iter().map(|&row| of(row)).collect();
    let mut particles = Particles::new(
        column(&|row| all.positions[row]),
        column(&|row| all.velocities[row]),
        rows.iter().map(|&row| all.radii[row]).collect(),
        1.0,
    );
    particles.masses = rows.iter().map(|&row| all.masses[row]).collect();
    particles.restitution = rows.iter().map(|&row| all.restitution[row]).collect();
    particles.movable = rows.iter().map(|&row| all.movable[row]).collect();
    if all.has_friction() {
        particles.spins = rows.iter().map(|&row| all.spins[row]).collect();
    }
    (particles, rows.iter().map(|&row| row as Id).collect())
}

/// Calls `work` with the part of each rank, in a thread for each.
fn on_ranks<R: Send>(
    all: &Particles,
    settings: WorldSettings,
    communicators: Vec<ThreadRank>,
    work: impl Fn(usize, World) -> R + Sync,
) -> Vec<R> {
    let (size, work) = (communicators.len(), &work);
    thread::scope(|scope| {
        let start = |(rank, of): (usize, ThreadRank)| {
            scope.spawn(move || {
                let (particles, ids) = share(all, rank, size);
                let mut world = world_of(particles, settings);
                ranks::distribute(&mut world, Box::new(of), ids).unwrap();
                work(rank, world)
            })
        };
        let threads: Vec<_> = communicators.into_iter().enumerate().map(start).collect();
        threads.into_iter().map(|of| of.join().unwrap()).collect()
    })
}

/// Checks that some ranks have the particles of one process after some steps. Returns the number of ghosts
/// of each rank.
fn check(all: &Particles, settings: WorldSettings, size: usize, steps: usize) -> Vec<usize> {
    check_prepared(all, settings, size, steps, |_| ())
}

/// As [`check`]; `prepare` gets the world of one process, and that of each rank, before the steps.
fn check_prepared(
    all: &Particles,
    settings: WorldSettings,
    size: usize,
    steps: usize,
    prepare: impl Fn(&mut World) + Sync,
) -> Vec<usize> {
    let mut whole = world_of(all.clone(), settings);
    prepare(&mut whole);
    whole.step(1.0 / 60.0, steps).unwrap();
    let (expected, rows) = (whole.bodies().particles().unwrap(), whole.bodies().ids().unwrap());
    let parts = on_ranks(all, settings, ranks(size), |_, mut world| {
        prepare(&mut world);
        world.step(1.0 / 60.0, steps).unwrap();
        let own = ranks::own_particles(&world).unwrap();
        (ranks::own_records(&world).unwrap(), own.ids.len() - own.own)
    });
    let mut found = 0;
    for (bytes, _) in &parts {
        let (own, ids) = read_records(bytes);
        for (row, id) in ids.iter().enumerate() {
            let at = rows.binary_search(id).unwrap();
            let state = |all: &Particles, row: usize| {
                let moves = [all.positions[row], all.residuals[row], all.velocities[row]];
                (moves, [all.radii[row], all.masses[row], all.restitution[row]], all.movable[row])
            };
            assert_eq!(state(&own, row), state(&expected, at), "{id}");
        }
        found += ids.len();
    }
    assert_eq!(found, rows.len());
    parts.into_iter().map(|(_, ghosts)| ghosts).collect()
}

#[test]
fn ranks_have_the_bits_of_one_process() {
    for size in [1, 2, 5] {
        check(&gas(300), WorldSettings::default(), size, 40);
    }
    let container = Container::Torus { size: [45.0, 45.0] };
    check(&gas(300), inside(container), 3, 40);
}

#[test]
fn particles_that_merge_have_the_bits_of_one_process() {
    let on_touch = OnTouch::Merge;
    let mut all = gas(400);
    // Some are so heavy that they do not merge with each other.
    (0..400).step_by(7).for_each(|row| all.masses[row] = 3e29);
    (0..400).step_by(11).for_each(|row| all.movable[row] = false);
    (0..400).step_by(3).for_each(|row| all.restitution[row] = 0.5);
    let inside = boxed([-1.0, -1.0], [49.0, 49.0]);
    let gravity = [0.0, 40.0];
    for container in [Container::None, inside, Container::Torus { size: [50.0, 50.0] }] {
        let settings = WorldSettings { on_touch, gravity, container, ..WorldSettings::default() };
        for (size, steps) in [(1, 30), (2, 1), (3, 30), (5, 120)] {
            check(&all, settings, size, steps);
        }
    }
}

/// More contacts of a particle than there are colours: each rank has a part of those that are solved in sequence.
#[test]
fn particles_with_many_neighbours_have_the_bits_of_one_process() {
    let gravity = [0.0, 20.0];
    let settings = WorldSettings { gravity, ..WorldSettings::default() };
    // Discs over a quarter of the area, some of which move by 250 radii in a step.
    let mut fast = bouncing(gas(400), 0.5);
    fast.positions.iter_mut().for_each(|at| *at = at.map(|v| 1.4 * v));
    fast.velocities.iter_mut().flatten().for_each(|v| *v *= 10.0);
    fast.velocities.iter_mut().step_by(7).flatten().for_each(|v| *v *= 101.0);
    (0..400).step_by(5).for_each(|row| fast.movable[row] = false);
    let container = boxed([-2.0; 2], [70.0; 2]);
    for size in [2, 3] {
        check(&fast, WorldSettings { container, ..settings }, size, 1);
    }
    // Small discs, some of them heavy, on a large one.
    let small = |k: usize| {
        let angle = k as f32 * 0.045;
        [16.1 * angle.cos(), 16.1 * angle.sin()]
    };
    let mut crowd = bouncing(gas(141), 0.5);
    crowd.positions[..140].iter_mut().enumerate().for_each(|(k, at)| *at = small(k));
    (crowd.positions[140], crowd.velocities[140]) = ([0.0; 2], [1.0, -3.0]);
    crowd.radii.fill(0.36);
    crowd.velocities.iter_mut().flatten().for_each(|v| *v *= 0.1);
    crowd.spins_mut().iter_mut().for_each(|spin| spin.friction = 0.4);
    (crowd.radii[140], crowd.masses[140]) = (15.8, 3000.0);
    (0..140).step_by(9).for_each(|row| crowd.masses[row] = 40.0);
    for (moves, sizes) in [(true, &[1, 3][..]), (false, &[2])] {
        crowd.movable[140] = moves;
        sizes.iter().for_each(|&size| _ = check(&crowd, settings, size, 1));
    }
}

#[test]
fn external_accelerations_have_the_bits_of_one_process() {
    let all = gas(300);
    let settings = WorldSettings { gravity: [3.0, 0.0], ..WorldSettings::default() };
    let accelerate = |world: &mut World| {
        ranks::rebalance_every(world, 3);
        let acceleration = |id: Id| if id % 3 > 0 { [0.0; 2] } else { [40.0 - id as f32, 9.0] };
        let ids = ranks::own_ids(world).unwrap().0;
        world.set_accelerations(ids.into_iter().map(acceleration).collect()).unwrap();
    };
    let merging = WorldSettings { on_touch: OnTouch::Merge, ..settings };
    for (settings, steps) in [(settings, 20), (merging, 20)] {
        for size in [1, 2, 5] {
            check_prepared(&all, settings, size, steps, accelerate);
        }
    }
}

#[test]
fn an_error_of_external_accelerations_reaches_all_ranks() {
    let results = on_ranks(&gas(60), WorldSettings::default(), ranks(3), |rank, mut world| {
        let ids = ranks::own_ids(&world).unwrap().0;
        let worst = if rank == 1 { f32::NAN } else { 1.0 };
        world.set_accelerations(vec![[0.0, worst]; ids.len()]).map_err(|error| error.to_string())
    });
    let texts: Vec<String> = results.into_iter().map(|of| of.unwrap_err()).collect();
    assert!(texts[1].contains("accelerations") && texts[1].contains("NaN"), "{texts:?}");
}

#[test]
fn a_particle_far_away_does_not_bring_all_others_to_each_rank() {
    for far in [2e4, 1e9, 1e17] {
        let mut all = gas(4000);
        all.positions[17] = [far, -1.5 * far];
        let ghosts = check(&all, WorldSettings::default(), 4, 3);
        assert!(ghosts.iter().all(|&ghosts| ghosts < 1500), "{far}: {ghosts:?}");
    }
}

/// Each rank has other blocks of discs than the others, and simulates other discs again. That changes no hash
/// of a trajectory.
#[test]
fn steps_are_not_repeated_where_halos_are_wide_enough() {
    let mut all = gas(40_000);
    all.velocities.iter_mut().flatten().for_each(|v| *v *= 4.0);
    let repeats = on_ranks(&all, WorldSettings::default(), ranks(2), |_, mut world| {
        world.step(1.0 / 60.0, 8).unwrap();
        ranks::own_particles(&world).unwrap().repeats
    });
    assert_eq!(repeats, [0, 0]);
}

#[test]
fn impacts_at_the_same_time_do_not_depend_on_ranks_and_far_particles() {
    // Discs in contact, in a lattice that is hit at one side.
    let mut all = gas(900);
    all.positions.iter_mut().for_each(|at| *at = at.map(|v| v * 0.8));
    all.velocities.fill([0.0; 2]);
    all.velocities[..30].fill([0.0, 9.0]);
    check(&all, WorldSettings::default(), 4, 20);
    all.positions[899] = [1e10, 1e10];
    check(&all, WorldSettings::default(), 4, 20);
}

#[test]
fn a_rank_that_panics_tells_the_others() {
    let results = on_ranks(&gas(300), WorldSettings::default(), ranks(3), |rank, mut world| {
        let mut stop =
            |stage: Stage, _: &World| assert!(rank != 1 || stage != Stage::Pairs, "a defect");
        let step = || world.step_watched(1.0 / 60.0, 1, &mut stop);
        let result = catch_unwind(AssertUnwindSafe(step));
        result.map_err(|panic| panic.downcast_ref::<&str>().copied() == Some("a defect"))
    });
    for (rank, result) in results.iter().enumerate() {
        match result {
            Err(is_defect) => assert!(rank == 1 && *is_defect),
            Ok(done) => assert_eq!(*done, Err(Error::OtherRank { rank: 1 }), "{rank}"),
        }
    }
}

#[test]
fn ranks_that_do_not_agree_stop_when_each_has_all_particles() {
    let mut communicators = ranks(2);
    communicators[0].tampers = true;
    let results = on_ranks(&gas(300), WorldSettings::default(), communicators, |_, mut world| {
        let done = world.step(1.0 / 60.0, 1);
        (done, ranks::own_particles(&world).unwrap().repeats)
    });
    for (done, repeats) in results {
        let message = done.unwrap_err().to_string();
        assert!(message.contains("the ranks do not agree"), "{message}");
        assert!(repeats < 8, "{repeats}");
    }
}

#[test]
fn errors_name_the_ids_among_all_particles() {
    let mut all = gas(300);
    all.velocities[271] = [1e18, 0.0];
    let results = on_ranks(&all, WorldSettings::default(), ranks(3), |_, mut world| {
        world.step(100.0, 1).unwrap_err()
    });
    for (rank, error) in results.iter().enumerate() {
        if rank == 271 % 3 {
            assert!(error.to_string().contains("particle 271 would move"), "{error}");
        } else {
            assert_eq!(*error, Error::OtherRank { rank: 271 % 3 });
        }
    }
}

/// Checks that all ranks refuse a step of `dt` with too many collisions, as one process does, and
/// continue from where they were.
fn check_refused(all: &Particles, container: Container, dt: f64, size: usize) {
    let settings = inside(container);
    let results = on_ranks(all, settings, ranks(size), |_, mut world| {
        let error = world.step(dt, 1).unwrap_err();
        let named = match error {
            Error::TooManyCollisions { id, .. } => Some(id),
            Error::OtherRank { .. } => None,
            other => panic!("{other}"),
        };
        world.step(1e-8, 3).unwrap();
        (named, ranks::own_records(&world).unwrap())
    });
    let mut whole = world_of(all.clone(), settings);
    let error = whole.step(dt, 1).unwrap_err();
    assert!(matches!(error, Error::TooManyCollisions { .. }), "{error}");
    let ids = 0..all.len() as Id;
    assert!(results.iter().filter_map(|(named, _)| *named).all(|id| ids.contains(&id)));
    assert!(results.iter().any(|(named, _)| named.is_some()));
    whole.step(1e-8, 3).unwrap();
    for (_, bytes) in results {
        let (own, ids) = read_records(&bytes);
        for (row, id) in ids.into_iter().enumerate() {
            assert_eq!(own.positions[row], whole.bodies().positions().unwrap()[id as usize]);
        }
    }
}

#[test]
fn all_ranks_refuse_a_step_with_too_many_collisions() {
    let mut all = gas(20);
    all.velocities.iter_mut().flatten().for_each(|v| *v *= 3e6);
    let container = boxed([-1.2; 2], [11.2, 8.7]);
    check_refused(&all, container, 0.01, 2);
}

/// Few discs have few first impacts, so the step is one window: none follows in which ranks could
/// learn that one has failed.
#[test]
fn all_ranks_refuse_one_window_with_too_many_collisions() {
    let mut all = gas(2);
    all.velocities = vec![[0.0, 3e5], [0.0; 2]];
    let container = boxed([-1.2, -1.01], [3.7, 1.01]);
    for size in [1, 2, 3] {
        check_refused(&all, container, 0.01, size);
    }
    all.velocities.fill([0.0, 3e5]);
    check_refused(&all, container, 0.01, 2);
}

/// The messages of a world that one process has as a whole come from its own thread.
struct One(ThreadId);

impl One {
    fn check(&self) {
        assert_eq!(thread::current().id(), self.0, "a message from another thread");
    }
}

impl Communicator for One {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn gather(&mut self, own: &[u8]) -> Result<Vec<u8>, Error> {
        self.check();
        Ok(own.to_vec())
    }

    fn gather_all(&mut self, own: &[u8], _: &[usize]) -> Result<Vec<u8>, Error> {
        self.gather(own)
    }

    fn transpose(&mut self, to: &[u64]) -> Result<Vec<u64>, Error> {
        self.check();
        Ok(to.to_vec())
    }

    fn exchange(&mut self, to: &[u8], _: &[usize], _: &[usize]) -> Result<Vec<u8>, Error> {
        self.gather(to)
    }
}

#[test]
fn one_rank_has_the_bits_of_one_process_on_two_threads() {
    let pile = || {
        let mut world = find("pile").unwrap().create(Some(6000), 0).unwrap();
        let mut settings = *world.settings();
        settings.tree.threads = Some(2);
        world.configure(settings).unwrap();
        world
    };
    let (mut alone, mut one) = (pile(), pile());
    ranks::distribute(&mut one, Box::new(One(thread::current().id())), (0..6000).collect())
        .unwrap();
    for world in [&mut alone, &mut one] {
        world.step(STEP, 20).unwrap();
    }
    let (found, ids) = read_records(&ranks::own_records(&one).unwrap());
    let expected = alone.bodies().particles().unwrap();
    assert_eq!(ids.len(), 6000);
    for (index, &id) in ids.iter().enumerate() {
        assert_eq!(found.positions[index], expected.positions[id as usize]);
        assert_eq!(found.velocities[index], expected.velocities[id as usize]);
    }
}
