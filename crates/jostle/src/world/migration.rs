//! Moving particles to the ranks in whose domains they are, with what the solver keeps of them.

use std::collections::HashMap;
use std::sync::Mutex;

use super::World;
use super::carried::{NONE, Push, Resting};
use crate::bytes::Plain;
use crate::container::MAX_WALLS;
use crate::decomposition::{Group, cuts, key, put_record, sample};
use crate::error::Result;
use crate::parallel::locked;
use crate::space::Id;

/// Impulses over mass of the sides of the container, along the normals and of friction.
type Sides = [[f32; MAX_WALLS]; 2];

/// What leaves this rank for each other one, as bytes.
#[derive(Debug)]
struct Leaving {
    records: Vec<Vec<u8>>,
    sides: Vec<Vec<u8>>,
    resting: Vec<Vec<u8>>,
    pushes: Vec<Vec<u8>>,
    /// The rank of each row that leaves.
    homes: HashMap<u32, usize>,
}

impl World {
    /// Cuts the Morton curve anew, and moves particles to the ranks of their domains.
    pub(super) fn rebalance(&mut self) -> Result<()> {
        let Some([low, high]) = self.extent_of_all()? else { return Ok(()) };
        let area = [low, high].map(|corner| corner.map(f64::from));
        let keys: Vec<u64> = self.particles.positions.iter().map(|&at| key(area, at)).collect();
        let Some(domain) = &self.domain else { return Ok(()) };
        let cuts = cuts_of_all(&domain.group, &keys, domain.work)?;
        let leaving = self.leaving(&keys, &cuts);
        // After a failed exchange the other ranks make no further one.
        let (records, sides, resting, pushes) = {
            let mut group = locked(&domain.group);
            let records = group.exchange(&leaving.records)?;
            let sides = group.exchange(&leaving.sides)?.concat();
            let resting = group.exchange(&leaving.resting)?.concat();
            (records, sides, resting, group.exchange(&leaving.pushes)?.concat())
        };
        let first = self.leave(&leaving.homes);
        self.append_records(&records, true);
        self.take_sides(first, &sides);
        self.take_resting(first, &resting, &pushes);
        self.renumber();
        Ok(())
    }

    /// Gives the rows the order of the places, so that what is stored by rows is near in memory to what is
    /// stored by places.
    fn renumber(&mut self) {
        let Self { domain, rows, wall_impulses, .. } = self;
        let Some(domain) = domain else { return };
        let mut new = vec![0; rows.len()];
        (0..).zip(&*rows).for_each(|(place, &row)| new[row as usize] = place);
        domain.ids = rows.iter().map(|&row| domain.ids[row as usize]).collect();
        for of in &mut domain.resting {
            of.rows = of.rows.map(|row| new.get(row as usize).copied().unwrap_or(NONE));
        }
        wall_impulses.iter_mut().for_each(|of| of.row = new[of.row as usize]);
        wall_impulses.sort_by_key(|of| (of.row, of.wall));
        (0..).zip(rows).for_each(|(place, row)| *row = place);
        self.forget_places();
    }

    /// What leaves this rank.
    fn leaving(&self, keys: &[u64], cuts: &[u64]) -> Leaving {
        let none = || vec![Vec::new(); cuts.len() + 1];
        let mut leaving = Leaving {
            records: none(),
            sides: none(),
            resting: none(),
            pushes: none(),
            homes: HashMap::new(),
        };
        let Some(domain) = &self.domain else { return leaving };
        let rank = locked(&domain.group).rank();
        for (place, key) in keys.iter().enumerate() {
            let home = cuts.partition_point(|cut| cut <= key);
            if home == rank {
                continue;
            }
            let row = self.rows[place];
            let id = domain.ids[row as usize];
            put_record(&mut leaving.records[home], id, &self.particles, place);
            let frictions = self.persistent.wall_frictions.get(place);
            let sides: Sides =
                [self.persistent.wall_pushes[place], frictions.copied().unwrap_or_default()];
            let start = leaving.sides[home].len();
            leaving.sides[home].resize(start + Sides::SIZE, 0);
            sides.store(&mut leaving.sides[home][start..]);
            leaving.homes.insert(row, home);
        }
        for of in &domain.resting {
            let mut homes = of.rows.map(|row| leaving.homes.get(&row).copied());
            if homes[0] == homes[1] {
                homes[1] = None;
            }
            for home in homes.into_iter().flatten() {
                of.put(&mut leaving.resting[home]);
            }
        }
        for of in self.wall_impulses.iter().filter(|of| of.pushes[0] > 0.0) {
            if let Some(&home) = leaving.homes.get(&of.row) {
                let id = domain.ids[of.row as usize];
                let push = Push { id, wall: of.wall, pushes: of.pushes };
                push.put(&mut leaving.pushes[home]);
            }
        }
        leaving
    }

    /// Removes the rows that leave; returns how many are left.
    fn leave(&mut self, homes: &HashMap<u32, usize>) -> usize {
        let stays: Vec<bool> = self.rows.iter().map(|row| !homes.contains_key(row)).collect();
        let mut left = 0;
        let shifted: Vec<u32> = (0..self.rows.len() as u32)
            .map(|row| {
                let is_gone = homes.contains_key(&row);
                left += u32::from(!is_gone);
                if is_gone { NONE } else { left - 1 }
            })
            .collect();
        self.keep(&stays);
        self.rows.iter_mut().for_each(|row| *row = shifted[*row as usize]);
        self.wall_impulses.retain_mut(|of| {
            of.row = shifted[of.row as usize];
            of.row != NONE
        });
        if let Some(domain) = &mut self.domain {
            let ids = domain.ids.iter().zip(&shifted).filter(|(_, row)| **row != NONE);
            domain.ids = ids.map(|(id, _)| *id).collect();
            domain.own = domain.ids.len();
            for of in &mut domain.resting {
                of.rows = of.rows.map(|row| shifted.get(row as usize).copied().unwrap_or(NONE));
            }
        }
        left as usize
    }

    /// Gives the rows from `first` on, which are the last places, the impulses of the sides.
    fn take_sides(&mut self, first: usize, bytes: &[u8]) {
        let count = self.rows.len();
        for (place, bytes) in (first..).zip(bytes.chunks_exact(Sides::SIZE)) {
            let [pushes, frictions] = Sides::load(bytes);
            self.persistent.wall_pushes[place] = pushes;
            if frictions != [0.0; MAX_WALLS] {
                self.persistent.wall_frictions.resize(count, Default::default());
                self.persistent.wall_frictions[place] = frictions;
            }
        }
    }

    /// Adds contacts at rest and pushes of walls of the rows from `first` on.
    fn take_resting(&mut self, first: usize, resting: &[u8], pushes: &[u8]) {
        let Some(domain) = &mut self.domain else { return };
        let new = (first as u32..).zip(&domain.ids[first..]);
        let rows: HashMap<Id, u32> = new.map(|(row, &id)| (id, row)).collect();
        domain.resting.extend(resting.chunks_exact(Resting::SIZE).map(Resting::get));
        for of in &mut domain.resting {
            for k in [0, 1] {
                if of.rows[k] == NONE
                    && let Some(&row) = rows.get(&of.ids[k])
                {
                    of.rows[k] = row;
                }
            }
        }
        // A contact that this rank had before knows both rows.
        let unknown = |of: &Resting| of.rows.iter().filter(|&&row| row == NONE).count();
        domain.resting.sort_by_key(|of| (of.ids, unknown(of)));
        domain.resting.dedup_by_key(|of| of.ids);
        domain.resting.retain(|of| unknown(of) < 2);
        let pushes = pushes.chunks_exact(Push::SIZE).map(Push::get);
        self.wall_impulses.extend(pushes.map(|push| push.of_row(rows[&push.id])));
        self.wall_impulses.sort_by_key(|of| (of.row, of.wall));
    }
}

/// The keys at which the domains of all ranks but the first begin.
fn cuts_of_all(group: &Mutex<Group>, keys: &[u64], work: f64) -> Result<Vec<u64>> {
    let mut group = locked(group);
    let samples = sample(&mut keys.to_vec());
    let samples = samples.iter().flat_map(|key| key.to_le_bytes()).collect();
    let amounts = group.gather([(work * keys.len() as f64).to_bits()])?;
    let to = vec![samples; group.size()];
    let all = group.exchange(&to)?;
    let ranks = all.iter().zip(amounts).map(|(bytes, [work])| {
        let (keys, _) = bytes.as_chunks::<8>();
        (keys.iter().map(|key| u64::from_le_bytes(*key)).collect(), f64::from_bits(work))
    });
    Ok(cuts(&ranks.collect::<Vec<_>>()))
}
