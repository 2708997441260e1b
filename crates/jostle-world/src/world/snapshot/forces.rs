//! Serialization of forces. They name particles by rows.

use std::sync::Arc;

use crate::forces::{
    Andersen, Attractor, Flocking, Force, Gravitation, Law, Motor, PairForce, PairTable, Pole,
    Spring, Springs, ThermalWalls, Thermostat,
};
use jostle_base::bytes::{Reader, Writer, damaged};
use jostle_base::error::Result;
use jostle_base::ids::Id;

/// The number of `ThermalWalls` with walls that are not sides of the container.
const WITH_WALLS: u8 = 20;

pub(super) fn put_force(to: &mut Writer, force: &Force) {
    match force {
        Force::Attractor(Attractor { pole, strength, law }) => {
            to.put(0u8);
            match *pole {
                Pole::Point(point) => {
                    to.put(0u8);
                    to.put(point);
                }
                Pole::Particle(row) => {
                    to.put(1u8);
                    to.put(row as u32);
                }
            }
            to.put(*strength);
            to.put(u8::from(*law == Law::InverseSquare));
        }
        Force::Gravitation(Gravitation { g, softening, theta }) => {
            to.put(1u8);
            to.put([*g, *softening, *theta]);
        }
        Force::Springs(Springs(springs)) => {
            to.put(2u8);
            to.put_count(springs.len());
            for spring in springs {
                to.put(spring.pair.map(|row| row as u32));
                to.put([spring.length, spring.stiffness, spring.damping, spring.max_stretch]);
            }
        }
        Force::Thermostat(Thermostat { speed, rate }) => {
            to.put(3u8);
            to.put([*speed, *rate]);
        }
        Force::ThermalWalls(ThermalWalls { temperature, sides, walls, seed }) => {
            // Without walls as in older snapshots.
            to.put(if walls.is_empty() { 4u8 } else { WITH_WALLS });
            to.put(*temperature);
            to.put(sides.map(u8::from));
            to.put(*seed);
            if !walls.is_empty() {
                to.put_count(walls.len());
                walls.iter().for_each(|&wall| to.put(wall));
            }
        }
        Force::Andersen(Andersen { temperature, rate, seed }) => {
            to.put(5u8);
            to.put([*temperature, *rate]);
            to.put(*seed);
        }
        Force::Motor(Motor { ids, walls, center, angular_velocity, velocity, period }) => {
            to.put(6u8);
            to.put_count(ids.len());
            ids.iter().for_each(|&row| to.put(row as u32));
            to.put_count(walls.len());
            walls.iter().for_each(|&wall| to.put(wall));
            to.put([*center, *velocity]);
            to.put([*angular_velocity, *period]);
        }
        Force::Pair(PairForce { table }) => {
            to.put(7u8);
            to.put_count(table.kinds());
            to.put([table.cutoff(), table.damping()]);
            to.put_count(table.values().len());
            to.put_all(table.values());
        }
        Force::Flocking(flocking) => {
            let Flocking { cutoff, separation, alignment, cohesion, max_speed, min_speed } =
                *flocking;
            to.put(8u8);
            to.put([cutoff, separation, alignment]);
            to.put([cohesion, max_speed, min_speed]);
        }
    }
}

pub(super) fn get_force(from: &mut Reader<'_>) -> Result<Force> {
    Ok(match from.get()? {
        0u8 => {
            let pole = match from.get()? {
                0u8 => Pole::Point(from.get()?),
                _ => Pole::Particle(from.get::<u32>()?.into()),
            };
            let strength = from.get()?;
            let law = if from.get::<u8>()? > 0 { Law::InverseSquare } else { Law::Harmonic };
            Force::Attractor(Attractor { pole, strength, law })
        }
        1 => {
            let [g, softening, theta] = from.get()?;
            Force::Gravitation(Gravitation { g, softening, theta })
        }
        2 => {
            let mut springs = Vec::new();
            for _ in 0..from.get_count()? {
                let pair = from.get::<[u32; 2]>()?.map(Id::from);
                let [length, stiffness, damping, max_stretch] = from.get()?;
                springs.push(Spring { pair, length, stiffness, damping, max_stretch });
            }
            Force::Springs(Springs(springs))
        }
        3 => {
            let [speed, rate] = from.get()?;
            Force::Thermostat(Thermostat { speed, rate })
        }
        kind @ (4 | WITH_WALLS) => {
            let (temperature, sides, seed) = (from.get()?, from.get::<[u8; 4]>()?, from.get()?);
            let sides = sides.map(|side| side > 0);
            let count = if kind == WITH_WALLS { from.get_count()? } else { 0 };
            let walls = from.get_all(count)?;
            Force::ThermalWalls(ThermalWalls { temperature, sides, walls, seed })
        }
        5 => {
            let ([temperature, rate], seed) = (from.get()?, from.get()?);
            Force::Andersen(Andersen { temperature, rate, seed })
        }
        6 => {
            let count = from.get_count()?;
            let ids = from.get_all::<u32>(count)?.into_iter().map(Id::from).collect();
            let count = from.get_count()?;
            let walls = from.get_all(count)?;
            let [center, velocity] = from.get()?;
            let [angular_velocity, period] = from.get()?;
            Force::Motor(Motor { ids, walls, center, angular_velocity, velocity, period })
        }
        7 => {
            let (kind_count, [cutoff, damping]) = (from.get_count()?, from.get()?);
            let count = from.get_count()?;
            let table = PairTable::new(kind_count, from.get_all(count)?, cutoff, damping);
            let table = table.map_err(|error| damaged(&error.to_string()))?;
            Force::Pair(PairForce { table: Arc::new(table) })
        }
        8 => {
            let ([cutoff, separation, alignment], [cohesion, max_speed, min_speed]) =
                (from.get()?, from.get()?);
            let flocking =
                Flocking { cutoff, separation, alignment, cohesion, max_speed, min_speed };
            Force::Flocking(flocking)
        }
        _ => return Err(damaged("there is no such force")),
    })
}
