//! Graph colouring of contacts: those of one colour share no particle that moves.
//!
//! Each contact has a priority, a hash of the state of its two particles, and takes the first colour
//! that no contact of higher priority at its particles has (M. T. Jones, P. E. Plassmann, *A Parallel
//! Graph Coloring Heuristic*, 1993). So the colour of a contact depends on a chain of contacts with
//! rising priorities, which is short, and not on contacts far away. Here the contacts are coloured one
//! after the other in the order of their priorities.

use super::COLOURS;
use crate::particles::Particles;
use jostle_base::error::Result;
use jostle_base::reserve;
use jostle_base::sorting::counting_sort;
use jostle_simd::{LANES, Number, Simd, Work};

/// Cells in a sum of radii in which positions are rounded before they are hashed, so that contacts of
/// particles at rest keep their priorities.
const CELLS: f32 = 8.0;

/// A contact to be coloured.
#[derive(Clone, Copy, Debug, Default)]
pub struct Edge {
    /// The indices of its particles.
    pub indices: [u32; 2],
    /// Contacts of higher priority are coloured first, of equal ones those that are listed first.
    pub priority: u32,
}

/// Fewer contacts than this are sorted by comparison. The radix sort clears its counters three
/// times, which costs more than to compare few contacts.
const FEW: usize = 1024;

/// Bits of a digit of the radix sort, and the digits of a priority.
const DIGIT: u32 = 11;
const DIGITS: u32 = u32::BITS.div_ceil(DIGIT);

/// Scratch.
#[derive(Clone, Debug, Default)]
pub struct Colouring {
    /// The complement of the priority and the index of each contact.
    order: Vec<[u32; 2]>,
    spare: Vec<[u32; 2]>,
    ends: Vec<u32>,
    /// A bit for each colour of the contacts of each particle.
    taken: Vec<u64>,
}

impl Colouring {
    /// Writes the colour of each contact, [`COLOURS`] for those for which there is none. Particles that
    /// do not move take no colour: any number of their contacts may share one.
    pub fn run(&mut self, edges: &[Edge], movable: &[bool], colours: &mut Vec<u8>) -> Result<()> {
        reserve!(edges.len(); *colours, self.order, self.spare);
        reserve!(movable.len(); self.taken);
        colours.clear();
        // The order of solving changes the result, because the iteration ends early. So the colours
        // must follow from the state, and only from the state nearby. The priorities are hashes, so
        // chains of rising priorities are short, and end near the contact.
        colours.resize(edges.len(), COLOURS as u8);
        // In descending order of priorities, each contact finds all colours of higher ones already
        // taken. So one pass gives the colours that the parallel algorithm of Jones and Plassmann
        // gives.
        self.sort(edges);
        let Self { order, taken, .. } = self;
        taken.clear();
        taken.resize(movable.len(), 0);
        for &[_, edge] in &*order {
            let [a, b] = edges[edge as usize].indices.map(|index| index as usize);
            // The lowest free colour is the first 0 among 64 bits. All 64 taken give 64, the number
            // that means "no colour".
            let colour = (taken[a] | taken[b]).trailing_ones();
            colours[edge as usize] = colour as u8;
            // A particle that does not move is never written, so its contacts may be solved at the
            // same time. An immovable disc under a thousand others would otherwise need a thousand
            // colours.
            let bit = 1u64.checked_shl(colour).unwrap_or(0);
            taken[a] |= if movable[a] { bit } else { 0 };
            taken[b] |= if movable[b] { bit } else { 0 };
        }
        Ok(())
    }

    /// Lists the contacts in the order of their priorities, the highest first (radix sort, least
    /// significant digit first).
    fn sort(&mut self, edges: &[Edge]) {
        let Self { order, spare, ends, .. } = self;
        order.clear();
        // The complement sorts in descending order. The index breaks ties by the canonical order:
        // the radix sort is stable, and the sort by comparison compares the index.
        order.extend((0..).zip(edges).map(|(index, edge)| [!edge.priority, index]));
        if order.len() < FEW {
            return order.sort_unstable();
        }
        spare.resize(order.len(), [0; 2]);
        ends.resize(1 << DIGIT, 0);
        // Three passes of 11 bits: 2,048 counters fit into the first-level cache. The time does not
        // depend on the distribution of the keys.
        for digit in 0..DIGITS {
            let digit_of = |of: &[u32; 2]| (of[0] >> (digit * DIGIT) & ((1 << DIGIT) - 1)) as usize;
            counting_sort(order.iter(), |of| digit_of(of), |of| *of, ends, spare);
            std::mem::swap(order, spare);
        }
    }
}

/// Writes the edges of some pairs with their priorities, the second particles moved by `image`.
pub fn prioritize(particles: &Particles, pairs: &[[u32; 2]], image: [f32; 2], to: &mut [Edge]) {
    f32::with_widest(Prioritize { particles, pairs, image, to });
}

struct Prioritize<'a> {
    particles: &'a Particles,
    pairs: &'a [[u32; 2]],
    image: [f32; 2],
    to: &'a mut [Edge],
}

impl Work<f32> for Prioritize<'_> {
    type Out = ();

    /// Plain loops over columns, for which the compiler uses vector instructions.
    #[inline(always)]
    fn run<S: Simd<f32>>(self, _: S) {
        let Self { particles: Particles { positions, radii, .. }, pairs, image, to } = self;
        for (pairs, to) in pairs.chunks(LANES).zip(to.chunks_mut(LANES)) {
            let mut cells = [[0.0f32; LANES]; NUMBERS];
            for (lane, &indices) in pairs.iter().enumerate() {
                let [a, b] = indices.map(|index| index as usize);
                // Cells in units of the contact keep the colours of a pile at rest from step to
                // step. With positions to the last bit, colours would change in each step, and
                // impulses with them.
                let scale = CELLS / (radii[a] + radii[b]);
                let numbers = [positions[a], positions[b], image];
                for (column, number) in cells.iter_mut().zip(numbers.as_flattened()) {
                    column[lane % LANES] = number * scale;
                }
            }
            let mut hashes = [0u32; LANES];
            for column in &cells {
                for (hash, number) in hashes.iter_mut().zip(column) {
                    // The conversion to integers truncates and saturates in Rust, so it is defined
                    // for each number, also for NaN.
                    *hash = mix(*hash, *number as i32 as u32);
                }
            }
            for ((edge, &indices), priority) in to.iter_mut().zip(pairs).zip(hashes) {
                *edge = Edge { indices, priority };
            }
        }
    }
}

/// Numbers from which a priority is computed.
const NUMBERS: usize = 6;

/// A hash of a hash and a number: the finalizer of MurmurHash3 (A. Appleby).
#[inline(always)]
fn mix(hash: u32, number: u32) -> u32 {
    // Integer operations only, so the hash is the same on each machine. The factor 31 makes the
    // order of the numbers count.
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
        order.sort_by_key(|&edge| !edges[edge].priority);
        let mut colours = vec![None; edges.len()];
        for edge in order {
            let shares = |other: &Edge| {
                let own = edges[edge].indices;
                own.iter().any(|&index| movable[index as usize] && other.indices.contains(&index))
            };
            let is_free = |colour: &u8| {
                !(edges.iter().zip(&colours)).any(|(of, own)| *own == Some(*colour) && shares(of))
            };
            colours[edge] = Some((0..COLOURS as u8).find(is_free).unwrap_or(COLOURS as u8));
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
            let edge = |(a, b, priority)| Edge { indices: [a, b], priority };
            let edges: Vec<Edge> = pairs.into_iter().filter(solved).map(edge).collect();
            let mut colours = Vec::new();
            Colouring::default().run(&edges, &movable, &mut colours).unwrap();
            prop_assert_eq!(colours, one_by_one(&edges, &movable));
        }
    }

    /// More contacts than [`FEW`], many of equal priority.
    #[test]
    fn many_contacts_have_the_same_colours() {
        let random = |of: u32| mix(7, of);
        let edge = |of: u32| Edge {
            indices: [random(3 * of) % 900, 900 + random(3 * of + 1) % 900],
            priority: random(3 * of + 2) << (of % 3 * 12),
        };
        let edges: Vec<Edge> = (0..3 * FEW as u32).map(edge).collect();
        let movable: Vec<bool> = (0..1800).map(|index| random(index) % 5 > 0).collect();
        let mut colours = Vec::new();
        Colouring::default().run(&edges, &movable, &mut colours).unwrap();
        assert_eq!(colours, one_by_one(&edges, &movable));
    }

    /// Sixteen at a time and one by one, also where numbers are negative or too large.
    #[test]
    fn priorities_do_not_depend_on_the_other_pairs() {
        let number = |of: u32| mix(3, of) as i32 as f32 * 1e-6;
        let positions = (0..60).map(|of| [number(2 * of), number(2 * of + 1) * 1e9]).collect();
        let radii = (0..60).map(|of| 0.1 + of as f32).collect();
        let particles = Particles::new(positions, vec![[0.0; 2]; 60], radii, 1.0);
        let pairs: Vec<[u32; 2]> = (0..37).map(|of| [of, 59 - of / 2]).collect();
        let image = [0.0, -12.5];
        let mut edges = vec![Edge::default(); pairs.len()];
        prioritize(&particles, &pairs, image, &mut edges);
        for (edge, pair) in edges.iter().zip(&pairs) {
            let [a, b] = pair.map(|index| index as usize);
            let cells = CELLS / (particles.radii[a] + particles.radii[b]);
            let numbers = [particles.positions[a], particles.positions[b], image];
            let hash = numbers
                .as_flattened()
                .iter()
                .fold(0u32, |hash, number| mix(hash, (number * cells) as i32 as u32));
            assert_eq!((edge.indices, edge.priority), (*pair, hash));
        }
    }

    #[test]
    fn contacts_beyond_the_last_colour_are_left_over() {
        let edge = |other| Edge { indices: [0, other], priority: other };
        let edges: Vec<Edge> = (1..=COLOURS as u32 + 3).map(edge).collect();
        let mut colours = Vec::new();
        Colouring::default().run(&edges, &[true; COLOURS + 4], &mut colours).unwrap();
        let left = colours.iter().filter(|&&colour| colour == COLOURS as u8).count();
        assert_eq!(left, 3);
    }
}
