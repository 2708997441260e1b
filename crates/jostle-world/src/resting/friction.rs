//! Friction of the resting contacts of two particles, in the same blocks as the contacts.
//!
//! The impulse along the surfaces makes them stick, and is at most μ times the impulse along the
//! normal at that moment.

use super::pairs::Pass;
use crate::contacts::Block;
use crate::motion::Scalars;
use jostle_simd::Simd;

impl Block {
    /// Begins the friction of a sub-step in which some contacts rest.
    #[inline(always)]
    pub fn begin_friction<S: Simd<f32>>(&mut self, simd: S) {
        let zero = simd.splat(0.0);
        let [impacts, impulses] = &mut self.friction_impulses;
        simd.store(zero, impacts);
        // A contact that has ended must not begin again with its old friction.
        simd.store(simd.choose(self.resting, simd.load(impulses), zero), impulses);
    }

    /// Corrects the impulses of friction, or only applies those that they have. Returns the new
    /// velocities.
    #[inline(always)]
    pub fn rub<S: Simd<f32>>(
        &mut self,
        simd: S,
        velocities: [S::Block; 4],
        surface_speeds: &Scalars,
        pass: Pass,
    ) -> [S::Block; 4] {
        let phase = pass.phase() as usize;
        let [au, zero] = simd.gather(surface_speeds.words(), &self.indices, 0);
        let [bu, _] = simd.gather(surface_speeds.words(), &self.indices, 1);
        let [ax, ay, bx, by] = velocities;
        // −0 − v is −v for each v; 0 − v would lose the sign of a zero.
        let tx = simd.sub(simd.splat(-0.0), simd.load(&self.normal[1]));
        let ty = simd.load(&self.normal[0]);
        // The limit is that of the same phase: the impulse of an impact does not make what rests stick.
        let impulses = &mut self.friction_impulses[phase];
        let old = simd.load(impulses);
        let change = if pass == Pass::Start {
            old
        } else {
            let x = simd.mul(tx, simd.sub(bx, ax));
            let passing = simd.add(x, simd.mul(ty, simd.sub(by, ay)));
            let sliding = simd.sub(passing, simd.add(au, bu));
            // Without over-relaxation: the limit follows the impulse along the normal, which changes in
            // each iteration.
            let wanted = simd.sub(old, simd.mul(sliding, simd.load(&self.sliding_masses)));
            let most = simd.mul(simd.load(&self.frictions), simd.load(&self.impulses[phase]));
            let least = simd.sub(simd.splat(0.0), most);
            let new = simd.max(simd.min(wanted, most), least);
            simd.store(new, impulses);
            // A change that is not finite would reach particles that do not move.
            let most = simd.splat(f32::MAX);
            simd.max(simd.min(simd.sub(new, old), most), simd.splat(f32::MIN))
        };
        // An impulse along the surface turns both discs in the same sense, so both surface speeds
        // change with the same sign.
        let au = simd.sub(au, simd.mul(change, simd.load(&self.softness[0])));
        let bu = simd.sub(bu, simd.mul(change, simd.load(&self.softness[1])));
        simd.scatter([au, zero], surface_speeds.words(), &self.indices, 0);
        simd.scatter([bu, zero], surface_speeds.words(), &self.indices, 1);
        self.pushed(simd, velocities, [tx, ty], change)
    }
}
