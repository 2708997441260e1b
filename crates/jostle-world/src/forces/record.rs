//! Records: what acts on particles is declared once, field by field.
//!
//! [`record!`] declares a struct and derives from its fields its bytes in snapshots, the particles and walls to which
//! it refers, and what becomes of it if these get other names. A type of fields says itself whether it refers to
//! anything, so no new struct and no new field can be forgotten.

use std::collections::HashSet;

use jostle_base::ids::Id;

/// Particles, and indices of walls.
#[derive(Debug, Default)]
pub struct References {
    pub ids: Vec<Id>,
    pub walls: Vec<u32>,
}

/// The new id of a particle; None if it was removed.
pub type Renamed<'a> = dyn Fn(Id) -> Option<Id> + 'a;

/// A struct of [`record!`], or one of its fields.
pub trait Record {
    /// Lists the particles and walls to which it refers.
    fn list(&self, to: &mut References);
    /// Renumbers particles. Returns false if it cannot do without those that were removed.
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool;
}

macro_rules! record {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($(#[$doc:meta])* pub $field:ident: $type:ty,)*
        }
    ) => {
        $(#[$meta])*
        pub struct $name {
            $($(#[$doc])* pub $field: $type,)*
        }

        jostle_base::saved! { struct $name { $($field),* } }

        impl $crate::forces::record::Record for $name {
            fn list(&self, to: &mut $crate::forces::record::References) {
                $($crate::forces::record::Record::list(&self.$field, to);)*
            }
            fn renumber(&mut self, renamed: &$crate::forces::record::Renamed<'_>) -> bool {
                true $(&& $crate::forces::record::Record::renumber(&mut self.$field, renamed))*
            }
        }
    };
}
pub(crate) use record;

macro_rules! refers_to_nothing {
    ($($type:ty),*) => {$(
        impl $crate::forces::record::Record for $type {
            fn list(&self, _: &mut $crate::forces::record::References) {}
            fn renumber(&mut self, _: &$crate::forces::record::Renamed<'_>) -> bool {
                true
            }
        }
    )*};
}
pub(crate) use refers_to_nothing;

refers_to_nothing! { u32, f32, [f32; 2], [bool; 4] }

/// A particle, without which there is nothing.
impl Record for Id {
    fn list(&self, to: &mut References) {
        to.ids.push(*self);
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        let new = renamed(*self);
        *self = new.unwrap_or(*self);
        new.is_some()
    }
}

/// Two different particles: if they merge, as if one was removed, there is nothing between them.
impl Record for [Id; 2] {
    fn list(&self, to: &mut References) {
        to.ids.extend(self);
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        self.iter_mut().all(|id| id.renumber(renamed)) && self[0] != self[1]
    }
}

/// Particles, of which removed ones are left out; merged ones are listed once.
impl Record for Vec<Id> {
    fn list(&self, to: &mut References) {
        to.ids.extend(self);
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        let mut known = HashSet::new();
        self.retain_mut(|id| id.renumber(renamed) && known.insert(*id));
        true
    }
}

/// The indices of walls.
impl Record for Vec<u32> {
    fn list(&self, to: &mut References) {
        to.walls.extend(self);
    }
    fn renumber(&mut self, _: &Renamed<'_>) -> bool {
        true
    }
}
