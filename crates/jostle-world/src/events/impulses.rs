//! Impacts at the same time.
//!
//! Every contact obeys Newton's law of restitution as an inequality: the surfaces separate with
//! at least e times the speed of their approach, and an impulse never pulls. The impulses P ≥ 0
//! solve the linear complementarity problem w' = w + A P ≥ −e w, P ⟂ w' + e w, found by projected
//! Gauss–Seidel iteration (J. J. Moreau, *Numerical aspects of the sweeping process*, 1999). The
//! velocities after the impacts are unique, so symmetric impacts have symmetric results.

use super::queue::WALL;
use crate::trajectory::{Vector, dot, is_same_direction, vector};

/// Two surfaces that touch, as a constraint on their velocities in an impact.
#[derive(Clone, Copy, Debug, Default)]
pub struct Constraint {
    /// Identifies the contact: the indices of the discs, and the image or the wall.
    /// Contacts are solved in the order of their keys.
    pub key: [u32; 3],
    /// Which velocities belong to the two; a wall has none.
    pub bodies: [Option<usize>; 2],
    /// Unit vector from the first to the second.
    pub normal: Vector,
    /// One over the masses; 0 for walls and immovable discs.
    pub inverse_masses: [f64; 2],
    /// The part of the relative velocity that impacts do not change, because its surface belongs to no
    /// body that they move: the velocity of the second surface, or minus that of the first.
    pub carried: Vector,
    /// The part that impacts do not change of the sum of the speeds with which the surfaces turn.
    pub carried_turning: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

/// Iterations for each contact, at most.
pub const MAX_ITERATIONS: usize = 60;

/// Change of speed, relative to the fastest approach, below which the iteration ends.
pub const TOLERANCE: f64 = 1e-14;

/// Iterations, change of speed and factor of the impulses, for contacts of which some touch without
/// approaching. Each impulse changes by more than its contact alone needs (successive over-relaxation; D. M. Young, 1954): discs that are pressed
/// in a row need as many iterations as their number, and not as its square.
const MAX_JOINT_ITERATIONS: usize = 1000;
const JOINT_TOLERANCE: f64 = 1e-8;
const JOINT_RELAXATION: f64 = 1.7;

/// After each so many iterations it is tested whether the largest change has become smaller than
/// this share of that before them. If not, no velocities satisfy all contacts, and the iteration
/// ends.
const TESTED: usize = 100;
const CONVERGING: f64 = 0.9;

/// Changes the velocities by the impulses of all `touches`. The first of each of `impulses` is
/// then the impulse along the normal, in the order of the sorted `touches`.
pub fn apply(touches: &mut [Constraint], velocities: &mut [Vector], impulses: &mut Vec<[f64; 2]>) {
    iterate((MAX_ITERATIONS, TOLERANCE, 1.0), touches, velocities, impulses);
}

/// As [`apply`], for contacts of which some touch without approaching.
pub fn apply_jointly(
    touches: &mut [Constraint],
    velocities: &mut [Vector],
    impulses: &mut Vec<[f64; 2]>,
) {
    // Over-relaxation is for chains of contacts, along which an impulse moves by one contact in a
    // turn.
    let joint = (MAX_JOINT_ITERATIONS, JOINT_TOLERANCE, JOINT_RELAXATION);
    iterate(joint, touches, velocities, impulses);
}

/// Corrects the velocity of each body by the mean of what its contacts need, again and again (G.
/// Cimmino, *Calcolo approssimato per le soluzioni dei sistemi di equazioni lineari*, 1938). This
/// converges to the least sum of squares of what is left.
pub fn project<'a>(
    touches: impl Iterator<Item = &'a Constraint> + Clone,
    velocities: &mut [Vector],
    sums: &mut Vec<(Vector, f64)>,
) {
    sums.resize(velocities.len(), ([0.0; 2], 0.0));
    for _ in 0..MAX_ITERATIONS {
        // All corrections of a turn start from the same velocities and act at once. So the result
        // does not depend on the order of contacts, and shares of opposite surfaces are equal.
        sums.fill(([0.0; 2], 0.0));
        let mut largest = 0.0f64;
        for touch in touches.clone() {
            let weight = touch.inverse_masses[0] + touch.inverse_masses[1];
            let missing = (-touch.separation_speed(velocities)).max(0.0);
            largest = largest.max(missing);
            for (which, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(body) = touch.bodies[which] {
                    // Each body takes the share of its inverse mass, as of an impulse. A surface
                    // that nothing moves takes none.
                    let by = sign * missing * (touch.inverse_masses[which] / weight);
                    let (sum, count) = &mut sums[body];
                    *sum = vector(|k| sum[k] + by * touch.normal[k]);
                    *count += 1.0;
                }
            }
        }
        if largest == 0.0 {
            break;
        }
        for (velocity, &(sum, count)) in velocities.iter_mut().zip(&*sums) {
            if count > 0.0 {
                // The mean, and not the sum: with the sum, two contacts with nearly the same normal
                // would move a body twice as far as needed.
                *velocity = vector(|k| velocity[k] + sum[k] / count);
            }
        }
    }
}

fn iterate(
    (most, tolerance, relaxation): (usize, f64, f64),
    touches: &mut [Constraint],
    velocities: &mut [Vector],
    impulses: &mut Vec<[f64; 2]>,
) {
    // The iteration ends before it is exact to the last bit, so its result depends on the order.
    // The keys make the order that of the state.
    touches.sort_unstable_by_key(|touch| touch.key);
    // For each contact its impulse so far and the speed at which it has to separate.
    impulses.clear();
    let mut fastest = 0.0f64;
    for touch in touches.iter() {
        let approach = touch.separation_speed(velocities);
        fastest = fastest.max(-approach);
        // The wanted speed is that before any impulse. Computed again in each turn, it would follow
        // the corrections, and restitution would act on them.
        impulses.push([0.0, -touch.restitution * approach.min(0.0)]);
    }
    let mut largest_before = f64::INFINITY;
    for iteration in 1..=most {
        let mut largest = 0.0f64;
        for (touch, [impulse, wanted]) in touches.iter().zip(impulses.iter_mut()) {
            let missing = *wanted - touch.separation_speed(velocities);
            let weight = touch.inverse_masses[0] + touch.inverse_masses[1];
            // The sum of the corrections is limited, and not each correction: an impulse that was
            // too large may become smaller, but it never pulls.
            let new = (*impulse + relaxation * missing / weight).max(0.0);
            let change = new - *impulse;
            *impulse = new;
            touch.push(touch.normal, change, velocities);
            largest = largest.max(change.abs() * weight);
        }
        // A contact alone is exact after one turn with the factor 1. Otherwise the end is relative
        // to the fastest approach, so units of length and time do not matter.
        if touches.len() == 1 || largest <= tolerance * fastest {
            break;
        }
        // Without a solution the changes do not become smaller, for instance for a disc between
        // walls that close in. The iteration ends early there, and `share` divides what is left.
        if iteration % TESTED == 0 {
            if largest > CONVERGING * largest_before {
                break;
            }
            largest_before = largest;
        }
    }
}

impl Constraint {
    /// The contact of two discs; `offset` is that of the second from the first.
    pub fn of_discs(pair: [u32; 2], code: u32, offset: Vector) -> Self {
        let length = dot(offset, offset).sqrt();
        // Coincident centres have no normal; any fixed one keeps numbers finite.
        let normal = if length > 0.0 { offset.map(|v| v / length) } else { [1.0, 0.0] };
        Self { key: [pair[0], pair[1], code], normal, ..Self::default() }
    }

    /// The contact of a disc and a wall with a normal towards the disc.
    pub fn of_wall(index: u32, wall: u32, normal: Vector) -> Self {
        let normal = normal.map(|v| -v);
        Self { key: [index, WALL, wall], normal, ..Self::default() }
    }

    /// Whether another contact with the same key is this one. On a torus a disc may touch two images
    /// of a wall.
    pub fn is_same(&self, other: &Self) -> bool {
        is_same_direction(self.normal, other.normal)
    }

    /// Whether one of the two is a surface that no impulse moves.
    pub fn is_with_fixed(&self) -> bool {
        (0..2).any(|k| self.bodies[k].is_none() || self.inverse_masses[k] == 0.0)
    }

    /// The speed at which the two separate.
    pub fn separation_speed(&self, velocities: &[Vector]) -> f64 {
        dot(self.normal, self.relative_velocity(velocities))
    }

    /// The velocity of the second against the first.
    pub fn relative_velocity(&self, velocities: &[Vector]) -> Vector {
        let velocity = |body: Option<usize>| body.map_or([0.0; 2], |body| velocities[body]);
        let [a, b] = self.bodies.map(velocity);
        vector(|k| (b[k] - a[k]) + self.carried[k])
    }

    /// Changes the velocities by an impulse on the second along `direction`.
    pub fn push(&self, direction: Vector, impulse: f64, velocities: &mut [Vector]) {
        for (which, sign) in [(0, -1.0), (1, 1.0)] {
            if let Some(body) = self.bodies[which] {
                // One impulse on both bodies with opposite signs conserves momentum to rounding.
                let change = sign * impulse * self.inverse_masses[which];
                velocities[body] = vector(|k| velocities[body][k] + change * direction[k]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_disc_on_two_at_once_leaves_symmetrically() {
        let (x, y) = (0.75f64.sqrt(), 0.5);
        let touch = |second, normal| Constraint {
            key: [0, second as u32, 0],
            bodies: [Some(0), Some(second)],
            normal,
            inverse_masses: [1.0; 2],
            restitution: 1.0,
            ..Constraint::default()
        };
        let mut touches = [touch(1, [x, y]), touch(2, [x, -y])];
        let mut velocities = [[1.0, 0.0], [0.0; 2], [0.0; 2]];
        apply(&mut touches, &mut velocities, &mut Vec::new());
        let expected = [[-0.2, 0.0], [0.6, 0.6 / 3f64.sqrt()], [0.6, -0.6 / 3f64.sqrt()]];
        for (found, expected) in velocities.iter().zip(expected) {
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-14), "{found:?}");
        }
    }
}
