//! Reading arrays of a model document, with the place in every message.

use crate::error::ModelError;
use crate::spec::Array;

/// The arrays that travel beside a document.
#[derive(Clone, Copy, Debug)]
pub struct Arrays<'a>(pub &'a [Vec<f64>]);

impl<'a> Arrays<'a> {
    /// The numbers of `array`, all finite.
    ///
    /// # Errors
    /// [`ModelError`] where it is missing or holds a number that is not finite.
    pub fn get(&self, array: &'a Array, place: &str) -> Result<&'a [f64], ModelError> {
        let numbers = match array {
            Array::Inline(numbers) => numbers.as_slice(),
            Array::Beside { array } => {
                self.0.get(*array).map(Vec::as_slice).ok_or_else(|| ModelError::MissingArray {
                    place: place.to_owned(),
                    index: *array,
                    count: self.0.len(),
                })?
            }
        };
        match numbers.iter().find(|x| !x.is_finite()) {
            None => Ok(numbers),
            Some(&value) => {
                Err(ModelError::Value { place: place.to_owned(), value, allowed: "finite numbers" })
            }
        }
    }

    /// The same, of one of the given lengths.
    ///
    /// # Errors
    /// [`ModelError`] as above, or for the wrong length.
    pub fn sized(
        &self,
        array: &'a Array,
        lengths: &[usize],
        place: &str,
    ) -> Result<&'a [f64], ModelError> {
        let numbers = self.get(array, place)?;
        if lengths.contains(&numbers.len()) {
            return Ok(numbers);
        }
        let expected: Vec<_> = lengths.iter().map(ToString::to_string).collect();
        Err(ModelError::Length {
            place: place.to_owned(),
            expected: expected.join(" or "),
            got: numbers.len(),
        })
    }

    /// The same, all numbers `allowed` by a predicate.
    ///
    /// # Errors
    /// [`ModelError`] as above, or naming the first number that is not allowed.
    pub fn checked(
        &self,
        array: &'a Array,
        lengths: &[usize],
        place: &str,
        (predicate, allowed): (fn(f64) -> bool, &'static str),
    ) -> Result<&'a [f64], ModelError> {
        let numbers = self.sized(array, lengths, place)?;
        match numbers.iter().find(|&&x| !predicate(x)) {
            None => Ok(numbers),
            Some(&value) => Err(ModelError::Value { place: place.to_owned(), value, allowed }),
        }
    }

    /// Whole numbers.
    ///
    /// # Errors
    /// [`ModelError`] as above, or where a number is not whole or negative.
    pub fn whole(&self, array: &'a Array, place: &str) -> Result<Vec<usize>, ModelError> {
        let numbers = self.get(array, place)?;
        numbers
            .iter()
            .map(|&x| {
                if x >= 0.0 && x.fract() == 0.0 && x < 1e15 {
                    Ok(x as usize)
                } else {
                    Err(ModelError::Value {
                        place: place.to_owned(),
                        value: x,
                        allowed: "whole numbers from 0",
                    })
                }
            })
            .collect()
    }
}

/// Row `i` of an (n, 3) array.
#[must_use]
pub fn row(numbers: &[f64], i: usize) -> [f64; 3] {
    [numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]]
}
