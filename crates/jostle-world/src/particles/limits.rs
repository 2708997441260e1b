//! Limits of the values of particles.

use jostle_base::error::{Error, Result, counted};
use jostle_index::shapes::{self, check_finite};

/// Largest coordinate, component of a velocity, and displacement of a step.
pub const FARTHEST: f32 = 1e18;

/// Range of masses, so that they and their inverses are far from the limits of float32.
pub const MASS_RANGE: [f32; 2] = [1e-30, 1e30];

/// Maximum number of kinds of particles.
pub const MAX_KINDS: usize = 64;

/// Refuses positions or velocities that are not finite or too large.
pub fn check_vectors(argument: &'static str, vectors: &[[f32; 2]]) -> Result<()> {
    // Squares of coordinates must not overflow float32, so the limit is below the root of its
    // largest number.
    for (index, &[x, y]) in vectors.iter().enumerate() {
        check_finite(argument, &[[x, y]]).map_err(|_| {
            Error::at(argument, index, format!("({x}, {y})"), "both coordinates must be finite")
        })?;
        if x.abs() > FARTHEST || y.abs() > FARTHEST {
            let rule = format!("both coordinates must lie within ±{FARTHEST:e}");
            return Err(Error::at(argument, index, format!("({x:e}, {y:e})"), &rule));
        }
    }
    Ok(())
}

/// Refuses invalid radii.
pub fn check_radii(radii: &[f32]) -> Result<()> {
    shapes::check_radii("radii", radii)
}

/// Refuses masses outside [`MASS_RANGE`].
pub fn check_masses(masses: &[f32]) -> Result<()> {
    let [least, most] = MASS_RANGE;
    match masses.iter().position(|m| !(least..=most).contains(m)) {
        Some(index) => {
            let rule = format!("a mass must lie between {least:e} and {most:e}");
            Err(Error::at("masses", index, masses[index], &rule))
        }
        None => Ok(()),
    }
}

/// Refuses coefficients of restitution outside 0 to 1.
pub fn check_restitution(restitution: &[f32]) -> Result<()> {
    match restitution.iter().position(|e| !(0.0..=1.0).contains(e)) {
        Some(index) => {
            let rule = "a restitution must lie between 0 and 1";
            Err(Error::at("restitution", index, restitution[index], rule))
        }
        None => Ok(()),
    }
}

/// Refuses coefficients of friction that are not finite or below 0.
pub fn check_friction(friction: &[f32]) -> Result<()> {
    match friction.iter().position(|&friction| !(friction >= 0.0 && friction.is_finite())) {
        Some(index) => {
            let rule = "a coefficient of friction must be finite and at least 0";
            Err(Error::at("friction", index, friction[index], rule))
        }
        None => Ok(()),
    }
}

/// Refuses angular velocities that are not finite or too large.
pub fn check_angular_velocities(velocities: &[f32]) -> Result<()> {
    let is_allowed = |velocity: &f32| velocity.abs() <= FARTHEST;
    match velocities.iter().position(|velocity| !is_allowed(velocity)) {
        Some(index) => {
            let rule = format!("an angular velocity must be finite and lie within ±{FARTHEST:e}");
            Err(Error::at("angular_velocities", index, velocities[index], &rule))
        }
        None => Ok(()),
    }
}

/// Refuses angles that are not finite.
pub fn check_angles(angles: &[f64]) -> Result<()> {
    match angles.iter().position(|angle| !angle.is_finite()) {
        Some(index) => Err(Error::at("angles", index, angles[index], "an angle must be finite")),
        None => Ok(()),
    }
}

/// Refuses kinds that no force between kinds can have.
pub fn check_kinds(kinds: &[u8]) -> Result<()> {
    check_kinds_below(kinds, MAX_KINDS, &format!("a kind must lie between 0 and {}", MAX_KINDS - 1))
}

/// Refuses kinds that a table of `count` kinds does not have.
pub fn check_kinds_of_table(kinds: &[u8], count: usize) -> Result<()> {
    let rule = format!("the table has {}, from 0 to {}", counted(count, "kind"), count - 1);
    check_kinds_below(kinds, count, &rule)
}

fn check_kinds_below(kinds: &[u8], count: usize, rule: &str) -> Result<()> {
    match kinds.iter().position(|&kind| usize::from(kind) >= count) {
        Some(index) => Err(Error::at("kinds", index, kinds[index], rule)),
        None => Ok(()),
    }
}
