//! Graph colouring of contacts: those of one colour share no particle that moves.
//!
//! Each contact has a priority, a hash of the state of its two particles, and takes the first colour
//! that no contact of higher priority at its particles has (M. T. Jones, P. E. Plassmann, *A Parallel
//! Graph Coloring Heuristic*, 1993). So the colour of a contact depends on a chain of contacts with
//! rising priorities, which is short, and not on contacts far away.

use super::COLOURS;
use crate::particles::Particles;

/// Cells in a sum of radii in which positions are rounded before they are hashed, so that contacts of
/// particles at rest keep their priorities.
const CELLS: f32 = 8.0;

/// A contact to be coloured.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// The places of its particles.
    pub places: [u32; 2],
    /// Contacts of higher priority are coloured first, of equal ones those that are listed first.
    pub priority: u32,
}

/// Scratch.
#[derive(Clone, Debug, Default)]
pub struct Colouring {
    /// `edges_of[starts[i]..starts[i + 1]]` are the contacts of the particle at place i, that of the
    /// highest priority first: its complement, and the index of the contact.
    starts: Vec<u32>,
    edges_of: Vec<u64>,
    /// Index in `edges_of` of the first contact of each particle that has no colour yet.
    next: Vec<u32>,
    /// A bit for each colour of the contacts of each particle.
    taken: Vec<u64>,
    /// Places of particles whose next contact may be ready to be coloured.
    open: Vec<u32>,
}

impl Colouring {
    /// Writes the colour of each contact, [`COLOURS`] for those for which there is none. Particles that
    /// do not move take no colour: any number of their contacts may share one.
    pub fn run(&mut self, edges: &[Edge], movable: &[bool], colours: &mut Vec<u8>) {
        colours.clear();
        colours.resize(edges.len(), COLOURS as u8);
        if edges.is_empty() {
            return;
        }
        self.list(edges, movable);
        let Self { starts, edges_of, next, taken, open } = self;
        taken.clear();
        taken.resize(movable.len(), 0);
        open.clear();
        open.extend((0..movable.len() as u32).rev());
        let first = |next: &[u32], place: u32| {
            let place = place as usize;
            (next[place] < starts[place + 1]).then(|| edges_of[next[place] as usize] as u32)
        };
        while let Some(place) = open.pop() {
            let Some(index) = first(next, place) else { continue };
            let [a, b] = edges[index as usize].places;
            let is_first =
                |place: u32| !movable[place as usize] || first(next, place) == Some(index);
            if !(is_first(a) && is_first(b)) {
                continue;
            }
            let colour = (taken[a as usize] | taken[b as usize]).trailing_ones();
            colours[index as usize] = colour as u8;
            for place in [a, b].into_iter().filter(|&place| movable[place as usize]) {
                taken[place as usize] |= 1u64.checked_shl(colour).unwrap_or(0);
                next[place as usize] += 1;
                open.push(place);
            }
        }
    }

    /// Lists the contacts of each particle that moves, sorted by their priorities.
    fn list(&mut self, edges: &[Edge], movable: &[bool]) {
        let Self { starts, edges_of, next, .. } = self;
        let moving = |edge: &Edge| edge.places.into_iter().filter(|&place| movable[place as usize]);
        starts.clear();
        starts.resize(movable.len() + 1, 0);
        edges.iter().flat_map(moving).for_each(|place| starts[place as usize + 1] += 1);
        for place in 0..movable.len() {
            starts[place + 1] += starts[place];
        }
        next.clear();
        next.extend_from_slice(&starts[..movable.len()]);
        edges_of.clear();
        edges_of.resize(starts[movable.len()] as usize, 0);
        for (index, edge) in (0..).zip(edges) {
            for place in moving(edge) {
                let at = &mut next[place as usize];
                edges_of[*at as usize] = u64::from(!edge.priority) << 32 | index;
                *at += 1;
            }
        }
        next.copy_from_slice(&starts[..movable.len()]);
        for range in starts.windows(2) {
            edges_of[range[0] as usize..range[1] as usize].sort_unstable();
        }
    }
}

/// The priority of the contact of two particles, the second moved by `image`.
pub fn priority(particles: &Particles, places: [u32; 2], image: [f32; 2]) -> u32 {
    let [a, b] = places.map(|place| place as usize);
    let cells = CELLS / (particles.radii[a] + particles.radii[b]);
    let numbers = [particles.positions[a], particles.positions[b], image];
    numbers.as_flattened().iter().fold(0, |hash, number| mix(hash, (number * cells) as i32 as u32))
}

/// A hash of a hash and a number: the finalizer of MurmurHash3 (A. Appleby).
fn mix(hash: u32, number: u32) -> u32 {
    let mut mixed = hash.wrapping_mul(31).wrapping_add(number);
    mixed = (mixed ^ mixed >> 16).wrapping_mul(0x85eb_ca6b);
    mixed = (mixed ^ mixed >> 13).wrapping_mul(0xc2b2_ae35);
    mixed ^ mixed >> 16
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Colours given one contact after the other, in the order of their priorities.
    fn one_by_one(edges: &[Edge], movable: &[bool]) -> Vec<u8> {
        let mut order: Vec<usize> = (0..edges.len()).collect();
        order.sort_by_key(|&index| !edges[index].priority);
        let mut colours = vec![None; edges.len()];
        for index in order {
            let shares = |other: &Edge| {
                let own = edges[index].places;
                own.iter().any(|&place| movable[place as usize] && other.places.contains(&place))
            };
            let is_free = |colour: &u8| {
                !(edges.iter().zip(&colours)).any(|(of, own)| *own == Some(*colour) && shares(of))
            };
            colours[index] = Some((0..COLOURS as u8).find(is_free).unwrap_or(COLOURS as u8));
        }
        colours.into_iter().flatten().collect()
    }

    proptest! {
        #[test]
        fn the_colours_are_those_in_the_order_of_the_priorities(
            pairs in proptest::collection::vec((0u32..12, 0u32..12, 0u32..6), 0..150),
            movable in proptest::collection::vec(proptest::bool::weighted(0.8), 12),
        ) {
            let solved = |&(a, b, _): &(u32, u32, u32)| {
                a != b && (movable[a as usize] || movable[b as usize])
            };
            let edge = |(a, b, priority)| Edge { places: [a, b], priority };
            let edges: Vec<Edge> = pairs.into_iter().filter(solved).map(edge).collect();
            let mut colours = Vec::new();
            Colouring::default().run(&edges, &movable, &mut colours);
            prop_assert_eq!(colours, one_by_one(&edges, &movable));
        }
    }

    #[test]
    fn contacts_beyond_the_last_colour_are_left_over() {
        let edge = |other| Edge { places: [0, other], priority: other };
        let edges: Vec<Edge> = (1..=COLOURS as u32 + 3).map(edge).collect();
        let mut colours = Vec::new();
        Colouring::default().run(&edges, &[true; COLOURS + 4], &mut colours);
        let left = colours.iter().filter(|&&colour| colour == COLOURS as u8).count();
        assert_eq!(left, 3);
    }
}
