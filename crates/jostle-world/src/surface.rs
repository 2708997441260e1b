//! Coefficients of a contact from those of its two surfaces.

use jostle_base::bytes::{Reader, Saved, Writer};
use jostle_base::error::{Error, Result};
use jostle_base::saved;

/// The coefficient of a contact: the geometric mean of the two. For equal ones it is theirs to the bit.
#[inline(always)]
pub(crate) fn mean(a: f64, b: f64) -> f64 {
    (a * b).sqrt()
}

/// As [`mean`], of float32 numbers. In float64 their product neither overflows nor vanishes.
#[inline(always)]
pub(crate) fn mean32(a: f32, b: f32) -> f32 {
    mean(a.into(), b.into()) as f32
}

/// The surface of a wall or of a side of the container.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Coefficient of restitution, 0 to 1; None: that of the disc.
    pub restitution: Option<f32>,
    /// Coefficient of friction; None: that of the disc.
    pub friction: Option<f32>,
}

saved! { struct Surface { restitution, friction } }

impl Surface {
    /// Coefficient of restitution with a disc that has `own`.
    #[inline(always)]
    pub(crate) fn restitution_with(&self, own: f32) -> f32 {
        self.restitution.map_or(own, |of| mean32(of, own))
    }

    /// Coefficient of friction with a disc that has `own`.
    #[inline(always)]
    pub(crate) fn friction_with(&self, own: f64) -> f64 {
        self.friction.map_or(own, |of| mean(of.into(), own))
    }

    /// Whether discs with a coefficient of restitution of 1 keep their energy here.
    pub(crate) fn is_elastic(&self) -> bool {
        self.restitution.is_none_or(|of| of == 1.0)
    }

    /// Refuses values out of range. `names` are the arguments with the coefficients of restitution and of friction.
    pub(crate) fn validate(&self, names: [&'static str; 2], index: usize) -> Result<()> {
        if let Some(restitution) = self.restitution.filter(|of| !(0.0..=1.0).contains(of)) {
            return Err(Error::at(names[0], index, restitution, "it must lie between 0 and 1"));
        }
        if let Some(friction) = self.friction.filter(|of| !(*of >= 0.0 && of.is_finite())) {
            return Err(Error::at(names[1], index, friction, "it must be finite and at least 0"));
        }
        Ok(())
    }
}

/// Maximum number of sides of a container.
pub const MAX_SIDES: usize = 4;

/// The surfaces of the sides of a container, at min x, max x, min y and max y; those of a circle are equal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sides(pub [Surface; MAX_SIDES]);

impl Sides {
    /// Whether elastic discs keep their energy at all sides.
    pub(crate) fn are_elastic(&self) -> bool {
        self.0.iter().all(Surface::is_elastic)
    }

    /// Whether all have the same coefficient of restitution.
    pub(crate) fn bounce_alike(&self) -> bool {
        self.0.iter().all(|side| side.restitution == self.0[0].restitution)
    }

    /// Refuses values out of range, and different ones of a round container.
    pub fn validate(&self, is_round: bool) -> Result<()> {
        for (index, side) in self.0.iter().enumerate() {
            side.validate(["restitution", "friction"], index)?;
        }
        match self.0.iter().position(|side| is_round && *side != self.0[0]) {
            Some(index) => {
                let rule = "a circle has one side, so all four must be equal";
                Err(Error::of("sides", format!("side {index}"), rule))
            }
            None => Ok(()),
        }
    }
}

impl Saved for Sides {
    fn put(&self, to: &mut Writer) {
        self.0.iter().for_each(|side| side.put(to));
    }
    fn get(from: &mut Reader<'_>) -> Result<Self> {
        let mut all = Self::default();
        for side in &mut all.0 {
            *side = Saved::get(from)?;
        }
        Ok(all)
    }
}
