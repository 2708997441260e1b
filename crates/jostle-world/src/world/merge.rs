//! Merging of particles that touch.
//!
//! During a step particles pass through each other. Each sub-step marks the candidate pairs
//! that touch along their straight displacements. At the end of the step each island of
//! touching particles merges into one. If merged particles overlap others, these merge too, in
//! a limited number of iterations.

use super::bodies::discs::Discs;
use super::bodies::ids::renumber;
use super::boundaries::Boundaries;
use super::edits::{Removal, take_out};
use super::record::record_pairs;
use super::search::overlapping;
use super::settings::{OnTouch, WorldSettings};
use super::turns::turns_between;
use super::{Stats, World};
use crate::container::Container;
use crate::motion::Motions;
use crate::particles::{FARTHEST, MASS_RANGE, Particles, Spin};
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::ids::Id;
use jostle_base::memory;
use jostle_base::parallel;
use jostle_base::table::Table;
use jostle_index::shapes::Filter;

/// Iterations in a step at most; the next step merges the remaining overlaps.
pub(crate) const ROUNDS: usize = 16;

/// A candidate pair of particles that may merge.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CandidateMerge {
    indices: [u32; 2],
    /// Offset that is added to the second (torus).
    image: [f32; 2],
    /// Sum of the radii.
    radius_sum: f32,
    has_touched: bool,
}

/// Lists the pairs to test.
pub(crate) fn list_candidates(
    lists: &[([f32; 2], Vec<[u32; 2]>)],
    all: &Particles,
    candidates: &mut Vec<CandidateMerge>,
) -> Result<()> {
    candidates.clear();
    for (image, pairs) in lists {
        for &indices in pairs {
            let [a, b] = indices.map(|index| index as usize);
            if all.movable[a] || all.movable[b] {
                let radius_sum = all.radii[a] + all.radii[b];
                let (image, has_touched) = (*image, false);
                let candidate = CandidateMerge { indices, image, radius_sum, has_touched };
                memory::push(candidates, candidate)?;
            }
        }
    }
    Ok(())
}

/// Marks the pairs that touched during the sub-step that has just ended.
pub(crate) fn mark_touching(
    candidates: &mut [CandidateMerge],
    motions: &Motions,
    threads: Option<usize>,
) {
    parallel::for_chunks(threads, candidates, |_, chunk| {
        chunk.iter_mut().for_each(|candidate| candidate.has_touched |= touched(candidate, motions));
    });
}

fn touched(candidate: &CandidateMerge, motions: &Motions) -> bool {
    let both = |f: fn(&Motions, u32) -> [f32; 2]| {
        let [a, b] = candidate.indices.map(|index| f(motions, index).map(f64::from));
        [b[0] - a[0], b[1] - a[1]]
    };
    let (offset, displacement) = (both(Motions::position), both(Motions::displacement));
    let end = [0, 1].map(|k| offset[k] + f64::from(candidate.image[k]));
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    // Two straight paths are nearest where the relative position is at a right angle to the
    // relative displacement.
    // The share of the displacement, back from its end, at which they are nearest.
    let back = if dot(displacement, displacement) > 0.0 {
        dot(end, displacement) / dot(displacement, displacement)
    } else {
        0.0
    };
    let back = back.clamp(0.0, 1.0);
    let nearest = [0, 1].map(|k| end[k] - displacement[k] * back);
    let radius_sum = f64::from(candidate.radius_sum);
    dot(nearest, nearest) < radius_sum * radius_sum
}

/// Merges the particles that touched, and those that merged particles then overlap.
pub(crate) fn merge(world: &mut World) -> Result<()> {
    if world.settings.on_touch != OnTouch::Merge {
        return Ok(());
    }
    let candidates = world.scratch.candidate_merges.iter();
    let has_touched = candidates.filter(|candidate| candidate.has_touched);
    let mut touching: Vec<[u32; 2]> = Vec::new();
    memory::extend(&mut touching, has_touched.map(|candidate| candidate.indices))?;
    let protocol = world.halo.protocol();
    // A merged particle is larger, and may overlap others that none of its parts has touched.
    // Each iteration merges these. The limit bounds the time of a step; the next step goes on.
    for _ in 0..ROUNDS {
        let own = world.halo.own_rows();
        // Pairs of two ghosts are found by the processes that own these particles.
        touching
            .retain(|pair| pair.iter().any(|&index| world.bodies.awake.rows[index as usize] < own));
        if world.settings.track_events {
            let World { record, bodies, halo, .. } = &mut *world;
            record_pairs(record, bodies, &**halo, touching.iter().copied())?;
        }
        if !world.halo().any(!touching.is_empty())? || !protocol.merge_islands(world, &touching)? {
            return Ok(());
        }
        protocol.gather_near(world)?;
        let World { bodies, settings, stats, .. } = &mut *world;
        touching = pairs_to_merge(&bodies.awake.particles, settings, stats)?;
    }
    Ok(())
}

/// The pairs of indices that overlap and may merge.
fn pairs_to_merge(
    particles: &Particles,
    settings: &WorldSettings,
    stats: &mut Stats,
) -> Result<Vec<[u32; 2]>> {
    let (overlaps, tests) = overlapping(particles, settings)?;
    stats.tests += tests;
    let is_sensor = |index: u32| particles.is_sensor(index as usize);
    let pairs = overlaps.into_iter().map(|overlap| overlap.indices);
    let mut found = Vec::new();
    memory::extend(&mut found, pairs.filter(|&[a, b]| !is_sensor(a) && !is_sensor(b)))?;
    Ok(found)
}

/// Merges each island of these pairs of indices; returns whether any merged.
pub(crate) fn merge_touching(world: &mut World, touching: &[[u32; 2]]) -> Result<bool> {
    // All that touch, also through others, become one particle at once. If pairs merged one
    // after the other, the result would depend on their order.
    let mut groups = DisjointSets::default();
    groups.reset(world.len())?;
    touching.iter().for_each(|&[a, b]| groups.join(a, b));
    let mut members: Vec<[u32; 2]> = memory::with_capacity(2 * touching.len())?;
    members.extend(touching.iter().flatten().map(|&index| [groups.root(index), index]));
    // By islands, then by indices: `union` adds in the canonical order.
    members.sort_unstable();
    members.dedup();
    // The new row of each old one, before renumbering: the smallest of its island.
    let mut heirs: Vec<u32> = memory::collect(0..world.len() as u32)?;
    let mut any = false;
    for group in members.chunk_by(|a, b| a[0] == b[0]) {
        let indices = memory::collect(group.iter().map(|&[_, index]| index as usize))?;
        let Some(one) = union(&world.bodies.awake.particles, &indices, &world.settings.container)
        else {
            continue;
        };
        any = true;
        let Discs { particles, rows, .. } = &world.bodies.awake;
        world.external.merge(particles, rows, &indices);
        let len = world.bodies.awake.rows.len();
        count_turns_of_merged(world, &indices, one.positions[0])?;
        world.bodies.awake.particles.reserve(&one, len)?;
        world.bodies.awake.particles.put(len, indices[0], &one, 0);
        let rows = indices.iter().map(|&index| world.bodies.awake.rows[index]);
        let first = rows.clone().fold(u32::MAX, u32::min);
        rows.for_each(|row| heirs[row as usize] = first);
        // The merged particle has the first index: it comes from the state, not from the row.
        let holder =
            indices.iter().position(|&index| world.bodies.awake.rows[index] == first).unwrap_or(0);
        world.bodies.awake.rows.swap(indices[0], indices[holder]);
    }
    if any {
        close_up(world, &heirs)?;
    }
    Ok(any)
}

/// The merged particle at the first of `indices` continues the path of that whose row it keeps: it is at its nearest
/// image.
fn count_turns_of_merged(world: &mut World, indices: &[usize], position: [f32; 2]) -> Result<()> {
    let period = world.settings.container.period();
    if period.is_none() {
        return Ok(());
    }
    let Discs { particles, rows, persistent } = &mut world.bodies.awake;
    let turns = &mut persistent.turns;
    memory::resize_default(turns, rows.len())?;
    let Some(&kept) = indices.iter().min_by_key(|&&index| rows[index]) else { return Ok(()) };
    let [from, to] = [particles.positions[kept], position].map(|at| at.map(f64::from));
    let more = turns_between(from, to, &period);
    turns[indices[0]] = [0, 1].map(|k| turns[kept][k].saturating_add(more[k]));
    Ok(())
}

/// Removes the rows that became others.
fn close_up(world: &mut World, heirs: &[u32]) -> Result<()> {
    let gone = memory::collect(heirs.iter().enumerate().map(|(row, &heir)| heir as usize != row))?;
    let rows = (0..heirs.len() as u32).filter(|&row| gone[row as usize]);
    let ids = |row: u32| [row, heirs[row as usize]].map(|row| world.bodies.ids.of(row));
    let mut merged = Vec::new();
    memory::extend(&mut merged, rows.map(ids))?;
    // A copy of all ids is needed only by steps in which something merges.
    if world.scratch.before.ids.is_none() {
        world.scratch.before.ids = Some(world.bodies.ids.copied()?);
    }
    inherit(&mut world.boundaries, &mut world.scratch.exhausted, heirs)?;
    let removal = Removal::new(world, gone)?;
    let Removal { gone, shifted, .. } = take_out(world, removal);
    // The step still needs these.
    world.boundaries.renumber_pushes(&gone, &shifted);
    renumber(&mut world.scratch.exhausted, |row| row, (&gone, &shifted));
    world.influences.renumber(|row| Some(Id::from(shifted[heirs[row as usize] as usize])));
    world.record.add_merged(merged)?;
    world.external.end_if_zero(&*world.halo)
}

/// Gives merged particles what has been recorded of their parts in this step: the impulses of walls, and
/// that one was exhausted. Their resting impulses begin with 0.
fn inherit(boundaries: &mut Boundaries, exhausted: &mut Vec<u32>, heirs: &[u32]) -> Result<()> {
    let mut has_merged = memory::filled(heirs.len(), false)?;
    for (row, &heir) in heirs.iter().enumerate().filter(|&(row, &heir)| row != heir as usize) {
        has_merged[row] = true;
        has_merged[heir as usize] = true;
    }
    boundaries.inherit(heirs, &has_merged);
    exhausted.iter_mut().for_each(|row| *row = heirs[*row as usize]);
    exhausted.sort_unstable();
    exhausted.dedup();
    Ok(())
}

/// The merged particle: the sums of area, mass and momentum at the centre of mass. None if it
/// would not be valid or not fit into the container.
pub(crate) fn union(
    all: &Particles,
    indices: &[usize],
    container: &Container,
) -> Option<Particles> {
    // Offsets from one member keep their digits far from the origin, and on a torus the members are
    // where their nearest images are.
    let origin = all.positions[indices[0]].map(f64::from);
    let mut mass = 0.0f64;
    let mut square = 0.0f64;
    let mut bounce = 0.0f64;
    let mut moment = [0.0f64; 2];
    let mut momentum = [0.0f64; 2];
    for &index in indices {
        let own = f64::from(all.masses[index]);
        let radius = f64::from(all.radii[index]);
        let offset = [0, 1].map(|k| f64::from(all.positions[index][k]) - origin[k]);
        let offset = container.period().exact().minimum_image(offset);
        mass += own;
        square += radius * radius;
        bounce += own * f64::from(all.restitution[index]);
        moment = [0, 1].map(|k| moment[k] + own * offset[k]);
        momentum = [0, 1].map(|k| momentum[k] + own * f64::from(all.velocities[index][k]));
    }
    let (whole, radius) = (mass as f32, square.sqrt() as f32);
    if !(whole <= MASS_RANGE[1] && radius <= FARTHEST && container.check_fit(&[radius]).is_ok()) {
        return None;
    }
    // An immovable particle must not move, so a merger with one does not conserve momentum. The
    // comparison is strict: of equal masses the first in the canonical order counts.
    // The position is that of the heaviest immovable particle, if there is any.
    let anchors = indices.iter().filter(|&&index| !all.movable[index]);
    let anchor = anchors
        .copied()
        .reduce(|best, next| if all.masses[next] > all.masses[best] { next } else { best });
    let (position, velocity) = match anchor {
        Some(index) => (all.positions[index], all.velocities[index]),
        None => {
            let center = [0, 1].map(|k| (origin[k] + moment[k] / mass) as f32);
            let limit = |speed: f64| (speed as f32).clamp(-FARTHEST, FARTHEST);
            // Divided by the rounded mass, so that momentum is conserved.
            let inside = container.period().wrap(container.clamp(center, radius));
            (inside, momentum.map(|p| limit(p / f64::from(whole))))
        }
    };
    Some(Particles {
        positions: vec![position],
        residuals: vec![[0.0; 2]],
        velocities: vec![velocity],
        radii: vec![radius],
        masses: vec![whole],
        restitution: vec![((bounce / mass) as f32).clamp(0.0, 1.0)],
        movable: vec![anchor.is_none()],
        spins: vec![spin_of(all, indices, container, radius)],
        filters: vec![filter_of(all, indices)],
        sensors: vec![],
        kinds: vec![kind_of(all, indices)],
    })
}

/// The kind of the heaviest of `indices`; the smallest of several.
fn kind_of(all: &Particles, indices: &[usize]) -> u8 {
    let mass = |index: usize| all.masses[index];
    let order = |a: usize, b: usize| {
        mass(a).total_cmp(&mass(b)).then_with(|| all.kind(b).cmp(&all.kind(a)))
    };
    let heaviest = indices.iter().copied().max_by(|&a, &b| order(a, b));
    heaviest.map_or(0, |index| all.kind(index))
}

/// The filter of the merged particle, which may touch whatever one of `indices` may touch.
fn filter_of(all: &Particles, indices: &[usize]) -> Filter {
    let none = Filter { category: 0, mask: 0 };
    indices.iter().map(|&index| all.filter(index)).fold(none, |sum, own| Filter {
        category: sum.category | own.category,
        mask: sum.mask | own.mask,
    })
}

/// The rotation of the merged particle at the first of `indices`: the mean friction weighted by mass,
/// the angle of the first, and, if any has friction or turns, the sum of angular momentum about the
/// centre of mass.
fn spin_of(all: &Particles, indices: &[usize], container: &Container, radius: f32) -> Spin {
    if indices.iter().all(|&index| Spin { angle: 0.0, ..all.spin(index) } == Spin::default()) {
        return Spin { angle: all.spin(indices[0]).angle, ..Spin::default() };
    }
    let origin = all.positions[indices[0]].map(f64::from);
    let velocity = |index: usize| all.velocities[index].map(f64::from);
    let [mut mass, mut friction, mut angular] = [0.0f64; 3];
    let [mut moment, mut momentum] = [[0.0f64; 2]; 2];
    // Orbital angular momentum about the first member, and that of rotation with the moment of
    // inertia m r²/2.
    for &index in indices {
        let (own, spin) = (f64::from(all.masses[index]), all.spin(index));
        let offset = [0, 1].map(|k| f64::from(all.positions[index][k]) - origin[k]);
        let ([x, y], [u, v]) = (container.period().exact().minimum_image(offset), velocity(index));
        let own_radius = f64::from(all.radii[index]);
        mass += own;
        friction += own * f64::from(spin.friction);
        angular += own * (x * v - y * u + 0.5 * own_radius * own_radius * f64::from(spin.velocity));
        moment = [moment[0] + own * x, moment[1] + own * y];
        momentum = [momentum[0] + own * u, momentum[1] + own * v];
    }
    // Of the motion of the centre of mass.
    angular -= (moment[0] * momentum[1] - moment[1] * momentum[0]) / mass;
    let inertia = 0.5 * mass * f64::from(radius) * f64::from(radius);
    let limit = |speed: f64| (speed as f32).clamp(-FARTHEST, FARTHEST);
    Spin {
        friction: (friction / mass) as f32,
        velocity: if inertia > 0.0 { limit(angular / inertia) } else { 0.0 },
        angle: all.spin(indices[0]).angle,
    }
}
