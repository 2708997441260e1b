//! Serialization of a world. A restored world continues with the same bits.
//!
//! The bytes contain everything that the next step depends on: settings, forces, particles in their canonical
//! order, and the impulses for warm starting; not the statistics of the last step. They may contain a text of the
//! caller.

mod defaults;
mod forces;
mod ids;
mod record;
mod sleepers;

use super::drive::check_walls;
use super::ids::Ids;
use super::touches::WallImpulse;
use super::{OnTouch, Walls, World, WorldSettings};
use crate::contacts::Contact;
use crate::container::Container;
use crate::forces::{self as all_forces, Force};
use crate::particles::{Particles, check_vectors};
use crate::walls::{Wall, index_of};
use defaults::{get_defaults, put_defaults};
use forces::{get_force, put_force};
use ids::{get_ids, put_ids};
use jostle_base::bytes::{Reader, Writer, damaged, foreign};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::settings::{Method, Settings};
use jostle_base::table::{Declared, Kind, Table, Value, Visitor, VisitorMut};
use record::{get_record, put_record};
use sleepers::{get_sleepers, put_sleepers};

/// The first bytes.
const MAGIC: [u8; 8] = *b"jostle\x1a\n";

/// Version of the format of the other bytes, the only one that is read. It changes with them.
const VERSION: u32 = 3;

impl World {
    /// The whole world in bytes, the same on every machine.
    ///
    /// ```
    /// use jostle_world::{Particles, World, WorldSettings};
    /// let disc = Particles::new(vec![[0.0, 0.0]], vec![[1.0, 0.0]], vec![1.0], 1.0);
    /// let mut world = World::new(disc, WorldSettings::default())?;
    /// let bytes = world.snapshot();
    /// world.step(0.1, 10)?;
    /// let again = World::restore(&bytes)?;
    /// assert_eq!(again.positions(), [[0.0, 0.0]]);
    /// # Ok::<(), jostle_base::Error>(())
    /// ```
    pub fn snapshot(&self) -> Vec<u8> {
        let mut to = Writer::with_capacity(48 * self.len() + 256);
        put_settings(&mut to, &self.settings);
        to.put(self.time);
        to.put_count(self.rows.len());
        to.put_count(self.asleep.len());
        to.put_all(&self.rows);
        put_particles(&mut to, &self.particles);
        put_contacts(&mut to, self.contacts.lasting().collect());
        put_wall_impulses(&mut to, &self.wall_impulses);
        to.put(!self.persistent.drifts.is_empty());
        to.put_all(&self.persistent.drifts);
        put_sleepers(&mut to, &self.asleep.copy());
        to.put_count(self.forces.len());
        self.forces.iter().for_each(|force| put_force(&mut to, force));
        put_walls(&mut to, self.walls());
        put_ids(&mut to, &self.ids);
        put_defaults(&mut to, &self.defaults);
        put_given(&mut to, self.given_accelerations());
        put_record(&mut to, self);
        put_attachment(&mut to, self.attachment());
        to.finish(MAGIC, VERSION)
    }

    /// Refuses the first bytes of `size` if no snapshot begins with them.
    pub(crate) fn check_head_of_whole(head: &[u8], size: u64) -> Result<()> {
        if head.len() as u64 == size || head.starts_with(&MAGIC) {
            Ok(())
        } else {
            Err(foreign(size))
        }
    }

    /// The world of a snapshot. Refuses bytes that are none, are cut off or damaged.
    pub(crate) fn restore_whole(bytes: &[u8]) -> Result<Self> {
        let mut from = Reader::open(bytes, MAGIC, VERSION)?;
        let valid = |error: Error| damaged(&error.to_string());
        let mut world = Self::default();
        world.configure(get_settings(&mut from)?).map_err(valid)?;
        world.time = from.get()?;
        if !world.time.is_finite() {
            return Err(damaged("its time is not finite"));
        }
        let len = from.get_count()?;
        let sleeping = from.get_count()?;
        let rows: Vec<u32> = from.get_all(len)?;
        world.add(get_particles(&mut from, len)?).map_err(valid)?;
        world.rows = rows;
        world.contacts.recall(get_contacts(&mut from, len)?, len);
        // Rows are checked below.
        world.wall_impulses = get_wall_impulses(&mut from, len.saturating_add(sleeping))?;
        if from.get()? {
            world.persistent.drifts = from.get_all(len)?;
        }
        let sleepers = get_sleepers(&mut from, sleeping, len)?;
        world.asleep.append(&sleepers, world.settings.tree).map_err(valid)?;
        world.forget_indices();
        world.ids = Ids::of_rows(world.len());
        let all_rows = world.rows.iter().copied().chain(world.asleep.rows()).map(Id::from);
        world.distinct_rows_of(&all_rows.collect::<Vec<Id>>()).map_err(valid)?;
        world.check_sleeping()?;
        let count = from.get_count()?;
        // Not reserved: a damaged count may be very large.
        let forces: Result<Vec<Force>> = (0..count).map(|_| get_force(&mut from)).collect();
        world.forces = forces?;
        let forces = &world.forces;
        all_forces::validate(forces, |row| world.contains(row)).map_err(valid)?;
        all_forces::check_kinds(forces, &world.kinds()).map_err(valid)?;
        all_forces::check_fit(forces, world.settings.container).map_err(valid)?;
        let WorldSettings { container, tree, .. } = world.settings;
        world.walls = Walls::new(get_walls(&mut from)?, container, tree).map_err(valid)?;
        world.walls.set_sides(world.settings.side_restitutions());
        check_walls(&world.forces, world.walls.all().len()).map_err(valid)?;
        world.ids = get_ids(&mut from, world.len())?;
        world.set_defaults(get_defaults(&mut from)?).map_err(valid)?;
        world.given = get_given(&mut from, world.len())?;
        get_record(&mut from, &mut world)?;
        world.attachment = get_attachment(&mut from)?;
        world.check_wall_impulses()?;
        if !world.asleep.is_empty() && !world.may_sleep() {
            return Err(damaged("nothing can sleep in it"));
        }
        from.close()?;
        Ok(world)
    }
}

fn put_settings(to: &mut Writer, settings: &WorldSettings) {
    to.put(settings.gravity);
    to.put([settings.drag, settings.restitution]);
    let (kind, numbers) = match settings.container {
        Container::None => (0u8, [0.0f32; 4]),
        Container::Box { min, max } => (1, [min[0], min[1], max[0], max[1]]),
        Container::Circle { center, radius } => (2, [center[0], center[1], radius, 0.0]),
        Container::Torus { size } => (3, [size[0], size[1], 0.0, 0.0]),
    };
    to.put(kind);
    to.put(numbers);
    to.put(match settings.on_touch {
        OnTouch::Bounce => 0u8,
        OnTouch::Merge => 1,
        OnTouch::Ignore => 2,
    });
    to.put(match settings.method {
        Method::Quadtree => 0u8,
        Method::Brute => 1,
    });
    let Settings { leaf_capacity, max_depth, threads } = settings.tree;
    let numbers = [settings.substeps.unwrap_or(0), leaf_capacity, max_depth, threads.unwrap_or(0)];
    numbers.into_iter().for_each(|number| to.put_count(number));
    to.put(settings.sleeping);
    to.put(settings.container_restitution);
}

fn get_settings(from: &mut Reader<'_>) -> Result<WorldSettings> {
    let gravity = from.get()?;
    let [drag, restitution] = from.get()?;
    let (kind, [a, b, c, d]): (u8, [f32; 4]) = (from.get()?, from.get()?);
    let container = match kind {
        0 => Container::None,
        1 => Container::Box { min: [a, b], max: [c, d] },
        2 => Container::Circle { center: [a, b], radius: c },
        3 => Container::Torus { size: [a, b] },
        _ => return Err(damaged("there is no such container")),
    };
    let on_touch = match from.get()? {
        0u8 => OnTouch::Bounce,
        1 => OnTouch::Merge,
        2 => OnTouch::Ignore,
        _ => return Err(damaged("there is no such on_touch")),
    };
    let method = match from.get()? {
        0u8 => Method::Quadtree,
        1 => Method::Brute,
        _ => return Err(damaged("there is no such method")),
    };
    let substeps = Some(from.get_count()?).filter(|&substeps| substeps > 0);
    let (leaf_capacity, max_depth) = (from.get_count()?, from.get_count()?);
    let threads = Some(from.get_count()?).filter(|&threads| threads > 0);
    let tree = Settings { leaf_capacity, max_depth, threads };
    let sleeping = from.get()?;
    let container_restitution = from.get()?;
    let base = WorldSettings { gravity, drag, restitution, container, ..WorldSettings::default() };
    let base = WorldSettings { container_restitution, ..base };
    Ok(WorldSettings { on_touch, method, substeps, sleeping, tree, ..base })
}

fn put_particles(to: &mut Writer, all: &Particles) {
    all.visit(&mut Put(to));
}

/// Writes columns.
struct Put<'a>(&'a mut Writer);

impl Visitor for Put<'_> {
    fn column<V: Value>(&mut self, about: Declared, column: &[V]) {
        match about.kind {
            Kind::Dense => self.0.put_all(column),
            Kind::Uniform => self.0.put_uniform(column),
            Kind::Sparse => {
                self.0.put(!column.is_empty());
                self.0.put_all(column);
            }
        }
    }
}

fn get_particles(from: &mut Reader<'_>, len: usize) -> Result<Particles> {
    let mut all = Particles::default();
    all.visit_mut(&mut Get { from, len })?;
    Ok(all)
}

/// Reads columns of `len` values.
struct Get<'a, 'b> {
    from: &'a mut Reader<'b>,
    len: usize,
}

impl VisitorMut for Get<'_, '_> {
    fn column<V: Value>(&mut self, about: Declared, column: &mut Vec<V>) -> Result<()> {
        *column = match about.kind {
            Kind::Dense => self.from.get_all(self.len)?,
            Kind::Uniform => self.from.get_uniform(self.len)?,
            Kind::Sparse if self.from.get()? => self.from.get_all(self.len)?,
            Kind::Sparse => Vec::new(),
        };
        Ok(())
    }
}

fn put_given(to: &mut Writer, given: &[[f32; 2]]) {
    to.put(u8::from(!given.is_empty()));
    to.put_all(given);
}

/// The given accelerations of `len` particles, if there are any.
fn get_given(from: &mut Reader<'_>, len: usize) -> Result<Option<Vec<[f32; 2]>>> {
    if from.get::<u8>()? == 0 {
        return Ok(None);
    }
    let given = from.get_all(len)?;
    check_vectors("accelerations", &given).map_err(|error| damaged(&error.to_string()))?;
    Ok(Some(given))
}

fn put_attachment(to: &mut Writer, text: Option<&str>) {
    to.put(text.is_some());
    if let Some(text) = text {
        to.put_count(text.len());
        to.put_all(text.as_bytes());
    }
}

fn get_attachment(from: &mut Reader<'_>) -> Result<Option<String>> {
    if !from.get()? {
        return Ok(None);
    }
    let len = from.get_count()?;
    let text = String::from_utf8(from.get_all(len)?);
    text.map(Some).map_err(|_| damaged("its attachment is not UTF-8"))
}

fn put_contacts(to: &mut Writer, contacts: Vec<&Contact>) {
    to.put_count(contacts.len());
    for contact in contacts {
        to.put(contact.indices);
        let [[x, y], [u, v]] = [contact.image, contact.normal];
        to.put([x, y, u, v, contact.gap, contact.impulse, contact.friction_impulse]);
        to.put(contact.totals);
        to.put(u8::from(contact.touched));
    }
}

fn get_contacts(from: &mut Reader<'_>, len: usize) -> Result<Vec<Contact>> {
    let mut contacts = Vec::new();
    for _ in 0..from.get_count()? {
        let indices: [u32; 2] = from.get()?;
        let numbers: [f32; 6] = from.get()?;
        let [friction_impulse, total, total_friction]: [f32; 3] = from.get()?;
        let touched = from.get::<u8>()? > 0;
        let [x, y, u, v, gap, impulse] = numbers;
        let known = indices.iter().all(|&index| (index as usize) < len) && indices[0] != indices[1];
        if !known {
            return Err(damaged("a contact is between no particles"));
        }
        let sums = [friction_impulse, total, total_friction];
        if numbers.iter().chain(&sums).any(|number| number.is_nan()) || impulse < 0.0 {
            return Err(damaged("a number of a contact is negative or NaN"));
        }
        let (image, normal) = ([x, y], [u, v]);
        let base = Contact { indices, image, normal, gap, touched, ..Contact::default() };
        let totals = [total, total_friction];
        contacts.push(Contact { impulse, friction_impulse, totals, ..base });
    }
    Ok(contacts)
}

fn put_wall_impulses(to: &mut Writer, all: &[WallImpulse]) {
    to.put_count(all.len());
    for WallImpulse { row, wall, impulses, pushes } in all {
        to.put([*row, *wall]);
        to.put(*impulses);
        to.put(*pushes);
    }
}

fn get_wall_impulses(from: &mut Reader<'_>, len: usize) -> Result<Vec<WallImpulse>> {
    let mut all = Vec::new();
    for _ in 0..from.get_count()? {
        let [row, wall]: [u32; 2] = from.get()?;
        let [impulses, pushes]: [[f32; 2]; 2] = from.get()?;
        let is_push = pushes[0] >= 0.0 && pushes.iter().all(|push| push.is_finite());
        if row as usize >= len {
            return Err(damaged("a wall has an impulse on no particle"));
        }
        if impulses.iter().any(|impulse| impulse.is_nan()) || !is_push {
            return Err(damaged("an impulse of a wall is not a number, or negative"));
        }
        all.push(WallImpulse { row, wall, impulses, pushes });
    }
    Ok(all)
}

fn put_walls(to: &mut Writer, walls: &[Wall]) {
    to.put_count(walls.len());
    for Wall { ends: [[a, b], [c, d]], restitution, friction, .. } in walls {
        to.put([*a, *b, *c, *d]);
        // No coefficient is below 0.
        to.put([*restitution, friction.unwrap_or(-1.0)]);
    }
    // A wall that was stopped has residuals, too.
    let move_or_moved = walls.iter().any(|wall| wall.moves() || wall.residuals != [[0.0; 2]; 2]);
    to.put(u8::from(move_or_moved));
    for Wall { residuals: [[a, b], [c, d]], velocity: [u, v], .. } in walls {
        if move_or_moved {
            to.put([*a, *b, *c, *d]);
            to.put([*u, *v]);
        }
    }
}

fn get_walls(from: &mut Reader<'_>) -> Result<Vec<Wall>> {
    let count = from.get_count()?;
    let mut all = Vec::new();
    // Not reserved: a damaged count may be very large.
    for _ in 0..count {
        let ([a, b, c, d], [restitution, friction]) = (from.get()?, from.get::<[f32; 2]>()?);
        let friction = (friction != -1.0).then_some(friction);
        all.push(Wall { restitution, friction, ..Wall::new([[a, b], [c, d]]) });
    }
    if from.get()? {
        for wall in &mut all {
            let [a, b, c, d] = from.get()?;
            (wall.residuals, wall.velocity) = ([[a, b], [c, d]], from.get()?);
        }
    }
    Ok(all)
}

impl World {
    /// Refuses restored impulses of walls that do not exist.
    pub(crate) fn check_wall_impulses(&self) -> Result<()> {
        let count = self.walls.all().len();
        let mut all = self.wall_impulses.iter().chain(&self.asleep.sleepers().wall_impulses);
        let is_known =
            |of: &WallImpulse| index_of(of.wall).is_none_or(|index| (index as usize) < count);
        if all.all(is_known) {
            Ok(())
        } else {
            Err(damaged("a wall has an impulse on no particle"))
        }
    }
}
