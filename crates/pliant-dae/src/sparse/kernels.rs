//! Kernels on blocks of columns of factors, kept in double or single precision; all sums are in double precision.

use crate::passes::vectorised;

/// Entries below this are nothing in single precision: numbers without a leading one are slow.
const NOTHING: f64 = 1e-30;
/// Columns treated together.
pub(super) const TOGETHER: usize = 4;
/// Rows added at once.
const LANES: usize = 8;

/// An entry of factors.
pub(super) trait Number: Copy {
    fn number(self) -> f64;
}

impl Number for f32 {
    #[inline(always)]
    fn number(self) -> f64 {
        f64::from(self)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn number(self) -> f64 {
        self
    }
}

/// Copies factors to single precision.
pub(super) fn copy_single(from: &[f64], to: &mut [f32]) {
    vectorised(|| {
        for (to, &from) in to.iter_mut().zip(from) {
            *to = if from.abs() < NOTHING { 0.0 } else { from as f32 };
        }
    });
}

/// `y <- L^-1 y` in the first rows, `-L y` added to the others.
#[inline(always)]
pub(super) fn forward<T: Number>(l: &[T], columns: usize, y: &mut [f64]) {
    let height = y.len();
    let column = |j: usize| &l[j * height..(j + 1) * height];
    let mut j = 0;
    while j + TOGETHER <= columns {
        for k in 0..TOGETHER - 1 {
            for i in k + 1..TOGETHER {
                y[j + i] -= column(j + k)[j + i].number() * y[j + k];
            }
        }
        let [a, b, c, d] = std::array::from_fn(|k| y[j + k]);
        let rest = j + TOGETHER..height;
        let y = &mut y[rest.clone()];
        let n = y.len();
        let [la, lb, lc, ld] = std::array::from_fn(|k| &column(j + k)[rest.clone()][..n]);
        for i in 0..n {
            y[i] -= (la[i].number() * a + lb[i].number() * b)
                + (lc[i].number() * c + ld[i].number() * d);
        }
        j += TOGETHER;
    }
    while j < columns {
        let a = y[j];
        for (y, l) in y[j + 1..].iter_mut().zip(&column(j)[j + 1..]) {
            *y -= l.number() * a;
        }
        j += 1;
    }
}

/// `y <- L^-T y` in the first rows, all others known.
#[inline(always)]
pub(super) fn backward<T: Number>(l: &[T], columns: usize, y: &mut [f64]) {
    let height = y.len();
    let column = |j: usize| &l[j * height..(j + 1) * height];
    let mut j = columns;
    while !j.is_multiple_of(TOGETHER) {
        j -= 1;
        y[j] -= product(&column(j)[j + 1..], &y[j + 1..]);
    }
    while j > 0 {
        j -= TOGETHER;
        let rest = j + TOGETHER..height;
        let sums =
            products(std::array::from_fn(|k| &column(j + k)[rest.clone()]), &y[rest.clone()]);
        for k in (0..TOGETHER).rev() {
            let mut sum = sums[k];
            for i in k + 1..TOGETHER {
                sum += column(j + k)[j + i].number() * y[j + i];
            }
            y[j + k] -= sum;
        }
    }
}

/// Product of a column with a vector.
#[inline(always)]
pub(super) fn product<T: Number>(l: &[T], y: &[f64]) -> f64 {
    let (l, l_rest) = l.as_chunks::<LANES>();
    let (y, y_rest) = y.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (l, y) in l.iter().zip(y) {
        for i in 0..LANES {
            sums[i] += l[i].number() * y[i];
        }
    }
    let rest: f64 = l_rest.iter().zip(y_rest).map(|(l, y)| l.number() * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Products of four columns with one vector.
#[inline(always)]
pub(super) fn products<T: Number>(l: [&[T]; TOGETHER], y: &[f64]) -> [f64; TOGETHER] {
    let chunks = l.map(|l| l.as_chunks::<LANES>());
    let (full, rest) = y.as_chunks::<LANES>();
    let n = full.len();
    let columns = chunks.map(|(l, _)| &l[..n]);
    let mut sums = [[0.0; LANES]; TOGETHER];
    for (c, y) in full.iter().enumerate() {
        for k in 0..TOGETHER {
            for i in 0..LANES {
                sums[k][i] += columns[k][c][i].number() * y[i];
            }
        }
    }
    std::array::from_fn(|k| {
        let tail: f64 = chunks[k].1.iter().zip(rest).map(|(l, y)| l.number() * y).sum();
        sums[k].iter().sum::<f64>() + tail
    })
}
