//! The file of a distributed world as one world. `jostle.mpi` writes it in parts: a head, the settings as a
//! snapshot without particles, a table of chunks with their checksums, and the chunks, which have the particles
//! of a range of ids and what the solver keeps of them.

use super::carried::take_kept;
use super::carried::{KEPT, Member, Push, Resting};
use super::distribute::of_records;
use super::edits::set_ids;
use super::islands::SleepingContact;
use super::{RECORD, read_records};
use crate::world::World;
use crate::world::islands::sleep::may_sleep;
use crate::world::snapshot::check::{check_sleeping, check_wall_impulses};
use jostle_base::bytes::{Plain, Reader, checksum, damaged};
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;

/// The first bytes.
const MAGIC: [u8; 16] = *b"jostle ranks\x1a\n\0\0";

/// Version of the format of the other bytes.
const VERSION: u64 = 5;

/// Ids of a chunk.
const CHUNK: u64 = 1 << 14;

/// Bytes of the rows of a chunk: particles, what is kept of them, contacts at rest, pushes of walls, members
/// of sleeping islands, and their contacts.
const SIZES: [usize; 6] =
    [RECORD, KEPT, Resting::SIZE, Push::SIZE, Member::SIZE, SleepingContact::SIZE];

/// Refuses the first bytes of `size` if neither a snapshot nor such a file begins with them, before
/// the others are read.
pub fn check_head(head: &[u8], size: u64) -> Result<()> {
    if are_parts(head) { Ok(()) } else { World::check_head(head, size) }
}

/// The world of a snapshot, or of a file that the ranks of a distributed world have written. Refuses
/// bytes that are neither, are cut off or damaged.
pub fn restore(bytes: &[u8]) -> Result<World> {
    if are_parts(bytes) { restore_parts(bytes) } else { World::restore(bytes) }
}

/// Whether bytes begin like such a file.
fn are_parts(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// The world of such a file.
fn restore_parts(bytes: &[u8]) -> Result<World> {
    let mut from = Reader::without_head(&bytes[MAGIC.len()..]);
    let version: u64 = from.get()?;
    if version != VERSION {
        let rule = format!("this version of jostle reads format {VERSION} of ranks");
        return Err(Error::of("data", format!("a file in format {version} of ranks"), &rule));
    }
    let (total, next): (u64, u64) = (from.get()?, from.get()?);
    let settings = from.get_count()?;
    let settings = World::restore(&from.get_all::<u8>(settings)?)?;
    let table: Vec<[u64; 2]> = from.get_all(next.div_ceil(CHUNK) as usize)?;
    // Each rank writes whole chunks with their own checksums. So the bytes of the file do not
    // depend on the number of ranks.
    let mut parts = [const { Vec::new() }; SIZES.len()];
    for [size, sum] in table {
        let chunk: Vec<u8> = from.get_all(size as usize)?;
        if checksum(&chunk) != sum {
            return Err(damaged("its checksum is wrong"));
        }
        let mut chunk = Reader::without_head(&chunk);
        let counts: [u64; SIZES.len()] = chunk.get()?;
        for ((part, count), size) in parts.iter_mut().zip(counts).zip(SIZES) {
            // A forged count must not overflow. Too many bytes are an error of the reader.
            part.extend(chunk.get_all::<u8>((count as usize).saturating_mul(size))?);
        }
        chunk.close()?;
    }
    from.close()?;
    let [records, kept, resting, pushes, members, touches] = &parts;
    let ids = read_records(records).1;
    if ids.len() as u64 != total {
        return Err(damaged("the number of its particles is wrong"));
    }
    let valid = |error: Error| damaged(&error.to_string());
    // First particles, then ids, then what is kept by ids. After that the same checks as for a
    // snapshot.
    let mut world = of_records(&settings, records).map_err(valid)?;
    set_ids(&mut world, &ids, next as Id).map_err(valid)?;
    take_kept(&mut world, [kept, resting, pushes, members, touches])?;
    check_wall_impulses(&world.boundaries, &world.bodies)?;
    check_sleeping(&world.bodies)?;
    if !world.bodies.asleep.is_empty()
        && !may_sleep(&world.settings, &world.influences, &world.boundaries.walls)
    {
        return Err(damaged("nothing can sleep in it"));
    }
    Ok(world)
}
