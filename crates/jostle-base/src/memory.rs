//! Large allocations; a failure is an [`Error::NoMemory`] with the size.
//!
//! What grows with the data, with particles, shapes, contacts or pairs, is allocated here, also in threads.
//! `Vec::push`, `resize` and `extend` abort the process if they must allocate and cannot. So they are for vectors that
//! have the memory: a stage reserves it when it knows the sizes, and its loops stay as they are. The test `memory` of
//! the crate `jostle` refuses large allocations of steps and edits in turn.
//!
//! These still abort the process: allocations whose size does not grow with the data; lists of the walls near one disc;
//! the messages between processes of a distributed world; texts of errors. All are small, and [`MARGIN`] leaves memory
//! for them.

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

/// Reserves capacity for `len` values in all.
#[inline(always)]
pub fn reserve_len<V>(values: &mut Vec<V>, len: usize) -> Result<()> {
    reserve(values, len.saturating_sub(values.len()))
}

/// Reserves capacity for `$len` values in all, in each of some vectors.
#[macro_export]
macro_rules! reserve {
    ($len:expr; $($values:expr),* $(,)?) => {{
        let len: usize = $len;
        $($crate::memory::reserve_len(&mut $values, len)?;)*
    }};
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

/// Appends all values of an iterator.
#[inline]
pub fn extend<V>(values: &mut Vec<V>, more: impl IntoIterator<Item = V>) -> Result<()> {
    let mut more = more.into_iter();
    let least = more.size_hint().0;
    reserve(values, least)?;
    // These need no test of the capacity for each value, so the loop can use vector instructions.
    values.extend(more.by_ref().take(least));
    for value in more {
        push(values, value)?;
    }
    Ok(())
}

/// Appends a slice.
#[inline]
pub fn append<V: Copy>(values: &mut Vec<V>, more: &[V]) -> Result<()> {
    reserve(values, more.len())?;
    values.extend_from_slice(more);
    Ok(())
}

/// Replaces the contents by those of a slice.
pub fn assign<V: Copy>(values: &mut Vec<V>, new: &[V]) -> Result<()> {
    values.clear();
    append(values, new)
}

/// Replaces the contents by a copy, in the memory that there is.
pub fn copy_option<V: Copy>(to: &mut Option<Vec<V>>, from: Option<&[V]>) -> Result<()> {
    match from {
        None => *to = None,
        Some(from) => assign(to.get_or_insert_default(), from)?,
    }
    Ok(())
}

/// A copy of a slice.
pub fn copy<V: Copy>(values: &[V]) -> Result<Vec<V>> {
    let mut copy = with_capacity(values.len())?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// Changes the length to `len`; new values are default values.
pub fn resize_default<V: Default>(values: &mut Vec<V>, len: usize) -> Result<()> {
    reserve_len(values, len)?;
    values.resize_with(len, V::default);
    Ok(())
}

/// A vector of all values of an iterator, of which each may be an error.
pub fn try_collect<V>(values: impl IntoIterator<Item = Result<V>>) -> Result<Vec<V>> {
    let values = values.into_iter();
    let mut all = with_capacity(values.size_hint().0)?;
    for value in values {
        push(&mut all, value?)?;
    }
    Ok(all)
}

/// A vector of all values of an iterator whose length is known.
pub fn collect<V>(values: impl ExactSizeIterator<Item = V>) -> Result<Vec<V>> {
    let mut all = with_capacity(values.len())?;
    all.extend(values);
    Ok(all)
}
