//! Particles as bytes, one record of fixed length for each.

use crate::bytes::Plain;
use crate::forces::Kinds;
use crate::particles::{Particles, Spin};
use crate::shapes::Filter;
use crate::space::Id;

/// Bytes of a record.
pub const RECORD: usize = 72;

/// Appends the record of the particle in a row, with its id and its kinds.
pub fn put_record(to: &mut Vec<u8>, (id, kinds): (Id, Kinds), all: &Particles, row: usize) {
    let start = to.len();
    to.resize(start + RECORD, 0);
    let mut rest = &mut to[start..];
    let (spin, filter) = (all.spin(row), all.filter(row));
    put(&mut rest, id as u64);
    put(&mut rest, spin.angle);
    put(&mut rest, [all.positions[row], all.residuals[row], all.velocities[row]]);
    put(&mut rest, [all.radii[row], all.masses[row], all.restitutions[row]]);
    put(&mut rest, [spin.friction, spin.velocity]);
    put(&mut rest, [filter.category, filter.mask]);
    put(&mut rest, [u8::from(all.movable[row]), u8::from(all.is_sensor(row))]);
    put(&mut rest, kinds);
}

fn put<P: Plain>(rest: &mut &mut [u8], value: P) {
    let (to, after) = std::mem::take(rest).split_at_mut(P::SIZE);
    value.store(to);
    *rest = after;
}

/// The particles of some records, their ids and their kinds.
pub fn read_records(bytes: &[u8]) -> (Particles, Vec<Id>, Vec<Kinds>) {
    let (mut all, mut ids, mut kinds) = (Particles::default(), Vec::new(), Vec::new());
    for record in bytes.chunks_exact(RECORD) {
        let mut rest = record;
        ids.push(get::<u64>(&mut rest) as Id);
        let angle = get::<f64>(&mut rest);
        let [position, residual, velocity] = get::<[[f32; 2]; 3]>(&mut rest);
        let [radius, mass, restitution] = get::<[f32; 3]>(&mut rest);
        let [friction, turning] = get::<[f32; 2]>(&mut rest);
        let [category, mask] = get::<[u32; 2]>(&mut rest);
        let [movable, is_sensor] = get::<[u8; 2]>(&mut rest);
        kinds.push(get::<Kinds>(&mut rest));
        all.positions.push(position);
        all.residuals.push(residual);
        all.velocities.push(velocity);
        all.radii.push(radius);
        all.masses.push(mass);
        all.restitutions.push(restitution);
        all.movable.push(movable > 0);
        all.spins.push(Spin { friction, velocity: turning, angle });
        all.filters.push(Filter { category, mask });
        all.sensors.push(is_sensor > 0);
    }
    all.simplify();
    (all, ids, kinds)
}

fn get<P: Plain>(rest: &mut &[u8]) -> P {
    let (from, after) = rest.split_at(P::SIZE);
    *rest = after;
    P::load(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_contain_all_columns() {
        let mut all =
            Particles::new(vec![[1.0, 2.0], [3.0, 4.0]], vec![[5.0, 6.0]; 2], vec![7.0; 2], 1.0);
        all.residuals[1] = [8.0, -9.0];
        (all.masses[1], all.restitutions[1], all.movable[1]) = (10.0, 0.5, false);
        all.spins_mut()[1] = Spin { friction: 0.25, velocity: -1.5, angle: 0.75 };
        all.filters_mut()[1] = Filter { category: 2, mask: 3 };
        all.sensors_mut()[1] = true;
        let mut bytes = Vec::new();
        put_record(&mut bytes, (-1, [3, 0]), &all, 0);
        put_record(&mut bytes, (1 << 40, [0, 63]), &all, 1);
        assert_eq!(bytes.len(), 2 * RECORD);
        let kinds = vec![[3, 0], [0, 63]];
        assert_eq!(read_records(&bytes), (all, vec![-1, 1 << 40], kinds));
        let plain = Particles::new(vec![[0.0; 2]], vec![[0.0; 2]], vec![1.0], 1.0);
        let mut bytes = Vec::new();
        put_record(&mut bytes, (0, [0; 2]), &plain, 0);
        assert_eq!(read_records(&bytes), (plain, vec![0], vec![[0; 2]]));
    }
}
