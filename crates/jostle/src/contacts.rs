//! The pairs that may touch during a step, in the order in which they are
//! solved.
//!
//! Contacts of one colour share no movable particle, so they can be solved at
//! the same time and in any order with the same result. Colours are given out
//! greedily along the canonical order of the pairs, which comes from positions.

use crate::parallel;
use crate::particles::Particles;

/// Colours that a particle's contacts can be told apart by; the rest of a crowded
/// particle's contacts are solved one after the other.
const COLOURS: usize = 64;

/// Two particles that may touch during the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Places of the two particles in the world's order.
    pub places: [u32; 2],
    /// The first particle, moved by minus this, is the one that is meant (torus).
    pub image: [f32; 2],
    /// Sum of the radii.
    pub reach: f32,
    /// Share of the approach speed that a bounce gives back.
    pub restitution: f32,
    /// One over the masses; 0 for what cannot move.
    pub inverse_masses: [f32; 2],
    /// Unit vector from the first to the second.
    pub normal: [f32; 2],
    /// Distance from surface to surface; negative where they overlap.
    pub gap: f32,
    /// Momentum that holds the two apart at rest, carried from step to step.
    pub impulse: f32,
    /// Whether the two can rest on each other during this sub-step.
    pub leans: bool,
    /// Whether the two pushed each other during this step.
    pub touched: bool,
    /// Index in the canonical order.
    pub index: u32,
}

/// All contacts of a step.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// Sorted by colour, inside a colour in canonical order.
    pub list: Vec<Contact>,
    /// Ends of the colours in `list`; the last one is to be solved in sequence.
    ends: Vec<usize>,
    canonical: Vec<Contact>,
    colours: Vec<u8>,
    taken: Vec<u64>,
    previous: Previous,
}

/// Resting impulses of the last step, to start the next from.
#[derive(Clone, Debug, Default)]
struct Previous {
    /// `starts[place]..starts[place + 1]` are the contacts whose first is `place`.
    starts: Vec<u32>,
    seconds: Vec<u32>,
    impulses: Vec<f32>,
}

impl Previous {
    /// The impulse between two places of the previous order.
    fn impulse(&self, a: u32, b: u32) -> f32 {
        let (first, second) = (a.min(b) as usize, a.max(b));
        if first + 1 >= self.starts.len() {
            return 0.0;
        }
        let range = self.starts[first] as usize..self.starts[first + 1] as usize;
        let found = self.seconds[range.clone()].iter().position(|&other| other == second);
        found.map_or(0.0, |at| self.impulses[range.start + at])
    }
}

impl Contacts {
    /// Takes the pairs of a step, sorted, each with its torus image. `before` gives
    /// the place that each particle had in the previous step's order.
    pub fn collect(
        &mut self,
        pairs: impl Iterator<Item = ([u32; 2], [f32; 2])>,
        particles: &Particles,
        restitution: f32,
        before: &[u32],
    ) {
        self.canonical.clear();
        for ([a, b], image) in pairs {
            let (i, j) = (a as usize, b as usize);
            let inverse_masses = [particles.inverse_mass(i), particles.inverse_mass(j)];
            if inverse_masses == [0.0; 2] {
                continue;
            }
            let own = particles.restitutions[i] * particles.restitutions[j];
            let here = image == [0.0; 2];
            self.canonical.push(Contact {
                places: [a, b],
                image,
                reach: particles.radii[i] + particles.radii[j],
                restitution: restitution * own,
                inverse_masses,
                normal: [1.0, 0.0],
                gap: 0.0,
                impulse: if here { self.previous.impulse(before[i], before[j]) } else { 0.0 },
                leans: false,
                touched: false,
                index: self.canonical.len() as u32,
            });
        }
        self.colour(particles.len());
    }

    /// Drops the contacts of particles that are gone and renames the places of
    /// the others, which close up.
    pub fn retain(&mut self, keep: &[bool]) {
        let mut left = 0;
        let renamed: Vec<u32> = keep
            .iter()
            .map(|&kept| {
                left += u32::from(kept);
                left - u32::from(kept)
            })
            .collect();
        self.canonical.retain(|contact| contact.places.iter().all(|&place| keep[place as usize]));
        for contact in &mut self.canonical {
            contact.places = contact.places.map(|place| renamed[place as usize]);
        }
        self.index(left as usize);
    }

    /// Sorts the contacts by colour.
    fn colour(&mut self, places: usize) {
        self.taken.clear();
        self.taken.resize(places, 0);
        self.colours.clear();
        let mut counts = [0usize; COLOURS + 1];
        for contact in &self.canonical {
            let [a, b] = contact.places.map(|place| place as usize);
            let [movable_a, movable_b] = contact.inverse_masses.map(|m| m > 0.0);
            let mut taken = 0;
            if movable_a {
                taken |= self.taken[a];
            }
            if movable_b {
                taken |= self.taken[b];
            }
            let colour = taken.trailing_ones() as usize;
            if colour < COLOURS {
                self.taken[a] |= 1 << colour;
                self.taken[b] |= 1 << colour;
            }
            counts[colour] += 1;
            self.colours.push(colour as u8);
        }
        self.ends.clear();
        let mut sum = 0;
        let mut starts = counts.map(|count| {
            sum += count;
            self.ends.push(sum);
            sum - count
        });
        self.list.clear();
        self.list.extend_from_slice(&self.canonical);
        for (contact, &colour) in self.canonical.iter().zip(&self.colours) {
            self.list[starts[usize::from(colour)]] = *contact;
            starts[usize::from(colour)] += 1;
        }
    }

    /// Calls `act` on every contact, colour after colour.
    pub fn solve(&mut self, threads: Option<usize>, act: impl Fn(&mut Contact) + Sync + Send) {
        let mut start = 0;
        for (colour, &end) in self.ends.iter().enumerate() {
            let contacts = &mut self.list[start..end];
            start = end;
            if colour == COLOURS {
                contacts.iter_mut().for_each(&act);
            } else {
                parallel::for_chunks(threads, contacts, |_, chunk| chunk.iter_mut().for_each(&act));
            }
        }
    }

    /// Calls `act` on every contact, in any order; it may only write the contact.
    pub fn each(&mut self, threads: Option<usize>, act: impl Fn(&mut Contact) + Sync + Send) {
        parallel::for_chunks(threads, &mut self.list, |_, chunk| chunk.iter_mut().for_each(&act));
    }

    /// Keeps the resting impulses for the next step.
    pub fn remember(&mut self, places: usize) {
        for contact in &self.list {
            self.canonical[contact.index as usize] = *contact;
        }
        self.index(places);
    }

    /// Makes the resting impulses easy to find by place.
    fn index(&mut self, places: usize) {
        let Previous { starts, seconds, impulses } = &mut self.previous;
        starts.clear();
        starts.resize(places + 1, 0);
        seconds.clear();
        impulses.clear();
        for contact in &self.canonical {
            if contact.impulse > 0.0 && contact.image == [0.0; 2] {
                starts[contact.places[0] as usize + 1] += 1;
                seconds.push(contact.places[1]);
                impulses.push(contact.impulse);
            }
        }
        for place in 0..places {
            starts[place + 1] += starts[place];
        }
    }

    /// The contacts in canonical order, as the last step left them.
    pub fn touching(&self) -> impl Iterator<Item = &Contact> {
        self.canonical.iter().filter(|contact| contact.touched)
    }
}
