//! Merging of particles that touch.
//!
//! During a step they pass through each other, and every sub-step notes which of
//! them met: those whose straight ways came nearer than their radii. When the step
//! ends, everything that hangs together by such meetings becomes one particle, and
//! where that makes new ones touch, they follow, for a few rounds.

use super::World;
use crate::container::Container;
use crate::groups::Groups;
use crate::motion::Motions;
use crate::parallel;
use crate::particles::{FARTHEST, MASS_RANGE, Particles};

/// Rounds in which what merges makes others touch; the next step goes on from there.
const ROUNDS: usize = 16;

/// Two places that may meet during a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meeting {
    places: [u32; 2],
    /// The first, moved by minus this, is the one that is meant (torus).
    image: [f32; 2],
    /// Sum of the radii.
    reach: f32,
    happened: bool,
}

/// Lists the meetings to watch for.
pub(super) fn expect(
    lists: &[([f32; 2], Vec<[u32; 2]>)],
    all: &Particles,
    meetings: &mut Vec<Meeting>,
) {
    meetings.clear();
    for (image, pairs) in lists {
        for &places in pairs {
            let [a, b] = places.map(|place| place as usize);
            if all.movable[a] || all.movable[b] {
                let reach = all.radii[a] + all.radii[b];
                meetings.push(Meeting { places, image: *image, reach, happened: false });
            }
        }
    }
}

/// Notes who met during a sub-step that has just ended.
pub(super) fn note(meetings: &mut [Meeting], motions: &Motions, threads: Option<usize>) {
    parallel::for_chunks(threads, meetings, |_, chunk| {
        chunk.iter_mut().for_each(|meeting| meeting.happened |= met(meeting, motions));
    });
}

fn met(meeting: &Meeting, motions: &Motions) -> bool {
    let both = |f: fn(&Motions, u32) -> [f32; 2]| {
        let [a, b] = meeting.places.map(|place| f(motions, place).map(f64::from));
        [b[0] - a[0], b[1] - a[1]]
    };
    let (offset, way) = (both(Motions::position), both(Motions::travel));
    let end = [0, 1].map(|k| offset[k] + f64::from(meeting.image[k]));
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    // Going back from the end, where are they nearest?
    let back = if dot(way, way) > 0.0 { dot(end, way) / dot(way, way) } else { 0.0 };
    let back = back.clamp(0.0, 1.0);
    let nearest = [0, 1].map(|k| end[k] - way[k] * back);
    let reach = f64::from(meeting.reach);
    dot(nearest, nearest) < reach * reach
}

impl World {
    /// Makes one of those who met, and of those whom that makes touch.
    pub(super) fn merge(&mut self) {
        let meetings = std::mem::take(&mut self.memory.meetings);
        let happened = meetings.iter().filter(|meeting| meeting.happened);
        let mut touching: Vec<[u32; 2]> = happened.map(|meeting| meeting.places).collect();
        self.memory.meetings = meetings;
        for _ in 0..ROUNDS {
            if touching.is_empty() || !self.merge_touching(&touching) {
                return;
            }
            // Too many pairs to list are left to the next step, which says so.
            let Ok((overlaps, tests)) = self.overlapping() else { return };
            self.stats.tests += tests;
            touching = overlaps.into_iter().map(|overlap| overlap.places).collect();
        }
    }

    /// Merges what hangs together by these pairs of places; returns whether anything did.
    fn merge_touching(&mut self, touching: &[[u32; 2]]) -> bool {
        let mut groups = Groups::default();
        groups.reset(self.len());
        touching.iter().for_each(|&[a, b]| groups.join(a, b));
        let mut members: Vec<[u32; 2]> =
            touching.iter().flatten().map(|&place| [groups.root(place), place]).collect();
        members.sort_unstable();
        members.dedup();
        // Whose row each row becomes: a survivor has the first of its group.
        let mut heirs: Vec<u32> = (0..self.len() as u32).collect();
        let mut any = false;
        for group in members.chunk_by(|a, b| a[0] == b[0]) {
            let places: Vec<usize> = group.iter().map(|&[_, place]| place as usize).collect();
            let Some(one) = union(&self.particles, &places, &self.settings.container) else {
                continue;
            };
            any = true;
            self.particles.put(places[0], &one);
            self.wall_pushes[places[0]] = Default::default();
            let rows = places.iter().map(|&place| self.rows[place]);
            let first = rows.clone().fold(u32::MAX, u32::min);
            rows.for_each(|row| heirs[row as usize] = first);
            // The union stands in the first place, which comes from the state, whatever its row.
            let holder = places.iter().position(|&place| self.rows[place] == first).unwrap_or(0);
            self.rows.swap(places[0], places[holder]);
        }
        if any {
            self.close_up(&heirs);
        }
        any
    }

    /// Removes the rows that are not their own heirs.
    fn close_up(&mut self, heirs: &[u32]) {
        let gone: Vec<bool> = heirs.iter().zip(0..).map(|(&heir, row)| heir != row).collect();
        let shifted = self.take_out(&gone);
        let moved: Vec<Option<u32>> =
            heirs.iter().map(|&heir| Some(shifted[heir as usize])).collect();
        crate::forces::follow(&mut self.forces, &moved);
        self.renumbered = Some(match self.renumbered.take() {
            None => moved,
            Some(before) => before.iter().map(|row| moved[(*row)? as usize]).collect(),
        });
    }
}

/// The particle that these become: their area, mass and momentum at their centre of mass.
/// None if there could be no such particle in this container.
fn union(all: &Particles, places: &[usize], container: &Container) -> Option<Particles> {
    let origin = all.positions[places[0]].map(f64::from);
    let mut mass = 0.0f64;
    let mut square = 0.0f64;
    let mut bounce = 0.0f64;
    let mut moment = [0.0f64; 2];
    let mut momentum = [0.0f64; 2];
    for &place in places {
        let own = f64::from(all.masses[place]);
        let radius = f64::from(all.radii[place]);
        let offset = [0, 1].map(|k| f64::from(all.positions[place][k]) - origin[k]);
        let offset = container.short_way(offset);
        mass += own;
        square += radius * radius;
        bounce += own * f64::from(all.restitutions[place]);
        moment = [0, 1].map(|k| moment[k] + own * offset[k]);
        momentum = [0, 1].map(|k| momentum[k] + own * f64::from(all.velocities[place][k]));
    }
    let (whole, radius) = (mass as f32, square.sqrt() as f32);
    if !(whole <= MASS_RANGE[1] && radius <= FARTHEST && container.check_fit(&[radius]).is_ok()) {
        return None;
    }
    // What cannot be moved holds the others: the heaviest where there are several.
    let anchors = places.iter().filter(|&&place| !all.movable[place]);
    let anchor = anchors
        .copied()
        .reduce(|best, next| if all.masses[next] > all.masses[best] { next } else { best });
    let (position, velocity) = match anchor {
        Some(place) => (all.positions[place], [0.0; 2]),
        None => {
            let center = [0, 1].map(|k| (origin[k] + moment[k] / mass) as f32);
            let limit = |speed: f64| (speed as f32).clamp(-FARTHEST, FARTHEST);
            // By the mass as rounded, so that the momentum is right.
            let inside = container.wrap(container.clamp(center, radius));
            (inside, momentum.map(|p| limit(p / f64::from(whole))))
        }
    };
    Some(Particles {
        positions: vec![position],
        velocities: vec![velocity],
        radii: vec![radius],
        masses: vec![whole],
        restitutions: vec![((bounce / mass) as f32).clamp(0.0, 1.0)],
        movable: vec![anchor.is_none()],
    })
}
