//! Records: what acts on particles is declared once, field by field.
//!
//! [`record!`] declares a struct and derives from its fields its bytes in snapshots, the particles and walls to which
//! it refers, and what becomes of it if these get other names. A type of fields says itself whether it refers to
//! anything, so no new struct and no new field can be forgotten.

use std::collections::HashSet;

use super::check_distinct;
use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

/// What a record refers to.
#[derive(Clone, Copy, Debug)]
pub enum Reference {
    Particle(Id),
    /// The id of a wall.
    Wall(Id),
}

/// The ids of walls. Unlike particles, walls have their ids inside the world, too: few records refer to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallIds(pub Vec<Id>);

impl WallIds {
    /// Refuses ids that no wall can have, and ids given twice.
    pub fn validate(&self) -> Result<()> {
        match self.0.iter().position(|&wall| wall < 0) {
            Some(index) => {
                Err(Error::missing("walls", index, self.0[index], "no wall has this id"))
            }
            None => check_distinct("walls", &self.0),
        }
    }
}

impl Saved for WallIds {
    fn put(&self, to: &mut Writer) {
        self.0.put(to);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        Saved::get(from).map(Self)
    }
}

/// Called with each reference. A step asks for them, so they are not collected.
pub type Found<'a> = dyn FnMut(Reference) + 'a;

/// The new id of a particle; None if it was removed.
pub type Renamed<'a> = dyn Fn(Id) -> Option<Id> + 'a;

/// Whether a wall is removed.
pub type Gone<'a> = dyn Fn(Id) -> bool + 'a;

/// A struct of [`record!`], or one of its fields.
pub trait Record {
    /// Calls `found` with the particles and walls to which it refers.
    fn list(&self, found: &mut Found<'_>);
    /// Renumbers particles. Returns false if it cannot do without those that were removed.
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool;
    /// Leaves out walls that are gone.
    fn forget_walls(&mut self, _is_gone: &Gone<'_>) {}
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
            fn list(&self, found: &mut $crate::forces::record::Found<'_>) {
                $($crate::forces::record::Record::list(&self.$field, found);)*
            }
            fn renumber(&mut self, renamed: &$crate::forces::record::Renamed<'_>) -> bool {
                true $(&& $crate::forces::record::Record::renumber(&mut self.$field, renamed))*
            }
            fn forget_walls(&mut self, is_gone: &$crate::forces::record::Gone<'_>) {
                $($crate::forces::record::Record::forget_walls(&mut self.$field, is_gone);)*
            }
        }
    };
}
pub(crate) use record;

macro_rules! refers_to_nothing {
    ($($type:ty),*) => {$(
        impl $crate::forces::record::Record for $type {
            fn list(&self, _: &mut $crate::forces::record::Found<'_>) {}
            fn renumber(&mut self, _: &$crate::forces::record::Renamed<'_>) -> bool {
                true
            }
        }
    )*};
}
pub(crate) use refers_to_nothing;

refers_to_nothing! { u32, f32, [f32; 2], [f32; 4], [bool; 5] }

/// A particle, without which there is nothing.
impl Record for Id {
    fn list(&self, found: &mut Found<'_>) {
        found(Reference::Particle(*self));
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        let new = renamed(*self);
        *self = new.unwrap_or(*self);
        new.is_some()
    }
}

/// Two different particles: if they merge, as if one was removed, there is nothing between them.
impl Record for [Id; 2] {
    fn list(&self, found: &mut Found<'_>) {
        self.iter().for_each(|&id| found(Reference::Particle(id)));
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        self.iter_mut().all(|id| id.renumber(renamed)) && self[0] != self[1]
    }
}

/// Particles, of which removed ones are left out; merged ones are listed once.
impl Record for Vec<Id> {
    fn list(&self, found: &mut Found<'_>) {
        self.iter().for_each(|&id| found(Reference::Particle(id)));
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        let mut known = HashSet::new();
        self.retain_mut(|id| id.renumber(renamed) && known.insert(*id));
        true
    }
}

/// They change only if walls are removed, see [`Record::forget_walls`].
impl Record for WallIds {
    fn list(&self, found: &mut Found<'_>) {
        self.0.iter().for_each(|&wall| found(Reference::Wall(wall)));
    }
    fn renumber(&mut self, _: &Renamed<'_>) -> bool {
        true
    }
    fn forget_walls(&mut self, is_gone: &Gone<'_>) {
        self.0.retain(|&wall| !is_gone(wall));
    }
}
