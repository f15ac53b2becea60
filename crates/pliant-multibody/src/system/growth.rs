//! What the load factor of statics acts on.

/// What grows with the load factor; the rest acts in full.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Growth {
    /// Whether gravity grows and which loads; none: everything does.
    pub chosen: Option<Chosen>,
    /// Forces out of balance at the start, which fade as the factor goes to 1: `force -= (1 - factor) fading`.
    /// Empty: none.
    pub fading: Vec<f64>,
}

/// Gravity and loads that grow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chosen {
    /// Whether gravity grows.
    pub gravity: bool,
    /// Numbers of the loads that grow, ascending.
    pub loads: Vec<usize>,
}

impl Growth {
    /// Factor of gravity.
    pub(crate) fn of_gravity(&self, factor: f64) -> f64 {
        if self.chosen.as_ref().is_none_or(|chosen| chosen.gravity) { factor } else { 1.0 }
    }

    /// Factor of the constants of a load.
    pub(crate) fn of_load(&self, load: usize, factor: f64) -> f64 {
        let grows =
            self.chosen.as_ref().is_none_or(|chosen| chosen.loads.binary_search(&load).is_ok());
        if grows { factor } else { 1.0 }
    }
}
