//! Single elements, one number at a time: reactions, sensitivities, tests. No claim to speed.

use pliant_math::{Dual, Real, Vec3};

use super::{CableBlock, Core, Gram, LANES, PastRows};
use crate::element::{Motion, Weights};
use crate::elements::cable::{
    Column, Nodal, NodeOffsets, Past, inertia, place, wound_energy, wound_force,
    wound_plastic_work, wound_tangent,
};

/// A parameter that forces depend on linearly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// A factor of all EA.
    AxialStiffness,
    /// A factor of all EI.
    BendingStiffness,
    /// A factor of all rho A.
    MassPerLength,
}

impl Parameter {
    /// Whether the number at `place` is proportional to the parameter; of the three groups of such numbers only the
    /// parameter's own is kept in a derivative.
    fn keeps(self, at: usize) -> bool {
        use place::{AXIAL, AXIAL_METRIC, BENDING, MASS, SIMPLIFIED, TAU};
        let of = match at {
            MASS..AXIAL => Self::MassPerLength,
            AXIAL..AXIAL_METRIC => Self::AxialStiffness,
            BENDING..SIMPLIFIED | SIMPLIFIED..TAU => Self::BendingStiffness,
            _ => return true,
        };
        of == self
    }
}

/// Numbers of one element, or only those proportional to one parameter.
#[derive(Clone, Copy)]
pub(crate) struct ScalarColumn<'a> {
    core: &'a Core,
    gram: Option<&'a Gram>,
    lane: usize,
    only: Option<Parameter>,
    exact: bool,
    past: &'a PastRows,
    element: usize,
}

impl ScalarColumn<'_> {
    fn number(self, at: usize) -> f64 {
        let curved = (place::CURVATURE..place::CURVATURE_SMOOTHING).contains(&at) && self.exact;
        let keep = match self.only {
            None => true,
            Some(parameter) if curved => parameter == Parameter::BendingStiffness,
            Some(parameter) => parameter.keeps(at),
        };
        if keep { self.core[at][self.lane] } else { 0.0 }
    }

    fn gram_number(self, k: usize) -> f64 {
        let keep = k >= 21 || self.only.is_none_or(|p| p == Parameter::AxialStiffness);
        match self.gram {
            Some(gram) if keep => gram[k][self.lane],
            _ => 0.0,
        }
    }
}

impl Column<f64> for ScalarColumn<'_> {
    fn get(self, place: usize) -> f64 {
        self.number(place)
    }
    fn gram(self, k: usize) -> f64 {
        self.gram_number(k)
    }
    fn past(self, k: usize) -> Past<f64> {
        self.past.at(k, self.element)
    }
}

impl Column<Dual> for ScalarColumn<'_> {
    fn get(self, place: usize) -> Dual {
        Dual::new(self.number(place), 0.0)
    }
    fn gram(self, k: usize) -> Dual {
        Dual::new(self.gram_number(k), 0.0)
    }
    fn past(self, k: usize) -> Past<Dual> {
        self.past.at(k, self.element).map(|x| Dual::new(x, 0.0))
    }
}

/// Local coordinates (r1, t1, r2, t2) as vectors.
pub(super) fn vectors<T: Real>(x: &[T; 12]) -> Nodal<T> {
    std::array::from_fn(|k| Vec3::new(x[3 * k], x[3 * k + 1], x[3 * k + 2]))
}

fn flatten<T: Real>(x: &Nodal<T>) -> [T; 12] {
    let x = x.map(Vec3::array);
    std::array::from_fn(|k| x[k / 3][k % 3])
}

impl CableBlock {
    pub(super) fn column(&self, e: usize) -> ScalarColumn<'_> {
        let group = self.groups[e / LANES] as usize;
        ScalarColumn {
            core: &self.core[group],
            gram: self.gram.get(group),
            lane: e % LANES,
            only: None,
            exact: self.law.bending == crate::elements::cable::Bending::Exact,
            past: &self.past,
            element: e,
        }
    }

    /// The numbers of the axial part alone.
    pub(super) fn axial_column(&self, e: usize) -> ScalarColumn<'_> {
        ScalarColumn { only: Some(Parameter::AxialStiffness), ..self.column(e) }
    }

    /// Local coordinates (r1, t1, r2, t2) of element `e`.
    #[must_use]
    pub fn local(&self, e: usize, global: &[f64]) -> [f64; 12] {
        let indices = self.indices_of(e);
        std::array::from_fn(|k| global[indices[k]])
    }

    /// Global indices of the local coordinates of element `e`.
    #[must_use]
    pub fn indices_of(&self, e: usize) -> [usize; 12] {
        let [a, b] = self.nodes_of(e);
        let first = [a.r, a.t, b.r, b.t];
        std::array::from_fn(|k| first[k / 3] as usize + k % 3)
    }

    /// Elastic energy of element `e` [J] at local coordinates, over any kind of number.
    pub(crate) fn local_energy<T: Real>(&self, e: usize, q: &[T; 12]) -> T
    where
        for<'a> ScalarColumn<'a>: Column<T>,
    {
        wound_energy(self.law, self.column(e), &vectors(q), self.scale(e, q[0]))
    }

    /// Work of element `e` [J] on plastic flow since what its points remember, likewise.
    pub(crate) fn local_plastic_work<T: Real>(&self, e: usize, q: &[T; 12]) -> T
    where
        for<'a> ScalarColumn<'a>: Column<T>,
    {
        wound_plastic_work(self.law, self.column(e), &vectors(q), self.scale(e, q[0]))
    }

    /// Internal force of element `e` at local coordinates and velocities, over any kind of number.
    pub(crate) fn local_force<T: Real>(&self, e: usize, q: &[T; 12], v: &[T; 12]) -> [T; 12]
    where
        for<'a> ScalarColumn<'a>: Column<T>,
    {
        let rates = vectors(v);
        let rates = self.law.damped.then_some(&rates);
        flatten(&wound_force(self.law, self.column(e), &vectors(q), rates, self.scale(e, q[0])))
    }

    fn column_force(
        &self,
        e: usize,
        column: ScalarColumn<'_>,
        motion: Motion<'_>,
        gravity: [f64; 3],
    ) -> [f64; 12] {
        let x = vectors(&self.local(e, motion.q));
        let mut a = vectors(&self.local(e, motion.a));
        a[0] = a[0] - gravity.into();
        a[2] = a[2] - gravity.into();
        let rates = self.law.damped.then(|| vectors(&self.local(e, motion.v)));
        let internal = wound_force(self.law, column, &x, rates.as_ref(), self.scale(e, 1.0));
        let internal = flatten(&internal);
        let inertial = flatten(&inertia(column, &a));
        std::array::from_fn(|k| internal[k] + inertial[k])
    }

    /// `M (a - g) + f(q, v)` of element `e`, in the order (r1, t1, r2, t2).
    #[must_use]
    pub fn element_force(&self, e: usize, motion: Motion<'_>, gravity: [f64; 3]) -> [f64; 12] {
        self.column_force(e, self.column(e), motion, gravity)
    }

    /// Lower triangle by rows of the weighted tangent of element `e`, as [`super::Block::tangent`] stores it.
    #[must_use]
    pub fn element_tangent(&self, e: usize, motion: Motion<'_>, weights: Weights) -> [f64; 78] {
        let x = vectors(&self.local(e, motion.q));
        let rates = self.law.damped.then(|| vectors(&self.local(e, motion.v)));
        let mut out = [0.0; 78];
        let (column, scale) = (self.column(e), self.scale(e, 1.0));
        wound_tangent(self.law, column, &x, rates.as_ref(), weights, scale, |k, c: f64| out[k] = c);
        out
    }

    /// The complete derivative of the internal force of element `e` by its coordinates, `[i][j] = df_i/dq_j`, with the
    /// unsymmetric part of damping forces that the tangent leaves out. By dual numbers.
    #[must_use]
    pub fn element_jacobian(&self, e: usize, motion: Motion<'_>) -> [[f64; 12]; 12] {
        let mut q = self.local(e, motion.q).map(|c| Dual::new(c, 0.0));
        let v = if self.law.damped { self.local(e, motion.v) } else { [0.0; 12] };
        let v = v.map(|c| Dual::new(c, 0.0));
        let mut jacobian = [[0.0; 12]; 12];
        for j in 0..12 {
            q[j].derivative = 1.0;
            let f = self.local_force(e, &q, &v);
            q[j].derivative = 0.0;
            for i in 0..12 {
                jacobian[i][j] = f[i].derivative;
            }
        }
        jacobian
    }

    /// Elastic energy of element `e` [J].
    #[must_use]
    pub fn element_elastic_energy(&self, e: usize, q: &[f64]) -> f64 {
        self.local_energy(e, &self.local(e, q))
    }

    /// Adds the derivative of the residual by a parameter's factor (at 1) to `force`: of one cable, or of the block.
    pub fn add_parameter_derivative(
        &self,
        parameter: Parameter,
        cable: Option<usize>,
        motion: Motion<'_>,
        gravity: [f64; 3],
        force: &mut [f64],
    ) {
        let elements = cable.map_or(0..self.is_bridge.len(), |c| self.elements_of(c));
        for e in elements.filter(|&e| !self.is_bridge[e]) {
            let mut column = self.column(e);
            column.only = Some(parameter);
            let f = self.column_force(e, column, motion, gravity);
            for (i, f) in self.indices_of(e).into_iter().zip(f) {
                force[i] += f;
            }
        }
    }

    /// The two nodes of each element that touches position coordinate `r`: with shared positions there may be many.
    pub fn elements_at(&self, r: u32) -> impl Iterator<Item = (usize, [NodeOffsets; 2])> + '_ {
        self.real_elements().filter(move |(_, nodes)| nodes.iter().any(|n| n.r == r))
    }
}
