//! Fields: the columns of particles as callers see them, each declared once.
//!
//! Callers give friction, angular velocities and angles one by one, and the core keeps them in one column.
//! Records of particles, comparisons and [`Changes`] follow from the list of fields. Its order is that in which
//! [`Particles::compare`] compares.

use std::cmp::Ordering;

use super::{
    Particles, check_angles, check_angular_velocities, check_friction, check_kinds, check_masses,
    check_radii, check_restitution, check_vectors,
};
use jostle_base::bytes::Plain;
use jostle_base::error::Result;
use jostle_base::memory;
use jostle_base::table::{Table, dense, sparse, sparse_value};
use jostle_index::shapes::Each;

/// A value of a field: one number or several.
pub trait Field: Plain + Default + PartialEq {
    /// The type of its numbers.
    const NUMBER: &'static str;
    /// Bytes of a number.
    const WIDTH: usize;
    /// Orders two values; the order is total.
    fn compare(&self, other: &Self) -> Ordering;
}

macro_rules! numbers {
    ($($number:ident by $compare:path,)*) => {$(
        impl Field for $number {
            const NUMBER: &'static str = stringify!($number);
            const WIDTH: usize = size_of::<$number>();
            fn compare(&self, other: &Self) -> Ordering {
                $compare(self, other)
            }
        }
    )*};
}
numbers! { bool by Ord::cmp, u8 by Ord::cmp, u32 by Ord::cmp, f32 by f32::total_cmp, f64 by f64::total_cmp, }

impl<F: Field> Field for [F; 2] {
    const NUMBER: &'static str = F::NUMBER;
    const WIDTH: usize = F::WIDTH;
    fn compare(&self, other: &Self) -> Ordering {
        self[0].compare(&other[0]).then_with(|| self[1].compare(&other[1]))
    }
}

/// A visitor of the fields of a row.
pub trait FieldVisitor {
    /// Is called with each field.
    fn field<F: Field>(&mut self, name: &'static str, value: F);
}

/// A visitor that changes the fields of a row.
pub trait FieldVisitorMut {
    /// Is called with each field.
    fn field<F: Field>(&mut self, value: &mut F);
}

/// Checks the values of a column, or a part of each, if there is a check.
macro_rules! check {
    ([] $($rest:tt)*) => {};
    ([$check:expr] $type:ty, $column:expr) => {
        let check: fn(&[$type]) -> Result<()> = $check;
        check(&$column)?;
    };
    ([$check:expr] $type:ty, $column:expr, $part:ident) => {
        check!([$check] $type, memory::collect($column.iter().map(|value| value.$part))?);
    };
}

macro_rules! fields {
    ($(
        $(#[$doc:meta])*
        $name:ident: $type:ty = $kind:ident $column:ident$(.$part:ident)? $(, $check:expr)?;
    )*) => {
        /// New values of some fields, with a value for each of some particles or one for all of them.
        /// None leaves a field as it is.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Changes {
            $($(#[$doc])* pub $name: Option<Each<$type>>,)*
        }

        // A column without a field would be lost by records, ties and comparisons.
        const _: () = assert!(
            0 $(+ size_of::<$type>())* == <Particles as Table>::ROW_SIZE,
            "each column of particles needs a field"
        );

        impl Changes {
            /// Refuses fields that do not have `len` values, and values out of range.
            pub fn validate(&self, len: usize) -> Result<()> {
                $(if let Some(values) = &self.$name {
                    values.check_len(stringify!($name), len)?;
                    $(values.check($check)?;)?
                })*
                Ok(())
            }

            /// Reserves memory for [`Changes::write`] to particles of which there will be `len`.
            pub fn reserve(&self, to: &mut Particles, len: usize) -> Result<()> {
                $(if self.$name.is_some() {
                    memory::reserve_len(&mut to.$column, len)?;
                })*
                Ok(())
            }

            /// Writes each field into some rows.
            pub(super) fn write_fields(&self, to: &mut Particles, rows: &[u32]) {
                let len = to.len();
                $(if let Some(values) = &self.$name {
                    $kind::change(&mut to.$column, len, rows, |nth, value| {
                        (*value)$(.$part)? = values.at(nth);
                    });
                })*
            }
        }

        impl Particles {
            /// The first field that is in a column.
            pub(super) fn field_in(column: &'static str) -> &'static str {
                let all = [$((stringify!($column), stringify!($name))),*];
                all.into_iter().find(|of| of.0 == column).map_or(column, |of| of.1)
            }

            /// Refuses values out of range.
            pub(super) fn check_values(&self) -> Result<()> {
                $(check!([$($check)?] $type, self.$column $(, $part)?);)*
                Ok(())
            }

            /// Visits each field of a row.
            #[inline(always)]
            pub fn visit_row(&self, row: usize, visitor: &mut impl FieldVisitor) {
                $(visitor.field(
                    stringify!($name),
                    sparse_value(&self.$column, row)$(.$part)?,
                );)*
            }

            /// Visits each field of a row; the visitor may change it.
            #[inline(always)]
            pub fn visit_row_mut(&mut self, row: usize, visitor: &mut impl FieldVisitorMut) {
                let len = self.len();
                $(
                    self.$column.resize(len, Default::default());
                    visitor.field(&mut self.$column[row]$(.$part)?);
                )*
            }

            /// Orders two rows by all their values: a total order, the same on every machine.
            pub fn compare(&self, a: usize, b: usize) -> Ordering {
                let order = Ordering::Equal;
                $(let order = order.then_with(|| {
                    let [a, b] = [a, b].map(|row| sparse_value(&self.$column, row)$(.$part)?);
                    a.compare(&b)
                });)*
                order
            }

            /// The names of the fields in which a row differs from the same row of `other`.
            pub fn differences(
                &self,
                other: &Self,
                row: usize,
            ) -> impl Iterator<Item = &'static str> {
                let all = [$({
                    let [a, b] = [self, other].map(|of| sparse_value(&of.$column, row)$(.$part)?);
                    (a != b).then_some(stringify!($name))
                }),*];
                all.into_iter().flatten()
            }
        }
    };
}

fields! {
    /// Centres.
    positions: [f32; 2] = dense positions, |all| check_vectors("positions", all);
    /// Residuals of the centres; 0 if there are new centres without residuals.
    residuals: [f32; 2] = dense residuals, |all| check_vectors("residuals", all);
    /// Velocities.
    velocities: [f32; 2] = dense velocities, |all| check_vectors("velocities", all);
    /// Radii.
    radii: f32 = dense radii, check_radii;
    /// Masses.
    masses: f32 = dense masses, check_masses;
    /// Coefficients of restitution.
    restitution: f32 = dense restitution, check_restitution;
    /// Coefficients of friction.
    friction: f32 = sparse spins.friction, check_friction;
    /// Angular velocities.
    angular_velocities: f32 = sparse spins.velocity, check_angular_velocities;
    /// Angles in radians.
    angles: f64 = sparse spins.angle, check_angles;
    /// Whether the particles are movable.
    movable: bool = dense movable;
    /// Categories.
    categories: u32 = sparse filters.category;
    /// Masks.
    masks: u32 = sparse filters.mask;
    /// Whether the particles are sensors.
    sensors: bool = sparse sensors;
    /// Kinds.
    kinds: u8 = sparse kinds, check_kinds;
}
