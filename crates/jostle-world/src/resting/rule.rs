//! Which contacts rest in a sub-step, and how they begin it: one rule for two discs, for sides, walls and
//! their ends, and for a round container.
//!
//! A contact rests if all of its bounces would end within the sub-step, see [`rest_speeds`]. The
//! solver then replaces them by one impulse. Of a contact that does not rest,
//! [`crate::events`] computes each impact at its own time.

use crate::trajectory::MAX_REST_SPEED;

/// Surfaces touch if their gap is at most this share of the size; at a wall, of the radius.
pub const TOUCHING: f32 = 0.003;

/// Surfaces with a larger gap cannot rest. In units of the displacement at the speed that gravity and
/// forces give in the sub-step.
pub const MAX_REST_GAP: f32 = MAX_REST_SPEED as f32 + 2.01;

/// The solver takes the normal as constant in a sub-step. That is allowed if the bodies move by at most
/// this share of the radius of the curve on which they would slide along each other.
const STEADY: f32 = 0.5;

/// Whether surfaces of bodies of a size count as touching with this gap.
#[inline(always)]
pub fn are_touching(gap: f32, size: f32) -> bool {
    gap <= TOUCHING * size
}

/// Two surfaces as a sub-step begins.
#[derive(Clone, Copy, Debug)]
pub struct Surfaces {
    /// Distance from surface to surface; negative if they overlap.
    pub gap: f32,
    /// The smaller diameter; at a wall, the radius.
    pub size: f32,
    /// Radius of the curve on which one centre slides along the other surface: the sum of the radii of
    /// two discs, the radius at the end of a wall, the difference of the radii in a round container,
    /// infinite at a flat wall.
    pub curve: f32,
    /// The speed of one body relative to the other.
    pub speed: f32,
    /// The part of it along the normal: that at which they separate.
    pub normal_speed: f32,
    /// Coefficient of restitution.
    pub restitution: f32,
    /// [`rest_speeds`](crate::trajectory::rest_speeds) of it; 0 if the contact may not rest.
    pub rest_speeds: [f32; 2],
    /// The speeds that gravity and forces give to the two in the sub-step.
    pub speeds: [f32; 2],
    /// Whether the contact rested in the sub-step before.
    pub has_pushed: bool,
}

/// How a contact begins a sub-step.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Whether it rests. Only then the other fields have a meaning.
    pub rests: bool,
    /// Whether the surfaces touch and approach too fast to rest. Then an impact is solved before
    /// gravity and forces act.
    pub is_fast: bool,
    /// Speed at which the gap may close: it is 0 at the end of the sub-step at most.
    pub closing_speed: f32,
    /// Speed of separation after the impacts at the beginning, at least. Slow contacts do not approach
    /// faster than before, so they change nothing where no contact is fast.
    pub bounce: f32,
}

impl Surfaces {
    /// The start of the contact in a sub-step of `h` seconds. Without branches, so that the compiler
    /// uses vector instructions for sixteen contacts.
    #[inline(always)]
    pub fn start(self, h: f32) -> Start {
        let Self { gap, normal_speed, restitution, speeds: [a, b], has_pushed, .. } = self;
        // All speeds are compared with what gravity and forces can give: without them nothing presses
        // the two together.
        let most = larger(a, b);
        let [approach, separation] = self.rest_speeds.map(|limit| limit * most);
        // An overlap counts as a gap of 0: position correction removes it. A speed that removes it
        // would add energy.
        let closing_speed = larger(gap, 0.0) / h;
        // What falls from farther away lands in a later sub-step.
        let is_near = (gap <= MAX_REST_GAP * most * h) & (closing_speed <= approach + a + b);
        let is_touching = are_touching(gap, self.size);
        // One that pushed in the sub-step before is not lost because others throw it off for a moment.
        let is_slow = (normal_speed >= -approach) & ((normal_speed <= separation) | has_pushed);
        // The square of the speed at which they fall onto each other, v² + 2 a d.
        let impact = normal_speed * normal_speed + 2.0 * most * closing_speed;
        let limit = if has_pushed { larger(approach, most) } else { approach };
        let is_low = impact <= limit * limit;
        let is_steady = self.speed * h <= STEADY * self.curve;
        // The operators do not branch, so all sixteen lanes are one sequence of vector
        // instructions.
        let rests = is_near & (is_touching | is_slow & is_low) & is_steady & (approach > 0.0);
        // A disc that lands fast first bounces with its restitution, and only then does gravity
        // act. Without this phase a fast impact would be absorbed.
        let is_fast = rests & is_touching & (normal_speed < -approach);
        // In the phase of impacts a slow contact keeps its speed of approach. It only passes on
        // what fast contacts press into it.
        let slow_bounce = if is_touching { smaller(normal_speed, 0.0) } else { f32::MIN };
        let bounce = if is_fast { -restitution * normal_speed } else { slow_bounce };
        Start { rests, is_fast, closing_speed, bounce }
    }
}

/// As the vector instruction: not [`f32::max`], which takes several where a number may be NaN.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// See [`larger`].
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Surfaces with a coefficient of restitution of 0.5 and a small gap, in a sub-step of 1 s in which
    /// gravity gives a speed of 1.
    fn near(normal_speed: f32) -> Surfaces {
        Surfaces {
            gap: 0.04,
            size: 10.0,
            curve: f32::INFINITY,
            speed: normal_speed.abs(),
            normal_speed,
            restitution: 0.5,
            rest_speeds: [0.5, 0.25],
            speeds: [1.0, 0.0],
            has_pushed: false,
        }
    }

    #[test]
    fn a_contact_rests_if_its_bounces_end_within_the_sub_step() {
        // v² + 2 a d ≤ 0.5² for those that approach.
        for (normal_speed, rests) in [(0.25, true), (0.26, false), (-0.4, true), (-0.42, false)] {
            assert_eq!(near(normal_speed).start(1.0).rests, rests, "{normal_speed}");
        }
        let pushed = |normal_speed| Surfaces { has_pushed: true, ..near(normal_speed) };
        assert!(pushed(0.9).start(1.0).rests && !pushed(1.0).start(1.0).rests);
    }

    #[test]
    fn surfaces_that_touch_bounce_first_if_they_are_fast() {
        let touching = |normal_speed| Surfaces { gap: 0.02, ..near(normal_speed) }.start(1.0);
        let [slow, fast] = [touching(-0.5), touching(-2.0)];
        assert!(slow.rests && !slow.is_fast && slow.bounce == -0.5);
        assert!(fast.rests && fast.is_fast && fast.bounce == 1.0);
        assert_eq!(fast.closing_speed, 0.02);
    }

    #[test]
    fn a_contact_rests_only_while_its_normal_hardly_turns() {
        let sliding = |speed| Surfaces { curve: 3.0, speed, ..near(0.0) }.start(1.0).rests;
        assert!(sliding(1.5) && !sliding(1.6));
    }

    #[test]
    fn nothing_rests_that_nothing_presses_together() {
        assert!(!Surfaces { speeds: [0.0; 2], gap: 0.0, ..near(0.0) }.start(1.0).rests);
        assert!(!Surfaces { rest_speeds: [0.0; 2], gap: 0.0, ..near(0.0) }.start(1.0).rests);
    }
}
