//! What one process that has the whole world does at the points at which several exchange messages.

use super::bodies::asleep::Sleepers;
use super::bodies::discs::Discs;
use super::distribution::{Agreed, Agreement, Distribution, Protocol};
use super::islands::wake::{
    cancel_waking, forget_woken, wake, wake_changed, wake_driven, wake_every_island,
};
use super::merge::merge_touching;
use super::record::Touched;
use super::touching::known_touches_asleep;
use super::{World, WorldSettings};
use crate::contacts::{Contact, ContactShape};
use crate::halo::Alone;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_index::pairs::JoinScratch;
use jostle_index::quadtree::Quadtree;

impl Distribution for Alone {
    fn protocol(&self) -> &'static dyn Protocol {
        &Alone
    }

    fn is_whole(&self) -> bool {
        true
    }

    fn own_rows(&self) -> u32 {
        u32::MAX
    }

    fn ids(&self) -> &[Id] {
        &[]
    }

    fn agreed(&self) -> Option<Agreed> {
        None
    }

    fn take_extent(&mut self) -> Option<[[f32; 2]; 2]> {
        None
    }

    fn fail(&self) {}

    fn forget_domains(&mut self) {}

    fn touch_others(
        &mut self,
        _circles: &Quadtree<f32>,
        _radius: &dyn Fn(u32) -> Option<f32>,
        _settings: &WorldSettings,
        _scratch: &mut JoinScratch,
    ) -> Result<bool> {
        Ok(false)
    }

    fn keep_contacts(&mut self, _: &Sleepers, _: &[(u32, Contact)], _: &Discs) -> Result<bool> {
        Ok(false)
    }
}

impl Protocol for Alone {
    fn guard(
        &self,
        world: &mut World,
        step: &mut dyn FnMut(&mut World) -> Result<()>,
    ) -> Result<()> {
        step(world)
    }

    fn begin_step(&self, _: &mut World) {}

    fn migrate(&self, _: &mut World) -> Result<bool> {
        Ok(true)
    }

    fn gather(&self, _: &mut World, _dt: f32) -> Result<()> {
        Ok(())
    }

    fn renew(&self, _: &mut World, _dt: f32) -> Result<()> {
        Ok(())
    }

    fn begin_part(&self, _: &mut World) {}

    fn share_accelerations(&self, _: &mut World) -> Result<()> {
        Ok(())
    }

    fn agree_on_order(
        &self,
        _: &mut World,
        own: ContactShape,
        refinement: usize,
    ) -> Result<(ContactShape, usize)> {
        Ok((own, refinement))
    }

    fn limit(&self, _: &mut World) -> Result<()> {
        Ok(())
    }

    fn end_part(&self, _: &mut World) {}

    fn merge_islands(&self, world: &mut World, touching: &[[u32; 2]]) -> Result<bool> {
        merge_touching(world, touching)
    }

    fn gather_near(&self, _: &mut World) -> Result<()> {
        Ok(())
    }

    fn compare(&self, _: &mut World, _meets_sleepers: bool) -> Result<Agreement> {
        Ok(Agreement::Same)
    }

    fn end_step(&self, _: &mut World) {}

    fn undo(&self, _: &mut World) {}

    fn widen(&self, _: &mut World, _: Agreement, _dt: f64) -> Result<()> {
        Ok(())
    }

    fn give_up(&self, _: &mut World) {}

    fn wake_touched(&self, world: &mut World, touched: &[u32], all: bool) -> Result<()> {
        if all { wake_every_island(world) } else { wake(world, touched) }
    }

    fn wake_edited(&self, world: &mut World, driven: &mut [u32], changed: &[u32]) -> Result<()> {
        // All wake or none.
        let woken = wake_driven(world, driven).and_then(|()| wake_changed(world, changed));
        match woken {
            Err(_) => cancel_waking(world),
            Ok(()) if world.bodies.asleep.woken_rows().next().is_some() => forget_woken(world),
            Ok(()) => {}
        }
        woken
    }

    fn recall_contacts(&self, _: &mut World, _islands: &[u32]) -> Result<()> {
        Ok(())
    }

    fn drop_contacts(&self, _: &mut World) {}

    fn join_islands(&self, _: &mut World) -> Result<()> {
        Ok(())
    }

    fn keep_pairs(&self, _: &mut World) -> Result<()> {
        Ok(())
    }

    fn touching_asleep(&self, world: &World) -> Result<Vec<Touched>> {
        known_touches_asleep(&world.bodies, &world.record)
    }
}

impl Default for Box<dyn Distribution> {
    fn default() -> Self {
        Box::new(Alone)
    }
}
