//! Springs between pairs of particles.
//!
//! A *body* is a set of movable particles connected by springs. Springs are much stiffer than other
//! forces, so the sub-step of a body is divided into parts (multiple time stepping). Its stiffest
//! spring determines the number of parts, up to a limit; the stiffness of springs that need more is
//! reduced. Each part is a leapfrog step: half of the displacement, the change of velocity, the
//! other half.
//!
//! The parts know of no contacts. If contacts stop the ends of stiff springs, this would add
//! energy. So the springs of a stiff body that is near anything are solved together with the
//! resting contacts: see [`held`].

mod held;

use std::ops::Range;

pub use held::{Place, Push, Pushes, Surroundings};

use super::record::{Found, Record, Renamed, record};
use super::{ASLEEP, ForceInput, check_number};
use crate::container::Container;
use crate::flow::Kick;
use crate::motion::Motions;
use crate::particles::FARTHEST;
use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::disjoint_sets::DisjointSets;
use jostle_base::error::{Error, Result};
use jostle_base::ids::Id;
use jostle_base::{memory, reserve};

/// Maximum number of parts of a sub-step.
const MAX_PARTS: f64 = 32.0;

/// Phase of the fastest oscillation in one part, in radians: the error of its period is 0.2 %.
/// A smaller phase needs more parts of each sub-step.
const PHASE: f64 = 0.2;

/// Maximum phase in one part, which is still stable.
const MAX_PHASE: f64 = 1.0;

/// Maximum relative change of a velocity by damping in one part.
const MAX_DAMPING: f64 = 0.25;

/// A body is stiff if the sum of the stiffness of the springs of one of its particles, over the
/// mass and times the square of the sub-step, is more than this. Up to 1.48 the parts are stable
/// with contacts: a particle that contacts support moves with the velocity of the last part, which
/// is stable while the phase x of the fastest oscillation in a sub-step has x tan(x/2) < 2, and x²
/// is at most twice that sum.
const STIFF: f64 = 1.45;

/// A body is stiff, too, if the sum of the damping of the springs of one of its particles, over the mass
/// and times the sub-step, is more than this.
const STIFF_DAMPING: f64 = 1.0;

record! {
    /// F = stiffness · (L − length) + damping · dL/dt along the line between two particles.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Spring {
        /// Ids of its ends.
        pub pair: [Id; 2],
        /// Rest length.
        pub length: f32,
        /// Force per unit of stretch.
        pub stiffness: f32,
        /// Force per unit of the rate of lengthening.
        pub damping: f32,
        /// Stretch beyond which it breaks; infinite if it never breaks.
        pub max_stretch: f32,
    }
}

/// A list of springs, in any order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Springs(pub Vec<Spring>);

impl Saved for Springs {
    fn put(&self, to: &mut Writer) {
        self.0.put(to);
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        Saved::get(from).map(Self)
    }
}

/// Springs of removed particles, and springs whose ends have merged, are removed.
impl Record for Springs {
    fn list(&self, found: &mut Found<'_>) {
        self.0.iter().for_each(|spring| spring.list(found));
    }
    fn renumber(&mut self, renamed: &Renamed<'_>) -> bool {
        self.0.retain_mut(|spring| spring.renumber(renamed));
        true
    }
}

impl Springs {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        for (index, spring) in self.0.iter().enumerate() {
            let [i, j] = spring.pair;
            if i == j {
                let value = format!("({i}, {j})");
                return Err(Error::at("pairs", index, value, "a spring has two ends"));
            }
            let numbers = [
                ("lengths", spring.length),
                ("stiffness", spring.stiffness),
                ("damping", spring.damping),
            ];
            for (argument, value) in numbers {
                check_number(argument, value, 0.0).map_err(|error| error.in_row(index))?;
            }
            if spring.max_stretch.is_nan() || spring.max_stretch < 0.0 {
                let rule = "it must be at least 0";
                return Err(Error::at("max_stretch", index, spring.max_stretch, rule));
            }
        }
        Ok(())
    }

    /// Potential energy: the sum of ½ · stiffness · stretch². Positions are those of all rows.
    pub fn energy(&self, positions: &[[f32; 2]], container: &Container) -> Result<f64> {
        let energy = |spring: &Spring| {
            let ends = spring.pair.map(|row| positions[row as usize]);
            let stretch = distance(ends, container) - f64::from(spring.length);
            0.5 * f64::from(spring.stiffness) * stretch * stretch
        };
        let mut all = memory::collect(self.0.iter().map(energy))?;
        // The sum must not depend on the order of the springs.
        all.sort_unstable_by(f64::total_cmp);
        Ok(all.iter().sum())
    }

    /// The offset from the first end of each spring to its second, and the force on the second. Positions and
    /// velocities are those of all rows.
    pub fn pulls<'a>(
        &'a self,
        positions: &'a [[f32; 2]],
        velocities: &'a [[f32; 2]],
        container: &'a Container,
    ) -> impl Iterator<Item = ([usize; 2], [f64; 2], [f64; 2])> + 'a {
        self.0.iter().map(|spring| {
            let rows = spring.pair.map(|row| row as usize);
            let [a, b] = rows.map(|row| Node {
                position: positions[row].map(f64::from),
                velocity: velocities[row].map(f64::from),
                ..Node::default()
            });
            let link = Link {
                body: 0,
                nodes: [0; 2],
                length: f64::from(spring.length),
                stiffness: f64::from(spring.stiffness),
                damping: f64::from(spring.damping),
            };
            let (along, length) = link.direction(&a, &b, container);
            let force = link.force(&a, &b, container, [1.0; 2]).map(|of| -of);
            (rows, along.map(|v| v * length), force)
        })
    }

    /// Removes springs whose stretch exceeds their maximum.
    pub fn break_stretched(&mut self, bodies: &ForceInput<'_>) {
        // A sleeping end has no index, and its spring does not stretch.
        self.0.retain(|spring| {
            spring.max_stretch == f32::INFINITY
                || spring.pair.iter().any(|&row| bodies.indices[row as usize] == ASLEEP)
                || length(spring, bodies) - f64::from(spring.length)
                    <= f64::from(spring.max_stretch)
        });
    }
}

/// The length of a spring.
fn length(spring: &Spring, bodies: &ForceInput<'_>) -> f64 {
    let ends = spring.pair.map(|row| bodies.positions[bodies.indices[row as usize] as usize]);
    distance(ends, &bodies.container)
}

fn distance([a, b]: [[f32; 2]; 2], container: &Container) -> f64 {
    let [x, y] = container.period().minimum_image([0, 1].map(|k| b[k] - a[k])).map(f64::from);
    (x * x + y * y).sqrt()
}

/// Writes an estimate of the displacement of each particle by springs in a step of `dt` into
/// `displacements[index]`. All particles of an island get the largest one, because an impact on
/// one end of a spring may move the other end within the step.
pub fn estimate_displacements<'a>(
    springs: impl Iterator<Item = &'a Spring> + Clone,
    bodies: &ForceInput<'_>,
    velocities: &[[f32; 2]],
    dt: f32,
    islands: &mut DisjointSets,
    displacements: &mut Vec<f32>,
) -> Result<()> {
    islands.reset(bodies.positions.len())?;
    displacements.clear();
    memory::resize(displacements, bodies.positions.len(), 0.0)?;
    for spring in springs.clone() {
        let [a, b] = spring.pair.map(|row| bodies.indices[row as usize]);
        islands.join(a, b);
    }
    let indices = |spring: &Spring| spring.pair.map(|row| bodies.indices[row as usize] as usize);
    for spring in springs.clone() {
        let indices = indices(spring);
        let speed = |index: usize| {
            let [x, y] = velocities[index].map(f64::from);
            (x * x + y * y).sqrt()
        };
        let masses = indices.map(|index| f64::from(bodies.masses[index]));
        // The stretch times the angular frequency is the largest speed that the spring can give to
        // its lighter end.
        let stretch = (length(spring, bodies) - f64::from(spring.length)).abs();
        let swing = stretch * (f64::from(spring.stiffness) / masses[0].min(masses[1])).sqrt();
        let fastest = speed(indices[0]).max(speed(indices[1])) + swing;
        let of_all = &mut displacements[islands.root(indices[0] as u32) as usize];
        *of_all = of_all.max((fastest * f64::from(dt)) as f32);
    }
    // The largest of its island, see above: an impact travels along springs within one step.
    for index in springs.flat_map(indices) {
        displacements[index] = displacements[islands.root(index as u32) as usize];
    }
    Ok(())
}

/// The springs of a world in one step, in an order that depends only on the state.
#[derive(Debug, Default)]
pub struct SpringSolver {
    bodies: Vec<Body>,
    links: Vec<Link>,
    nodes: Vec<Node>,
    container: Container,
    sets: DisjointSets,
    held: held::Scratch,
}

/// Movable particles that are connected by springs, and the immovable ones at the other ends.
#[derive(Clone, Debug, Default)]
struct Body {
    nodes: Range<usize>,
    links: Range<usize>,
    /// Sums over the springs of a particle, divided by its mass: the largest of stiffness, and of
    /// damping.
    most: [f64; 2],
    /// Whether its springs are solved together with resting contacts in this sub-step.
    is_held: bool,
}

/// A spring, by the indices of its nodes.
#[derive(Clone, Copy, Debug)]
struct Link {
    /// The smallest index of a particle of its body.
    body: u32,
    nodes: [u32; 2],
    length: f64,
    stiffness: f64,
    damping: f64,
}

/// A particle that springs act on.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    body: u32,
    index: u32,
    inverse_mass: f64,
    /// Sum of the stiffness of its springs divided by its mass.
    stiffness: f64,
    /// Sum of the damping of its springs divided by its mass.
    damping: f64,
    position: [f64; 2],
    velocity: [f64; 2],
    change: [f64; 2],
}

impl Body {
    /// Whether the parts of a sub-step of `h` seconds would be unstable with contacts.
    fn is_stiff(&self, h: f64) -> bool {
        is_stiff(self.most, h)
    }

    /// The number of parts of a sub-step of `h` seconds.
    fn parts(&self, h: f64) -> f64 {
        let [stiffness, damping] = self.most;
        // ω² is at most twice the largest sum of stiffness over mass (Gershgorin's theorem).
        let by_phase = (2.0 * stiffness).sqrt() * h / PHASE;
        by_phase.max(damping * h / MAX_DAMPING).ceil().clamp(1.0, MAX_PARTS)
    }
}

fn is_stiff([stiffness, damping]: [f64; 2], h: f64) -> bool {
    stiffness * h * h > STIFF || damping * h > STIFF_DAMPING
}

/// Whether any body is stiff in sub-steps of `h` seconds. `sums` is scratch.
pub fn are_stiff<'a>(
    springs: impl Iterator<Item = &'a Spring>,
    bodies: &ForceInput<'_>,
    movable: &[bool],
    h: f64,
    sums: &mut Vec<[f64; 2]>,
) -> Result<bool> {
    sums.clear();
    memory::resize(sums, bodies.positions.len(), [0.0; 2])?;
    for spring in springs {
        for index in spring.pair.map(|row| bodies.indices[row as usize] as usize) {
            let mass = f64::from(bodies.masses[index]);
            let own = [spring.stiffness, spring.damping].map(|v| f64::from(v) / mass);
            sums[index] = [0, 1].map(|k| sums[index][k] + own[k]);
        }
    }
    Ok(sums.iter().zip(movable).any(|(&sums, &movable)| movable && is_stiff(sums, h)))
}

impl SpringSolver {
    /// Whether there is no spring.
    pub fn is_empty(&self) -> bool {
        self.links.is_empty()
    }

    /// Replaces all springs; `inverse_mass` is 0 for immovable particles, of `len`.
    pub fn prepare<'a>(
        &mut self,
        springs: impl Iterator<Item = &'a Spring>,
        indices: &[u32],
        container: Container,
        len: usize,
        inverse_mass: impl Fn(usize) -> f32,
    ) -> Result<()> {
        self.container = container;
        self.held.any = false;
        let inverse_mass = |index: u32| f64::from(inverse_mass(index as usize));
        self.list_links(springs, indices, len, &inverse_mass)?;
        self.list_nodes(&inverse_mass)?;
        self.list_bodies()
    }

    /// Lists the springs that act on anything, in the order of their bodies. Their nodes are
    /// indices of particles.
    fn list_links<'a>(
        &mut self,
        springs: impl Iterator<Item = &'a Spring>,
        indices: &[u32],
        len: usize,
        inverse_mass: &impl Fn(u32) -> f64,
    ) -> Result<()> {
        let Self { links, sets, .. } = self;
        links.clear();
        let all = springs.map(|spring| {
            let [a, b] = spring.pair.map(|row| indices[row as usize]);
            Link {
                body: 0,
                nodes: [a.min(b), a.max(b)],
                length: f64::from(spring.length),
                stiffness: f64::from(spring.stiffness),
                damping: f64::from(spring.damping),
            }
        });
        memory::extend(links, all)?;
        // A spring between two immovable particles does nothing.
        links.retain(|link| link.nodes.iter().any(|&index| inverse_mass(index) > 0.0));
        sets.reset(len)?;
        // An immovable particle transmits nothing, so it does not join bodies: each has its own
        // parts.
        for Link { nodes: [a, b], .. } in &*links {
            if inverse_mass(*a) > 0.0 && inverse_mass(*b) > 0.0 {
                sets.join(*a, *b);
            }
        }
        for link in links.iter_mut() {
            let [a, b] = link.nodes;
            link.body = sets.root(if inverse_mass(a) > 0.0 { a } else { b });
        }
        // Two springs may connect the same pair, so their numbers decide the rest of the order.
        // Sums over springs then do not depend on the order in which the caller has given them.
        links.sort_unstable_by(|a, b| {
            let numbers = |link: &Link| [link.length, link.stiffness, link.damping];
            let pairs = numbers(a).into_iter().zip(numbers(b));
            let by_numbers = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
            let by_numbers = by_numbers.unwrap_or(std::cmp::Ordering::Equal);
            (a.body, a.nodes).cmp(&(b.body, b.nodes)).then(by_numbers)
        });
        Ok(())
    }

    /// Lists the ends of the springs of each body, and gives springs the numbers of their nodes.
    fn list_nodes(&mut self, inverse_mass: &impl Fn(u32) -> f64) -> Result<()> {
        let Self { links, nodes, .. } = self;
        nodes.clear();
        reserve!(2 * links.len(); *nodes);
        // An immovable particle is a node of each body that it holds.
        let ends = links.iter().flat_map(|link| link.nodes.map(|index| (link.body, index)));
        nodes.extend(ends.map(|(body, index)| Node {
            body,
            index,
            inverse_mass: inverse_mass(index),
            ..Node::default()
        }));
        nodes.sort_unstable_by_key(|node| (node.body, node.index));
        nodes.dedup_by_key(|node| (node.body, node.index));
        for link in links.iter_mut() {
            link.nodes = link.nodes.map(|index| {
                let name = (link.body, index);
                nodes
                    .binary_search_by_key(&name, |node| (node.body, node.index))
                    .expect("every node is listed") as u32
            });
            for node in link.nodes {
                let node = &mut nodes[node as usize];
                node.stiffness += link.stiffness * node.inverse_mass;
                node.damping += link.damping * node.inverse_mass;
            }
        }
        Ok(())
    }

    /// Lists the bodies: nodes and springs that follow each other.
    fn list_bodies(&mut self) -> Result<()> {
        let Self { bodies, links, nodes, .. } = self;
        bodies.clear();
        let (mut node, mut link) = (0, 0);
        // Both lists are sorted by bodies, and each body has a spring. So their runs correspond.
        let runs = nodes.chunk_by(|a, b| a.body == b.body);
        for (own, own_links) in runs.zip(links.chunk_by(|a, b| a.body == b.body)) {
            let most = |of: fn(&Node) -> f64| own.iter().map(of).fold(0.0, f64::max);
            let body = Body {
                nodes: node..node + own.len(),
                links: link..link + own_links.len(),
                most: [most(|node| node.stiffness), most(|node| node.damping)],
                is_held: false,
            };
            memory::push(bodies, body)?;
            (node, link) = (node + own.len(), link + own_links.len());
        }
        Ok(())
    }

    /// Adds the effect of the springs in a sub-step of `step` seconds to the kicks: particles move
    /// with the mean velocity of the parts, and afterwards have the velocity of the last part.
    /// Bodies that are held get no kicks.
    pub fn act(&mut self, motions: &Motions, kicks: &mut [Kick], step: f64) {
        let Self { bodies, links, nodes, container, .. } = self;
        for body in bodies.iter().filter(|body| !body.is_held) {
            let (links, base) = (&links[body.links.clone()], body.nodes.start);
            let nodes = &mut nodes[body.nodes.clone()];
            integrate(body.parts(step), (links, base), nodes, container, motions, kicks, step);
        }
    }
}

/// Adds the effect of the springs of a body to the kicks of its particles. `base` is the number of
/// its first node.
fn integrate(
    parts: f64,
    (links, base): (&[Link], usize),
    nodes: &mut [Node],
    container: &Container,
    motions: &Motions,
    kicks: &mut [Kick],
    step: f64,
) {
    let part = step / parts;
    for node in nodes.iter_mut() {
        node.position = motions.position(node.index).map(f64::from);
        let velocity = motions.velocity(node.index);
        let kick = &kicks[node.index as usize];
        node.velocity = [0, 1].map(|k| f64::from(velocity[k]) + kick.before[k]);
    }
    // Stiffness and damping beyond the limit of stability (Gershgorin's bound) are reduced.
    let max_stiffness = 0.5 * (MAX_PHASE / part) * (MAX_PHASE / part);
    let max_damping = MAX_DAMPING / part;
    let factor = |max: f64, own: f64| if own > max { max / own } else { 1.0 };
    for _ in 0..parts as usize {
        nodes.iter_mut().for_each(|node| node.drift(0.5 * part));
        // Changes are collected, and velocities change after all springs. So each spring sees the
        // state in the middle of the part, and the order of springs matters only for rounding.
        for link in links {
            let numbers = link.nodes.map(|node| node as usize - base);
            let [a, b] = numbers.map(|node| nodes[node]);
            // Both ends have one factor, so that momentum is conserved.
            let stiffness =
                factor(max_stiffness, a.stiffness).min(factor(max_stiffness, b.stiffness));
            let damping = factor(max_damping, a.damping).min(factor(max_damping, b.damping));
            let impulse = link.force(&a, &b, container, [stiffness, damping]).map(|v| v * part);
            for (node, sign) in numbers.into_iter().zip([1.0, -1.0]) {
                nodes[node].push(impulse, sign);
            }
        }
        for node in nodes.iter_mut() {
            node.velocity = [0, 1].map(|k| node.velocity[k] + node.change[k]);
            node.change = [0.0; 2];
            node.drift(0.5 * part);
        }
    }
    // A flight is straight and has one velocity. With the mean over the parts it ends where they
    // end; afterwards the particle gets the velocity of the last part. Contacts in between see the
    // mean.
    for node in nodes.iter().filter(|node| node.inverse_mass > 0.0) {
        let motion = motions.get(node.index);
        let kick = &mut kicks[node.index as usize];
        let mean = [0, 1].map(|k| {
            let displacement = node.position[k] - f64::from(motion.position[k]);
            bounded(displacement / step)
        });
        let last = node.velocity.map(bounded);
        kick.before = [0, 1].map(|k| mean[k] - f64::from(motion.velocity[k]));
        kick.after = [0, 1].map(|k| kick.after[k] + (last[k] - mean[k]));
    }
}

/// A velocity within the limits of a world; 0 for NaN.
fn bounded(value: f64) -> f64 {
    let limit = f64::from(FARTHEST);
    if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) }
}

impl Node {
    /// Adds an impulse times a sign to the change of its velocity.
    fn push(&mut self, impulse: [f64; 2], sign: f64) {
        self.change = [0, 1].map(|k| self.change[k] + sign * impulse[k] * self.inverse_mass);
    }

    fn drift(&mut self, time: f64) {
        self.position = [0, 1].map(|k| self.position[k] + self.velocity[k] * time);
    }
}

/// How fast a spring with this direction lengthens.
fn rate(along: [f64; 2], a: &Node, b: &Node) -> f64 {
    along[0] * (b.velocity[0] - a.velocity[0]) + along[1] * (b.velocity[1] - a.velocity[1])
}

impl Link {
    /// The unit vector from its first node to its second, and their distance; the vector is 0 if
    /// the nodes coincide.
    fn direction(&self, a: &Node, b: &Node, container: &Container) -> ([f64; 2], f64) {
        let offset =
            container.period().exact().minimum_image([0, 1].map(|k| b.position[k] - a.position[k]));
        let [x, y] = offset;
        let length = (x * x + y * y).sqrt();
        (if length == 0.0 { [0.0; 2] } else { offset.map(|v| v / length) }, length)
    }

    /// The force on its first node; stiffness and damping are multiplied by the given factors.
    fn force(
        &self,
        a: &Node,
        b: &Node,
        container: &Container,
        [stiffness, damping]: [f64; 2],
    ) -> [f64; 2] {
        let (along, length) = self.direction(a, b, container);
        let rate = rate(along, a, b);
        let force =
            stiffness * self.stiffness * (length - self.length) + damping * self.damping * rate;
        along.map(|v| v * force)
    }
}
