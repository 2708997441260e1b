//! Gravity and linear damping over a sub-step.
//!
//! With dv/dt = g − γ v a disc that starts with v₀ is at x₀ + v₀ τ + g (h − τ)/γ after h seconds,
//! where τ = (1 − exp(−γ h))/γ, and its velocity is v₀ exp(−γ h) + g τ. In the time s with
//! ds = exp(−γ t) dt all velocities are constant without gravity, so that collisions are those of
//! free flight for τ seconds. A sub-step is such a flight, under the constant acceleration that
//! leads to the right place, followed by the change of velocity that leads to the right velocity.
//! Without damping it is the parabola itself.

/// A sub-step as free flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Seconds of the sub-step.
    pub seconds: f64,
    /// Seconds of free flight.
    pub duration: f64,
    /// Acceleration during the flight.
    pub gravity: [f64; 2],
    /// What velocities are multiplied by after the flight.
    pub decay: f64,
    /// What is added to the velocities of falling particles after that.
    pub correction: [f64; 2],
    /// Seconds for which a constant force changes the velocity before the flight, and after the
    /// damping.
    pub kicks: [f64; 2],
}

/// What forces and resting contacts do to a particle in a sub-step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kick {
    /// Change of the velocity before the flight.
    pub before: [f64; 2],
    /// Change of the velocity after the flight and the damping.
    pub after: [f64; 2],
    /// Whether resting contacts support the particle. Then gravity is a part of `before`, and the
    /// flight is straight.
    pub is_supported: bool,
    /// The speed that gravity and forces give to a free particle in the sub-step.
    pub speed: f32,
}

impl Kick {
    /// Whether it changes the velocity of a free particle.
    #[inline(always)]
    pub fn has_changes(&self) -> bool {
        self.before != [0.0; 2] || self.after != [0.0; 2]
    }
}

impl Flow {
    /// A sub-step of `h` seconds.
    pub fn new(h: f64, gravity: [f32; 2], drag: f32) -> Self {
        let gravity = gravity.map(f64::from);
        let x = f64::from(drag) * h;
        // Without damping the formulas below would divide by 0. Their limit is the leapfrog method
        // with halves of the kick.
        if x == 0.0 {
            let (decay, correction, kicks) = (1.0, [0.0; 2], [0.5 * h; 2]);
            return Self { seconds: h, duration: h, gravity, decay, correction, kicks };
        }
        let lost = lost_share(x);
        // τ/h and (h − τ)/(γ h²).
        let (share, fall) = (lost / x, remainder(x, lost));
        let (duration, decay) = (h * share, 1.0 - lost);
        // The flight lasts τ, and its displacement by gravity must be g (h − τ)/γ. With the
        // constant acceleration a it is a τ²/2.
        let acceleration = gravity.map(|g| g * (2.0 * fall / (share * share)));
        // The velocity must end as v₀ exp(−γ h) + g τ. The flight and the damping give (v₀ + a τ)
        // exp(−γ h); this is the rest.
        let correction = [0, 1].map(|k| (gravity[k] - acceleration[k] * decay) * duration);
        // A constant force is divided so that position and velocity of a free particle are exact.
        // The kick before the flight alone moves the particle, so it follows from the displacement.
        let before = h * fall / share;
        let kicks = [before, duration - before * decay];
        Self { seconds: h, duration, gravity: acceleration, decay, correction, kicks }
    }
}

/// Halvings of the exponent, after which three dozen terms of its series are more than enough.
const MOST_HALVINGS: i32 = 12;

/// 1 − exp(−x) for x ≥ 0, with nothing but sums and products: the same on every machine.
fn lost_share(x: f64) -> f64 {
    let mut halvings = 0;
    let mut y = x;
    // exp of the system's library has other last bits on other machines. Halving the exponent and a
    // series need only sums and products, which IEEE 754 defines to the bit.
    while y > 0.25 && halvings < MOST_HALVINGS {
        y *= 0.5;
        halvings += 1;
    }
    if y > 0.25 {
        // The exponent is above 0.25 · 2¹² = 1024 here, and exp(−1024) is below the smallest number
        // of float64.
        return 1.0;
    }
    let (mut sum, mut term) = (0.0, 1.0);
    // The series of 1 − exp(−y) itself, because 1 minus a computed exp(−y) loses all digits for
    // small y. With y ≤ 1/4 the first term left out is below 10⁻³⁰.
    for k in 1..20 {
        term *= -y / f64::from(k);
        sum -= term;
    }
    for _ in 0..halvings {
        // 1 − exp(−2y) = s (2 − s) with s = 1 − exp(−y). Both factors are positive, so there is no
        // cancellation.
        sum = sum * (2.0 - sum);
    }
    sum
}

/// (x − (1 − exp(−x)))/x², where `lost` is 1 − exp(−x).
fn remainder(x: f64, lost: f64) -> f64 {
    if x > 0.5 {
        // For x above 1/2 the difference x − lost is at least a fifth of x and loses few bits.
        // Below, the series has no difference of nearly equal numbers.
        return (x - lost) / (x * x);
    }
    let (mut sum, mut term) = (0.0, 0.5);
    for k in 3..24 {
        sum += term;
        term *= -x / f64::from(k);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flow_is_the_solution_of_the_equation_of_motion() {
        for (drag, h) in [(0.0, 0.1), (1e-4, 0.5), (0.5, 0.1), (2.0, 0.3), (30.0, 1.0), (1e4, 1.0)]
        {
            let flow = Flow::new(h, [0.0, 10.0], drag as f32);
            let v = 3.0;
            let displacement = v * flow.duration + 0.5 * flow.gravity[1] * flow.duration.powi(2);
            let end = (v + flow.gravity[1] * flow.duration) * flow.decay + flow.correction[1];
            let drag = f64::from(drag as f32);
            let (tau, fall) = if drag == 0.0 {
                (h, 0.5 * h * h)
            } else {
                let tau = -(-drag * h).exp_m1() / drag;
                (tau, (h - tau) / drag)
            };
            let (right_displacement, right_end) =
                (v * tau + 10.0 * fall, v * (-drag * h).exp() + 10.0 * tau);
            let error = if drag * h < 1e-3 { 1e-9 } else { 1e-12 };
            assert!(
                (displacement / right_displacement - 1.0).abs() < error,
                "{drag}: {displacement} {right_displacement}"
            );
            assert!((end / right_end - 1.0).abs() < 1e-12, "{drag}: {end} {right_end}");
            // A constant force does the same.
            let kicked = v + 10.0 * flow.kicks[0];
            let (displacement, end) =
                (kicked * flow.duration, kicked * flow.decay + 10.0 * flow.kicks[1]);
            assert!(
                (displacement / right_displacement - 1.0).abs() < error,
                "{drag}: {displacement} {right_displacement}"
            );
            assert!((end / right_end - 1.0).abs() < 1e-12, "{drag}: {end} {right_end}");
        }
    }
}
