//! What one process that has the whole world does at the points at which several exchange messages.

use super::World;
use super::distribution::{Distribution, Protocol};
use super::islands::wake::{wake, wake_changed, wake_driven, wake_every_island};
use super::merge::merge_touching;
use super::touching::known_touches_asleep;
use crate::halo::Alone;
use jostle_base::error::Result;
use jostle_base::ids::Id;

impl Distribution for Alone {
    fn protocol(&self) -> &'static dyn Protocol {
        &Alone
    }
}

impl Protocol for Alone {
    fn merge_islands(&self, world: &mut World, touching: &[[u32; 2]]) -> Result<bool> {
        merge_touching(world, touching)
    }

    fn wake_touched(&self, world: &mut World, touched: &[u32], all: bool) -> Result<()> {
        if all {
            wake_every_island(world);
        } else {
            wake(world, touched);
        }
        Ok(())
    }

    fn wake_edited(&self, world: &mut World, driven: &mut [u32], changed: &[u32]) -> Result<()> {
        wake_driven(world, driven);
        wake_changed(world, changed);
        Ok(())
    }

    fn touching_asleep(&self, world: &World) -> Vec<[Id; 2]> {
        known_touches_asleep(&world.bodies, &world.record)
    }
}

impl Default for Box<dyn Distribution> {
    fn default() -> Self {
        Box::new(Alone)
    }
}
