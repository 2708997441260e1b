//! A world: particles, walls, forces and settings change between steps, and islands sleep and wake.
//!
//! The same operations are made on three worlds, which must agree: one with the tree, one with brute force and more
//! threads, and one that often continues from its snapshot. Columns and events are those of a model.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::sync::Arc;

use jostle_base::interrupt::watch;
use jostle_base::{Error, Id, Method, Result};
use jostle_index::{Each, Filter};
use jostle_scenes::STEP;
use jostle_world::forces::{
    Andersen, Attractor, Flocking, Grab, Gravitation, Law, Motor, PairForce, PairTable, Pole,
    Spring, Springs, ThermalWalls, Thermostat, WallIds,
};
use jostle_world::{
    Changes, Container, Influence, OnTouch, Particles, Sides, Spin, Surface, Wall, World,
    WorldSettings,
};

use super::driver::{Case, Draw, run};
use crate::common::worlds::{bouncing, boxed, still, surface, with_friction};
use crate::events::touching_by_brute_force;

thread_local! {
    /// Polls that do not interrupt a step.
    static LEFT: Cell<u32> = const { Cell::new(0) };
}

/// Names of the worlds.
const WAYS: [&str; 3] = ["the tree", "brute force", "a snapshot"];

struct WorldCase {
    worlds: [World; 3],
    /// The particles as they should be, in the order of adding, and their ids.
    all: Particles,
    ids: Vec<Id>,
    /// The id that is given next.
    next: Id,
    /// The pairs that touched at the end of the last record.
    touching: BTreeSet<[Id; 2]>,
}

impl Case for WorldCase {
    fn new(draw: &mut Draw) -> Self {
        let settings = draw_settings(draw);
        draw.say("new", settings);
        let worlds = WAYS.map(|_| World::new(Particles::default(), settings).expect("valid"));
        let (all, ids) = (Particles::default(), Vec::new());
        let mut case = Self { worlds, all, ids, next: 0, touching: BTreeSet::new() };
        case.configure(settings);
        case.add(draw, 14);
        case
    }

    fn operate(&mut self, draw: &mut Draw) {
        match draw.below(24) {
            0 => self.add(draw, 4),
            1 => self.remove(draw),
            2..5 => self.set(draw),
            5 => self.edit(draw),
            6..8 => self.set_walls(draw),
            8..10 => self.set_forces(draw),
            10 => self.accelerate(draw),
            11 => self.change_settings(draw),
            12 => self.refuse(draw),
            13..15 => self.snapshot(draw),
            15 => self.interrupt(draw),
            16 => self.step(draw, 50),
            _ => {
                let steps = 1 + draw.below(3);
                self.step(draw, steps);
            }
        }
        self.check();
    }
}

impl WorldCase {
    /// Makes an operation on all worlds. If it is refused, it is refused by all of them in the same way.
    fn each<R: Debug + PartialEq>(&mut self, act: impl Fn(&mut World) -> Result<R>) -> Result<R> {
        let [result, others @ ..] = self.worlds.each_mut().map(&act);
        others.iter().zip(&WAYS[1..]).for_each(|(other, way)| assert_eq!(*other, result, "{way}"));
        result
    }

    /// Makes an operation that must be refused, and change nothing.
    fn refused<R: Debug + PartialEq>(&mut self, act: impl Fn(&mut World) -> Result<R>) {
        for world in &mut self.worlds {
            let before = world.snapshot().unwrap();
            let result = act(world);
            assert!(result.is_err(), "{result:?} is not refused");
            assert!(world.snapshot().unwrap() == before, "{result:?} has changed something");
        }
    }

    fn add(&mut self, draw: &mut Draw, most: usize) {
        let new = draw_particles(draw, most);
        draw.say("add", &new);
        let ids = self.each(|world| world.add(new.clone())).expect("valid");
        assert_eq!(ids, self.next..self.next + new.len() as Id);
        self.next = ids.end;
        self.ids.extend(ids);
        self.all.extend(&new);
        self.all.simplify();
    }

    fn remove(&mut self, draw: &mut Draw) {
        let ids = draw.subset(&self.ids, 3);
        draw.say("remove", &ids);
        self.each(|world| world.remove(&ids)).expect("they are there");
        let kept = self.ids.clone();
        self.all.retain(|row| !ids.contains(&kept[row]));
        self.all.simplify();
        self.ids.retain(|id| !ids.contains(id));
    }

    fn rows_of(&self, ids: &[Id]) -> Vec<usize> {
        ids.iter()
            .map(|id| self.ids.iter().position(|own| own == id).expect("it is there"))
            .collect()
    }

    /// Sets one column of some particles.
    fn set(&mut self, draw: &mut Draw) {
        let ids = draw.subset(&self.ids, 4);
        let (rows, which) = (self.rows_of(&ids), draw.below(9));
        let new = (0..ids.len()).map(|_| draw_particle(draw)).collect::<Vec<_>>();
        let (mut changes, mut all) = (Changes::default(), self.all.clone());
        let first =
            |of: &dyn Fn(&Particles) -> f32| Each::Rows(new.iter().map(of).collect::<Vec<f32>>());
        for (&row, new) in rows.iter().zip(&new) {
            let spin = new.spin(0);
            match which {
                0 => (all.positions[row], all.residuals[row]) = (new.positions[0], [0.0; 2]),
                1 => all.velocities[row] = new.velocities[0],
                2 => all.radii[row] = new.radii[0],
                3 => all.masses[row] = new.masses[0],
                4 => all.restitution[row] = new.restitution[0],
                5 => all.spins_mut()[row].friction = spin.friction,
                6 => all.spins_mut()[row].velocity = spin.velocity,
                7 => all.filters_mut()[row].mask = new.filter(0).mask,
                _ => {
                    all.sensors_mut()[row] = new.is_sensor(0);
                    all.kinds.resize(all.len(), 0);
                    all.kinds[row] = new.kind(0);
                }
            }
        }
        match which {
            0 => {
                changes.positions = Some(Each::Rows(new.iter().map(|of| of.positions[0]).collect()))
            }
            1 => {
                changes.velocities =
                    Some(Each::Rows(new.iter().map(|of| of.velocities[0]).collect()))
            }
            2 => changes.radii = Some(first(&|of| of.radii[0])),
            3 => changes.masses = Some(first(&|of| of.masses[0])),
            4 => changes.restitution = Some(first(&|of| of.restitution[0])),
            5 => changes.friction = Some(first(&|of| of.spin(0).friction)),
            6 => changes.angular_velocities = Some(first(&|of| of.spin(0).velocity)),
            7 => changes.masks = Some(Each::Rows(new.iter().map(|of| of.filter(0).mask).collect())),
            _ => {
                changes.sensors = Some(Each::Rows(new.iter().map(|of| of.is_sensor(0)).collect()));
                changes.kinds = Some(Each::Rows(new.iter().map(|of| of.kind(0)).collect()));
            }
        }
        draw.say("set", (&ids, &changes));
        self.each(|world| world.set(&ids, &changes)).expect("valid");
        all.simplify();
        self.all = all;
    }

    /// Edits all particles in a function, or replaces a movable one by an immovable one.
    fn edit(&mut self, draw: &mut Draw) {
        let (by, toggled) = (draw.between(-0.5, 0.5) as f32, draw.below(20));
        draw.say("edit", (by, toggled));
        let toggled = Some(toggled).filter(|&row| row < self.all.len());
        let edit = |all: &mut Particles| {
            all.velocities.iter_mut().step_by(2).for_each(|velocity| velocity[0] += by);
            if let Some(row) = toggled {
                all.movable[row] = !all.movable[row];
            }
            Ok(())
        };
        // A merged particle may be too large for the container.
        if self.each(|world| world.edit(edit)).is_ok() {
            edit(&mut self.all).expect("valid");
        }
    }

    fn set_walls(&mut self, draw: &mut Draw) {
        let walls: Vec<Wall> = draw.some(3, draw_wall);
        draw.say("set_walls", &walls);
        // Walls that forces name cannot be removed.
        if self.each(|world| world.set_walls(walls.clone())).is_ok() {
            assert_eq!(self.worlds[0].walls(), walls);
        }
    }

    fn set_forces(&mut self, draw: &mut Draw) {
        let forces: Vec<Influence> = draw.some(2, |draw| self.draw_force(draw));
        draw.say("set_forces", &forces);
        if self.each(|world| world.set_forces(forces.clone())).is_ok() {
            assert_eq!(self.worlds[0].forces().unwrap(), forces);
        }
    }

    fn draw_force(&self, draw: &mut Draw) -> Influence {
        let some = draw.subset(&self.ids, 2);
        let seed = draw.below(9) as u32;
        match draw.below(11) {
            0 => Influence::Attractor(Attractor {
                pole: Pole::Point([4.0, 5.0]),
                strength: 3.0,
                law: Law::Harmonic,
            }),
            1 if !some.is_empty() => {
                let (pole, law) = (Pole::Particle(some[0]), Law::InverseSquare);
                Influence::Attractor(Attractor { pole, strength: 2.0, law })
            }
            2 => Influence::Gravitation(Gravitation { g: 0.5, softening: 0.1, theta: 0.5 }),
            3 | 4 if some.len() == 2 => {
                let max_stretch = draw.pick(&[f32::INFINITY, 0.5]);
                let (pair, stiffness) = ([some[0], some[1]], draw.pick(&[10.0, 1e4]));
                Influence::Springs(Springs(vec![Spring {
                    pair,
                    length: 2.0,
                    stiffness,
                    damping: 0.5,
                    max_stretch,
                }]))
            }
            5 => Influence::Thermostat(Thermostat { speed: 2.0, rate: 0.5 }),
            6 => Influence::ThermalWalls(ThermalWalls {
                temperature: 2.0,
                sides: [true, false, true, true, false],
                walls: WallIds::default(),
                seed,
            }),
            9 => {
                let values = (0..9 * 5).map(|k| (k * 7 % 11) as f32 - 5.0).collect();
                let table = PairTable::new(3, values, 2.5, 0.1).expect("valid");
                Influence::Pair(PairForce { table: Arc::new(table) })
            }
            10 if !some.is_empty() => {
                let max_force = draw.pick(&[f32::INFINITY, 20.0]);
                Influence::Grab(Grab { id: some[0], point: [4.0, 5.0], rate: 9.0, max_force })
            }
            7 => Influence::Andersen(Andersen { temperature: 2.0, rate: 3.0, seed }),
            8 => {
                let (walls, ids) = (if draw.one_in(2) { vec![0] } else { vec![] }, some);
                Influence::Motor(Motor {
                    ids,
                    walls: WallIds(walls),
                    pivot: [5.0; 2],
                    angular_velocity: 1.0,
                    velocity: [1.0, 0.5],
                    cycle: 0.7,
                })
            }
            _ => Influence::Flocking(Flocking {
                cutoff: 2.0,
                separation: 2.0,
                alignment: 1.0,
                cohesion: 0.5,
                max_speed: 9.0,
                min_speed: 0.0,
            }),
        }
    }

    /// Gives accelerations or forces that the caller has computed.
    fn accelerate(&mut self, draw: &mut Draw) {
        let vectors: Vec<[f32; 2]> =
            (0..self.ids.len()).map(|_| [draw.between(-9.0, 9.0) as f32, 0.0]).collect();
        let (which, which_points) = (draw.below(3), draw.below(2));
        draw.say("accelerate", (which, which_points, &vectors));
        let ids = self.ids.clone();
        let done = self.each(|world| match which {
            0 => world.set_accelerations(vectors.clone()),
            1 => {
                // With torques, because the points are anywhere.
                let half = ids.len() / 2;
                let points = (which_points == 0).then_some(&vectors[half..2 * half]);
                world.add_forces(&ids[..half], &vectors[..half], points)
            }
            _ => {
                world.clear_accelerations();
                Ok(())
            }
        });
        done.expect("valid");
    }

    fn change_settings(&mut self, draw: &mut Draw) {
        let (mut settings, new) = (*self.worlds[0].settings(), draw_settings(draw));
        match draw.below(8) {
            0 => settings.gravity = new.gravity,
            1 => settings.container = new.container,
            2 => settings.sides = new.sides,
            3 => settings.on_touch = new.on_touch,
            4 => settings.drag = new.drag,
            5 => settings.substeps = new.substeps,
            6 => settings.track_events = !settings.track_events,
            _ => settings.sleeping = !settings.sleeping,
        }
        draw.say("configure", settings);
        self.configure(settings);
    }

    /// Gives each world its own way.
    fn configure(&mut self, settings: WorldSettings) {
        let tracked = self.worlds[0].settings().track_events;
        let mut results = Vec::new();
        for (way, world) in self.worlds.iter_mut().enumerate() {
            let mut settings = settings;
            settings.tree.threads = Some([1, 2, 1][way]);
            settings.tree.leaf_capacity = [16, 4, 1][way];
            settings.method = if way == 1 { Method::Brute } else { Method::Quadtree };
            results.push(world.configure(settings));
        }
        assert!(results.iter().all(|result| *result == results[0]), "{results:?}");
        if results[0].is_ok() && settings.track_events != tracked {
            self.touching.clear();
        }
    }

    /// Wrong arguments are refused, and nothing changes.
    fn refuse(&mut self, draw: &mut Draw) {
        let bad: f32 = draw.wrong();
        let mut ids = self.ids.clone();
        let wrong_id = draw.pick(&[-1, self.next, Id::MAX]);
        ids.push(if ids.is_empty() || draw.one_in(2) { wrong_id } else { ids[0] });
        draw.say("refuse", (bad, &ids));
        let (still, own) = (Changes::default(), self.ids.clone());
        self.refused(|world| world.remove(&ids));
        self.refused(|world| world.set(&ids, &still));
        if ids.last() != self.ids.first() {
            self.refused(|world| world.read(&ids));
        }
        for dt in [f64::from(bad), 0.0, -0.1] {
            self.refused(|world| world.step(dt, 1));
        }
        let mut new = draw_particle(draw);
        match draw.below(5) {
            0 => new.positions[0][1] = bad,
            1 => new.velocities[0][0] = bad,
            2 => new.radii[0] = bad,
            3 => new.masses[0] = 0.0,
            _ => new.restitution[0] = 1.5,
        }
        self.refused(|world| world.add(new.clone()));
        self.refused(|world| world.set_walls(vec![Wall::new([[0.0; 2], [bad, 1.0]])]));
        self.refused(|world| {
            world.set_forces(vec![Influence::Thermostat(Thermostat { speed: bad, rate: 0.5 })])
        });
        self.refused(|world| world.set_accelerations(vec![[bad, 0.0]; own.len() + 1]));
        self.refused(|world| {
            world.configure(WorldSettings { sides: Sides([surface(bad); 4]), ..*world.settings() })
        });
        if !own.is_empty() {
            let positions = Some(Each::One([0.0, bad]));
            let changes = Changes { positions, ..Changes::default() };
            self.refused(|world| world.set(&own, &changes));
            self.refused(|world| world.add_forces(&own, &vec![[bad; 2]; own.len()], None));
            self.refused(|world| {
                world.edit(|all| {
                    all.masses[0] = bad;
                    Ok(())
                })
            });
        }
        let bytes = self.worlds[0].snapshot().unwrap();
        let mut damaged = bytes.clone();
        let at = draw.below(bytes.len());
        damaged[at] ^= 1 << draw.below(8);
        assert!(World::restore(&damaged).is_err() && World::restore(&bytes[..at]).is_err());
    }

    /// The third world continues from its snapshot.
    fn snapshot(&mut self, draw: &mut Draw) {
        draw.say("snapshot", ());
        let bytes = self.worlds[2].snapshot().unwrap();
        let restored = World::restore(&bytes).expect("its own snapshot");
        assert!(restored.snapshot().unwrap() == bytes, "another snapshot");
        // Events are a choice of the caller, not a part of the state.
        assert_eq!(restored.settings(), self.worlds[2].settings());
        self.worlds[2] = restored;
    }

    /// A step that is interrupted leaves the world as it was.
    fn interrupt(&mut self, draw: &mut Draw) {
        let polls = draw.below(12) as u32;
        draw.say("interrupt", polls);
        for world in &mut self.worlds {
            let before = world.snapshot().unwrap();
            LEFT.set(polls);
            let poll = || LEFT.replace(LEFT.get().saturating_sub(1)) == 0;
            // One step more is not a part of the case: it is made by a copy.
            let mut copy = World::restore(&before).expect("its own snapshot");
            if watch(poll, || copy.step(STEP, 1)) == Err(Error::Interrupted) {
                assert!(copy.snapshot().unwrap() == before, "it has changed");
            }
            copy.step(STEP, 1).ok();
        }
    }

    fn step(&mut self, draw: &mut Draw, steps: usize) {
        let dt = if steps > 3 { STEP } else { draw.pick(&[STEP, STEP, 0.03, 1e-4]) };
        draw.say("step", (dt, steps));
        for _ in 0..steps {
            // Also between the moments at which islands may fall asleep.
            if draw.one_in(12) {
                self.snapshot(draw);
            }
            let before = self.worlds.each_ref().map(|world| world.snapshot().unwrap());
            self.each(World::begin_record).expect("there is memory");
            if self.each(|world| world.step(dt, 1)).is_err() {
                // The record that has begun is empty; apart from it, nothing has changed.
                for (world, before) in self.worlds.iter().zip(before) {
                    assert!(
                        world.snapshot().unwrap() == before,
                        "a refused step has changed something"
                    );
                }
                return;
            }
            self.each(World::end_record).expect("few pairs");
            self.compare();
            self.follow();
        }
        self.all = self.worlds[0].bodies().particles().unwrap();
        self.ids = self.worlds[0].bodies().ids().unwrap();
    }

    /// Compares what the worlds know after a step.
    fn compare(&self) {
        let [first, others @ ..] = &self.worlds;
        for (world, way) in others.iter().zip(&WAYS[1..]) {
            assert_eq!(world.state_hash().unwrap(), first.state_hash().unwrap(), "{way}");
            assert_eq!(world.bodies().ids().unwrap(), first.bodies().ids().unwrap(), "{way}");
            assert_eq!(world.bodies().asleep().unwrap(), first.bodies().asleep().unwrap(), "{way}");
            assert_eq!(world.contacts(), first.contacts(), "{way}");
            assert_eq!(world.wall_contacts().unwrap(), first.wall_contacts().unwrap(), "{way}");
            assert_eq!(
                (world.record().totals().collisions, world.events().unwrap()),
                (first.record().totals().collisions, first.events().unwrap()),
                "{way}"
            );
            assert_eq!(world.renumbered(), first.renumbered(), "{way}");
            assert_eq!(
                (world.forces().unwrap(), world.walls()),
                (first.forces().unwrap(), first.walls()),
                "{way}"
            );
            assert_eq!((world.time(), world.momentum()), (first.time(), first.momentum()), "{way}");
        }
    }

    /// The events of a step are the changes of a set of pairs, which are those that touch by their distances.
    fn follow(&mut self) {
        let world = &self.worlds[0];
        let Some(events) = world.events().unwrap() else { return };
        let (entered, stayed, left) = {
            let [pairs, _] = events;
            (pairs.entered, pairs.stayed, pairs.left)
        };
        assert!(entered.iter().all(|pair| !self.touching.contains(pair)), "{entered:?}");
        let gone = |pair: &[Id; 2]| left.binary_search(pair).is_ok();
        let before = &self.touching;
        assert!(
            left.iter().all(|pair| before.contains(pair) || entered.contains(pair)),
            "{left:?}"
        );
        assert!(before.iter().copied().filter(|pair| !gone(pair)).eq(stayed), "{before:?}");
        let mut now: BTreeSet<[Id; 2]> =
            before.union(&entered.into_iter().collect()).copied().collect();
        now.retain(|pair| !gone(pair));
        let [mut at_most, at_least] = touching_by_brute_force(world, 0.0);
        // Those that press each other touch, too, at any distance.
        at_most.extend(world.contacts().expect("few").iter().map(|touch| touch.pair));
        assert!(now.is_subset(&at_most), "{now:?} are not all in {at_most:?}");
        assert!(now.is_superset(&at_least), "{now:?} are not all of {at_least:?}");
        self.touching = now;
    }

    fn check(&self) {
        for (world, way) in self.worlds.iter().zip(WAYS) {
            assert_eq!(world.bodies().particles().unwrap(), self.all, "{way}");
            assert_eq!(
                (world.bodies().ids().unwrap(), world.len()),
                (self.ids.clone(), self.all.len()),
                "{way}"
            );
        }
    }
}

pub fn draw_settings(draw: &mut Draw) -> WorldSettings {
    let container = match draw.below(6) {
        0 => Container::None,
        1 => Container::Circle { center: [5.0; 2], radius: 7.0 },
        2 => Container::Torus { size: [10.0, 12.0] },
        _ => boxed([0.0; 2], [10.0; 2]),
    };
    let settings = WorldSettings {
        gravity: [0.0, -9.8],
        drag: draw.pick(&[0.0, 0.0, 0.5, 30.0]),
        sides: Sides([draw_surface(draw); 4]),
        track_events: draw.one_in(2),
        ..WorldSettings::default()
    };
    // In every other world, islands may fall asleep.
    if draw.one_in(2) {
        return WorldSettings { container: boxed([0.0; 2], [10.0; 2]), ..settings };
    }
    WorldSettings {
        gravity: draw.pick(&[[0.0; 2], [0.0, -9.8], [3.0, 1.0]]),
        container,
        on_touch: draw.pick(&[OnTouch::Bounce, OnTouch::Merge, OnTouch::Ignore]),
        substeps: draw.pick(&[None, None, Some(1), Some(3)]),
        sleeping: draw.one_in(2),
        ..settings
    }
}

/// Discs that rest side by side on the floor.
pub fn draw_resting(draw: &mut Draw, most: usize) -> Particles {
    let (apart, count) = (draw.pick(&[1.0, 1.0, 1.5]), 1 + draw.below(most));
    let row: Vec<[f32; 2]> = (0..count).map(|k| [apart * k as f32 + 0.5, 0.5]).collect();
    with_friction(bouncing(still(&row, 0.5), 0.3), draw.pick(&[0.0, 0.5]))
}

/// Discs on a lattice or anywhere, also one at the place of another; or discs that rest on a floor.
/// Some of the first kind all keep their energy.
pub fn draw_particles(draw: &mut Draw, most: usize) -> Particles {
    if most > 0 && draw.one_in(3) {
        return draw_resting(draw, most.min(6));
    }
    let mut all = Particles::default();
    draw.some(most, draw_particle).iter().for_each(|one| all.extend(one));
    if draw.one_in(4) {
        all = bouncing(all, 1.0);
    }
    all.simplify();
    all
}

pub fn draw_particle(draw: &mut Draw) -> Particles {
    let along = |draw: &mut Draw| match draw.below(20) {
        0..8 => draw.between(0.5, 9.5) as f32,
        8..19 => draw.below(10) as f32 + 0.5,
        _ => draw.pick(&[0.0, -3.0, 1e6]),
    };
    let speed = |draw: &mut Draw| match draw.below(12) {
        0..5 => 0.0,
        5..11 => draw.between(-9.0, 9.0) as f32,
        _ => draw.pick(&[60.0, -200.0]),
    };
    let place = [along(draw), along(draw)];
    let velocity = [speed(draw), speed(draw)];
    let radius = draw.pick(&[0.5, 0.5, 0.5, 0.3, 0.8, 0.0, 2.0]);
    let mut one = Particles::new(vec![place], vec![velocity], vec![radius], 1.0);
    one.masses[0] = draw.pick(&[1.0, 1.0, 2.0, 0.1, 100.0]);
    one.restitution[0] = draw.pick(&[1.0, 0.5, 0.3, 0.0]);
    one.movable[0] = !draw.one_in(8);
    if draw.one_in(2) {
        let velocity = if radius > 0.0 { draw.pick(&[0.0, 0.0, 3.0]) } else { 0.0 };
        one.spins = vec![Spin { friction: draw.pick(&[0.0, 0.4, 1.0]), velocity, angle: 0.0 }];
    }
    if draw.one_in(5) {
        one.filters = vec![Filter { category: draw.pick(&[1, 2]), mask: draw.bits() }];
    }
    if draw.one_in(12) {
        one.sensors = vec![true];
    }
    one.kinds = vec![u8::from(radius > 0.5) + u8::from(one.masses[0] > 1.0)];
    one.simplify();
    one
}

pub fn draw_wall(draw: &mut Draw) -> Wall {
    let mut point = || [draw.below(11) as f32, draw.below(11) as f32];
    let (a, mut b) = (point(), point());
    b[0] += if a == b { 1.0 } else { 0.0 };
    let velocity = draw.pick(&[[0.0; 2], [0.0; 2], [1.0, -2.0]]);
    Wall { velocity, surface: draw_surface(draw), ..Wall::new([a, b]) }
}

fn draw_surface(draw: &mut Draw) -> Surface {
    let mut one = || draw.pick(&[None, Some(0.5)]);
    Surface { restitution: one(), friction: one() }
}

#[test]
fn a_world_is_its_model_however_it_is_computed() {
    run::<WorldCase>(150);
}
