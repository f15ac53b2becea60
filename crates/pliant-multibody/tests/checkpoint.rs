//! A saved run continues with the same bits, and damaged bytes are refused.

#![allow(clippy::unwrap_used)]

mod support;

use pliant_dae::generalized_alpha::Options;
use pliant_multibody::checkpoint::Saved;
use pliant_multibody::model::Model;
use pliant_multibody::run::{Leg, Run, RunOptions, Start};
use proptest::prelude::*;
use std::sync::Arc;
use std::time::Duration;

const H: f64 = 1e-3;

fn begin() -> (Arc<Model>, RunOptions, Run) {
    let model = Arc::new(Model::new(&support::pendulum(8), &[]).unwrap());
    let options = RunOptions { integrator: Options::default(), threads: 1 };
    let (run, _) = Run::new(model.clone(), &options, Start::default()).unwrap();
    (model, options, run)
}

fn advance(run: &mut Run, steps: u64) {
    let leg = Leg { steps, step: H, end: None, output_every: 0 };
    assert_eq!(run.advance(leg, Duration::MAX).unwrap(), steps);
}

#[test]
fn a_saved_run_continues_with_the_same_bits() {
    let (model, options, mut whole) = begin();
    advance(&mut whole, 60);
    for at in [0, 1, 17, 40] {
        let (_, _, mut run) = begin();
        advance(&mut run, at);
        let bytes = run.save().to_bytes().unwrap();
        let saved = Saved::from_bytes(&bytes).unwrap();
        assert_eq!(saved, run.save());
        let mut resumed = Run::resume(model.clone(), &options, saved.clone(), None).unwrap();
        assert_eq!(resumed.steps(), at);
        // Back again from somewhere else, with a solver that holds other numbers.
        advance(&mut run, 13);
        run.reset(saved).unwrap();
        for run in [&mut resumed, &mut run] {
            advance(run, 60 - at);
            assert_eq!(run.state(), whole.state(), "saved after {at} steps");
            assert_eq!(run.present(), whole.present());
        }
    }
}

#[test]
fn states_of_other_models_are_refused() {
    let (_, _, mut run) = begin();
    let other = Arc::new(Model::new(&support::pendulum(9), &[]).unwrap());
    let options = RunOptions { integrator: Options::default(), threads: 1 };
    let (other, _) = Run::new(other, &options, Start::default()).unwrap();
    let before = run.save();
    assert!(run.reset(other.save()).is_err());
    assert_eq!(run.save(), before);
}

#[test]
fn legs_end_at_the_time_asked_for() {
    let (_, _, mut run) = begin();
    for (steps, end) in [(3, 0.1_f64 + 0.2), (7, 0.7), (1, 0.7001)] {
        let step = (end - run.state().t) / steps as f64;
        let leg = Leg { steps, step, end: Some(end), output_every: 0 };
        run.advance(leg, Duration::MAX).unwrap();
        assert_eq!(run.state().t.to_bits(), end.to_bits());
    }
}

proptest! {
    #[test]
    fn altered_bytes_never_panic(at in any::<prop::sample::Index>(), value: u8, cut: bool) {
        let (model, options, mut run) = begin();
        advance(&mut run, 2);
        let mut bytes = run.save().to_bytes().unwrap();
        let at = at.index(bytes.len());
        bytes[at] = value;
        if cut {
            bytes.truncate(at);
        }
        if let Ok(saved) = Saved::from_bytes(&bytes) {
            let _ = Run::resume(model, &options, saved, None);
        }
    }
}
