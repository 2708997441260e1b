//! All that acts on particles beside gravity, contacts and walls, as callers list it: forces, springs, motors and
//! thermostats. The list has a line for each.

use std::collections::HashSet;

use super::record::{Found, Gone, Record, Reference, Renamed};
use super::{
    Andersen, Attractor, Flocking, Force, ForceInput, Grab, Gravitation, Motor, PairForce,
    Partners, Pump, Scratch, Springs, ThermalWalls, Thermostat, bounded,
};
use crate::container::Container;
use crate::particles::check_kinds_of_table;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::saved;
use jostle_base::{memory, parallel};

/// What an influence does, and so which part of a step reads it.
#[derive(Clone, Copy, Debug)]
pub enum Role<'a> {
    /// It accelerates particles, in the middle of each sub-step.
    Force(&'a dyn Force),
    /// It connects particles; a solver of its own integrates it in parts of a sub-step, or with contacts.
    Springs(&'a Springs),
    /// It prescribes the velocities of immovable particles and walls, before a step.
    Motor(&'a Motor),
    /// It changes the speed of particles that bounce off walls.
    Thermostat(&'a Thermostat),
    /// It draws new velocities of particles that bounce off some walls.
    ThermalWalls(&'a ThermalWalls),
    /// It draws new velocities of some particles, at the end of a step.
    Andersen(&'a Andersen),
    /// It moves particles from a drain to a nozzle, before a step.
    Pump(&'a Pump),
}

macro_rules! influences {
    ($($(#[$doc:meta])* $number:literal $name:ident($type:ty) as $role:ident, $noun:literal;)*) => {
        /// Something that acts on particles. It refers to them by id; within a world, by row.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Influence {
            $($(#[$doc])* $name($type),)*
        }

        saved! { enum Influence("force") { $($number => $name(own)),* } }

        impl Influence {
            /// Refuses numbers out of range.
            pub fn validate(&self) -> Result<()> {
                match self {
                    $(Self::$name(own) => own.validate(),)*
                }
            }

            /// What it does.
            pub fn role(&self) -> Role<'_> {
                match self {
                    $(Self::$name(own) => Role::$role(own),)*
                }
            }

            /// Its noun in errors.
            pub fn noun(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => $noun,)*
                }
            }

            fn list(&self, found: &mut Found<'_>) {
                match self {
                    $(Self::$name(own) => own.list(found),)*
                }
            }

            fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
                match self {
                    $(Self::$name(own) => own.renumber(renamed),)*
                }
            }

            fn forget_walls(&mut self, is_gone: &Gone<'_>) {
                match self {
                    $(Self::$name(own) => own.forget_walls(is_gone),)*
                }
            }
        }

        $(impl From<$type> for Influence {
            fn from(own: $type) -> Self {
                Self::$name(own)
            }
        })*
    };
}

influences! {
    /// Attraction to a point or to a particle.
    0 Attractor(Attractor) as Force, "an Attractor";
    /// Attraction between all particles.
    1 Gravitation(Gravitation) as Force, "Gravitation";
    /// Forces between kinds of particles within a cutoff.
    7 Pair(PairForce) as Force, "a PairForce";
    /// Separation, alignment and cohesion of neighbours.
    8 Flocking(Flocking) as Force, "Flocking";
    /// A force that brings one particle to a point.
    9 Grab(Grab) as Force, "a Grab";
    /// Springs between pairs of particles.
    2 Springs(Springs) as Springs, "Springs";
    /// A given motion of immovable particles and walls.
    6 Motor(Motor) as Motor, "a motor";
    /// Walls that heat or cool the particles that bounce off them.
    3 Thermostat(Thermostat) as Thermostat, "a Thermostat";
    /// Sides of the container and walls at a temperature.
    4 ThermalWalls(ThermalWalls) as ThermalWalls, "ThermalWalls";
    /// New velocities at random times (Andersen's thermostat).
    5 Andersen(Andersen) as Andersen, "an AndersenThermostat";
    /// Particles that leave through a drain start again at a nozzle.
    10 Pump(Pump) as Pump, "a Pump";
}

/// All influences of a world. There is one list, in the order in which the caller has given them, so that what is read
/// can be assigned back; what a part of the step reads are views of it, which cannot differ from it.
#[derive(Debug, Default, PartialEq)]
pub struct Influences {
    list: Vec<Influence>,
}

saved! { struct Influences { list } }

impl From<Vec<Influence>> for Influences {
    fn from(list: Vec<Influence>) -> Self {
        Self { list }
    }
}

/// Declares iterators over the influences of each role.
macro_rules! views {
    ($($(#[$doc:meta])* $name:ident: $role:ident($type:ty);)*) => {
        impl Influences {
            $($(#[$doc])*
            pub fn $name(&self) -> impl Iterator<Item = &$type> + Clone {
                self.list.iter().filter_map(|influence| match influence.role() {
                    Role::$role(own) => Some(own),
                    _ => None,
                })
            })*
        }
    };
}

views! {
    /// The forces.
    forces: Force(dyn Force);
    /// The springs.
    springs: Springs(Springs);
    /// The motors.
    motors: Motor(Motor);
    /// The thermostat, if there is one.
    thermostats: Thermostat(Thermostat);
    /// The thermal walls.
    thermal_walls: ThermalWalls(ThermalWalls);
    /// Andersen's thermostat, if there is one.
    andersen_thermostats: Andersen(Andersen);
    /// The pumps.
    pumps: Pump(Pump);
}

impl Influences {
    /// The list.
    pub fn list(&self) -> &[Influence] {
        &self.list
    }

    /// The list.
    pub fn into_list(self) -> Vec<Influence> {
        self.list
    }

    /// Replaces all by copies of `other`, in the memory that there is: a step copies springs to undo itself.
    pub fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.list.truncate(other.list.len());
        memory::reserve_len(&mut self.list, other.list.len())?;
        for (index, from) in other.list.iter().enumerate() {
            match (self.list.get_mut(index), from) {
                (Some(Influence::Springs(to)), Influence::Springs(from)) => {
                    memory::assign(&mut to.0, &from.0)?;
                }
                (to, Influence::Springs(from)) => {
                    let copy = Springs(memory::copy(&from.0)?).into();
                    match to {
                        Some(to) => *to = copy,
                        None => self.list.push(copy),
                    }
                }
                // Others are small.
                (Some(to), from) => to.clone_from(from),
                (None, from) => self.list.push(from.clone()),
            }
        }
        Ok(())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether any force accelerates particles.
    pub fn has_forces(&self) -> bool {
        self.forces().next().is_some()
    }

    /// Whether no force acts on all particles.
    pub fn are_short_ranged(&self) -> bool {
        self.forces().all(|force| force.partners() != Partners::All)
    }

    /// The largest cutoff of forces between neighbours; 0 without any.
    pub fn largest_cutoff(&self) -> f32 {
        self.forces().filter_map(|force| force.partners().cutoff()).fold(0.0, f32::max)
    }

    /// The particles that are grabbed.
    pub fn grabbed(&self) -> impl Iterator<Item = Id> + Clone {
        self.forces().filter_map(|force| match force.partners() {
            Partners::One(id) => Some(id),
            _ => None,
        })
    }

    /// Whether these differ from others by grabs at most.
    pub fn differ_by_grabs(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|all| {
            all.list.iter().filter(|influence| !matches!(influence, Influence::Grab(_)))
        });
        own.eq(others)
    }

    /// Whether any force or spring refers to particles, whose rows are then needed in the sub-steps. Motors only
    /// set velocities before a step.
    pub fn act_by_rows(&self) -> bool {
        let mut any = self.springs().any(|springs| !springs.0.is_empty());
        self.forces().for_each(|force| force.list(&mut |_| any = true));
        any
    }

    /// Renumbers particles. Attractors and springs of a removed particle are removed; motors no longer drive it.
    pub fn renumber(&mut self, renamed: impl Fn(Id) -> Option<Id>) {
        self.list.retain_mut(|influence| influence.renumber(&renamed));
    }

    /// Leaves out walls that are removed. Thermal walls of which none is left are removed.
    pub fn forget_walls(&mut self, is_gone: impl Fn(Id) -> bool) {
        self.list.retain_mut(|influence| {
            influence.forget_walls(&is_gone);
            !matches!(influence.role(), Role::ThermalWalls(walls) if !walls.has_any())
        });
    }

    /// Removes springs that are stretched too far.
    pub fn break_springs(&mut self, bodies: &ForceInput<'_>) {
        for influence in &mut self.list {
            if let Influence::Springs(springs) = influence {
                springs.break_stretched(bodies);
            }
        }
    }

    /// Writes the acceleration of each body by all forces within their limits. It is finite and does not depend on
    /// the order of the bodies.
    pub fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        scratch: &mut Scratch,
        accelerations: &mut Vec<[f32; 2]>,
    ) -> Result<()> {
        self.sum(bodies, scratch, accelerations)?;
        // Limits come last, because they depend on the sum of all forces.
        self.forces().for_each(|force| force.limit(bodies, accelerations));
        Ok(())
    }

    /// Writes the sum of the accelerations of each body by all forces, without the limits that are for a sub-step.
    pub fn sum(
        &self,
        bodies: &ForceInput<'_>,
        scratch: &mut Scratch,
        accelerations: &mut Vec<[f32; 2]>,
    ) -> Result<()> {
        accelerations.clear();
        memory::resize(accelerations, bodies.positions.len(), [0.0; 2])?;
        // Sorted once for all forces between neighbours.
        if self.forces().any(|force| force.partners().cutoff().is_some()) {
            scratch.neighbors.sort(bodies)?;
        }
        self.forces().try_for_each(|force| force.accelerate(bodies, scratch, accelerations))?;
        let threads = parallel::worthwhile(bodies.threads, bodies.positions.len());
        parallel::for_chunks(threads, accelerations, |_, chunk| {
            // Sums of valid forces may overflow or be NaN. A step relies on finite accelerations.
            chunk.iter_mut().for_each(|acceleration| *acceleration = acceleration.map(bounded));
        });
        Ok(())
    }

    /// Refuses invalid influences; `exists` returns whether the world has a particle.
    pub fn validate(&self, exists: impl Fn(Id) -> bool) -> Result<()> {
        let (mut thermostats, mut andersen_thermostats, mut known) = (0, 0, HashSet::new());
        for (index, influence) in self.list.iter().enumerate() {
            influence.validate()?;
            let refuse = |value: &str, rule: &str| Err(Error::at("forces", index, value, rule));
            let mut unknown = None;
            influence.list(&mut |reference| {
                if let Reference::Particle(id) = reference
                    && !exists(id)
                {
                    unknown.get_or_insert(id);
                }
            });
            if let Some(id) = unknown {
                let value = format!("a force on particle {id}");
                return Err(Error::missing("forces", index, value, "no particle has this id"));
            }
            match influence.role() {
                Role::Thermostat(_) => thermostats += 1,
                Role::Andersen(_) => andersen_thermostats += 1,
                Role::ThermalWalls(walls) => {
                    let sides = walls.side_names().into_iter().map(str::to_string);
                    let walls = walls.walls.0.iter().map(|wall| format!("wall {wall}"));
                    if let Some(of) = sides.chain(walls).find(|of| !known.insert(of.clone())) {
                        let rule = format!("{of} has a temperature already");
                        return refuse("another ThermalWalls", &rule);
                    }
                }
                Role::Force(_) | Role::Springs(_) | Role::Motor(_) | Role::Pump(_) => {}
            }
            if thermostats > 1 {
                return refuse("another Thermostat", "a world has one thermostat at most");
            }
            if andersen_thermostats > 1 {
                return refuse("another AndersenThermostat", "a world has one at most");
            }
        }
        Ok(())
    }

    /// Refuses kinds of particles that the table of a force does not have.
    pub fn check_kinds(&self, kinds: &[u8]) -> Result<()> {
        self.forces().try_for_each(|force| match force.partners() {
            Partners::All | Partners::One(_) => Ok(()),
            Partners::Neighbors { kinds: count, .. } => check_kinds_of_table(kinds, count),
        })
    }

    /// Refuses a torus on which forces between neighbours would act from two images of a particle.
    pub fn check_fit(&self, container: Container) -> Result<()> {
        let Container::Torus { size: [width, height] } = container else { return Ok(()) };
        // Within half of the shorter side each particle has one image.
        let most = 0.5 * width.min(height);
        for (index, influence) in self.list.iter().enumerate() {
            if let Role::Force(force) = influence.role()
                && let Some(cutoff) = force.partners().cutoff().filter(|&cutoff| cutoff > most)
            {
                let value = format!("a force with the cutoff {cutoff}");
                let rule =
                    format!("with a period of ({width}, {height}) a cutoff is at most {most}");
                return Err(Error::at("forces", index, value, &rule));
            }
        }
        Ok(())
    }

    /// Refuses thermal walls on sides that a container does not have.
    pub fn check_sides(&self, container: Container) -> Result<()> {
        for (index, influence) in self.list.iter().enumerate() {
            if let Role::ThermalWalls(walls) = influence.role()
                && let Some(rule) = walls.misfit(container)
            {
                let value = format!("ThermalWalls of {}", walls.side_names().join(", "));
                return Err(Error::at("forces", index, value, rule));
            }
        }
        Ok(())
    }

    /// Refuses influences that refer to walls which do not exist.
    pub fn check_walls(&self, exists: impl Fn(Id) -> bool) -> Result<()> {
        for (index, influence) in self.list.iter().enumerate() {
            let mut unknown = None;
            influence.list(&mut |reference| {
                if let Reference::Wall(wall) = reference
                    && !exists(wall)
                {
                    unknown.get_or_insert(wall);
                }
            });
            if let Some(wall) = unknown {
                let value = format!("{} of wall {wall}", influence.noun());
                return Err(Error::missing("forces", index, value, "no wall has this id"));
            }
        }
        Ok(())
    }
}
