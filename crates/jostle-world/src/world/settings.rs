//! The settings of a world, apart from its particles and forces.

use crate::container::Container;
use crate::particles;
use crate::surface::Sides;
use jostle_base::error::{Error, Result};
use jostle_base::saved;
use jostle_base::settings::{Method, Settings};

/// What happens to particles that touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnTouch {
    /// They bounce, or rest on each other.
    #[default]
    Bounce,
    /// They merge at the centre of mass: area, mass and momentum are summed. If one of them
    /// is immovable, they merge at its position, and momentum is lost.
    Merge,
    /// They pass through each other.
    Ignore,
}

saved! { enum OnTouch("on_touch") { 0 => Bounce, 1 => Merge, 2 => Ignore } }

/// The settings of a world, apart from its particles and forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldSettings {
    /// Acceleration of everything movable, world units per second squared.
    pub gravity: [f32; 2],
    /// Linear damping, per second: dv/dt = −drag · v.
    pub drag: f32,
    /// The region that contains the particles.
    pub container: Container,
    /// The surfaces of its sides, at min x, max x, min y and max y; those of a circle are equal.
    pub sides: Sides,
    /// What happens to particles that touch.
    pub on_touch: OnTouch,
    /// How pairs are found. The result is the same.
    pub method: Method,
    /// Sub-steps of a step, in which forces act and resting contacts are solved, at least 1.
    /// None: 1 if nothing can rest and flights are exact, or only forces between neighbours act,
    /// otherwise [`DEFAULT_SUBSTEPS`].
    pub substeps: Option<usize>,
    /// Whether islands that have been slow for half a second fall asleep under gravity, if
    /// collisions are inelastic.
    pub sleeping: bool,
    /// Whether the pairs that touch are recorded, see [`World::events`](super::World::events). The
    /// state does not depend on it.
    pub track_events: bool,
    /// Leaf capacity, maximum depth and threads.
    pub tree: Settings,
}

saved! {
    struct WorldSettings {
        gravity, drag, container, sides, on_touch, method, substeps,
        sleeping, track_events, tree
    }
}

/// Sub-steps of a step with forces or resting contacts: piles then rest with small overlaps.
pub const DEFAULT_SUBSTEPS: usize = 4;

impl Default for WorldSettings {
    fn default() -> Self {
        Self {
            gravity: [0.0; 2],
            drag: 0.0,
            container: Container::None,
            sides: Sides::default(),
            on_touch: OnTouch::Bounce,
            method: Method::Quadtree,
            substeps: None,
            sleeping: true,
            track_events: false,
            tree: Settings::default(),
        }
    }
}

impl WorldSettings {
    pub(crate) fn validate(&self) -> Result<()> {
        particles::check_vectors("gravity", &[self.gravity]).map_err(|_| {
            let value = format!("({}, {})", self.gravity[0], self.gravity[1]);
            Error::of("gravity", value, "both components must be finite and at most 1e18")
        })?;
        if !(self.drag >= 0.0 && self.drag.is_finite()) {
            return Err(Error::of("drag", self.drag, "it must be finite and at least 0"));
        }
        if let Some(substeps) = self.substeps
            && !(1..=1000).contains(&substeps)
        {
            return Err(Error::of("substeps", substeps, "it must lie between 1 and 1000"));
        }
        self.container.validate()?;
        self.sides.validate(self.container.sides().count() == 1)?;
        self.tree.validate()
    }

    /// The surfaces of the sides that there are.
    pub(crate) fn present_sides(&self) -> Sides {
        if self.container.has_sides() { self.sides } else { Sides::default() }
    }
}
