//! A run as bytes: everything that a bit-identical continuation needs, little endian, numbers as they are in memory.

use crate::error::ModelError;
use crate::memory::Memory;
use crate::run::Balance;
use pliant_dae::generalized_alpha::State;
use pliant_dae::statistics::Statistics;
use serde::{Deserialize, Serialize};

/// Of the layout; it changes with any field of what is saved.
const VERSION: u32 = 6;

/// A run at one moment. The model and the options of the run are not in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// State of the integrator.
    pub state: State,
    /// Integrals and inputs.
    pub memory: Memory,
    /// Cost so far.
    pub statistics: Statistics,
    /// Steps since the start.
    pub steps: u64,
    /// The watch over energy.
    pub balance: Balance,
}

impl Saved {
    /// As bytes.
    ///
    /// # Errors
    /// None that is known: [`ModelError::Saved`] with what the encoder says.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        postcard::to_stdvec(&(VERSION, self)).map_err(damaged)
    }

    /// Reads what [`Self::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`ModelError::Saved`] where the bytes are of another version, damaged, or hold numbers that are not finite.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ModelError> {
        let (version, rest) = postcard::take_from_bytes::<u32>(bytes).map_err(damaged)?;
        if version != VERSION {
            return Err(damaged(format!("version {version}, this pliant reads {VERSION}")));
        }
        let (saved, rest) = postcard::take_from_bytes::<Self>(rest).map_err(damaged)?;
        let state = &saved.state;
        let arrays =
            [&state.q, &state.v, &state.a, &state.a_alg, &state.a_previous, &state.lambda_];
        if !rest.is_empty() {
            return Err(damaged(format!("{} bytes too many", rest.len())));
        }
        if !state.t.is_finite() || arrays.iter().any(|x| x.iter().any(|x| !x.is_finite())) {
            return Err(damaged("numbers that are not finite"));
        }
        Ok(saved)
    }
}

fn damaged(reason: impl ToString) -> ModelError {
    ModelError::Saved { reason: reason.to_string() }
}
