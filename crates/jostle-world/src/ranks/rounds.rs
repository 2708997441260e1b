//! Contacts that one process solves in sequence, divided into rounds which ranks solve at the same
//! time, with the same result.
//!
//! A rank solves all contacts of its own moving particles, in the order of the sequence; a contact
//! of two ranks is solved by both. Before each round ghosts get the values of their own ranks. So a
//! rank knows a particle after one of its contacts if it has solved this contact, otherwise in the
//! next round. The rounds of all contacts follow from that, and all ranks compute the same ones.

use std::collections::HashMap;
use std::sync::Mutex;

use jostle_base::bytes::Plain;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::parallel::locked;

use super::Group;

/// A contact in the sequence of a rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Link {
    /// The ids of its particles.
    pub ids: [Id; 2],
    /// The number of the torus image.
    pub image: u32,
    /// The rank of each particle that moves.
    pub ranks: [Option<u32>; 2],
}

/// Stands for the rank of a particle that does not move.
const STILL: u32 = u32::MAX;

/// Bytes of a contact.
const SIZE: usize = 32;

impl Link {
    fn put(&self, to: &mut Vec<u8>) {
        let [a, b] = self.ranks.map(|rank| u64::from(rank.unwrap_or(STILL)));
        let words = [self.ids[0] as u64, self.ids[1] as u64, u64::from(self.image), a << 32 | b];
        words.iter().for_each(|word| to.extend(word.to_le_bytes()));
    }

    fn get(bytes: &[u8]) -> Self {
        let [a, b, image, ranks] = Plain::load(bytes);
        let rank = |word: u64| Some(word as u32).filter(|&rank| rank != STILL);
        let (ids, ranks) = ([a, b].map(|id: u64| id as Id), [rank(ranks >> 32), rank(ranks)]);
        Self { ids, image: image as u32, ranks }
    }

    /// Whether a rank solves it.
    fn is_of(&self, rank: u32) -> bool {
        self.ranks.contains(&Some(rank))
    }
}

/// The round of each contact in the sequence of this rank, and the number of rounds of all ranks.
pub fn rounds(group: &Mutex<Group>, own: &[Link]) -> Result<(Vec<u32>, usize)> {
    // Rounds follow from the contacts of all ranks, so all are shared. They are few: only those
    // that no colour was left for are solved in sequence.
    let mut bytes = Vec::with_capacity(own.len() * SIZE);
    own.iter().for_each(|link| link.put(&mut bytes));
    let all = locked(group).share(&bytes)?;
    let links = |bytes: &Vec<u8>| bytes.chunks_exact(SIZE).map(Link::get).collect();
    let all: Vec<Vec<Link>> = all.iter().map(links).collect();
    let rounds = rounds_of(&all);
    let count = rounds.values().max().map_or(0, |&last| last as usize + 1);
    Ok((own.iter().map(|link| rounds[link]).collect(), count))
}

/// The round of each contact in the sequences of all ranks. Of each particle that moves the
/// contacts follow each other as in the sequence of its rank.
fn rounds_of(sequences: &[Vec<Link>]) -> HashMap<Link, u32> {
    // The contacts before and after each one at its two particles.
    let (mut links, mut before, mut after) = (Vec::new(), Vec::new(), Vec::new());
    let (mut known, mut last) = (HashMap::new(), HashMap::new());
    // Two ranks have the same contact. It is one node of the graph.
    for (rank, &link) in
        (0..).zip(sequences).flat_map(|(rank, of)| of.iter().map(move |one| (rank, one)))
    {
        let at = *known.entry(link).or_insert_with(|| {
            links.push(link);
            before.push(Vec::new());
            after.push(Vec::new());
            links.len() - 1
        });
        // Only the rank of a particle knows all its contacts, so its sequence orders them.
        for (id, _) in link.ids.iter().zip(link.ranks).filter(|of| of.1 == Some(rank)) {
            if let Some(previous) = last.insert(*id, at) {
                before[at].push(previous);
                after[previous].push(at);
            }
        }
    }
    // A topological order (A. B. Kahn, 1962). The sequences are parts of one order, so there is no
    // cycle.
    let mut missing: Vec<usize> = before.iter().map(Vec::len).collect();
    let mut ready: Vec<usize> = (0..links.len()).filter(|&at| missing[at] == 0).collect();
    let mut rounds = vec![0; links.len()];
    while let Some(at) = ready.pop() {
        // A rank that has solved the contact before knows the particle at once. Another rank gets
        // it at the beginning of the next round.
        let round = |&previous: &usize| {
            let ranks = links[at].ranks.iter().flatten();
            let is_known = ranks.copied().all(|rank| links[previous].is_of(rank));
            rounds[previous] + u32::from(!is_known)
        };
        rounds[at] = before[at].iter().map(round).max().unwrap_or(0);
        for &next in &after[at] {
            missing[next] -= 1;
            if missing[next] == 0 {
                ready.push(next);
            }
        }
    }
    known.into_iter().map(|(link, at)| (link, rounds[at])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contacts of particles, whose ranks are their ids divided by 100.
    fn link(a: Id, b: Id) -> Link {
        Link { ids: [a, b], image: 0, ranks: [a, b].map(|id| Some((id / 100) as u32)) }
    }

    fn rounds_in(sequence: &[Link], ranks: u32) -> Vec<u32> {
        let of = |rank| sequence.iter().copied().filter(|link| link.is_of(rank)).collect();
        let rounds = rounds_of(&(0..ranks).map(of).collect::<Vec<_>>());
        sequence.iter().map(|link| rounds[link]).collect()
    }

    #[test]
    fn contacts_of_one_particle_need_a_round_for_each_rank() {
        // The particle 0 and 50 of its own rank, then 50 of the next one.
        let others = (1..=50).chain(100..150).chain(200..250);
        let sequence: Vec<Link> = others.map(|other| link(0, other)).collect();
        let rounds = rounds_in(&sequence, 3);
        assert_eq!([rounds[0], rounds[49], rounds[50], rounds[99], rounds[100]], [0, 0, 1, 1, 2]);
        assert_eq!(rounds[149], 2);
    }

    #[test]
    fn particles_that_do_not_move_need_no_round() {
        let still =
            |other: Id| Link { ranks: [None, Some((other / 100) as u32)], ..link(0, other) };
        let sequence: Vec<Link> = [100, 200, 101, 201].map(still).to_vec();
        assert_eq!(rounds_in(&sequence, 3), [0; 4]);
    }

    /// Values that depend on the order are those of the sequence.
    #[test]
    fn ranks_have_the_result_of_the_sequence() {
        let random = |of: usize| of.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let id = |of: usize| (random(of) % 3 * 100 + random(of + 7) % 6) as Id;
        for case in 0..200 {
            let pairs = (0..60).map(|k| [id(900 * case + 2 * k), id(900 * case + 2 * k + 1)]);
            let mut sequence: Vec<Link> = Vec::new();
            for ([a, b], image) in pairs.zip(0..) {
                if a != b {
                    sequence.push(Link { image, ..link(a, b) });
                }
            }
            let solve = |values: &mut HashMap<Id, u64>, [a, b]: [Id; 2]| {
                let [p, q] = [a, b].map(|id| values.get(&id).copied().unwrap_or(id as u64));
                values.insert(a, p.wrapping_mul(31).wrapping_add(q));
                values.insert(b, q.wrapping_mul(17) ^ p);
            };
            let mut expected = HashMap::new();
            sequence.iter().for_each(|link| solve(&mut expected, link.ids));
            let rounds = rounds_in(&sequence, 3);
            let mut of_ranks = vec![HashMap::new(); 3];
            for round in 0..=rounds.iter().copied().max().unwrap_or(0) {
                let now = sequence.iter().zip(&rounds).filter(|of| *of.1 == round);
                for link in now.map(|of| of.0) {
                    (0..3).filter(|&rank| link.is_of(rank)).for_each(|rank| {
                        solve(&mut of_ranks[rank as usize], link.ids);
                    });
                }
                let own: HashMap<Id, u64> = (0..3)
                    .flat_map(|rank| {
                        let of: HashMap<Id, u64> = of_ranks[rank].clone();
                        of.into_iter().filter(move |(id, _)| *id as usize / 100 == rank)
                    })
                    .collect();
                of_ranks.fill(own);
            }
            assert_eq!(of_ranks[0], expected, "{case}");
        }
    }
}
