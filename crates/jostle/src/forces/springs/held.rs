//! Springs of stiff bodies that are near anything, solved together with the resting contacts.
//!
//! With the direction n of a spring, its stretch s and the velocity w of its second end relative to
//! the first, its tension in a sub-step of h seconds is J = h (k (s + h n·w) + c n·w), where w is that at
//! the end of the sub-step (D. Baraff and A. Witkin, *Large Steps in Cloth Simulation*, 1998). This is
//! stable at any stiffness and never adds energy; it damps oscillations that are fast compared with
//! the sub-step. The tensions of a body are the solution of a symmetric positive definite system, which
//! the method of conjugate gradients finds. All impulses are between pairs, so momentum is conserved
//! after any number of iterations. Resting contacts and springs take turns, each with the velocities
//! that the others leave.

use super::{Body, Link, Node, SpringSolver, bounded, rate};
use crate::contacts::Contacts;
use crate::flow::{Flow, Kick};
use crate::motion::{Motions, Vectors, exact};
use crate::particles::Particles;
use crate::walls::{self, Around};

/// Iterations of the method of conjugate gradients in each turn of the springs at most.
const ITERATIONS: usize = 24;

/// Square of the relative error of the tensions with which a turn ends.
const ERROR: f64 = 1e-14;

/// Particles are near each other if they could meet within this many sub-steps.
const SUBSTEPS: f32 = 2.0;

/// And if their gap is at most this share of the sum of radii.
const NEAR: f32 = 0.01;

/// Stands for no body.
const NONE: u32 = u32::MAX;

/// Scratch.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The stiff body of each particle.
    body_of: Vec<u32>,
    ties: Vec<Tie>,
    found: Vec<walls::Contact>,
    any: bool,
}

/// What decides whether a body is near anything.
pub struct Surroundings<'a> {
    /// The particles.
    pub particles: &'a Particles,
    /// Positions and velocities at the beginning of the sub-step.
    pub motions: &'a Motions,
    /// The contacts that the step may have.
    pub contacts: &'a Contacts,
    /// The walls.
    pub walls: Around<'a>,
    /// What other forces do in the sub-step.
    pub kicks: &'a [Kick],
    /// The sub-step.
    pub flow: &'a Flow,
}

/// A spring of a held body. It corresponds to the link with the same number.
#[derive(Clone, Copy, Debug, Default)]
struct Tie {
    along: [f64; 2],
    /// Change of the rate of lengthening that an impulse of 1 stands for: 1/(h² k + h c).
    softness: f64,
    /// The rate at which a spring without tension would lengthen.
    rate: f64,
    /// The tension.
    impulse: f64,
    /// One over the diagonal of the system.
    inverse: f64,
    residual: f64,
    search: f64,
    image: f64,
}

impl Surroundings<'_> {
    /// How far a particle may get in the next sub-steps.
    fn reach(&self, index: u32) -> f32 {
        let (velocity, Kick { before, after, .. }) =
            (self.motions.velocity(index), self.kicks[index as usize]);
        let Flow { gravity, duration, .. } = self.flow;
        let speed = |of: [f64; 2]| (of[0] * of[0] + of[1] * of[1]).sqrt();
        let change = [0, 1].map(|k| before[k] + gravity[k] * duration + after[k]);
        let own = speed(velocity.map(f64::from)) + speed(change);
        SUBSTEPS * (own * duration) as f32
    }

    /// Whether a particle is near a wall or a side of the container.
    fn is_near_wall(
        &self,
        index: u32,
        container: &crate::container::Container,
        found: &mut Vec<walls::Contact>,
    ) -> bool {
        let position = self.motions.position(index);
        let radius = self.particles.radii[index as usize];
        let far = self.reach(index) + NEAR * radius;
        if !container.is_far(position.map(f64::from), f64::from(radius), [f64::from(far); 2]) {
            let sides = container.walls(self.motions.exact(index), f64::from(radius));
            if sides.into_iter().flatten().any(|side| side.gap <= far) {
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
    pub fn find_held(&mut self, of: &Surroundings<'_>) {
        let h = of.flow.seconds;
        let Self { bodies, nodes, container, held, .. } = self;
        bodies.iter_mut().for_each(|body| body.is_held = false);
        held.any = false;
        if !bodies.iter().any(|body| body.is_stiff(h)) {
            return;
        }
        held.body_of.clear();
        held.body_of.resize(of.particles.len(), NONE);
        for (number, body) in bodies.iter_mut().enumerate().filter(|(_, body)| body.is_stiff(h)) {
            let own = nodes[body.nodes.clone()].iter().filter(|node| node.inverse_mass > 0.0);
            for node in own {
                held.body_of[node.index as usize] = number as u32;
                body.is_held |= of.is_near_wall(node.index, container, &mut held.found);
            }
        }
        for block in &of.contacts.blocks.list {
            block.each_lane(|lane| {
                let pair = [0, 1].map(|k| block.indices.of(k)[lane]);
                let names = pair.map(|index| held.body_of[index as usize]);
                if names.iter().all(|&name| name == NONE || bodies[name as usize].is_held) {
                    return;
                }
                let [a, b] = pair.map(|index| of.motions.position(index));
                let [x, y] = [0, 1].map(|k| b[k] - a[k] + block.images[k][lane]);
                let near = (1.0 + NEAR) * block.contact_distances[lane];
                let far = near + of.reach(pair[0]) + of.reach(pair[1]);
                if x * x + y * y <= far * far {
                    names.into_iter().filter(|&name| name != NONE).for_each(|name| {
                        bodies[name as usize].is_held = true;
                    });
                }
            });
        }
        held.any = bodies.iter().any(|body| body.is_held);
    }

    /// Begins a sub-step: directions and stretches of the springs of held bodies. Calls `pull` with the
    /// index of each particle and the change of velocity that its springs alone would give it.
    pub fn begin_held(
        &mut self,
        flow: &Flow,
        motions: &Motions,
        moving: &[bool],
        velocities: &Vectors,
        mut pull: impl FnMut(u32, [f64; 2]),
    ) {
        let Self { bodies, links, nodes, container, held, .. } = self;
        held.ties.resize(links.len(), Tie::default());
        for body in bodies.iter().filter(|body| body.is_held) {
            for node in &mut nodes[body.nodes.clone()] {
                let motion = motions.get(node.index);
                node.position = exact(motion.position, motion.residual);
                node.velocity = velocities.get(node.index).map(f64::from);
                node.change = [0.0; 2];
                if !moving[node.index as usize] {
                    node.inverse_mass = 0.0;
                }
            }
            for (link, tie) in
                links[body.links.clone()].iter().zip(&mut held.ties[body.links.clone()])
            {
                *tie = Tie::new(link, nodes, container, flow);
                let [a, b] = link.nodes.map(|node| nodes[node as usize]);
                let impulse = (rate(tie.along, &a, &b) + tie.rate) * tie.inverse;
                push(nodes, link, tie.along, impulse);
            }
            for node in &mut nodes[body.nodes.clone()] {
                pull(node.index, node.change.map(bounded));
                node.change = [0.0; 2];
            }
        }
    }

    /// A turn of the springs of held bodies: changes their tensions and the velocities of their ends. In
    /// the first turn they begin with a share of the tensions that they have at rest.
    pub fn take_turn(&mut self, velocities: &Vectors, is_first: bool) {
        let Self { bodies, links, nodes, held, .. } = self;
        for body in bodies.iter().filter(|body| body.is_held) {
            let Body { nodes: own, links: range, .. } = body;
            let (links, ties) = (&links[range.clone()], &mut held.ties[range.clone()]);
            for node in &mut nodes[own.clone()] {
                node.velocity = velocities.get(node.index).map(f64::from);
            }
            let mut system = System { links, ties, nodes, own: own.clone() };
            if is_first {
                system.begin();
            }
            system.iterate();
            for node in nodes[own.clone()].iter().filter(|node| node.inverse_mass > 0.0) {
                velocities.set(node.index, node.velocity.map(|v| bounded(v) as f32));
            }
        }
    }
}

impl Tie {
    fn new(
        link: &Link,
        nodes: &[Node],
        container: &crate::container::Container,
        flow: &Flow,
    ) -> Self {
        let [a, b] = link.nodes.map(|node| &nodes[node as usize]);
        let (along, length) = link.direction(a, b, container);
        let gain = flow.seconds * (link.stiffness * flow.duration + link.damping);
        if gain == 0.0 || along == [0.0; 2] {
            return Self::default();
        }
        let stretch = length - link.length;
        let diagonal = a.inverse_mass + b.inverse_mass + 1.0 / gain;
        Self {
            along,
            softness: 1.0 / gain,
            rate: flow.seconds * link.stiffness * stretch / gain,
            inverse: 1.0 / diagonal,
            ..Self::default()
        }
    }
}

/// Adds the changes of velocity by a tension.
fn push(nodes: &mut [Node], link: &Link, along: [f64; 2], impulse: f64) {
    let impulse = along.map(|v| v * impulse);
    for (node, sign) in link.nodes.into_iter().zip([1.0, -1.0]) {
        nodes[node as usize].push(impulse, sign);
    }
}

/// The system of equations of a body: (B M⁻¹ Bᵀ + softness) J = rate without J.
struct System<'a> {
    links: &'a [Link],
    ties: &'a mut [Tie],
    nodes: &'a mut [Node],
    own: std::ops::Range<usize>,
}

impl System<'_> {
    /// Begins with the share of the tensions at rest that leaves the least error.
    fn begin(&mut self) {
        self.ties.iter_mut().for_each(|tie| {
            tie.impulse = 0.0;
            tie.search = if tie.softness > 0.0 { tie.rate / tie.softness } else { 0.0 };
        });
        self.find_residuals();
        let wanted: f64 = self.ties.iter().map(|tie| tie.search * tie.residual).sum();
        let curvature = self.find_images();
        if curvature > 0.0 {
            self.advance((wanted / curvature).clamp(0.0, 1.0));
        }
    }

    /// Iterates from the present tensions and velocities.
    fn iterate(&mut self) {
        self.find_residuals();
        let error = |ties: &[Tie]| -> f64 {
            ties.iter().map(|tie| tie.residual * tie.residual * tie.inverse).sum()
        };
        let size = |tie: &Tie| {
            if tie.inverse > 0.0 { tie.impulse * tie.impulse / tie.inverse } else { 0.0 }
        };
        let most = ERROR * self.ties.iter().map(size).sum::<f64>();
        let mut before = error(self.ties);
        self.ties.iter_mut().for_each(|tie| tie.search = tie.residual * tie.inverse);
        for _ in 0..ITERATIONS {
            if before <= most {
                return;
            }
            let curvature = self.find_images();
            if !(curvature > 0.0 && curvature < f64::INFINITY) {
                return;
            }
            self.advance(before / curvature);
            let now = error(self.ties);
            for tie in self.ties.iter_mut() {
                tie.search = tie.residual * tie.inverse + now / before * tie.search;
            }
            before = now;
        }
    }

    /// How much the rate of each spring differs from that of its tension.
    fn find_residuals(&mut self) {
        for (tie, link) in self.ties.iter_mut().zip(self.links) {
            let [a, b] = link.nodes.map(|node| &self.nodes[node as usize]);
            tie.residual = rate(tie.along, a, b) + tie.rate - tie.impulse * tie.softness;
        }
    }

    /// The effect of the tensions `search` on all rates; returns the scalar product of both.
    fn find_images(&mut self) -> f64 {
        self.nodes[self.own.clone()].iter_mut().for_each(|node| node.change = [0.0; 2]);
        for (tie, link) in self.ties.iter().zip(self.links) {
            push(self.nodes, link, tie.along, tie.search);
        }
        let mut sum = 0.0;
        for (tie, link) in self.ties.iter_mut().zip(self.links) {
            let [a, b] = link.nodes.map(|node| &self.nodes[node as usize]);
            let [x, y] = [0, 1].map(|k| a.change[k] - b.change[k]);
            tie.image = tie.along[0] * x + tie.along[1] * y + tie.search * tie.softness;
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
        for node in &mut self.nodes[self.own.clone()] {
            node.velocity = [0, 1].map(|k| node.velocity[k] + by * node.change[k]);
        }
    }
}
