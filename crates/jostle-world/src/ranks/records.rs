//! Particles as bytes, one record of fixed length for each: its id and all fields.
//!
//! Fields with numbers of 8 bytes come first, then those of 4 bytes, then bytes.

use crate::particles::{Field, FieldVisitor, FieldVisitorMut, Particles};
use jostle_base::bytes::Plain;
use jostle_base::ids::Id;
use jostle_base::table::Table;

/// Bytes of a record.
pub const RECORD: usize = u64::SIZE + Particles::ROW_SIZE;

/// Bytes of numbers, in the order of a record.
const WIDTHS: [usize; 3] = [8, 4, 1];

/// Appends the record of the particle in a row, with its id.
pub fn put_record(to: &mut Vec<u8>, id: Id, all: &Particles, row: usize) {
    let start = to.len();
    to.resize(start + RECORD, 0);
    let mut rest = &mut to[start..];
    put(&mut rest, id as u64);
    // Fields of one width follow each other, so no bytes between numbers are needed to align them.
    for width in WIDTHS {
        all.visit_row(row, &mut Put { rest: &mut rest, width });
    }
}

/// Writes the fields of one width.
struct Put<'a, 'b> {
    rest: &'a mut &'b mut [u8],
    width: usize,
}

impl FieldVisitor for Put<'_, '_> {
    #[inline(always)]
    fn field<F: Field>(&mut self, _name: &'static str, value: F) {
        if F::WIDTH == self.width {
            put(self.rest, value);
        }
    }
}

fn put<P: Plain>(rest: &mut &mut [u8], value: P) {
    let (to, after) = std::mem::take(rest).split_at_mut(P::SIZE);
    value.store(to);
    *rest = after;
}

/// The particles of some records, and their ids.
pub fn read_records(bytes: &[u8]) -> (Particles, Vec<Id>) {
    let (mut all, mut ids) = (Particles::default(), Vec::new());
    all.resize(bytes.len() / RECORD);
    for (row, mut rest) in bytes.chunks_exact(RECORD).enumerate() {
        ids.push(get::<u64>(&mut rest) as Id);
        for width in WIDTHS {
            all.visit_row_mut(row, &mut Get { rest: &mut rest, width });
        }
    }
    // Reading fills all columns; those with default values alone are removed again.
    all.simplify();
    (all, ids)
}

/// Reads the fields of one width.
struct Get<'a, 'b> {
    rest: &'a mut &'b [u8],
    width: usize,
}

impl FieldVisitorMut for Get<'_, '_> {
    #[inline(always)]
    fn field<F: Field>(&mut self, value: &mut F) {
        if F::WIDTH == self.width {
            *value = get(self.rest);
        }
    }
}

fn get<P: Plain>(rest: &mut &[u8]) -> P {
    let (from, after) = rest.split_at(P::SIZE);
    *rest = after;
    P::load(from)
}

/// The name of each field in the order of a record, the type of its numbers, and how many it has.
pub fn record_fields() -> Vec<(&'static str, &'static str, usize)> {
    let mut blank = Particles::default();
    blank.resize(1);
    let mut names = Names::default();
    for width in WIDTHS {
        names.width = width;
        blank.visit_row(0, &mut names);
    }
    names.found
}

/// Lists the fields of one width.
#[derive(Default)]
struct Names {
    found: Vec<(&'static str, &'static str, usize)>,
    width: usize,
}

impl FieldVisitor for Names {
    fn field<F: Field>(&mut self, name: &'static str, _value: F) {
        if F::WIDTH == self.width {
            self.found.push((name, F::NUMBER, F::SIZE / F::WIDTH));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Spin;
    use jostle_index::shapes::Filter;

    #[test]
    fn records_contain_all_columns() {
        let mut all =
            Particles::new(vec![[1.0, 2.0], [3.0, 4.0]], vec![[5.0, 6.0]; 2], vec![7.0; 2], 1.0);
        all.residuals[1] = [8.0, -9.0];
        (all.masses[1], all.restitution[1], all.movable[1]) = (10.0, 0.5, false);
        all.spins_mut()[1] = Spin { friction: 0.25, velocity: -1.5, angle: 0.75 };
        all.filters_mut()[1] = Filter { category: 2, mask: 3 };
        all.sensors_mut()[1] = true;
        all.kinds = vec![3, 63];
        let mut bytes = Vec::new();
        put_record(&mut bytes, -1, &all, 0);
        put_record(&mut bytes, 1 << 40, &all, 1);
        assert_eq!(bytes.len(), 2 * RECORD);
        assert_eq!(read_records(&bytes), (all, vec![-1, 1 << 40]));
        let plain = Particles::new(vec![[0.0; 2]], vec![[0.0; 2]], vec![1.0], 1.0);
        let mut bytes = Vec::new();
        put_record(&mut bytes, 0, &plain, 0);
        assert_eq!(read_records(&bytes), (plain, vec![0]));
    }
}
