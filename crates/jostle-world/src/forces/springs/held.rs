//! Springs of stiff bodies that are near anything, solved together with the resting contacts.
//!
//! With the direction n of a spring, its stretch s and the velocity w of its second end relative to
//! the first, its tension in a sub-step of h seconds is J = h (k (s + h n·w) + c n·w), where w is
//! that at the end of the sub-step (D. Baraff and A. Witkin, *Large Steps in Cloth Simulation*,
//! 1998). This is stable at any stiffness and never adds energy; it damps oscillations that are
//! fast compared with the sub-step. The tensions of a body are the solution of a symmetric positive
//! definite system, which the method of conjugate gradients finds. All impulses are between pairs,
//! so momentum is conserved after any number of iterations.
//!
//! Resting contacts and springs take turns, each with the velocities that the others leave. The
//! iterations of contacts know the mass of one particle, but what they push is the whole body. So
//! the system of a turn of the springs includes the contacts that push, as springs without softness
//! that only push (M. Silcowitz et al., *Projected Gauss-Seidel Subspace Minimization Method for
//! Interactive Rigid Body Dynamics*, 2010). The contacts find out which of them push.

use std::ops::Range;

use super::{SpringSolver, bounded, rate};
use crate::flow::{Flow, Kick};
use crate::motion::{Motions, Vectors, exact};
use crate::particles::Particles;
use crate::walls::{self, Around};
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::Result;
use jostle_base::memory;

/// Iterations of the method of conjugate gradients in each turn of the springs at most.
const ITERATIONS: usize = 24;

/// Square of the relative error of the tensions with which a turn ends.
const ERROR: f64 = 1e-8;

/// Particles are near each other if they could meet within this many sub-steps.
const SUBSTEPS: f32 = 2.0;

/// And if their gap is at most this share of the sum of radii.
const NEAR: f32 = 0.01;

/// Stands for no body.
const NONE: u32 = u32::MAX;

/// Share of the diagonal of the system by which contacts are soft, so that it has a solution where
/// contacts contradict each other.
const SOFTNESS: f64 = 1e-6;

/// Scratch.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The stiff body of each particle.
    body_of: Vec<u32>,
    found: Vec<walls::WallContact>,
    /// Whether any body is held.
    pub any: bool,
    /// The particles of held bodies, and those that they touch.
    ends: Vec<End>,
    /// The number of each particle among these.
    end_of: Vec<u32>,
    ties: Vec<Tie>,
    groups: DisjointSets,
    /// Ranges of ties that share particles.
    systems: Vec<Range<usize>>,
}

/// What decides whether a body is near anything.
pub struct Surroundings<'a> {
    /// The particles.
    pub particles: &'a Particles,
    /// Positions and velocities at the beginning of the sub-step.
    pub motions: &'a Motions,
    /// The walls.
    pub walls: Around<'a>,
    /// What other forces do in the sub-step.
    pub kicks: &'a [Kick],
    /// The sub-step.
    pub flow: &'a Flow,
}

/// A particle in a system.
#[derive(Clone, Copy, Debug, Default)]
struct End {
    index: u32,
    inverse_mass: f64,
    velocity: [f64; 2],
    change: [f64; 2],
}

/// A spring of a held body, or a contact of one of its particles.
#[derive(Clone, Copy, Debug, Default)]
struct Tie {
    /// The system to which it belongs: the first of its particles.
    system: u32,
    /// Its place in the list before the systems are sorted.
    at: u32,
    ends: [u32; 2],
    /// Where its impulse is kept; None for springs.
    place: Option<Place>,
    /// From the first end to the second.
    along: [f64; 2],
    /// Change of the rate of lengthening that an impulse of 1 stands for: 1/(h² k + h c).
    softness: f64,
    /// The rate at which a spring without tension would lengthen, and a contact shorten.
    rate: f64,
    /// The tension; of a contact, its change in a turn.
    impulse: f64,
    /// One over the diagonal of the system; 0 for contacts that do not push.
    inverse: f64,
    residual: f64,
    search: f64,
    image: f64,
}

/// Where the impulse of a contact is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a lane of a block of contacts of two particles.
    Pair {
        /// The number of the block.
        block: u32,
        /// The lane.
        lane: u32,
    },
    /// At a wall of a particle.
    Wall {
        /// The number of the particle among those at walls.
        particle: u32,
        /// The number of the contact among those of the particle.
        contact: u32,
    },
}

/// A resting contact in a turn of the springs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Push {
    /// The direction in which it pushes the second particle, or the particle at a wall.
    pub normal: [f32; 2],
    /// The speed along the normal with which the surfaces separate at least.
    pub least_speed: f32,
    /// The impulse, of a wall over the mass of the particle.
    pub impulse: f32,
}

/// The resting contacts of a sub-step.
pub trait Pushes {
    /// A contact.
    fn get(&self, place: Place) -> Push;
    /// Replaces the impulse of a contact.
    fn set(&mut self, place: Place, impulse: f32);
}

impl Surroundings<'_> {
    /// The velocity of a particle, and its change by gravity and forces other than springs.
    fn velocities(&self, index: u32) -> [[f64; 2]; 2] {
        let Kick { before, after, .. } = self.kicks[index as usize];
        let Flow { gravity, duration, .. } = self.flow;
        let is_pulled = self.particles.movable[index as usize];
        // In flight the velocity changes by gravity, before and after it by the kicks.
        let change = |k: usize| before[k] + gravity[k] * duration + after[k];
        let change = [0, 1].map(|k| if is_pulled { change(k) } else { 0.0 });
        [self.motions.velocity(index).map(f64::from), change]
    }

    /// How far a particle with such velocities may get in the next sub-steps.
    fn reach(&self, velocities: [[f64; 2]; 2]) -> f32 {
        let [own, change] = velocities.map(|[x, y]| (x * x + y * y).sqrt());
        SUBSTEPS * ((own + change) * self.flow.duration) as f32
    }

    /// Whether the particles of a contact are near each other.
    fn are_near(&self, [a, b]: [u32; 2], image: [f32; 2], contact_distance: f32) -> bool {
        let ([p, q], [v, w]) = (
            [a, b].map(|index| self.motions.position(index)),
            [a, b].map(|index| self.velocities(index)),
        );
        let relative = [0, 1].map(|which| [0, 1].map(|k| w[which][k] - v[which][k]));
        // The relative speed counts, because two bodies that fall together do not meet.
        let far = (1.0 + NEAR) * contact_distance + self.reach(relative);
        let [x, y] = [0, 1].map(|k| q[k] - p[k] + image[k]);
        x * x + y * y <= far * far
    }

    /// Whether a particle is near a wall or a side of the container.
    fn is_near_wall(&self, index: u32, found: &mut Vec<walls::WallContact>) -> bool {
        let position = self.motions.position(index);
        let radius = self.particles.radii[index as usize];
        let far = self.reach(self.velocities(index)) + NEAR * radius;
        let container = self.walls.container;
        // A cheap test leaves out particles far from all sides.
        if !container.is_far(position.map(f64::from), f64::from(radius), [f64::from(far); 2]) {
            let at = self.motions.exact(index);
            let mut sides = container.sides();
            if sides.any(|(wall, side)| side.contact(wall, at, f64::from(radius)).gap as f32 <= far)
            {
                return true;
            }
        }
        if self.walls.is_empty() || self.walls.is_far(index, position, far) {
            return false;
        }
        let at = (exact(position, self.motions.residual(index)), 0.0);
        self.walls.contacts(index, at, f64::from(radius), f64::from(far), found);
        !found.is_empty()
    }
}

impl SpringSolver {
    /// Whether resting contacts and springs are solved together in this sub-step.
    pub fn holds_any(&self) -> bool {
        self.held.any
    }

    /// Finds out which bodies are held in a sub-step: those that are stiff and near anything.
    /// `each_pair` calls a function with the particles of each contact that the step may have, the
    /// image of the second particle, and the distance at which they touch.
    pub fn find_held(
        &mut self,
        of: &Surroundings<'_>,
        each_pair: impl FnOnce(&mut dyn FnMut([u32; 2], [f32; 2], f32)),
    ) -> Result<()> {
        let h = of.flow.seconds;
        let Self { bodies, nodes, held, .. } = self;
        // What is held is decided anew in each sub-step: a body in free flight keeps the energy of
        // its oscillations, and one that is held loses it.
        bodies.iter_mut().for_each(|body| body.is_held = false);
        held.any = false;
        if !bodies.iter().any(|body| body.is_stiff(h)) {
            return Ok(());
        }
        held.body_of.clear();
        memory::resize(&mut held.body_of, of.particles.len(), NONE)?;
        for (number, body) in bodies.iter_mut().enumerate().filter(|(_, body)| body.is_stiff(h)) {
            // An immovable particle may be an end of springs of several bodies, and belongs to
            // none.
            let own = nodes[body.nodes.clone()].iter().filter(|node| node.inverse_mass > 0.0);
            for node in own {
                held.body_of[node.index as usize] = number as u32;
                body.is_held |= of.is_near_wall(node.index, &mut held.found);
            }
        }
        each_pair(&mut |pair, image, contact_distance| {
            let names = pair.map(|index| held.body_of[index as usize]);
            // This pair cannot hold any further body.
            if names.iter().all(|&name| name == NONE || bodies[name as usize].is_held) {
                return;
            }
            if of.are_near(pair, image, contact_distance) {
                names.into_iter().filter(|&name| name != NONE).for_each(|name| {
                    bodies[name as usize].is_held = true;
                });
            }
        });
        held.any = bodies.iter().any(|body| body.is_held);
        Ok(())
    }

    /// Begins a sub-step: directions and stretches of the springs of held bodies. Calls `pull` with
    /// the index of each particle and the change of velocity that its springs would give it, each
    /// alone.
    pub fn begin_held(
        &mut self,
        flow: &Flow,
        motions: &Motions,
        movable: &[bool],
        mut pull: impl FnMut(u32, [f64; 2]),
    ) -> Result<()> {
        let Self { bodies, links, nodes, container, held, .. } = self;
        let Scratch { ends, end_of, ties, .. } = held;
        ends.clear();
        ties.clear();
        end_of.clear();
        memory::resize(end_of, movable.len(), NONE)?;
        for body in bodies.iter().filter(|body| body.is_held) {
            memory::reserve(ends, body.nodes.len())?;
            memory::reserve(ties, body.links.len())?;
            for node in &mut nodes[body.nodes.clone()] {
                let motion = motions.get(node.index);
                node.position = exact(motion.position, motion.residual);
                node.velocity = motion.velocity.map(f64::from);
                let is_movable = movable[node.index as usize];
                end(ends, end_of, node.index, if is_movable { node.inverse_mass } else { 0.0 });
            }
            for link in &links[body.links.clone()] {
                let [a, b] = link.nodes.map(|node| nodes[node as usize]);
                let (along, length) = link.direction(&a, &b, container);
                // J = h k s + (h² k + h c) w, with the rate w at the end of the sub-step. Divided
                // by the gain h² k + h c this is w plus a known rate, and one over the gain is the
                // softness of the tie.
                let gain = flow.seconds * (link.stiffness * flow.duration + link.damping);
                // A spring without stiffness and damping, or without a direction, has no tension.
                if gain == 0.0 || along == [0.0; 2] {
                    continue;
                }
                let pair = [&a, &b].map(|node| end_of[node.index as usize]);
                let masses = pair.map(|end| ends[end as usize].inverse_mass);
                let tie = Tie {
                    ends: pair,
                    along,
                    softness: 1.0 / gain,
                    rate: flow.seconds * link.stiffness * (length - link.length) / gain,
                    inverse: 1.0 / (masses[0] + masses[1] + 1.0 / gain),
                    ..Tie::default()
                };
                // The first guess treats each spring as if it were alone. It only serves to find
                // out which contacts rest.
                let impulse = (rate(along, &a, &b) + tie.rate) * tie.inverse;
                tie.push(ends, impulse);
                ties.push(tie);
            }
            for node in &nodes[body.nodes.clone()] {
                let change = &mut ends[end_of[node.index as usize] as usize].change;
                pull(node.index, change.map(bounded));
                *change = [0.0; 2];
            }
        }
        Ok(())
    }

    /// Adds the resting contacts of the particles of held bodies, and finds the systems. `pushes`
    /// are the places of contacts, their particles and one over the masses of these; a contact with
    /// a wall has one particle twice.
    pub fn add_pushes(
        &mut self,
        pushes: impl Iterator<Item = (Place, [u32; 2], [f32; 2])>,
    ) -> Result<()> {
        let Scratch { ends, end_of, ties, groups, systems, .. } = &mut self.held;
        // Ends from here on belong to contacts only.
        let springs = ends.len() as u32;
        for (place, pair, masses) in pushes {
            // Neither particle is an end of a held spring: `NONE` is above all numbers. The
            // contacts decide such a pair by themselves.
            if pair.iter().all(|&index| end_of[index as usize] >= springs) {
                continue;
            }
            memory::reserve(ends, 2)?;
            let of = |k: usize| end(ends, end_of, pair[k], f64::from(masses[k]));
            let tie = Tie { ends: [0, 1].map(of), place: Some(place), ..Tie::default() };
            memory::push(ties, tie)?;
        }
        groups.reset(ends.len())?;
        // An immovable particle transmits nothing, so it joins no systems.
        let moves = |end: u32| ends[end as usize].inverse_mass > 0.0;
        for &Tie { ends: [a, b], .. } in &*ties {
            if moves(a) && moves(b) {
                groups.join(a, b);
            }
        }
        for tie in ties.iter_mut() {
            let [a, b] = tie.ends;
            tie.system = groups.root(if moves(a) { a } else { b });
        }
        // Stable, so that the order within a system follows from the state.
        for (tie, at) in ties.iter_mut().zip(0..) {
            tie.at = at;
        }
        ties.sort_unstable_by_key(|tie| (tie.system, tie.at));
        systems.clear();
        let mut start = 0;
        for run in ties.chunk_by(|a, b| a.system == b.system) {
            memory::push(systems, start..start + run.len())?;
            start += run.len();
        }
        Ok(())
    }

    /// The places of the contacts that are solved together with springs.
    pub fn places(&self) -> impl Iterator<Item = Place> {
        self.held.ties.iter().filter_map(|tie| tie.place)
    }

    /// A turn of the springs of held bodies: changes their tensions, the impulses of the contacts
    /// that push, and the velocities. In the first turn springs begin with a share of the tensions
    /// that they have at rest.
    pub fn take_turn(&mut self, velocities: &Vectors, pushes: &mut impl Pushes, is_first: bool) {
        let Scratch { ends, ties, systems, .. } = &mut self.held;
        for end in ends.iter_mut() {
            end.velocity = velocities.get(end.index).map(f64::from);
        }
        // Systems share no moving particle, so each is solved by itself.
        for range in &*systems {
            let ties = &mut ties[range.clone()];
            for tie in ties.iter_mut() {
                tie.read(pushes, ends);
            }
            let mut system = System { ties, ends };
            if is_first {
                system.begin();
            }
            system.iterate();
            for tie in &*ties {
                tie.write(pushes, ends);
            }
        }
        for end in ends.iter().filter(|end| end.inverse_mass > 0.0) {
            velocities.set(end.index, end.velocity.map(|v| bounded(v) as f32));
        }
    }
}

/// The number of a particle among the ends, which is added if it is new.
fn end(ends: &mut Vec<End>, end_of: &mut [u32], index: u32, inverse_mass: f64) -> u32 {
    let number = &mut end_of[index as usize];
    if *number == NONE {
        *number = ends.len() as u32;
        ends.push(End { index, inverse_mass, ..End::default() });
    }
    *number
}

impl Tie {
    /// The ends of a contact with a wall are the same, and the wall has no mass.
    fn inverse_masses(&self, ends: &[End]) -> [f64; 2] {
        let [a, b] = self.ends.map(|end| ends[end as usize].inverse_mass);
        if self.ends[0] == self.ends[1] { [0.0, b] } else { [a, b] }
    }

    /// How fast it lengthens.
    fn rate(&self, of: impl Fn(u32) -> [f64; 2]) -> f64 {
        let [x, y] = of(self.ends[1]);
        let [u, v] = if self.ends[0] == self.ends[1] { [0.0; 2] } else { of(self.ends[0]) };
        self.along[0] * (x - u) + self.along[1] * (y - v)
    }

    /// Adds the changes of velocity by a tension.
    fn push(&self, ends: &mut [End], impulse: f64) {
        let masses = self.inverse_masses(ends);
        for ((end, sign), mass) in self.ends.into_iter().zip([1.0, -1.0]).zip(masses) {
            let change = &mut ends[end as usize].change;
            *change = [0, 1].map(|k| change[k] + sign * mass * impulse * self.along[k]);
        }
    }

    /// Begins a turn of a contact.
    fn read(&mut self, pushes: &impl Pushes, ends: &[End]) {
        let Some(place) = self.place else { return };
        let Push { normal, least_speed, impulse } = pushes.get(place);
        let [a, b] = self.inverse_masses(ends);
        (self.impulse, self.inverse, self.along) = (0.0, 0.0, [0.0; 2]);
        // A contact without impulse stays out of the system, in which it would pull. The turn of
        // the contacts before has found which push.
        if impulse > 0.0 {
            self.along = normal.map(f64::from);
            self.softness = SOFTNESS * (a + b);
            self.inverse = 1.0 / (a + b + self.softness);
            self.rate = -f64::from(least_speed);
        }
    }

    /// Ends a turn of a contact. It does not pull.
    fn write(&self, pushes: &mut impl Pushes, ends: &mut [End]) {
        let Some(place) = self.place.filter(|_| self.inverse > 0.0) else { return };
        // Impulses of walls are kept as changes of velocity.
        let unit = match place {
            Place::Pair { .. } => 1.0,
            Place::Wall { .. } => ends[self.ends[1] as usize].inverse_mass,
        };
        // A contact never pulls. What is cut off is taken back from the velocities, so that these
        // are always those of the impulses.
        let before = f64::from(pushes.get(place).impulse);
        let after = (before - self.impulse * unit).max(0.0) as f32;
        let excess = (f64::from(after) - before) / unit + self.impulse;
        if excess != 0.0 {
            let masses = self.inverse_masses(ends);
            for ((end, sign), mass) in self.ends.into_iter().zip([-1.0, 1.0]).zip(masses) {
                let velocity = &mut ends[end as usize].velocity;
                *velocity = [0, 1].map(|k| velocity[k] + sign * mass * excess * self.along[k]);
            }
        }
        pushes.set(place, after);
    }
}

/// The system of equations of ties that share particles: (B M⁻¹ Bᵀ + softness) J = rate without J.
struct System<'a> {
    ties: &'a mut [Tie],
    ends: &'a mut [End],
}

impl System<'_> {
    /// Begins with the share of the tensions at rest that leaves the least error.
    fn begin(&mut self) {
        for tie in self.ties.iter_mut() {
            tie.impulse = 0.0;
            tie.search = if tie.place.is_none() { tie.rate / tie.softness } else { 0.0 };
        }
        // An exact search along one line: the scalar product of direction and residual over that of
        // the direction and its image, between none of the tensions at rest and all of them.
        self.find_residuals();
        let wanted: f64 = self.ties.iter().map(|tie| tie.search * tie.residual).sum();
        let curvature = self.find_images();
        if curvature > 0.0 {
            self.advance((wanted / curvature).clamp(0.0, 1.0));
        }
    }

    /// Iterates from the present tensions and velocities.
    fn iterate(&mut self) {
        // Conjugate gradients, preconditioned by the diagonal: `inverse` is one over it. Contacts
        // that do not push have 0 there, so they stay out of all sums.
        self.find_residuals();
        let error = |ties: &[Tie]| -> f64 {
            ties.iter().map(|tie| tie.residual * tie.residual * tie.inverse).sum()
        };
        // The error is relative to the tensions. The impulse of a contact is its change in this
        // turn, which says nothing of its size.
        let size = |tie: &Tie| match tie.place {
            None => tie.impulse * tie.impulse / tie.inverse,
            Some(_) => 0.0,
        };
        let most = ERROR * self.ties.iter().map(size).sum::<f64>();
        let mut before = error(self.ties);
        self.ties.iter_mut().for_each(|tie| tie.search = tie.residual * tie.inverse);
        for _ in 0..ITERATIONS {
            if before <= most {
                return;
            }
            let curvature = self.find_images();
            // By rounding it may be 0 or less, by an overflow infinite. The present tensions are
            // right to that rounding.
            if !(curvature > 0.0 && curvature < f64::INFINITY) {
                return;
            }
            self.advance(before / curvature);
            let now = error(self.ties);
            // The formula of Fletcher and Reeves.
            for tie in self.ties.iter_mut() {
                tie.search = tie.residual * tie.inverse + now / before * tie.search;
            }
            before = now;
        }
    }

    /// How much the rate of each tie differs from that of its tension.
    fn find_residuals(&mut self) {
        for tie in self.ties.iter_mut() {
            let rate = tie.rate(|end| self.ends[end as usize].velocity);
            tie.residual = rate + tie.rate - tie.impulse * tie.softness;
        }
    }

    /// The effect of the tensions `search` on all rates; returns the scalar product of both.
    fn find_images(&mut self) -> f64 {
        // Only the ends of this system are cleared, so that a turn costs as much as it has ties.
        for tie in &*self.ties {
            tie.ends.into_iter().for_each(|end| self.ends[end as usize].change = [0.0; 2]);
        }
        for tie in &*self.ties {
            tie.push(self.ends, tie.search);
        }
        let mut sum = 0.0;
        for tie in self.ties.iter_mut() {
            let rate = tie.rate(|end| self.ends[end as usize].change);
            tie.image = tie.search * tie.softness - rate;
            sum += tie.search * tie.image;
        }
        sum
    }

    /// Adds a multiple of the tensions `search`.
    fn advance(&mut self, by: f64) {
        for tie in self.ties.iter_mut() {
            tie.impulse += by * tie.search;
            tie.residual -= by * tie.image;
        }
        // Each end once: its change is 0 afterwards.
        for tie in &*self.ties {
            for end in tie.ends {
                let end = &mut self.ends[end as usize];
                end.velocity = [0, 1].map(|k| end.velocity[k] + by * end.change[k]);
                end.change = [0.0; 2];
            }
        }
    }
}
