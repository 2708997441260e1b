//! Tables: structures of arrays whose columns are declared once.
//!
//! [`table!`](crate::table!) declares a struct of columns and implements [`Table`] for it, so whatever moves
//! rows (reordering, removing, appending) or visits all columns needs no change for a new one. A column is
//! *dense*, with a value for each row; *uniform*, dense, but often with the same value in all rows, so that
//! files contain it once; *sparse*, empty if all rows have the default value; or *nested*, a table itself.

use crate::bytes::{Plain, Reader, Saved, Writer};
use crate::error::{Error, Result};
use crate::memory;

/// Operations on all columns of a table. `len` is the number of rows before the operation, which a sparse
/// column does not store. After [`Table::reserve`] the others do not allocate.
pub trait Table: Default {
    /// Bytes of the values of a row.
    const ROW_SIZE: usize;
    /// Reserves memory for `len` rows in all. Sparse columns are left out if they are empty, also in `other`, from
    /// which rows will come.
    fn reserve(&mut self, other: &Self, len: usize) -> Result<()>;
    /// A copy.
    fn copied(&self) -> Result<Self>;
    /// The rows `order`, in that order.
    fn gathered(&self, order: &[u32]) -> Result<Self> {
        let mut all = Self::default();
        all.reserve(self, order.len())?;
        all.gather(self, order, Some(1));
        Ok(all)
    }
    /// Replaces the contents by the rows `order` of `source`, in that order.
    fn gather(&mut self, source: &Self, order: &[u32], threads: Option<usize>);
    /// Appends the rows of `other`, of which there are `added`.
    fn append(&mut self, len: usize, other: &Self, added: usize);
    /// Writes the row `from` of `other` over `row`.
    fn put(&mut self, len: usize, row: usize, other: &Self, from: usize);
    /// Writes one row over another.
    fn move_row(&mut self, from: usize, to: usize);
    /// Keeps the marked rows.
    fn keep(&mut self, keep: &[bool]);
    /// Removes rows at the end, or appends rows with default values.
    fn resize(&mut self, len: usize);
    /// Empties sparse columns in which all rows have the default value.
    fn drop_defaults(&mut self);
    /// Visits each column, in the order of the declaration.
    fn visit(&self, visitor: &mut impl Visitor);
    /// Visits each column, in the order of the declaration; the visitor may change it.
    fn visit_mut(&mut self, visitor: &mut impl VisitorMut) -> Result<()>;
}

/// A value of a column.
pub trait Value: Plain + Default + PartialEq {}

impl<V: Plain + Default + PartialEq> Value for V {}

/// A visitor of the columns of a table.
pub trait Visitor {
    /// Is called with each column.
    fn column<V: Value>(&mut self, about: Declared, column: &[V]);
}

/// A visitor that changes the columns of a table.
pub trait VisitorMut {
    /// Is called with each column.
    fn column<V: Value>(&mut self, about: Declared, column: &mut Vec<V>) -> Result<()>;
}

/// What the declaration of a table says of a column.
#[derive(Clone, Copy, Debug)]
pub struct Declared {
    /// Its name.
    pub name: &'static str,
    /// Whether it is dense, uniform or sparse.
    pub kind: Kind,
}

/// Kinds of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A value for each row.
    Dense,
    /// A value for each row, often the same.
    Uniform,
    /// Empty if all rows have the default value.
    Sparse,
}

/// Writes columns into files.
#[derive(Debug)]
pub struct PutColumns<'a>(pub &'a mut Writer);

impl Visitor for PutColumns<'_> {
    fn column<V: Value>(&mut self, about: Declared, column: &[V]) {
        match about.kind {
            Kind::Dense => {
                self.0.put_count(column.len());
                self.0.put_all(column);
            }
            Kind::Uniform => self.0.put_uniform(column),
            Kind::Sparse => self.0.put_sparse(column),
        }
    }
}

/// Reads columns from files. Their lengths may be wrong, see [`check_lengths`]. A uniform or sparse column has that of
/// the dense one before it, also of a table that contains it: the bytes of dense ones limit what a damaged file makes
/// of it.
#[derive(Debug)]
pub struct GetColumns<'a, 'b> {
    from: &'a mut Reader<'b>,
    len: usize,
}

impl<'a, 'b> GetColumns<'a, 'b> {
    /// Columns that begin with the next byte.
    pub fn new(from: &'a mut Reader<'b>) -> Self {
        Self { from, len: 0 }
    }
}

impl VisitorMut for GetColumns<'_, '_> {
    fn column<V: Value>(&mut self, about: Declared, column: &mut Vec<V>) -> Result<()> {
        *column = match about.kind {
            Kind::Dense => Saved::get(self.from)?,
            Kind::Uniform => self.from.get_uniform(self.len)?,
            Kind::Sparse => self.from.get_sparse(self.len)?,
        };
        if about.kind == Kind::Dense {
            self.len = column.len();
        }
        Ok(())
    }
}

/// Refuses a table of which a column does not have `expected` rows; `argument` gives the names of columns in errors.
pub fn check_lengths(
    table: &impl Table,
    expected: usize,
    argument: impl Fn(&'static str) -> &'static str,
) -> Result<()> {
    let mut lengths = Lengths { expected, wrong: None };
    table.visit(&mut lengths);
    lengths.wrong.map_or(Ok(()), |(name, found)| {
        Err(Error::Length { argument: argument(name), found, expected })
    })
}

/// Finds the first column with a wrong number of rows.
struct Lengths {
    expected: usize,
    wrong: Option<(&'static str, usize)>,
}

impl Visitor for Lengths {
    fn column<V: Value>(&mut self, about: Declared, column: &[V]) {
        let found = column.len();
        let is_right = found == self.expected || about.kind == Kind::Sparse && found == 0;
        if !is_right {
            self.wrong.get_or_insert((about.name, found));
        }
    }
}

/// The default value of rows that a sparse column does not have.
pub fn sparse_value<V: Copy + Default>(column: &[V], row: usize) -> V {
    column.get(row).copied().unwrap_or_default()
}

/// Columns with a value for each row.
pub mod dense {
    use super::Kind;
    use crate::error::Result;
    use crate::{memory, parallel};

    /// The type of a column.
    pub type Column<V> = Vec<V>;
    /// This kind.
    pub const KIND: Kind = Kind::Dense;

    /// See [`Table::reserve`](super::Table::reserve).
    pub fn reserve<V>(column: &mut Vec<V>, _other: &[V], len: usize) -> Result<()> {
        memory::reserve_len(column, len)
    }

    /// See [`Table::copied`](super::Table::copied).
    pub fn copied<V: Copy>(column: &[V]) -> Result<Vec<V>> {
        memory::copy(column)
    }

    /// See [`Table::gather`](super::Table::gather).
    pub fn gather<V: Copy + Default + Send + Sync>(
        column: &mut Vec<V>,
        source: &[V],
        order: &[u32],
        threads: Option<usize>,
    ) {
        parallel::gather(threads, column, source, order);
    }

    /// See [`Table::append`](super::Table::append).
    pub fn append<V: Copy>(column: &mut Vec<V>, _len: usize, other: &[V], _added: usize) {
        column.extend_from_slice(other);
    }

    /// See [`Table::put`](super::Table::put).
    pub fn put<V: Copy>(column: &mut [V], _len: usize, row: usize, other: &[V], from: usize) {
        column[row] = other[from];
    }

    /// See [`Table::move_row`](super::Table::move_row).
    pub fn move_row<V: Copy>(column: &mut [V], from: usize, to: usize) {
        column[to] = column[from];
    }

    /// See [`Table::keep`](super::Table::keep).
    pub fn keep<V>(column: &mut Vec<V>, keep: &[bool]) {
        let mut keep = keep.iter();
        // `retain` visits the rows in their order, once each, so the marks are read in step with
        // them.
        column.retain(|_| keep.next().is_some_and(|&keep| keep));
    }

    /// See [`Table::resize`](super::Table::resize).
    pub fn resize<V: Copy + Default>(column: &mut Vec<V>, len: usize) {
        column.resize(len, V::default());
    }

    /// A dense column stays as it is.
    pub fn drop_defaults<V>(_column: &mut Vec<V>) {}

    /// Changes the values of some rows; `change` gets the number of the row in `rows`. Rows from `len` on
    /// are left out.
    pub fn change<V>(column: &mut [V], _len: usize, rows: &[u32], change: impl Fn(usize, &mut V)) {
        for (nth, &row) in rows.iter().enumerate() {
            if let Some(value) = column.get_mut(row as usize) {
                change(nth, value);
            }
        }
    }
}

/// Dense columns that often have the same value in all rows.
pub mod uniform {
    use super::Kind;
    pub use super::dense::*;

    /// This kind.
    pub const KIND: Kind = Kind::Uniform;
}

/// Columns that are empty if all rows have the default value.
pub mod sparse {
    use super::{Kind, dense, memory, sparse_value};
    use crate::error::Result;

    /// The type of a column.
    pub type Column<V> = Vec<V>;
    /// This kind.
    pub const KIND: Kind = Kind::Sparse;

    /// See [`Table::reserve`](super::Table::reserve).
    pub fn reserve<V>(column: &mut Vec<V>, other: &[V], len: usize) -> Result<()> {
        let is_used = !(column.is_empty() && other.is_empty());
        memory::reserve_len(column, if is_used { len } else { 0 })
    }

    /// See [`Table::gather`](super::Table::gather).
    pub fn gather<V: Copy + Default + Send + Sync>(
        column: &mut Vec<V>,
        source: &[V],
        order: &[u32],
        threads: Option<usize>,
    ) {
        if source.is_empty() {
            column.clear();
        } else {
            dense::gather(column, source, order, threads);
        }
    }

    /// See [`Table::append`](super::Table::append).
    pub fn append<V: Copy + Default>(column: &mut Vec<V>, len: usize, other: &[V], added: usize) {
        if column.is_empty() && other.is_empty() {
            return;
        }
        // An empty column does not store how many rows it stands for: `len` has it. The last line
        // pads the rows of `other` if its column is empty.
        column.resize(len, V::default());
        column.extend_from_slice(other);
        column.resize(len + added, V::default());
    }

    /// See [`Table::put`](super::Table::put).
    pub fn put<V: Copy + Default + PartialEq>(
        column: &mut Vec<V>,
        len: usize,
        row: usize,
        other: &[V],
        from: usize,
    ) {
        let value = sparse_value(other, from);
        if column.is_empty() {
            // Nothing is written, so the column stays empty: a column with one default value would
            // cost the memory and the time of a dense one in each reorder.
            if value == V::default() {
                return;
            }
            column.resize(len, V::default());
        }
        column[row] = value;
    }

    pub use super::dense::{copied, keep};

    /// See [`Table::move_row`](super::Table::move_row).
    pub fn move_row<V: Copy>(column: &mut [V], from: usize, to: usize) {
        if !column.is_empty() {
            column[to] = column[from];
        }
    }

    /// See [`Table::resize`](super::Table::resize).
    pub fn resize<V: Copy + Default>(column: &mut Vec<V>, len: usize) {
        if !column.is_empty() {
            column.resize(len, V::default());
        }
    }

    /// See [`Table::drop_defaults`](super::Table::drop_defaults).
    pub fn drop_defaults<V: Default + PartialEq>(column: &mut Vec<V>) {
        if column.iter().all(|value| *value == V::default()) {
            column.clear();
        }
    }

    /// As [`dense::change`].
    pub fn change<V: Copy + Default + PartialEq>(
        column: &mut Vec<V>,
        len: usize,
        rows: &[u32],
        change: impl Fn(usize, &mut V),
    ) {
        let rows =
            || rows.iter().map(|&row| row as usize).enumerate().filter(|&(_, row)| row < len);
        let changed = |nth: usize, mut value: V| {
            change(nth, &mut value);
            value
        };
        if column.is_empty() {
            // `change` may be called twice for a row, here and below. It only computes a value, so
            // that is harmless and cheaper than a column that is made and emptied again.
            if rows().all(|(nth, _)| changed(nth, V::default()) == V::default()) {
                return;
            }
            column.resize(len, V::default());
        }
        let mut has_default = false;
        for (nth, row) in rows() {
            column[row] = changed(nth, column[row]);
            has_default |= column[row] == V::default();
        }
        // Only then can all rows have the default value; the search through the column costs as
        // much as its length, and this function may be called for one row of a million.
        if has_default {
            drop_defaults(column);
        }
    }
}

/// Tables in tables.
pub mod nested {
    pub use super::Table;
    use crate::error::Result;

    /// The type of a column.
    pub type Column<T> = T;

    /// See [`Table::reserve`].
    pub fn reserve<T: Table>(column: &mut T, other: &T, len: usize) -> Result<()> {
        column.reserve(other, len)
    }

    /// See [`Table::copied`].
    pub fn copied<T: Table>(column: &T) -> Result<T> {
        column.copied()
    }

    /// See [`Table::gather`].
    pub fn gather<T: Table>(column: &mut T, source: &T, order: &[u32], threads: Option<usize>) {
        column.gather(source, order, threads);
    }

    /// See [`Table::append`].
    pub fn append<T: Table>(column: &mut T, len: usize, other: &T, added: usize) {
        column.append(len, other, added);
    }

    /// See [`Table::put`].
    pub fn put<T: Table>(column: &mut T, len: usize, row: usize, other: &T, from: usize) {
        column.put(len, row, other, from);
    }

    /// See [`Table::move_row`].
    pub fn move_row<T: Table>(column: &mut T, from: usize, to: usize) {
        column.move_row(from, to);
    }

    /// See [`Table::keep`].
    pub fn keep<T: Table>(column: &mut T, keep: &[bool]) {
        column.keep(keep);
    }

    /// See [`Table::resize`].
    pub fn resize<T: Table>(column: &mut T, len: usize) {
        column.resize(len);
    }

    /// See [`Table::drop_defaults`].
    pub fn drop_defaults<T: Table>(column: &mut T) {
        column.drop_defaults();
    }
}

/// Declares a struct of columns, each `dense`, `uniform`, `sparse` or `nested`, and implements [`Table`] and
/// [`Saved`] for it.
#[macro_export]
macro_rules! table {
    (
        $(#[$about:meta])*
        $visible:vis struct $name:ident {
            $(
                $(#[doc = $doc:literal])*
                $field_visible:vis $field:ident: $kind:ident $type:ty,
            )*
        }
    ) => {
        $(#[$about])*
        $visible struct $name {
            $($(#[doc = $doc])* $field_visible $field: $crate::table::$kind::Column<$type>,)*
        }

        impl $crate::table::Table for $name {
            const ROW_SIZE: usize = 0 $(+ $crate::table!(@size $kind $type))*;

            fn reserve(&mut self, other: &Self, len: usize) -> $crate::error::Result<()> {
                $($crate::table::$kind::reserve(&mut self.$field, &other.$field, len)?;)*
                Ok(())
            }

            fn copied(&self) -> $crate::error::Result<Self> {
                Ok(Self { $($field: $crate::table::$kind::copied(&self.$field)?,)* })
            }

            fn gather(&mut self, source: &Self, order: &[u32], threads: Option<usize>) {
                $($crate::table::$kind::gather(&mut self.$field, &source.$field, order, threads);)*
            }

            fn append(&mut self, len: usize, other: &Self, added: usize) {
                $($crate::table::$kind::append(&mut self.$field, len, &other.$field, added);)*
            }

            fn put(&mut self, len: usize, row: usize, other: &Self, from: usize) {
                $($crate::table::$kind::put(&mut self.$field, len, row, &other.$field, from);)*
            }

            fn move_row(&mut self, from: usize, to: usize) {
                $($crate::table::$kind::move_row(&mut self.$field, from, to);)*
            }

            fn keep(&mut self, keep: &[bool]) {
                $($crate::table::$kind::keep(&mut self.$field, keep);)*
            }

            fn resize(&mut self, len: usize) {
                $($crate::table::$kind::resize(&mut self.$field, len);)*
            }

            fn drop_defaults(&mut self) {
                $($crate::table::$kind::drop_defaults(&mut self.$field);)*
            }

            fn visit(&self, visitor: &mut impl $crate::table::Visitor) {
                $($crate::table!(@visit $kind self, $field, visitor, visit, &);)*
            }

            fn visit_mut(
                &mut self,
                visitor: &mut impl $crate::table::VisitorMut,
            ) -> $crate::error::Result<()> {
                $($crate::table!(@visit $kind self, $field, visitor, visit_mut, &mut)?;)*
                Ok(())
            }
        }

        impl $crate::bytes::Saved for $name {
            fn put(&self, to: &mut $crate::bytes::Writer) {
                $crate::table::Table::visit(self, &mut $crate::table::PutColumns(to));
            }

            fn get(from: &mut $crate::bytes::Reader<'_>) -> $crate::error::Result<Self> {
                let mut all = Self::default();
                let mut columns = $crate::table::GetColumns::new(from);
                $crate::table::Table::visit_mut(&mut all, &mut columns)?;
                Ok(all)
            }
        }
    };
    (@size nested $type:ty) => { <$type as $crate::table::Table>::ROW_SIZE };
    (@size $kind:ident $type:ty) => { <$type as $crate::bytes::Plain>::SIZE };
    (@visit nested $self:ident, $field:ident, $visitor:ident, $visit:ident, $($rest:tt)*) => {
        $self.$field.$visit($visitor)
    };
    (@visit $kind:ident $self:ident, $field:ident, $visitor:ident, $visit:ident, &$($mut:ident)?) => {
        $visitor.column(
            $crate::table::Declared {
                name: stringify!($field),
                kind: $crate::table::$kind::KIND,
            },
            &$($mut)? $self.$field,
        )
    };
}

#[cfg(test)]
mod tests {
    use super::{Declared, Table, Value, Visitor};

    table! {
        #[derive(Clone, Debug, Default, PartialEq)]
        struct Inner {
            bits: sparse u8,
        }
    }

    table! {
        #[derive(Clone, Debug, Default, PartialEq)]
        struct All {
            numbers: dense u32,
            rare: sparse u64,
            inner: nested Inner,
        }
    }

    fn all(numbers: &[u32], rare: &[u64], bits: &[u8]) -> All {
        let inner = Inner { bits: bits.to_vec() };
        All { numbers: numbers.to_vec(), rare: rare.to_vec(), inner }
    }

    #[test]
    fn sparse_columns_stay_empty_or_get_defaults() {
        let mut own = all(&[1, 2], &[], &[]);
        own.append(2, &all(&[3], &[], &[7]), 1);
        assert_eq!(own, all(&[1, 2, 3], &[], &[0, 0, 7]));
        own.append(3, &all(&[4], &[5], &[]), 1);
        assert_eq!(own, all(&[1, 2, 3, 4], &[0, 0, 0, 5], &[0, 0, 7, 0]));
        own.keep(&[true, true, false, true]);
        assert_eq!(own, all(&[1, 2, 4], &[0, 0, 5], &[0, 0, 0]));
        own.drop_defaults();
        assert_eq!(own, all(&[1, 2, 4], &[0, 0, 5], &[]));
        own.put(3, 2, &all(&[9], &[], &[]), 0);
        own.put(3, 0, &all(&[8], &[], &[6]), 0);
        assert_eq!(own, all(&[8, 2, 9], &[0, 0, 0], &[6, 0, 0]));
        let mut other = all(&[0; 5], &[1; 5], &[]);
        other.gather(&all(&[1, 2], &[], &[3, 4]), &[1, 0, 1], Some(1));
        assert_eq!(other, all(&[2, 1, 2], &[], &[4, 3, 4]));
        other.resize(4);
        assert_eq!(other, all(&[2, 1, 2, 0], &[], &[4, 3, 4, 0]));
    }

    #[test]
    fn visitors_get_all_columns() {
        #[derive(Default)]
        struct Lengths(Vec<(&'static str, usize)>);
        impl Visitor for Lengths {
            fn column<V: Value>(&mut self, about: Declared, column: &[V]) {
                self.0.push((about.name, column.len()));
            }
        }
        let mut found = Lengths::default();
        all(&[1, 2], &[], &[3]).visit(&mut found);
        assert_eq!(found.0, [("numbers", 2), ("rare", 0), ("bits", 1)]);
    }
}
