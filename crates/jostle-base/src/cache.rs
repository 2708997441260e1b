//! Loading of memory into the processor's cache before it is read in random order.

use std::hint::black_box;

/// Bytes of a cache line.
const LINE: usize = 64;

/// Reads one value of each cache line, in order. The hardware prefetcher makes this faster than
/// reads in random order.
pub fn load<V: Copy>(values: &[V]) {
    // One read brings a whole line into the cache, so the other values of the line need none.
    // `black_box` keeps the compiler from removing reads whose values are not used.
    for value in values.iter().step_by(LINE / size_of::<V>()) {
        black_box(*value);
    }
}
