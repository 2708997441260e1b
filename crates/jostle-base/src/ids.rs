//! Names of shapes and particles.

/// The id of a shape in a space, or of a particle in a world; at least 0.
pub type Id = i64;
