//! Gravitation between all bodies by the Barnes-Hut method.
//!
//! The bodies are sorted by a quadtree of their own, so the order of every sum depends only on
//! their positions. A *group* is a node of few bodies. The tree is traversed once for each group.
//! A node counts as one body at its centre of mass if its diagonal divided by its distance from
//! the bounding box of the group is below `theta`; otherwise it is opened. The resulting list of
//! bodies and nodes acts on every body of the group.
//!
//! The approximation violates Newton's third law slightly. Therefore the mean acceleration, whose
//! exact value is 0, is subtracted from all, so that momentum is conserved up to rounding.
//!
//! J. Barnes and P. Hut, *A hierarchical O(N log N) force-calculation algorithm*, Nature 324
//! (1986); J. Barnes, *A modified tree code: don't laugh, it runs*, J. Comput. Phys. 87 (1990),
//! for the groups.

use std::ops::Range;
use std::sync::Mutex;

use super::record::record;
use super::sorted::Sorted;
use super::{Force, ForceInput, Partners, Virial, check_number, total_of};
use crate::particles::FARTHEST;
use jostle_base::error::{Error, Result};
use jostle_base::interrupt::Stop;
use jostle_base::parallel::{self, locked};
use jostle_base::{memory, reserve};
use jostle_index::columns::Columns;
use jostle_index::period::Period;
use jostle_index::quadtree::Quadtree;
use jostle_simd::{LANES, Number, Simd, Work};

/// Up to this number of bodies direct summation is faster.
/// To measure it, compare θ = 0 and the default for several numbers of bodies.
const DIRECT: usize = 512;

/// Maximum number of bodies in a group.
const MAX_GROUP: usize = 64;

/// Number of groups in a task.
const TASK_GROUPS: usize = 16;

/// Number of sources whose accelerations are summed in float32; these sums are added in float64.
/// Each lane adds 16 numbers, so the rounding of its sum stays about 10⁻⁶.
const RUN: usize = 16 * LANES;

/// Lower limit of squared distances, which prevents overflow.
const MIN_SQUARE: f32 = 1e-24;

/// The default of [`Gravitation::theta`].
pub const DEFAULT_THETA: f32 = 0.5;

record! {
    /// a = Σ G m d / (d² + softening²)^³⁄₂ over all others.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Gravitation {
        /// The gravitational constant.
        pub g: f32,
        /// Softening length.
        pub softening: f32,
        /// Opening parameter θ: a node counts as one body if its diagonal divided by its distance is
        /// below θ; 0 is direct summation.
        pub theta: f32,
    }
}

impl Gravitation {
    /// Refuses numbers out of range.
    pub fn validate(&self) -> Result<()> {
        check_number("G", self.g, -FARTHEST)?;
        check_number("softening", self.softening, 0.0)?;
        if (0.0..=1.0).contains(&self.theta) {
            return Ok(());
        }
        Err(Error::of("theta", self.theta, "it must lie between 0 and 1"))
    }
}

/// Scratch of the accelerations.
#[derive(Debug, Default)]
pub struct Scratch {
    sorted: Sorted,
    all: Sources,
    moments: Vec<Moment>,
    pulls: Vec<[f64; 2]>,
    lists: Mutex<Vec<List>>,
}

/// The monopole of a node: its mass and centre of mass.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    center: [f32; 2],
    mass: f32,
    /// Diagonal of its bounding box.
    width: f32,
}

impl Force for Gravitation {
    fn accelerate(
        &self,
        bodies: &ForceInput<'_>,
        scratch: &mut super::Scratch,
        sums: &mut [[f32; 2]],
    ) -> Result<()> {
        let direct = prepare(self, bodies, &mut scratch.gravitation)?;
        let Scratch { sorted, all, moments, pulls, lists } = &mut scratch.gravitation;
        let tree = &sorted.tree;
        let walk =
            Walk { gravitation: self, tree, all, moments, period: bodies.container.period() };
        pulls.clear();
        memory::resize(pulls, tree.len(), [0.0; 2])?;
        // A task has its own part of `pulls`, and each body is summed by one task. So the number of
        // threads changes no sum.
        let threads = parallel::threads_for(bodies.threads, tree.len(), DIRECT, DIRECT);
        let (tasks, stop) = (sorted.tasks(TASK_GROUPS, pulls), Stop::current());
        parallel::try_for_each(threads, tasks, |(share, mut pulls)| {
            let mut list = locked(lists).pop().unwrap_or_default();
            // An interruption is reported by the caller, which then does not use the sums.
            for &group in share.iter().take_while(|_| !stop.is_set()) {
                let len = sorted.range(group).len();
                let own = pulls.split_off_mut(..len).expect("the sizes add up");
                walk.pull(group, direct, &mut list, own)?;
            }
            locked(lists).push(list);
            Ok(())
        })?;
        // The exact mean is 0. The approximation by nodes pulls both sides of a pair a little
        // differently, and without this the centre of mass would drift.
        subtract_mean(pulls, &all.mass);
        // All sums are for G = 1, and are multiplied in float64.
        let g = f64::from(self.g);
        for (pull, &row) in pulls.iter().zip(tree.rows()) {
            let to = &mut sums[row as usize];
            *to = [0, 1].map(|k| to[k] + (g * pull[k]) as f32);
        }
        Ok(())
    }

    fn limit(&self, _: &ForceInput<'_>, _: &mut [[f32; 2]]) {}

    /// It is 0 at infinity, and summed over the same pairs of bodies, or over the same bodies and nodes, as the
    /// accelerations.
    fn energy(&self, bodies: &ForceInput<'_>) -> Result<f64> {
        let soft = f64::from(self.softening);
        // Each body is one of its own sources, at distance 0.
        let own = if soft > 0.0 { 1.0 / soft } else { 0.0 };
        let [sum] = self.sum_of_pairs(bodies, |walk, sources, at, mass| {
            [mass * (sources.potential(at, soft, &walk.period) - mass * own)]
        })?;
        // Every pair was summed twice.
        Ok(-0.5 * f64::from(self.g) * sum)
    }

    /// It is summed over the same pairs as the energy.
    fn virial(&self, bodies: &ForceInput<'_>) -> Result<Virial> {
        let soft = f64::from(self.softening);
        let [xx, xy, yy] = self.sum_of_pairs(bodies, |walk, sources, at, mass| {
            sources.pull_products(at, soft, &walk.period).map(|sum| mass * sum)
        })?;
        // Attraction is negative.
        Ok([[xx, xy], [xy, yy]].map(|row| row.map(|sum| -0.5 * f64::from(self.g) * sum)))
    }

    fn partners(&self) -> Partners {
        Partners::All
    }
}

impl Gravitation {
    /// The sums of `value` over all bodies: it gets their sources, position and mass.
    fn sum_of_pairs<const N: usize>(
        &self,
        bodies: &ForceInput<'_>,
        value: impl Fn(&Walk<'_>, &Sources, [f32; 2], f64) -> [f64; N] + Sync + Send,
    ) -> Result<[f64; N]> {
        let mut scratch = Scratch::default();
        let direct = prepare(self, bodies, &mut scratch)?;
        let Scratch { sorted: Sorted { tree, groups, .. }, all, moments, .. } = &scratch;
        let walk =
            Walk { gravitation: self, tree, all, moments, period: bodies.container.period() };
        let threads = parallel::threads_for(bodies.threads, tree.len(), DIRECT, DIRECT);
        let stop = Stop::current();
        let mut parts = memory::filled(groups.len(), [0.0; N])?;
        let tasks = parts.iter_mut().zip(groups);
        parallel::try_for_each(threads, tasks, |(part, &group)| {
            if !stop.is_set() {
                *part = walk.sum_of_group(group, direct, &value)?;
            }
            Ok(())
        })?;
        Ok(total_of(parts.into_iter()))
    }
}

/// Sorts the bodies and computes the moments of the nodes. Returns whether direct summation is
/// used.
fn prepare(
    gravitation: &Gravitation,
    bodies: &ForceInput<'_>,
    scratch: &mut Scratch,
) -> Result<bool> {
    let Scratch { sorted, all, moments, .. } = scratch;
    // Bodies at the same place are sorted by mass, because nothing else of them enters the sums.
    sorted.sort(bodies, MAX_GROUP, &|a, b| bodies.masses[a].total_cmp(&bodies.masses[b]))?;
    let tree = &sorted.tree;
    all.clear();
    all.reserve(tree.len())?;
    let Columns { x, y, .. } = tree.columns();
    for (index, &row) in tree.rows().iter().enumerate() {
        all.push([x[index], y[index]], bodies.masses[row as usize]);
    }
    all.pad();
    // With few bodies the walk and the moments take longer than they save.
    let direct = tree.len() <= DIRECT || gravitation.theta == 0.0;
    if !direct {
        compute_moments(tree, &all.mass, moments)?;
    }
    Ok(direct)
}

/// Computes mass and centre of mass of every node, bottom-up.
fn compute_moments(tree: &Quadtree<f32>, masses: &[f32], moments: &mut Vec<Moment>) -> Result<()> {
    let Columns { x, y, .. } = tree.columns();
    moments.clear();
    memory::resize(moments, tree.nodes().len(), Moment::default())?;
    // Children come after their parents in memory, so the reverse order has their moments ready.
    for (number, (node, bounds)) in tree.nodes().iter().zip(tree.bounds()).enumerate().rev() {
        let mut sum = [0.0f64; 3];
        let mut add = |[px, py]: [f32; 2], mass: f32| {
            let mass = f64::from(mass);
            let terms = [mass, mass * f64::from(px), mass * f64::from(py)];
            (0..3).for_each(|k| sum[k] += terms[k]);
        };
        if node.is_leaf() {
            node.range().for_each(|index| add([x[index], y[index]], masses[index]));
        } else {
            let children = &moments[node.children()];
            children.iter().for_each(|child| add(child.center, child.mass));
        }
        let [mass, mx, my] = sum;
        let sides = [0, 1].map(|k| bounds.max[k] - bounds.min[k]);
        moments[number] = Moment {
            center: [(mx / mass) as f32, (my / mass) as f32],
            mass: mass as f32,
            width: (sides[0] * sides[0] + sides[1] * sides[1]).sqrt(),
        };
    }
    Ok(())
}

/// Subtracts the mean acceleration from all.
fn subtract_mean(pulls: &mut [[f64; 2]], masses: &[f32]) {
    let mut sum = [0.0f64; 3];
    for (pull, &mass) in pulls.iter().zip(masses) {
        let mass = f64::from(mass);
        let terms = [mass, mass * pull[0], mass * pull[1]];
        (0..3).for_each(|k| sum[k] += terms[k]);
    }
    let mean = [sum[1] / sum[0], sum[2] / sum[0]];
    // Without mass, or after an overflow, there is no mean; the accelerations are bounded later.
    if mean.iter().all(|v| v.is_finite()) {
        pulls.iter_mut().for_each(|pull| *pull = [pull[0] - mean[0], pull[1] - mean[1]]);
    }
}

/// Bodies that attract others, as columns padded to a multiple of [`LANES`].
#[derive(Debug, Default)]
struct Sources {
    x: Vec<f32>,
    y: Vec<f32>,
    mass: Vec<f32>,
}

impl Sources {
    fn clear(&mut self) {
        [&mut self.x, &mut self.y, &mut self.mass].into_iter().for_each(Vec::clear);
    }

    /// Reserves memory for so many more, and for the last block.
    fn reserve(&mut self, more: usize) -> Result<()> {
        reserve!(self.x.len() + more + LANES; self.x, self.y, self.mass);
        Ok(())
    }

    #[inline(always)]
    fn push(&mut self, [x, y]: [f32; 2], mass: f32) {
        self.x.push(x);
        self.y.push(y);
        self.mass.push(mass);
    }

    fn extend(&mut self, other: &Self, range: Range<usize>) {
        self.x.extend_from_slice(&other.x[range.clone()]);
        self.y.extend_from_slice(&other.y[range.clone()]);
        self.mass.extend_from_slice(&other.mass[range]);
    }

    /// Appends bodies without mass until the last block is full.
    fn pad(&mut self) {
        while !self.x.len().is_multiple_of(LANES) {
            self.push([0.0; 2], 0.0);
        }
    }

    /// The acceleration at `position` for G = 1; `wrap` returns the minimum image of an offset.
    #[inline(always)]
    fn pull(
        &self,
        [px, py]: [f32; 2],
        soft_square: f32,
        wrap: impl Fn([f32; 2]) -> [f32; 2],
    ) -> [f64; 2] {
        // Sixteen lanes add in float32, which is fast. Every run is added up in float64, so the
        // error does not grow with the number of sources. The order of all sums is fixed by the
        // order of the list.
        let mut total = [0.0f64; 2];
        let runs = self.x.chunks(RUN).zip(self.y.chunks(RUN)).zip(self.mass.chunks(RUN));
        for ((x, y), mass) in runs {
            let mut sums = [[0.0f32; LANES]; 2];
            let (x, y, mass) =
                (x.as_chunks::<LANES>().0, y.as_chunks::<LANES>().0, mass.as_chunks::<LANES>().0);
            for ((x, y), mass) in x.iter().zip(y).zip(mass) {
                for lane in 0..LANES {
                    // A body is one of its own sources. The limit of the square makes its quotient
                    // finite, and the offset of 0 makes its pull 0.
                    let [dx, dy] = wrap([x[lane] - px, y[lane] - py]);
                    let square = (dx * dx + dy * dy + soft_square).max(MIN_SQUARE);
                    let inverse = 1.0 / square.sqrt();
                    let strength = mass[lane] * (inverse * inverse);
                    sums[0][lane] += strength * (dx * inverse);
                    sums[1][lane] += strength * (dy * inverse);
                }
            }
            for k in 0..2 {
                total[k] += sums[k].iter().fold(0.0f64, |sum, &v| sum + f64::from(v));
            }
        }
        total
    }
}

impl Sources {
    /// Sum of mass divided by distance from `position`.
    fn potential(&self, [px, py]: [f32; 2], soft: f64, period: &Period<f32>) -> f64 {
        let mut sum = 0.0;
        // The sum is in float64, because energies are compared over many steps.
        for ((x, y), &mass) in self.x.iter().zip(&self.y).zip(&self.mass) {
            let [dx, dy] = period.minimum_image([x - px, y - py]).map(f64::from);
            let square = dx * dx + dy * dy + soft * soft;
            if square > 0.0 {
                sum += f64::from(mass) / square.sqrt();
            }
        }
        sum
    }
}

impl Sources {
    /// Sums of m · x · x / d³, of m · x · y / d³ and of m · y · y / d³, where (x, y) is the offset from `position`.
    fn pull_products(&self, [px, py]: [f32; 2], soft: f64, period: &Period<f32>) -> [f64; 3] {
        let sources = self.x.iter().zip(&self.y).zip(&self.mass);
        total_of(sources.map(|((x, y), &mass)| {
            let [dx, dy] = period.minimum_image([x - px, y - py]).map(f64::from);
            let square = (dx * dx + dy * dy + soft * soft).max(f64::from(MIN_SQUARE));
            let factor = f64::from(mass) / (square * square.sqrt());
            [factor * dx * dx, factor * dx * dy, factor * dy * dy]
        }))
    }
}

/// The interaction list of one group, and the stack of the traversal.
#[derive(Debug, Default)]
struct List {
    found: Sources,
    stack: Vec<u32>,
}

/// The input of all groups.
struct Walk<'a> {
    gravitation: &'a Gravitation,
    tree: &'a Quadtree<f32>,
    all: &'a Sources,
    moments: &'a [Moment],
    period: Period<f32>,
}

impl Walk<'_> {
    /// Writes the accelerations of the bodies of a group, for G = 1.
    fn pull(
        &self,
        group: u32,
        direct: bool,
        list: &mut List,
        pulls: &mut [[f64; 2]],
    ) -> Result<()> {
        let sources = if direct { self.all } else { self.collect(group, list)? };
        let bodies = self.tree.nodes()[group as usize].range();
        f32::with_widest(Pull { walk: self, sources, bodies, pulls });
        Ok(())
    }

    /// The sums of `value` over the bodies of a group: it gets their sources, position and mass.
    fn sum_of_group<const N: usize>(
        &self,
        group: u32,
        direct: bool,
        value: impl Fn(&Self, &Sources, [f32; 2], f64) -> [f64; N],
    ) -> Result<[f64; N]> {
        let mut list = List::default();
        let sources = if direct { self.all } else { self.collect(group, &mut list)? };
        let own = |index: usize| {
            let at = [self.all.x[index], self.all.y[index]];
            value(self, sources, at, f64::from(self.all.mass[index]))
        };
        Ok(total_of(self.tree.nodes()[group as usize].range().map(own)))
    }

    /// Makes the interaction list of a group: near bodies and far nodes.
    fn collect<'a>(&self, group: u32, list: &'a mut List) -> Result<&'a Sources> {
        let List { found, stack } = list;
        found.clear();
        stack.clear();
        let target = &self.tree.bounds()[group as usize];
        let middle = [0, 1].map(|k| 0.5 * target.min[k] + 0.5 * target.max[k]);
        let half = [0, 1].map(|k| 0.5 * target.max[k] - 0.5 * target.min[k]);
        // The opening angle is tested from the box of the group, so one list is right for all its
        // bodies, and the walk is made once for many.
        stack.push(0);
        while let Some(index) = stack.pop() {
            let index = index as usize;
            let (node, moment) = (&self.tree.nodes()[index], &self.moments[index]);
            if self.is_far(middle, half, moment) {
                found.reserve(1)?;
                found.push(moment.center, moment.mass);
            } else if node.is_leaf() {
                found.reserve(node.len())?;
                found.extend(self.all, node.range());
            } else {
                // The stack is last in, first out: in reverse order, sources are listed in Morton
                // order.
                memory::extend(stack, node.children().rev().map(|child| child as u32))?;
            }
        }
        found.reserve(0)?;
        found.pad();
        Ok(found)
    }

    /// Whether a node counts as one body for all bodies of a group.
    #[inline(always)]
    fn is_far(&self, middle: [f32; 2], half: [f32; 2], moment: &Moment) -> bool {
        let Moment { center, width, .. } = *moment;
        // All bodies of the node are at one point, so the monopole is exact.
        if width == 0.0 {
            return true;
        }
        let offset = self.period.minimum_image([0, 1].map(|k| center[k] - middle[k]));
        // The minimum image must be the same for all bodies of the group.
        let [w, h] = self.period.sides();
        // If the sum of the three lengths is below half of the period, no body of the group has
        // another nearest image of any body of the node. Else the monopole would be on the wrong
        // side for some.
        let same = |k: usize, side: f32| offset[k].abs() + half[k] + width < 0.5 * side;
        let is_same = self.period.is_none() || same(0, w) && same(1, h);
        if !is_same {
            return false;
        }
        // The distance from the box of the group, and not from its middle: the criterion holds for
        // each of its bodies.
        let [x, y] = [0, 1].map(|k| (offset[k].abs() - half[k]).max(0.0));
        let theta = self.gravitation.theta;
        width * width < theta * theta * (x * x + y * y)
    }
}

/// [`Sources::pull`] for the bodies of a group, auto-vectorized with the widest instructions.
struct Pull<'a> {
    walk: &'a Walk<'a>,
    sources: &'a Sources,
    bodies: Range<usize>,
    pulls: &'a mut [[f64; 2]],
}

impl Work<f32> for Pull<'_> {
    type Out = ();

    #[inline(always)]
    fn run<S: Simd<f32>>(self, _: S) {
        let Self { walk, sources, bodies, pulls } = self;
        let Gravitation { softening, .. } = *walk.gravitation;
        let soft_square = softening * softening;
        for (pull, index) in pulls.iter_mut().zip(bodies) {
            let position = [walk.all.x[index], walk.all.y[index]];
            // The kernel is compiled twice, so that the loop without a period has no minimum
            // images.
            *pull = if walk.period.is_none() {
                sources.pull(position, soft_square, |offset| offset)
            } else {
                sources
                    .pull(position, soft_square, |offset| walk.period.minimum_image_within(offset))
            };
        }
    }
}
