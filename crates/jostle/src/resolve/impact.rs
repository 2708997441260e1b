//! Bounces at the moment of impact.
//!
//! Both particles are on straight lines (see [`Motion`]), so the moment at which
//! they meet follows from a quadratic equation, and the normal from where they
//! are then. The impulse along it is Newton's:
//! P = −(1 + e) (w·n) / ((1/m₁ + 1/m₂) n·n) · n. Dividing by n·n instead of
//! normalising n keeps the energy of an elastic bounce to rounding.
//!
//! The closest approach is found first and the moment of impact from there: that
//! keeps its accuracy when the way is a thousand radii long.

use super::Rules;
use crate::contacts::Contact;
use crate::container::Container;
use crate::motion::{Motion, Motions};

/// Bounces off the walls that one particle may have in a sub-step.
const WALL_BOUNCES: usize = 64;

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn both(f: impl Fn(usize) -> f64) -> [f64; 2] {
    [f(0), f(1)]
}

/// Lets the two particles of a contact bounce if they meet in this sub-step.
/// Returns whether they did; what changed says in which `turn`.
pub fn between(
    contact: &mut Contact,
    motions: &Motions,
    rest_speed: f32,
    h: f32,
    turn: u32,
) -> bool {
    let [a, b] = contact.places.map(|place| motions.get(place));
    if is_idle(contact, &a, &b, rest_speed) {
        return false;
    }
    let w = both(|k| f64::from(b.velocity[k]) - f64::from(a.velocity[k]));
    let end = both(|k| {
        let offset =
            f64::from(b.position[k]) - f64::from(a.position[k]) + f64::from(contact.image[k]);
        offset + (f64::from(b.travel[k]) - f64::from(a.travel[k]))
    });
    let start = f64::from(a.since.max(b.since));
    let left = f64::from(h) - start;
    let q = both(|k| end[k] - w[k] * left);
    let Some((wait, normal)) = meeting(q, w, f64::from(contact.reach), left) else { return false };
    let (nn, nw) = (dot(normal, normal), dot(normal, w));
    let slow = f64::from(rest_speed);
    if nw * nw < slow * slow * nn {
        return false;
    }
    let [inverse_a, inverse_b] = contact.inverse_masses.map(f64::from);
    let share = -(1.0 + f64::from(contact.restitution)) * nw / (nn * (inverse_a + inverse_b));
    let time = start + wait;
    let push = |motion: Motion, inverse: f64| {
        let change = both(|k| inverse * share * normal[k]);
        Motion { turn, ..changed(motion, change, time, h) }
    };
    if inverse_a > 0.0 {
        motions.set(contact.places[0], push(a, -inverse_a));
    }
    if inverse_b > 0.0 {
        motions.set(contact.places[1], push(b, inverse_b));
    }
    contact.touched = true;
    true
}

/// Whether a glance is enough to see that nothing happens: still on their first lines
/// and too far apart, or too slow to bounce.
#[inline(always)]
fn is_idle(contact: &Contact, a: &Motion, b: &Motion, rest_speed: f32) -> bool {
    let square = |v: [f32; 2]| v[0] * v[0] + v[1] * v[1];
    let way = square([0, 1].map(|k| b.travel[k] - a.travel[k]));
    let straight = a.since == 0.0 && b.since == 0.0;
    if straight && contact.gap > 0.0 && way < 0.999 * contact.gap * contact.gap {
        return true;
    }
    square([0, 1].map(|k| b.velocity[k] - a.velocity[k])) < rest_speed * rest_speed
}

/// When two particles at offset `q` that close in with `w` come within `reach`,
/// at most `left` seconds from now, and their offset then.
fn meeting(q: [f64; 2], w: [f64; 2], reach: f64, left: f64) -> Option<(f64, [f64; 2])> {
    let approach = dot(q, w);
    if approach >= 0.0 {
        return None;
    }
    let qq = dot(q, q);
    if qq <= reach * reach {
        return Some((0.0, q));
    }
    let ww = dot(w, w);
    let wait = -approach / ww;
    let closest = both(|k| q[k] + w[k] * wait);
    let free = reach * reach - dot(closest, closest);
    if free <= 0.0 {
        return None;
    }
    let back = (free / ww).sqrt();
    let wait = (wait - back).max(0.0);
    if wait > left { None } else { Some((wait, both(|k| closest[k] - w[k] * back))) }
}

/// The motion after its velocity changed at `time`.
fn changed(motion: Motion, change: [f64; 2], time: f64, h: f32) -> Motion {
    let left = f64::from(h) - time;
    let add = |value: f32, by: f64| (f64::from(value) + by) as f32;
    Motion {
        position: motion.position,
        velocity: [0, 1].map(|k| add(motion.velocity[k], change[k])),
        travel: [0, 1].map(|k| add(motion.travel[k], change[k] * left)),
        since: time as f32,
        ..motion
    }
}

/// The motion after all its bounces off the walls; `None` if there was none.
pub fn against_walls(
    motion: Motion,
    radius: f32,
    restitution: f32,
    rules: &Rules,
    h: f32,
) -> Option<Motion> {
    let hit = match rules.container {
        Container::None | Container::Torus { .. } => return None,
        Container::Box { min, max } => {
            let low = [min[0] + radius, min[1] + radius];
            let high = [max[0] - radius, max[1] - radius];
            let goal = [0, 1].map(|k| motion.position[k] + motion.travel[k]);
            let inside = |k: usize| goal[k] >= low[k] && goal[k] <= high[k];
            if inside(0) && inside(1) {
                return None;
            }
            flat_walls(motion, [low, high], restitution, rules.rest_speed, h)
        }
        Container::Circle { center, radius: outer } => {
            round_wall(motion, center, outer - radius, restitution, rules.rest_speed, h)
        }
    };
    (hit != motion).then_some(hit)
}

/// Bounces between parallel walls; the two axes do not know of each other.
fn flat_walls(
    mut motion: Motion,
    [low, high]: [[f32; 2]; 2],
    restitution: f32,
    rest_speed: f32,
    h: f32,
) -> Motion {
    let began = motion.since;
    let mut latest = began;
    for axis in 0..2 {
        motion.since = began;
        for _ in 0..WALL_BOUNCES {
            let velocity = f64::from(motion.velocity[axis]);
            let goal = f64::from(motion.position[axis]) + f64::from(motion.travel[axis]);
            let wall = f64::from(if velocity > 0.0 { high[axis] } else { low[axis] });
            let beyond = goal - wall;
            let leaves = beyond * velocity > 0.0;
            if !leaves || velocity.abs() < f64::from(rest_speed) {
                break;
            }
            let time = (f64::from(h) - beyond / velocity).max(f64::from(motion.since));
            let mut change = [0.0; 2];
            change[axis] = -(1.0 + f64::from(restitution)) * velocity;
            motion = changed(motion, change, time, h);
            if restitution == 0.0 {
                break;
            }
        }
        latest = latest.max(motion.since);
    }
    motion.since = latest;
    motion
}

/// Bounces inside a circle of `reach` around `center`.
fn round_wall(
    mut motion: Motion,
    center: [f32; 2],
    reach: f32,
    restitution: f32,
    rest_speed: f32,
    h: f32,
) -> Motion {
    let reach = f64::from(reach);
    for _ in 0..WALL_BOUNCES {
        let v = both(|k| f64::from(motion.velocity[k]));
        let left = f64::from(h) - f64::from(motion.since);
        let end = both(|k| {
            let offset = f64::from(motion.position[k]) - f64::from(center[k]);
            offset + f64::from(motion.travel[k])
        });
        if dot(end, end) <= reach * reach || dot(end, v) <= 0.0 {
            break;
        }
        let q = both(|k| end[k] - v[k] * left);
        let vv = dot(v, v);
        let to_closest = -dot(q, v) / vv;
        let closest = both(|k| q[k] + v[k] * to_closest);
        let free = (reach * reach - dot(closest, closest)).max(0.0);
        // Not `clamp`, which panics where an overflow has made `left` NaN.
        let wait = (to_closest + (free / vv).sqrt()).max(0.0).min(left);
        let outward = both(|k| q[k] + v[k] * wait);
        let (nn, nv) = (dot(outward, outward), dot(outward, v));
        if nv <= 0.0 || nv * nv < f64::from(rest_speed) * f64::from(rest_speed) * nn {
            break;
        }
        let share = -(1.0 + f64::from(restitution)) * nv / nn;
        let change = both(|k| share * outward[k]);
        motion = changed(motion, change, f64::from(motion.since) + wait, h);
        if restitution == 0.0 {
            break;
        }
    }
    motion
}
