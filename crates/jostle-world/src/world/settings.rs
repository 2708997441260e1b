//! The settings of a world, apart from its particles and forces.

use crate::container::{Container, MAX_SIDES};
use crate::particles;
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
    /// Coefficient of restitution of the world, 0 to 1; multiplied by those of the particles.
    pub restitution: f32,
    /// The region that contains the particles.
    pub container: Container,
    /// Coefficients of restitution of its sides, 0 to 1, at min x, max x, min y and max y; those of a
    /// circle are equal. At a side it is multiplied by those of the world and the particle.
    pub container_restitution: [f32; MAX_SIDES],
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
        gravity, drag, restitution, container, container_restitution, on_touch, method, substeps,
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
            restitution: 1.0,
            container: Container::None,
            container_restitution: [1.0; MAX_SIDES],
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
        if !(0.0..=1.0).contains(&self.restitution) {
            return Err(Error::of("restitution", self.restitution, "it must lie between 0 and 1"));
        }
        if let Some(substeps) = self.substeps
            && !(1..=1000).contains(&substeps)
        {
            return Err(Error::of("substeps", substeps, "it must lie between 1 and 1000"));
        }
        self.container.validate()?;
        self.validate_sides()?;
        self.tree.validate()
    }

    /// The coefficients of restitution of the sides that there are; 1 for others.
    pub(crate) fn side_restitutions(&self) -> [f32; MAX_SIDES] {
        if self.container.has_sides() { self.container_restitution } else { [1.0; MAX_SIDES] }
    }

    fn validate_sides(&self) -> Result<()> {
        let all = self.container_restitution;
        let refuse = |index: usize, rule| {
            let is_one = all.iter().all(|one| one.to_bits() == all[0].to_bits());
            Err(match is_one {
                true => Error::of("container_restitution", all[0], rule),
                false => Error::at("container_restitution", index, all[index], rule),
            })
        };
        if let Some(index) = all.iter().position(|one| !(0.0..=1.0).contains(one)) {
            return refuse(index, "it must lie between 0 and 1");
        }
        if self.container.sides().count() == 1
            && let Some(index) = all.iter().position(|one| *one != all[0])
        {
            return refuse(index, "a circle has one wall, so all four must be equal");
        }
        Ok(())
    }
}
