//! Serialization of a world. A restored world continues with the same bits.
//!
//! The bytes contain everything that the next step depends on: settings, forces, particles in their canonical
//! order, and the impulses for warm starting; not the statistics of the last step. They may contain a text of the
//! caller. Each type declares its fields once, with [`saved!`](jostle_base::saved!) or
//! [`plain!`](jostle_base::plain!), and the columns are those of [`table!`](jostle_base::table!). `check` refuses what
//! no world can have.

pub(crate) mod check;

use super::boundaries::Boundaries;
use super::islands::Islands;
use super::plan::start_threads;
use super::{Stats, StepScratch, World};
use jostle_base::bytes::{Reader, Saved, Writer, foreign};
use jostle_base::error::Result;

/// The first bytes.
const MAGIC: [u8; 8] = *b"jostle\x1a\n";

/// Version of the format of the other bytes, the only one that is read. It changes with them.
const VERSION: u32 = 17;

impl Saved for World {
    fn put(&self, to: &mut Writer) {
        // Without `..`, so that the compiler asks for each new field.
        #[rustfmt::skip]
        let Self {
            settings, time, bodies, contacts, boundaries, influences, external, record, attachment,
            stats: _, halo: _, islands: _, scratch: _,
        } = self;
        settings.put(to);
        time.put(to);
        bodies.put(to);
        contacts.put(to);
        boundaries.impulses.put(to);
        influences.put(to);
        boundaries.walls.put(to);
        boundaries.ids.put(to);
        external.put(to);
        record.put(to);
        attachment.put(to);
    }

    fn get(from: &mut Reader<'_>) -> Result<Self> {
        // Without `..Self::default()`, so that the compiler asks for each new field.
        let (settings, time) = (Saved::get(from)?, Saved::get(from)?);
        let (bodies, contacts) = (Saved::get(from)?, Saved::get(from)?);
        let (impulses, influences) = (Saved::get(from)?, Saved::get(from)?);
        let (walls, wall_ids) = (Saved::get(from)?, Saved::get(from)?);
        Ok(Self {
            settings,
            time,
            bodies,
            contacts,
            boundaries: Boundaries::new(walls, wall_ids, impulses),
            influences,
            external: Saved::get(from)?,
            record: Saved::get(from)?,
            attachment: Saved::get(from)?,
            stats: Stats::default(),
            halo: Box::default(),
            islands: Islands::default(),
            scratch: StepScratch::default(),
        })
    }
}

impl World {
    /// The whole world in bytes, the same on every machine.
    ///
    /// ```
    /// use jostle_world::{Particles, World, WorldSettings};
    /// let disc = Particles::new(vec![[0.0, 0.0]], vec![[1.0, 0.0]], vec![1.0], 1.0);
    /// let mut world = World::new(disc, WorldSettings::default())?;
    /// let bytes = world.snapshot()?;
    /// world.step(0.1, 10)?;
    /// let again = World::restore(&bytes)?;
    /// assert_eq!(again.bodies().positions()?, [[0.0, 0.0]]);
    /// # Ok::<(), jostle_base::Error>(())
    /// ```
    pub fn snapshot(&self) -> Result<Vec<u8>> {
        let mut to = Writer::with_capacity(48 * self.len() + 256);
        self.put(&mut to);
        to.finish(MAGIC, VERSION)
    }

    /// Refuses the first bytes of `size` if no snapshot begins with them.
    pub fn check_head(head: &[u8], size: u64) -> Result<()> {
        if head.len() as u64 == size || head.starts_with(&MAGIC) {
            Ok(())
        } else {
            Err(foreign(size))
        }
    }

    /// The world of a snapshot. Refuses bytes that are none, are cut off or damaged.
    pub fn restore(bytes: &[u8]) -> Result<Self> {
        let mut from = Reader::open(bytes, MAGIC, VERSION)?;
        let mut world = Self::get(&mut from)?;
        from.close()?;
        check::finish(&mut world)?;
        start_threads(&world);
        Ok(world)
    }
}
