//! Plastic flow at an axial point: return mapping, exact for any strain path without a turn.
//!
//! Stresses are counted over E. Trial: `s = eps - eps_p`, with the back stress `X = K eps_p` and the bound
//! `Y = sigma_y + H alpha`. Where `s - X > Y` the line yields by `dgamma = (s - X - Y)/(1 + H + K)`, likewise where
//! `X - s > Y` the other way; `eps_p` grows by `dgamma` with its sign, alpha without. (Simo & Hughes 1998, ch. 1.)
//!
//! A tension-only line carries no compression and so cannot yield in it: where it goes slack it flows back no further
//! than to where zero stress is elastic, which matters once `X > Y`.

use pliant_math::Real;

use super::CableLaw;

/// What a point remembers, with its law.
#[derive(Clone, Copy)]
pub(crate) struct Past<T> {
    /// sigma_y / E.
    pub yield_strain: T,
    /// H / E.
    pub isotropic: T,
    /// K / E.
    pub kinematic: T,
    /// Plastic strain eps_p.
    pub strain: T,
    /// Its path alpha.
    pub path: T,
    /// Part of the bound below which the tangent still counts as flowing: a point that has flowed stands on the bound,
    /// and which way it goes next is a matter of rounding.
    pub lead: T,
}

/// What a step to a strain does to a point.
#[derive(Clone, Copy)]
pub(crate) struct Flow<T> {
    /// Elastic strain after it.
    pub elastic: T,
    /// Its derivative by the strain.
    pub share: T,
    /// Increment of the plastic strain.
    pub step: T,
}

/// Lets a point flow to the strain `eps`.
#[inline(always)]
pub(crate) fn flow<T: Real>(law: CableLaw, past: Past<T>, eps: T) -> Flow<T> {
    let (zero, one) = (eps.zero(), eps.constant(1.0));
    let hardening = past.isotropic + past.kinematic;
    let inverse = (one + hardening).recip();
    let (back, bound) = past.range();
    let trial = eps - past.strain;
    let above = trial - back - bound;
    let below = back - bound - trial;
    let forward = above.max(zero) * inverse;
    let mut backward = below.max(zero) * inverse;
    let near = past.lead * bound;
    let mut flows_back = below + near;
    if law.tension_only {
        // Without hardening X is zero, and so is the way to where zero stress is elastic.
        let way = (back - bound).max(zero) / hardening.max(eps.constant(f64::MIN_POSITIVE));
        let left = way - backward;
        flows_back = left.select_positive(flows_back, -one);
        backward = left.select_positive(backward, way);
    }
    let soft = hardening * inverse;
    let share = (above + near).select_positive(soft, flows_back.select_positive(soft, one));
    Flow { elastic: trial - forward + backward, share, step: forward - backward }
}

impl<T: Real> Past<T> {
    /// Back stress X and bound Y.
    #[inline(always)]
    pub fn range(self) -> (T, T) {
        (self.kinematic * self.strain, self.isotropic.mul_add(self.path, self.yield_strain))
    }

    /// As another kind of number.
    pub fn map<U>(self, number: impl Fn(T) -> U) -> Past<U> {
        Past {
            yield_strain: number(self.yield_strain),
            isotropic: number(self.isotropic),
            kinematic: number(self.kinematic),
            strain: number(self.strain),
            path: number(self.path),
            lead: number(self.lead),
        }
    }
}
