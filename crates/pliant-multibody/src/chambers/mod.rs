//! Chambers: gas enclosed by surfaces, with its pressure as an unknown of its own.
//!
//! The multiplier is minus the gauge pressure, `lambda_ = p_a - p`, and its equation `phi = V(q) - V_gas(p, m)`: then
//! `phi_q^T lambda_` is the force of the gas, the border of the matrix is symmetric, and it stays sparse, for the volume
//! is a sum over faces. The equation is compliant ([`pliant_dae::problem::Problem::compliant`]): of a gas that is hard to
//! compress, as of one that is nearly a vacuum, nothing is stiff but the equation.

pub mod gas;
pub mod volume;

use crate::error::ModelError;
use crate::point::Support;
use crate::signal::Moment;
use crate::spec::ChamberSpec;
use crate::vector::vector;
use gas::Gas;
use nalgebra::Vector3;
use pliant_dae::structure::{Storage, Structure, entries, entry_number};
use volume::Part;

/// Numbers that a chamber shows: absolute pressure [Pa], volume [m^3], mass of the gas [kg].
pub(crate) const OUTPUTS: usize = 3;

/// A part of the volume with its coordinates and its element matrix.
pub(crate) struct PlacedPart {
    pub part: Part,
    pub support: Support,
    pub element: usize,
}

/// Gas enclosed by surfaces.
pub(crate) struct Chamber {
    pub name: String,
    pub parts: Vec<PlacedPart>,
    /// Point from which volumes count.
    pub origin: Vector3<f64>,
    pub gas: Gas,
    /// Number of its multiplier.
    pub multiplier: usize,
    /// Number of the integral that is the mass of the gas.
    pub mass: usize,
    /// Whether gas flows in or out.
    pub flows: bool,
    /// Mass at the start of a run [kg]; none: what the state of the document makes of the volume there.
    pub given_mass: Option<f64>,
    /// Typical volume [m^3].
    pub scale: f64,
}

/// Weights of a tangent: that of the stiffness, and that of the Jacobian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Border {
    pub stiffness: f64,
    pub jacobian: f64,
}

impl Chamber {
    /// The chamber of a document whose parts are known; `q` is the start.
    ///
    /// # Errors
    /// [`ModelError`] for numbers out of range, or a volume below zero.
    pub fn new(
        spec: &ChamberSpec,
        parts: Vec<PlacedPart>,
        (multiplier, mass): (usize, usize),
        q: &[f64],
    ) -> Result<Self, ModelError> {
        let place = format!("chamber '{}'", spec.name);
        let gas = Gas::of_spec(&spec.gas, spec.ambient, &place)?;
        let mut chamber = Self {
            name: spec.name.clone(),
            parts,
            origin: vector(spec.origin),
            gas,
            multiplier,
            mass,
            flows: spec.inflow.is_some(),
            given_mass: spec.mass,
            scale: 1.0,
        };
        // The ball of the same surface.
        let area = chamber.area(q);
        chamber.scale = area.powf(1.5) / (6.0 * std::f64::consts::PI.sqrt());
        let volume = chamber.volume(q);
        if !(volume >= -1e-9 * chamber.scale && area > 0.0) {
            let allowed = "volumes from zero on: let the normals of the faces point out of the gas";
            return Err(ModelError::Value { place, value: volume, allowed });
        }
        Ok(chamber)
    }

    /// Area of its faces [m^2].
    fn area(&self, q: &[f64]) -> f64 {
        let faces = self.parts.iter().map(|placed| match &placed.part {
            Part::Face { block, element } => block.current_area(*element, q),
            _ => 0.0,
        });
        faces.sum()
    }

    /// Volume [m^3].
    pub fn volume(&self, q: &[f64]) -> f64 {
        self.parts.iter().map(|placed| placed.part.volume(q, self.origin)).sum()
    }

    /// Mass of the gas [kg].
    pub fn mass(&self, now: Moment<'_>) -> f64 {
        now.integrals.get(self.mass).copied().unwrap_or(0.0).max(0.0)
    }

    /// Mass at the start of a run at coordinates `q` [kg].
    pub fn first_mass(&self, q: &[f64]) -> f64 {
        self.given_mass.unwrap_or_else(|| self.gas.density * self.volume(q).max(0.0))
    }

    /// Absolute pressure of a multiplier [Pa].
    pub fn pressure(&self, lambda_: f64) -> f64 {
        self.gas.ambient - lambda_
    }

    /// The multiplier where coordinates determine it.
    pub fn multiplier_at(&self, now: Moment<'_>, q: &[f64]) -> f64 {
        self.gas.ambient - self.gas.pressure_in(self.mass(now), self.volume(q))
    }

    /// `phi`.
    pub fn residual(&self, now: Moment<'_>, q: &[f64], lambda_: f64) -> f64 {
        self.volume(q) - self.gas.volume(self.mass(now), self.pressure(lambda_))
    }

    /// Adds `factor phi_q^T` to `force`.
    pub fn add_force(&self, q: &[f64], factor: f64, force: &mut [f64]) {
        for placed in &self.parts {
            placed.part.add_force(q, self.origin, factor, force);
        }
    }

    /// The vector b whose product `b b^T` the gas adds to the stiffness; none where it has no volume.
    pub fn stiffness_root(&self, q: &[f64], lambda_: f64) -> Vec<f64> {
        let mut force = vec![0.0; q.len()];
        let volume = self.volume(q);
        if volume > 0.0 {
            let root = (self.gas.stiffness(self.pressure(lambda_)) / volume).sqrt();
            self.add_force(q, root, &mut force);
        }
        force
    }

    /// Energy of the gas [J].
    pub fn energy(&self, now: Moment<'_>, q: &[f64]) -> f64 {
        self.gas.energy(self.mass(now), self.volume(q))
    }

    /// Writes the matrices of all parts: `stiffness (phi_q^T lambda_)_q`, and the border.
    ///
    /// The diagonal is that of `rho V - m = 0`, scaled: close to the solution that of phi, and a better guess far from it.
    pub fn tangent(
        &self,
        structure: &Structure,
        (q, lambda_): (&[f64], f64),
        weights: Border,
        values: &mut [f64],
    ) {
        let bordered = weights.stiffness != 0.0 && weights.jacobian != 0.0;
        let diagonal = if bordered {
            let compliance = self.volume(q).max(0.0) / self.gas.stiffness(self.pressure(lambda_));
            -compliance * weights.jacobian / weights.stiffness
        } else {
            -weights.jacobian
        };
        let (mut full, mut force) = (Vec::new(), vec![0.0; q.len()]);
        for (number, PlacedPart { part, support, element }) in self.parts.iter().enumerate() {
            let slot = structure.slot(*element);
            let n = support.unknowns.len();
            let size = n + 1;
            let out = &mut values[slot.base..slot.base + entries(size, Storage::Symmetric)];
            out.fill(0.0);
            if weights.stiffness != 0.0 {
                full.resize(n * n, 0.0);
                part.hessian(q, self.origin, weights.stiffness * lambda_, support, &mut full);
                for i in 0..n {
                    for j in 0..=i {
                        out[entry_number(size, i, j, Storage::Symmetric)] =
                            0.5 * (full[i * n + j] + full[j * n + i]);
                    }
                }
            }
            if bordered {
                part.add_force(q, self.origin, weights.jacobian, &mut force);
                for (j, &u) in support.unknowns.iter().enumerate() {
                    out[entry_number(size, n, j, Storage::Symmetric)] = force[u];
                    force[u] = 0.0;
                }
            }
            if number == 0 {
                out[entry_number(size, n, n, Storage::Symmetric)] = diagonal;
            }
        }
    }
}
