//! Large allocations; a failure is an [`Error::NoMemory`] with the size.

use core::hint::black_box;
use std::collections::TryReserveError;

use crate::error::{Error, Result};

/// Bytes that must be free after each allocation here. A small allocation elsewhere, for instance
/// for a thread, aborts the process if it fails; the margin is for these.
const MARGIN: usize = 1 << 20;

/// Allocations of fewer bytes do not check the margin.
const SMALL: usize = 1 << 10;

/// Whether 1 MiB is free after an allocation for `len` values.
pub fn check_margin<V>(len: usize) -> core::result::Result<(), TryReserveError> {
    // A small vector grows by doubling, so it passes here about once for each size. A check of the
    // margin costs a call of the system for a mebibyte, too much for each of them.
    if len.saturating_mul(size_of::<V>()) < SMALL {
        return Ok(());
    }
    let mut margin = Vec::<u8>::new();
    margin.try_reserve_exact(MARGIN)?;
    // `black_box` keeps the compiler from removing the allocation.
    black_box(margin);
    Ok(())
}

/// Reserves capacity for `more` values in addition to those of `values`.
#[inline(always)]
pub fn reserve<V>(values: &mut Vec<V>, more: usize) -> Result<()> {
    if values.capacity() - values.len() >= more { Ok(()) } else { grow(values, more) }
}

#[cold]
fn grow<V>(values: &mut Vec<V>, more: usize) -> Result<()> {
    let len = values.len();
    let before = values.capacity();
    let grown = values.try_reserve(more).and_then(|()| check_margin::<V>(values.capacity()));
    grown.map_err(|error| {
        // Other threads continue, and allocate, until they read the error.
        // The length has not changed, so `shrink_to` gives back only what this call has reserved.
        values.shrink_to(before);
        no_memory::<V>(&error, len.saturating_add(more))
    })
}

/// The error of an allocation for `len` values.
pub fn no_memory<V>(_: &TryReserveError, len: usize) -> Error {
    Error::NoMemory { bytes: len.saturating_mul(size_of::<V>()) }
}

/// An empty vector with capacity for exactly `len` values.
pub fn with_capacity<V>(len: usize) -> Result<Vec<V>> {
    let mut values = Vec::new();
    let grown = values.try_reserve_exact(len).and_then(|()| check_margin::<V>(len));
    grown.map_err(|error| no_memory::<V>(&error, len))?;
    Ok(values)
}

/// `len` copies of `value`.
pub fn filled<V: Clone>(len: usize, value: V) -> Result<Vec<V>> {
    let mut values = with_capacity(len)?;
    values.resize(len, value);
    Ok(values)
}

/// `len` default values. If these are zeros, the system maps each page when it is first used.
pub fn zeroed<V: Clone + Default>(len: usize) -> Result<Vec<V>> {
    // `vec!` aborts if the allocation fails, so the same size is allocated and freed first.
    drop(black_box(with_capacity::<V>(len)?));
    Ok(vec![V::default(); len])
}

/// Changes the length to `len`; new values are copies of `value`.
pub fn resize<V: Clone>(values: &mut Vec<V>, len: usize, value: V) -> Result<()> {
    reserve(values, len.saturating_sub(values.len()))?;
    values.resize(len, value);
    Ok(())
}

/// Appends copies of `value` until there are `len` values.
pub fn lengthen<V: Clone>(values: &mut Vec<V>, len: usize, value: V) -> Result<()> {
    let longer = len.max(values.len());
    // `Vec::resize` would shorten a vector that is longer than `len`.
    resize(values, longer, value)
}

/// Appends one value.
#[inline(always)]
pub fn push<V>(values: &mut Vec<V>, value: V) -> Result<()> {
    reserve(values, 1)?;
    values.push(value);
    Ok(())
}

/// A vector of all values of an iterator whose length is known.
pub fn collect<V>(values: impl ExactSizeIterator<Item = V>) -> Result<Vec<V>> {
    let mut all = with_capacity(values.len())?;
    all.extend(values);
    Ok(all)
}
