//! Values over time: what a [`Signal`] of the document evaluates to.

use crate::error::ModelError;
use crate::jet::Jet;
use crate::spec::Signal;

/// The moment of evaluation.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time [s], or the load factor in statics.
    pub t: f64,
    /// Factor of constants: 1, or the load factor in statics.
    pub constants: f64,
    /// What the caller's functions of time returned.
    pub inputs: &'a [f64],
    /// Rates of these; none where time stands still, as in statics.
    pub rates: Option<&'a [f64]>,
    /// Their first three derivatives, where a drive asked for them; empty: zero.
    pub derivatives: &'a [Vec<f64>],
    /// Integrals of signals since the start.
    pub integrals: &'a [f64],
    /// Freedoms of the joints at the last accepted point: angles are counted from there.
    pub angles: &'a [f64],
    /// What the joint in question remembers.
    pub memory: &'a [f64],
}

impl Moment<'_> {
    /// A time without inputs and memory.
    #[must_use]
    pub fn at(t: f64) -> Self {
        Self {
            t,
            constants: 1.0,
            inputs: &[],
            rates: Some(&[]),
            derivatives: &[],
            integrals: &[],
            angles: &[],
            memory: &[],
        }
    }

    /// Rate of the first component of a value that is no load: constants are constant.
    #[must_use]
    pub fn rate(&self, value: &Value) -> f64 {
        match self.rates {
            Some(rates) => value.rate(Moment { constants: 1.0, ..*self }, rates)[0],
            None => 0.0,
        }
    }
}

/// A signal checked and made ready: three components, or one for all.
#[derive(Clone, Debug)]
pub enum Value {
    /// See [`Signal::Constant`].
    Constant([f64; 3]),
    /// See [`Signal::Input`].
    Input {
        /// First component.
        first: usize,
        /// Whether one number serves for all three.
        scalar: bool,
    },
    /// See [`Signal::Table`].
    Table(Table),
    /// See [`Signal::Ramp`].
    Ramp(f64),
    /// See [`Signal::Sum`].
    Sum(Vec<Value>),
    /// See [`Signal::Product`].
    Product(Vec<Value>),
    /// The integral of a signal since the start, and its number.
    Integral(usize, Box<Value>),
}

impl Value {
    /// Checks `signal` and makes it ready.
    ///
    /// # Errors
    /// [`ModelError`] naming `place` where sizes or numbers are wrong.
    pub fn new(signal: &Signal, place: &str) -> Result<Self, ModelError> {
        let all = |s: &[Signal]| s.iter().map(|s| Self::new(s, place)).collect::<Result<_, _>>();
        Ok(match signal {
            Signal::Constant(x) => Self::Constant(triple(x, place)?),
            Signal::Input { first, size: 3 } => Self::Input { first: *first, scalar: false },
            Signal::Input { first, size: 1 } => Self::Input { first: *first, scalar: true },
            Signal::Input { size, .. } => return Err(length(place, *size)),
            Signal::Table { times, values, period, smooth } => {
                Self::Table(Table::new(times, values, *period, *smooth, place)?)
            }
            Signal::Ramp { duration } if *duration > 0.0 && duration.is_finite() => {
                Self::Ramp(*duration)
            }
            Signal::Ramp { duration } => {
                return Err(ModelError::Value {
                    place: place.to_owned(),
                    value: *duration,
                    allowed: "the duration of a ramp is above zero",
                });
            }
            Signal::Sum(s) => Self::Sum(all(s)?),
            Signal::Product(s) => Self::Product(all(s)?),
        })
    }

    /// Its value.
    #[must_use]
    pub fn at(&self, now: Moment<'_>) -> [f64; 3] {
        match self {
            Self::Constant(x) => x.map(|x| now.constants * x),
            Self::Input { first, scalar } => {
                let get = |k: usize| now.inputs.get(first + k).copied().unwrap_or(f64::NAN);
                if *scalar { [get(0); 3] } else { [get(0), get(1), get(2)] }
            }
            Self::Table(table) => table.at(now.t),
            Self::Ramp(duration) => {
                // 10 s^3 - 15 s^4 + 6 s^5: velocity and acceleration vanish at both ends
                let s = (now.t / duration).clamp(0.0, 1.0);
                [s * s * s * (10.0 + s * (6.0 * s - 15.0)); 3]
            }
            Self::Sum(terms) => terms.iter().fold([0.0; 3], |sum, x| {
                let x = x.at(now);
                [sum[0] + x[0], sum[1] + x[1], sum[2] + x[2]]
            }),
            Self::Integral(number, _) => [now.integrals.get(*number).copied().unwrap_or(0.0); 3],
            // A constant factor scales a function of time; it is not itself a load to be scaled again.
            Self::Product(factors) => {
                let varying = factors.iter().any(|f| !f.is_constant());
                let now = if varying { Moment { constants: 1.0, ..now } } else { now };
                factors.iter().fold([1.0; 3], |product, x| {
                    let x = x.at(now);
                    [product[0] * x[0], product[1] * x[1], product[2] * x[2]]
                })
            }
        }
    }

    /// The first time after `t` at which its slope (of a ramp, its third derivative) may jump.
    #[must_use]
    pub fn next_break(&self, t: f64) -> Option<f64> {
        match self {
            Self::Constant(_) | Self::Input { .. } => None,
            Self::Table(table) => table.next_break(t),
            Self::Ramp(duration) => [0.0, *duration].into_iter().find(|&end| is_after(end, t)),
            Self::Integral(_, rate) => rate.next_break(t),
            Self::Sum(parts) | Self::Product(parts) => {
                parts.iter().filter_map(|part| part.next_break(t)).reduce(f64::min)
            }
        }
    }

    /// Its rate, with those of the inputs.
    fn rate(&self, now: Moment<'_>, rates: &[f64]) -> [f64; 3] {
        match self {
            Self::Constant(_) => [0.0; 3],
            Self::Input { first, scalar } => {
                let get = |k: usize| rates.get(first + k).copied().unwrap_or(0.0);
                if *scalar { [get(0); 3] } else { [get(0), get(1), get(2)] }
            }
            Self::Table(table) => table.with_slope(now.t).1,
            Self::Ramp(duration) => {
                let s = (now.t / duration).clamp(0.0, 1.0);
                [30.0 * s * s * (1.0 - s) * (1.0 - s) / duration; 3]
            }
            Self::Sum(terms) => terms.iter().fold([0.0; 3], |sum, x| {
                let x = x.rate(now, rates);
                [sum[0] + x[0], sum[1] + x[1], sum[2] + x[2]]
            }),
            Self::Product(factors) => {
                let values: Vec<_> = factors.iter().map(|x| x.at(now)).collect();
                let mut sum = [0.0; 3];
                for (i, factor) in factors.iter().enumerate() {
                    let rate = factor.rate(now, rates);
                    for k in 0..3 {
                        let others = values.iter().enumerate().filter(|(j, _)| *j != i);
                        sum[k] += rate[k] * others.map(|(_, x)| x[k]).product::<f64>();
                    }
                }
                sum
            }
            Self::Integral(_, rate) => rate.at(now),
        }
    }

    /// Value and first three time derivatives; those of steps of slope are from the right.
    #[must_use]
    pub fn jet(&self, now: Moment<'_>) -> [[f64; 3]; 4] {
        match self {
            Self::Constant(x) => [x.map(|x| now.constants * x), [0.0; 3], [0.0; 3], [0.0; 3]],
            Self::Input { first, scalar } => {
                let mut jet = [self.at(now), [0.0; 3], [0.0; 3], [0.0; 3]];
                for (order, rates) in now.derivatives.iter().enumerate().take(3) {
                    let get = |k: usize| rates.get(first + k).copied().unwrap_or(0.0);
                    jet[order + 1] = if *scalar { [get(0); 3] } else { [get(0), get(1), get(2)] };
                }
                jet
            }
            Self::Table(table) => table.jet(now.t),
            Self::Ramp(duration) => {
                let mut jet = [self.at(now), [0.0; 3], [0.0; 3], [0.0; 3]];
                let s = now.t / duration;
                if (0.0..1.0).contains(&s) {
                    let rest = 1.0 - s;
                    jet[1] = [30.0 * s * s * rest * rest / duration; 3];
                    jet[2] = [60.0 * s * rest * (1.0 - 2.0 * s) / duration.powi(2); 3];
                    jet[3] = [60.0 * (1.0 + s * (6.0 * s - 6.0)) / duration.powi(3); 3];
                }
                jet
            }
            Self::Sum(terms) => terms.iter().fold([[0.0; 3]; 4], |sum, x| {
                let x = x.jet(now);
                std::array::from_fn(|n| std::array::from_fn(|k| sum[n][k] + x[n][k]))
            }),
            Self::Product(factors) => {
                let varying = factors.iter().any(|f| !f.is_constant());
                let now = if varying { Moment { constants: 1.0, ..now } } else { now };
                let one = [[1.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]];
                factors.iter().fold(one, |product, x| {
                    let x = x.jet(now);
                    let component =
                        |k: usize| Jet(product.map(|p| p[k])).times(Jet(x.map(|x| x[k]))).0;
                    let columns = [component(0), component(1), component(2)];
                    std::array::from_fn(|n| columns.map(|column| column[n]))
                })
            }
            Self::Integral(_, rate) => {
                let [rate, first, second, _] = rate.jet(now);
                [self.at(now), rate, first, second]
            }
        }
    }

    /// Whether any input in it satisfies a predicate on its first number.
    pub(crate) fn any_input(&self, predicate: &dyn Fn(usize) -> bool) -> bool {
        match self {
            Self::Input { first, .. } => predicate(*first),
            Self::Sum(x) | Self::Product(x) => x.iter().any(|x| x.any_input(predicate)),
            Self::Integral(_, x) => x.any_input(predicate),
            Self::Constant(_) | Self::Table(_) | Self::Ramp(_) => false,
        }
    }

    fn is_constant(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Sum(x) | Self::Product(x) => x.iter().all(Self::is_constant),
            Self::Input { .. } | Self::Table(_) | Self::Ramp(_) | Self::Integral(..) => false,
        }
    }
}

/// The first kink of several values after `t`, see [`Value::next_break`].
pub(crate) fn first_break<'a>(values: impl IntoIterator<Item = &'a Value>, t: f64) -> Option<f64> {
    values.into_iter().filter_map(|value| value.next_break(t)).reduce(f64::min)
}

/// Whether `later` is after `t` by more than the rounding of times.
fn is_after(later: f64, t: f64) -> bool {
    later > t + 1e-12 * t.abs()
}

/// Interpolation between rows of a table.
#[derive(Clone, Debug)]
pub struct Table {
    times: Vec<f64>,
    values: Vec<[f64; 3]>,
    /// Second derivatives of the cubic spline; empty: linear.
    second: Vec<[f64; 3]>,
    period: Option<f64>,
}

impl Table {
    pub(crate) fn new(
        times: &[f64],
        values: &[f64],
        period: Option<f64>,
        smooth: bool,
        place: &str,
    ) -> Result<Self, ModelError> {
        let k = times.len();
        let bad = |value: f64, allowed: &'static str| {
            Err(ModelError::Value { place: place.to_owned(), value, allowed })
        };
        if k < 2 || (values.len() != k && values.len() != 3 * k) {
            return Err(length(place, values.len()));
        }
        if let Some(pair) = times.windows(2).find(|w| w[1] <= w[0] || !w[1].is_finite()) {
            return bad(pair[1], "the times of a table ascend");
        }
        if let Some(&x) = values.iter().find(|x| !x.is_finite()) {
            return bad(x, "the values of a table are finite");
        }
        let span = times[k - 1] - times[0];
        if let Some(p) = period.filter(|&p| !(p >= span * (1.0 - 1e-12) && p.is_finite())) {
            return bad(p, "the period of a table is at least its span");
        }
        let rows: Vec<[f64; 3]> = if values.len() == k {
            values.iter().map(|&x| [x; 3]).collect()
        } else {
            values.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
        };
        let mut table = Self { times: times.to_vec(), values: rows, second: Vec::new(), period };
        if let Some(p) = period.filter(|&p| p > span * (1.0 + 1e-12)) {
            // Close the period with its first row, so that no time lies outside the table.
            table.times.push(times[0] + p);
            table.values.push(table.values[0]);
        }
        if smooth {
            table.second = match period {
                None => spline(&table.times, &table.values),
                Some(p) => periodic_spline(&table.times, &table.values, p),
            };
        }
        Ok(table)
    }

    /// Of a linear table the next of its times; a smooth one bends at its ends only, and not where it repeats.
    fn next_break(&self, t: f64) -> Option<f64> {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let smooth = !self.second.is_empty();
        let Some(period) = self.period else {
            return if smooth {
                [first, last].into_iter().find(|&end| is_after(end, t))
            } else {
                self.times.iter().copied().find(|&time| is_after(time, t))
            };
        };
        if smooth {
            return None;
        }
        let turns = ((t - first) / period).floor();
        (0..2)
            .flat_map(|more| {
                let shift = (turns + f64::from(more)) * period;
                self.times.iter().map(move |time| time + shift)
            })
            .find(|&time| is_after(time, t))
    }

    fn at(&self, t: f64) -> [f64; 3] {
        self.jet(t)[0]
    }

    /// Value and slope, which is zero outside a table without period.
    pub(crate) fn with_slope(&self, t: f64) -> ([f64; 3], [f64; 3]) {
        let [value, slope, ..] = self.jet(t);
        (value, slope)
    }

    /// Value and first three derivatives, from the right.
    fn jet(&self, t: f64) -> [[f64; 3]; 4] {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let moves = self.period.is_some() || (first..last).contains(&t);
        let t = match self.period {
            Some(p) => first + (t - first).rem_euclid(p),
            None => t.clamp(first, last),
        };
        let i = self.times.partition_point(|&x| x <= t).clamp(1, self.times.len() - 1) - 1;
        let h = self.times[i + 1] - self.times[i];
        let b = ((t - self.times[i]) / h).min(1.0);
        let a = 1.0 - b;
        let mut out = [[0.0; 3]; 4];
        for k in 0..3 {
            let (y_a, y_b) = (self.values[i][k], self.values[i + 1][k]);
            let (m_a, m_b) = match self.second[..] {
                [] => (0.0, 0.0),
                [..] => (self.second[i][k], self.second[i + 1][k]),
            };
            out[0][k] =
                a * y_a + b * y_b + ((a * a * a - a) * m_a + (b * b * b - b) * m_b) * (h * h / 6.0);
            if moves {
                out[1][k] = (y_b - y_a) / h
                    + ((3.0 * b * b - 1.0) * m_b - (3.0 * a * a - 1.0) * m_a) * (h / 6.0);
                out[2][k] = a * m_a + b * m_b;
                out[3][k] = (m_b - m_a) / h;
            }
        }
        out
    }
}

/// Second derivatives of the cubic spline with not-a-knot ends (Thomas algorithm): the third derivative does not
/// jump at the second row and the last but one, so cubic polynomials are met exactly; three rows make a parabola,
/// two a line. (Natural ends, without curvature, would put an error of order h into the rate there.)
fn spline(x: &[f64], y: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let n = x.len();
    // Six times the second divided difference, times the distance of the outer rows.
    let bend = |i: usize, k: usize| {
        let (h0, h1) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        6.0 * ((y[i + 1][k] - y[i][k]) / h1 - (y[i][k] - y[i - 1][k]) / h0)
    };
    match n {
        0..=2 => return vec![[0.0; 3]; n],
        3 => return vec![[0, 1, 2].map(|k| bend(1, k) / (3.0 * (x[2] - x[0]))); 3],
        _ => {}
    }
    let mut second = vec![[0.0; 3]; n];
    let mut c = vec![0.0; n];
    let first = (x[1] - x[0]) / (x[2] - x[1]);
    let last = (x[n - 1] - x[n - 2]) / (x[n - 2] - x[n - 3]);
    for i in 1..n - 1 {
        let (h0, h1) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        let (mut below, mut diagonal, mut above) = (h0, 2.0 * (h0 + h1), h1);
        if i == 1 {
            // M_0 = M_1 + (M_1 - M_2) h_0/h_1
            diagonal += h0 + h0 * first;
            above -= h0 * first;
        }
        if i == n - 2 {
            diagonal += h1 + h1 * last;
            below -= h1 * last;
        }
        let pivot = diagonal - below * c[i - 1];
        c[i] = above / pivot;
        for k in 0..3 {
            second[i][k] = (bend(i, k) - below * second[i - 1][k]) / pivot;
        }
    }
    for k in 0..3 {
        for i in (1..n - 2).rev() {
            second[i][k] -= c[i] * second[i + 1][k];
        }
        second[0][k] = second[1][k] + (second[1][k] - second[2][k]) * first;
        second[n - 1][k] = second[n - 2][k] + (second[n - 2][k] - second[n - 3][k]) * last;
    }
    second
}

/// The same for a period: the ends of a spline are forgotten by a factor of about 3.7 a row, so the middle one of
/// enough repetitions is periodic to rounding.
fn periodic_spline(x: &[f64], y: &[[f64; 3]], period: f64) -> Vec<[f64; 3]> {
    let rows = x.len() - 1;
    let turns = 32_usize.div_ceil(rows);
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for turn in 0..=2 * turns {
        let shift = (turn as f64 - turns as f64) * period;
        xs.extend(x[..rows].iter().map(|t| t + shift));
        ys.extend_from_slice(&y[..rows]);
    }
    spline(&xs, &ys)[turns * rows..=(turns + 1) * rows].to_vec()
}

fn triple(x: &[f64], place: &str) -> Result<[f64; 3], ModelError> {
    if let Some(&value) = x.iter().find(|x| !x.is_finite()) {
        return Err(ModelError::Value {
            place: place.to_owned(),
            value,
            allowed: "finite numbers",
        });
    }
    match *x {
        [a] => Ok([a; 3]),
        [a, b, c] => Ok([a, b, c]),
        _ => Err(length(place, x.len())),
    }
}

fn length(place: &str, got: usize) -> ModelError {
    ModelError::Length { place: place.to_owned(), expected: "1 or 3 components".to_owned(), got }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(signal: &Signal, t: f64) -> f64 {
        Value::new(signal, "test").unwrap().at(moment(t, 1.0))[0]
    }

    fn moment(t: f64, constants: f64) -> Moment<'static> {
        Moment { constants, ..Moment::at(t) }
    }

    #[test]
    fn rates_are_slopes() {
        let times: Vec<f64> = (0..=6).map(|i| 0.5 * f64::from(i)).collect();
        let table = |smooth| Signal::Table {
            values: times.iter().map(|t| (1.3 * t).sin()).collect(),
            times: times.clone(),
            period: None,
            smooth,
        };
        let ramp = || Signal::Ramp { duration: 2.0 };
        let constant = Signal::Constant(vec![3.0]);
        for signal in [
            table(true),
            table(false),
            ramp(),
            Signal::Sum(vec![
                constant.clone(),
                Signal::Product(vec![constant, table(true), ramp()]),
            ]),
        ] {
            let value = Value::new(&signal, "test").unwrap();
            for t in [0.1, 0.7, 1.6, 2.9, 3.5] {
                let slope = (at(&signal, t + 1e-6) - at(&signal, t - 1e-6)) / 2e-6;
                // Central differences of numbers of order one: rounding over the step.
                assert!((moment(t, 1.0).rate(&value) - slope).abs() < 1e-8, "{signal:?}, {t}");
            }
        }
    }

    #[test]
    fn a_periodic_smooth_table_follows_a_sine_and_repeats() {
        let times: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
        let values = times.iter().map(|t| (std::f64::consts::TAU * t).sin()).collect();
        let table = Signal::Table { times, values, period: Some(1.0), smooth: true };
        for t in [0.013, 0.5, 0.987, 1.3, -0.2] {
            // cubic spline: error 5/384 h^4 max|y''''| = 5/384 (2 pi/40)^4
            assert!((at(&table, t) - (std::f64::consts::TAU * t).sin()).abs() < 8e-6, "{t}");
        }
        assert!((at(&table, 0.3) - at(&table, 7.3)).abs() < 1e-12);
    }

    #[test]
    fn a_smooth_table_meets_polynomials_to_its_ends() {
        // Unequal distances; as many rows as the polynomial has coefficients, and more.
        let rows = [0.0, 0.3, 1.0, 1.2, 2.0, 2.7];
        for (degree, count) in [(1, 2), (2, 3), (3, 4), (3, 5), (3, 6)] {
            let times: Vec<f64> = rows[..count].to_vec();
            let end = times[count - 1];
            let values = times.iter().map(|t| (1.0 - 2.0 * t).powi(degree)).collect();
            let table = Signal::Table { times, values, period: None, smooth: true };
            let value = Value::new(&table, "test").unwrap();
            for t in [0.0, 0.1, 0.45 * end, end - 1e-9] {
                let (x, n) = (1.0 - 2.0 * t, f64::from(degree));
                let exact = [
                    x.powi(degree),
                    -2.0 * n * x.powi(degree - 1),
                    4.0 * n * (n - 1.0) * x.powi(degree - 2),
                ];
                let jet = value.jet(moment(t, 1.0));
                for order in 0..3 {
                    // Rounding of numbers up to 85 over squares of distances.
                    assert!((jet[order][0] - exact[order]).abs() < 1e-10, "{degree}, {count}, {t}");
                }
            }
        }
    }

    #[test]
    fn a_linear_table_is_constant_outside() {
        let table = Signal::Table {
            times: vec![1.0, 3.0],
            values: vec![2.0, 6.0],
            period: None,
            smooth: false,
        };
        assert_eq!([0.0, 2.0, 9.0].map(|t| at(&table, t)), [2.0, 4.0, 6.0]);
    }

    #[test]
    fn breaks_are_where_slopes_jump() {
        let table = |period, smooth| Signal::Table {
            times: vec![1.0, 2.0, 4.0],
            values: vec![0.0, 1.0, 0.0],
            period,
            smooth,
        };
        let breaks = |signal: &Signal, mut t: f64| {
            let value = Value::new(signal, "test").unwrap();
            let mut found = Vec::new();
            while let Some(next) = value.next_break(t).filter(|_| found.len() < 5) {
                found.push(next);
                t = next;
            }
            found
        };
        assert_eq!(breaks(&table(None, false), 0.0), [1.0, 2.0, 4.0]);
        assert_eq!(breaks(&table(None, true), 0.0), [1.0, 4.0]);
        // 4.0 is 1.0 of the next turn; the row that closes the period is one, too.
        assert_eq!(breaks(&table(Some(5.0), false), 2.0), [4.0, 6.0, 7.0, 9.0, 11.0]);
        assert!(breaks(&table(Some(3.0), true), 0.0).is_empty());
        let both = Signal::Product(vec![Signal::Ramp { duration: 1.5 }, table(None, false)]);
        assert_eq!(breaks(&both, 0.0), [1.0, 1.5, 2.0, 4.0]);
    }

    #[test]
    fn a_ramp_times_a_constant_is_not_scaled_by_the_load_factor() {
        let signal =
            Signal::Product(vec![Signal::Constant(vec![5.0]), Signal::Ramp { duration: 1.0 }]);
        let value = Value::new(&signal, "test").unwrap();
        assert_eq!(value.at(Moment { constants: 0.5, ..Moment::at(0.5) })[0], 2.5);
        assert_eq!(at(&signal, 2.0), 5.0);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let times: Vec<f64> = (0..=8).map(|i| f64::from(i) / 4.0).collect();
        let values = times.iter().map(|t| (2.0 * t).sin()).collect();
        let table = Signal::Table { times, values, period: None, smooth: true };
        let ramp = Signal::Ramp { duration: 1.5 };
        let factor = Signal::Sum(vec![Signal::Constant(vec![2.0]), ramp.clone()]);
        let product = Signal::Product(vec![factor, table.clone(), ramp.clone()]);
        for signal in [table, ramp, product] {
            let value = Value::new(&signal, "test").unwrap();
            let at = |t: f64| value.jet(Moment::at(t));
            // Within one piece of the table, and within the ramp.
            let (t, h) = (0.63, 1e-4);
            for order in 0..3 {
                let slope = (at(t + h)[order][0] - at(t - h)[order][0]) / (2.0 * h);
                // h^2/6 times a derivative of some hundreds
                assert!((slope - at(t)[order + 1][0]).abs() < 2e-6, "{signal:?}, {order}");
            }
        }
    }

    #[test]
    fn tables_refuse_bad_rows() {
        let table = |times: Vec<f64>, period| Signal::Table {
            values: vec![0.0; times.len()],
            times,
            period,
            smooth: false,
        };
        for bad in [
            table(vec![0.0], None),
            table(vec![0.0, 0.0], None),
            table(vec![0.0, f64::NAN], None),
            table(vec![0.0, 2.0], Some(1.0)),
        ] {
            assert!(Value::new(&bad, "load 'f'").is_err());
        }
    }
}
