//! What touched during the last step, and with which impulses.

use super::{OnTouch, World};
use crate::contacts::Contact;
use crate::error::Result;
use crate::motion::exact;
use crate::resting::WallPush;
use crate::space::Id;
use crate::trajectory::wall_normal;
use crate::walls::FIRST;

/// Two particles that touched during the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Their ids, the smaller first.
    pub pair: [Id; 2],
    /// Unit vector from the first to the second.
    pub normal: [f32; 2],
    /// Penetration at the end of the step; negative if they had separated.
    pub depth: f32,
    /// Sum of the impulses of the step on the second along the normal.
    pub normal_impulse: f32,
    /// Sum of those along the normal after a quarter turn from +x to +y.
    pub friction_impulse: f32,
}

/// A particle and a wall that gave it an impulse during the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallTouch {
    /// The id of the particle.
    pub id: Id,
    /// The number of the wall: 0 to 3 at min x, max x, min y and max y of a box; 0 of a circle;
    /// 4 + k of the wall k of [`World::walls`].
    pub wall: u32,
    /// Unit vector from the wall into the container.
    pub normal: [f32; 2],
    /// Penetration at the end of the step; negative if they had separated.
    pub depth: f32,
    /// As for [`Touch`], on the particle.
    pub normal_impulse: f32,
    /// As for [`Touch`], on the particle.
    pub friction_impulse: f32,
}

/// The impulses that a wall gave to a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct WallImpulse {
    pub(super) row: u32,
    pub(super) wall: u32,
    /// Along the normal, and of friction.
    pub(super) impulses: [f32; 2],
    /// Those over mass of the last sub-step, at rest; only of walls that are not the container's.
    pub(super) pushes: [f32; 2],
}

/// Sorts the impulses of a step, and adds up those of the same particle and wall.
pub(super) fn add_up(all: &mut Vec<WallImpulse>) {
    // Sums depend on the order, so equal numbers decide the rest.
    all.sort_unstable_by_key(|of| (of.row, of.wall, of.impulses.map(f32::to_bits)));
    all.dedup_by(|next, sum| {
        let is_same = (next.row, next.wall) == (sum.row, sum.wall);
        if is_same {
            sum.impulses = [0, 1].map(|k| sum.impulses[k] + next.impulses[k]);
            sum.pushes = [0, 1].map(|k| sum.pushes[k] + next.pushes[k]);
        }
        is_same
    });
    all.retain(|of| of.impulses[0] > 0.0);
}

impl World {
    /// Adds the pushes of the last sub-step to the impulses of the step, for the next step.
    pub(super) fn keep_wall_pushes(&mut self) {
        let pushes = self.memory.wall_pushes.iter();
        self.wall_impulses.extend(pushes.map(|&WallPush { row, wall, pushes }| WallImpulse {
            row,
            wall,
            impulses: [0.0; 2],
            pushes,
        }));
    }

    /// The pairs that touched during the last step, in canonical order. Then the pairs of sleeping
    /// islands, as in the last step in which these were awake, in the order in which they fell
    /// asleep. If nothing bounces, those that overlap now; an error if there are too many.
    pub fn contacts(&self) -> Result<Vec<Touch>> {
        if self.settings.on_touch != OnTouch::Bounce {
            return self.overlaps();
        }
        let touch = |contact: &Contact, [i, j]: [u32; 2]| {
            let sign = if i < j { 1.0 } else { -1.0 };
            let normal = contact.normal.map(|v| v * sign);
            // If the two are exchanged, normal and impulse change their signs, and the sums do not.
            let [normal_impulse, friction_impulse] = contact.totals;
            let pair = [i.min(j), i.max(j)].map(|row| self.ids.of(row));
            Touch { pair, normal, depth: -contact.gap, normal_impulse, friction_impulse }
        };
        let row = |place: u32| self.rows[place as usize];
        let awake = self.contacts.touching().map(|of| touch(of, of.places.map(row)));
        let asleep = self.asleep.contacts().filter(|contact| contact.touched);
        Ok(awake.chain(asleep.map(|of| touch(of, of.places))).collect())
    }

    /// The particles to which walls gave an impulse during the last step, by id; sleeping ones as
    /// in the last step in which they were awake.
    pub fn wall_contacts(&self) -> Vec<WallTouch> {
        let (places, container) = (self.places(), &self.settings.container);
        let touch = |&WallImpulse { row, wall, impulses, .. }: &WallImpulse| {
            let place = places[row as usize] as usize;
            let (all, place) = match place.checked_sub(self.rows.len()) {
                None => (&self.particles, place),
                Some(at) => (&self.asleep.sleepers().particles, at),
            };
            let position = exact(all.positions[place], all.residuals[place]);
            let radius = f64::from(all.radii[place]);
            let (gap, normal) = if wall < FIRST {
                let gap = container.gaps(position, radius)[wall as usize]?;
                (gap, wall_normal(container, wall, position))
            } else {
                let contact = self.walls.nearest_contact(wall, position, [0.0; 2], radius);
                (contact.gap, contact.normal)
            };
            let normal = normal.map(|v| v as f32);
            let [normal_impulse, friction_impulse] = impulses;
            let depth = -gap as f32;
            let id = self.ids.of(row);
            Some(WallTouch { id, wall, normal, depth, normal_impulse, friction_impulse })
        };
        let all = self.wall_impulses.iter().chain(self.asleep.wall_impulses());
        let mut all: Vec<WallTouch> = all.filter_map(touch).collect();
        all.sort_by_key(|touch| (touch.id, touch.wall));
        all
    }
}
