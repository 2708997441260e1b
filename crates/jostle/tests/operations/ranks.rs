//! The same operations on one world and on a distributed one, whose ranks are threads.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};

use super::driver::{Case, Draw, run};
use super::world::{draw_particle, draw_particles, draw_resting, draw_settings, draw_wall};
use crate::common::ranks::ranks;
use crate::common::worlds::boxed;
use jostle_base::{Id, Result};
use jostle_index::Each;
use jostle_scenes::STEP;
use jostle_world::forces::{Andersen, Flocking, ThermalWalls, Thermostat, WallIds};
use jostle_world::ranks;
use jostle_world::ranks::{put_record, read_records};
use jostle_world::{Changes, Influence, OnTouch, Particles, World, WorldSettings};

/// What a rank does: it gets its number and its part of the world, and may answer with bytes.
type Task = Arc<dyn Fn(usize, &mut World) -> Result<Vec<u8>> + Send + Sync>;

/// A thread with a part of the world.
struct Rank {
    tasks: Sender<Task>,
    answers: Receiver<Result<Vec<u8>>>,
    thread: Option<JoinHandle<()>>,
}

struct RanksCase {
    whole: World,
    ranks: Vec<Rank>,
}

impl Case for RanksCase {
    fn new(draw: &mut Draw) -> Self {
        let mut settings = draw_settings(draw);
        // The parts have no list of events of their own.
        settings.track_events = false;
        // In every other case all sleep before the first operation.
        let sleeps = draw.one_in(2);
        let all = if sleeps { draw_resting(draw, 6) } else { draw_particles(draw, 30) };
        if sleeps {
            let (gravity, container) = ([0.0, -9.8], boxed([0.0; 2], [10.0; 2]));
            let (sleeping, on_touch) = (true, OnTouch::Bounce);
            settings = WorldSettings { gravity, container, sleeping, on_touch, ..settings };
        }
        let size = draw.pick(&[2, 2, 3]);
        draw.say("new", (size, settings, &all));
        let whole = World::new(all.clone(), settings).expect("valid");
        let start = |(rank, communicator)| {
            let (tasks, waiting) = channel::<Task>();
            let (done, answers) = channel();
            let rows: Vec<u32> = (rank as u32..all.len() as u32).step_by(size).collect();
            let mut own = Particles::default();
            own.gather(&all, &rows, None);
            let ids = rows.into_iter().map(Id::from).collect();
            let work = move || {
                let mut world = World::new(own, settings).expect("valid");
                ranks::distribute(&mut world, Box::new(communicator), ids)
                    .expect("all ranks are there");
                while let Ok(task) = waiting.recv() {
                    _ = done.send(task(rank, &mut world));
                }
            };
            Rank { tasks, answers, thread: Some(thread::spawn(work)) }
        };
        let ranks = ranks(size).into_iter().enumerate().map(start).collect();
        let mut case = Self { whole, ranks };
        if sleeps {
            case.each(|world| world.step(STEP, 60));
        }
        case
    }

    fn operate(&mut self, draw: &mut Draw) {
        match draw.below(12) {
            0 => self.add(draw),
            1 => self.remove(draw),
            2..4 => self.set(draw),
            4 => self.accelerate(draw),
            5 => self.set_walls(draw),
            6 => self.set_forces(draw),
            7 => self.configure(draw),
            8 => self.rebalance(draw),
            _ => self.step(draw),
        }
        self.compare();
    }
}

impl RanksCase {
    /// Gives all ranks the same task; returns their answers.
    fn all_ranks(
        &self,
        task: impl Fn(usize, &mut World) -> Result<Vec<u8>> + Send + Sync + 'static,
    ) -> Vec<Result<Vec<u8>>> {
        let task: Task = Arc::new(task);
        for rank in &self.ranks {
            rank.tasks.send(task.clone()).expect("the rank waits for a task");
        }
        self.ranks.iter().map(|rank| rank.answers.recv().expect("the rank answers")).collect()
    }

    /// Makes an operation on the whole and on all parts, which either all do or all refuse.
    fn each(&mut self, act: impl Fn(&mut World) -> Result<()> + Send + Sync + 'static) -> bool {
        let act = Arc::new(act);
        let result = act(&mut self.whole);
        let answers = self.all_ranks(move |_, world| act(world).map(|()| Vec::new()));
        let all_do = answers.iter().all(|answer| answer.is_ok() == result.is_ok());
        assert!(all_do, "{result:?} {answers:?}");
        result.is_ok()
    }

    fn add(&mut self, draw: &mut Draw) {
        let new = draw_particles(draw, 5);
        draw.say("add", &new);
        let ids = self.whole.add(new.clone()).expect("valid");
        let (size, count) = (self.ranks.len(), new.len());
        let answers = self.all_ranks(move |rank, world| {
            let own = count * rank / size..count * (rank + 1) / size;
            let (mut records, mut given) = (Vec::new(), Vec::new());
            for row in own {
                let id = ids.start + row as Id;
                put_record(&mut records, id, &new, row);
                given.push(id);
            }
            ranks::add(world, records, &given, count)?;
            ranks::agree_on_losses(world)?;
            Ok(Vec::new())
        });
        assert!(answers.iter().all(Result::is_ok), "{answers:?}");
    }

    fn remove(&mut self, draw: &mut Draw) {
        let ids = draw.subset(&self.whole.bodies().ids().unwrap(), 4);
        draw.say("remove", &ids);
        self.whole.remove(&ids).expect("they are there");
        let answers = self.all_ranks(move |_, world| {
            ranks::remove(world, &ids)?;
            ranks::agree_on_losses(world)?;
            Ok(Vec::new())
        });
        assert!(answers.iter().all(Result::is_ok), "{answers:?}");
    }

    fn set(&mut self, draw: &mut Draw) {
        let ids = draw.subset(&self.whole.bodies().ids().unwrap(), 5);
        let (which, new) =
            (draw.below(5), ids.iter().map(|_| draw_particle(draw)).collect::<Vec<_>>());
        draw.say("set", (&ids, which, &new));
        let changes = move |rows: &[usize]| {
            let mut changes = Changes::default();
            let vectors = |of: fn(&Particles) -> [f32; 2]| {
                Some(Each::Rows(rows.iter().map(|&row| of(&new[row])).collect()))
            };
            let numbers = |of: fn(&Particles) -> f32| {
                Some(Each::Rows(rows.iter().map(|&row| of(&new[row])).collect()))
            };
            match which {
                0 => changes.positions = vectors(|one| one.positions[0]),
                1 => changes.velocities = vectors(|one| one.velocities[0]),
                2 => changes.radii = numbers(|one| one.radii[0]),
                3 => changes.restitution = numbers(|one| one.restitution[0]),
                _ => changes.friction = numbers(|one| one.spin(0).friction),
            }
            changes
        };
        let all: Vec<usize> = (0..ids.len()).collect();
        self.whole.set(&ids, &changes(&all)).expect("valid");
        let answers = self.all_ranks(move |_, world| {
            let own = ranks::own_ids(world).unwrap().0;
            let here = |id: &Id| own.iter().position(|other| other == id);
            let rows: Vec<usize> =
                (0..ids.len()).filter(|&row| here(&ids[row]).is_some()).collect();
            // In a part, rows have the numbers that ids have in a whole world.
            let named: Vec<Id> =
                rows.iter().filter_map(|&row| here(&ids[row])).map(|row| row as Id).collect();
            world.set(&named, &changes(&rows))?;
            ranks::agree_on_losses(world)?;
            Ok(Vec::new())
        });
        assert!(answers.iter().all(Result::is_ok), "{answers:?}");
    }

    fn accelerate(&mut self, draw: &mut Draw) {
        let by = draw.pick(&[0.0, 5.0, -30.0]);
        draw.say("accelerate", by);
        self.each(move |world| {
            ranks::drop_ghosts(world);
            let of = |id: Id| if id % 3 == 0 { [by, 1.0] } else { [0.0; 2] };
            let all = ranks::own_ids(world).unwrap().0.into_iter().map(of).collect();
            world.set_accelerations(all)
        });
    }

    fn set_walls(&mut self, draw: &mut Draw) {
        let walls = draw.some(3, draw_wall);
        draw.say("set_walls", &walls);
        self.each(move |world| world.set_walls(walls.clone()));
    }

    fn set_forces(&mut self, draw: &mut Draw) {
        let seed = draw.below(9) as u32;
        let force = match draw.below(5) {
            0 => Some(Influence::Thermostat(Thermostat { speed: 2.0, rate: 0.5 })),
            1 => Some(Influence::Andersen(Andersen { temperature: 2.0, rate: 3.0, seed })),
            2 => Some(Influence::ThermalWalls(ThermalWalls {
                temperature: 2.0,
                sides: [true; 5],
                walls: WallIds::default(),
                seed,
            })),
            3 => Some(Influence::Flocking(Flocking {
                cutoff: 1.5,
                separation: 2.0,
                alignment: 1.0,
                cohesion: 0.5,
                max_speed: 9.0,
                min_speed: 0.0,
            })),
            _ => None,
        };
        draw.say("set_forces", &force);
        self.each(move |world| world.set_forces(force.iter().cloned().collect()));
    }

    fn configure(&mut self, draw: &mut Draw) {
        let new = draw_settings(draw);
        let mut settings = *self.whole.settings();
        (settings.gravity, settings.sides) = (new.gravity, new.sides);
        (settings.drag, settings.sleeping) = (new.drag, new.sleeping);
        draw.say("configure", settings);
        self.each(move |world| {
            world.configure(settings)?;
            ranks::agree_on_losses(world)
        });
    }

    fn rebalance(&mut self, draw: &mut Draw) {
        let steps = 1 + draw.below(3) as u64;
        draw.say("rebalance_every", steps);
        self.all_ranks(move |_, world| {
            ranks::rebalance_every(world, steps);
            Ok(Vec::new())
        });
    }

    fn step(&mut self, draw: &mut Draw) {
        let steps = draw.pick(&[1, 2, 3, 20]);
        let dt = draw.pick(&[STEP, STEP, 0.05]);
        draw.say("step", (dt, steps));
        for _ in 0..steps {
            if !self.each(move |world| world.step(dt, 1)) {
                break;
            }
        }
    }

    /// All parts together have the particles of the whole.
    fn compare(&self) {
        let parts = self.all_ranks(|_, world| Ok(ranks::own_records(world).unwrap()));
        let mut found: Vec<(Id, Particles)> = Vec::new();
        for bytes in parts {
            let (own, ids) = read_records(&bytes.expect("they are read"));
            for (row, id) in ids.into_iter().enumerate() {
                let mut one = Particles::default();
                one.push(&own, row);
                one.simplify();
                found.push((id, one));
            }
        }
        found.sort_by_key(|of| of.0);
        let mut all = Particles::default();
        found.iter().for_each(|(_, one)| all.extend(one));
        all.simplify();
        assert!(found.iter().map(|of| of.0).eq(self.whole.bodies().ids().unwrap()));
        assert_eq!(all, self.whole.bodies().particles().unwrap());
    }
}

impl Drop for RanksCase {
    /// Waits for the threads.
    fn drop(&mut self) {
        for rank in self.ranks.drain(..) {
            drop(rank.tasks);
            _ = rank.thread.map(JoinHandle::join);
        }
    }
}

#[test]
fn ranks_are_one_world() {
    run::<RanksCase>(12);
}
