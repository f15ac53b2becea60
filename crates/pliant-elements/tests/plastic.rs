//! Cables that yield: return mapping against closed forms, the tangent on both branches, slack lines.
#![allow(clippy::unwrap_used)]

mod common;

use common::{EA, LENGTH, laws, line, perturbed, settle, symmetric_full, worked};
use pliant_elements::{
    Block, Cable, CableBlock, CableLaw, Integration, Motion, PAST, Slack, Strain, Weights,
    Yielding, testing,
};
use pliant_math::check::{central_difference, relative_error};

const STIFFNESS: Weights = Weights { mass: 0.0, damping: 0.0, stiffness: 1.0 };

/// A straight element of the Biot strain, and its coordinates at a strain.
fn bar(law: CableLaw, yielding: Yielding) -> CableBlock {
    let law = CableLaw { strain: Strain::Biot, plastic: true, ..law };
    let cable = Cable { yielding, slack: Slack::default(), ..common::cable(law, 1) };
    CableBlock::new(law, &[cable]).unwrap()
}

fn stretched(eps: f64) -> Vec<f64> {
    line(1).iter().map(|x| x * (1.0 + eps)).collect()
}

/// Stress over E after a step to each strain in turn.
fn stresses(block: &mut CableBlock, strains: &[f64]) -> Vec<f64> {
    strains
        .iter()
        .map(|&eps| {
            let q = stretched(eps);
            let stress = block.axial_force(0, &q) / EA;
            settle(block, &q);
            // What has flowed does not flow again.
            assert!((block.axial_force(0, &q) / EA - stress).abs() < 1e-15);
            assert!(block.plastic_work(0, &q).abs() < 1e-15);
            stress
        })
        .collect()
}

/// E = 200 GPa, yield stress 250 MPa, tangent modulus 20 GPa, the strain path of the reference, in units of E.
#[test]
fn cycles_of_both_hardenings_are_the_closed_form() {
    let hardening = 0.1 / 0.9;
    let path = [0.004, -0.004, 0.006, 0.0];
    let isotropic = Yielding { strain: 1.25e-3, isotropic: hardening, kinematic: 0.0 };
    let kinematic = Yielding { strain: 1.25e-3, isotropic: 0.0, kinematic: hardening };
    let cases =
        [(isotropic, [305.0, -404.0, 523.2, -538.56]), (kinematic, [305.0, -305.0, 345.0, -225.0])];
    for integration in [Integration::Lobatto, Integration::Full] {
        for (law, expected) in cases {
            let mut block = bar(CableLaw { integration, ..CableLaw::default() }, law);
            let found = stresses(&mut block, &path);
            for (stress, expected) in found.iter().zip(expected) {
                // Strains of 1e-3 are differences of numbers of order one: a few roundings of those.
                assert!((stress * 200e3 / expected - 1.0).abs() < 1e-12, "{stress} {expected}");
            }
        }
    }
}

#[test]
fn work_is_stored_or_spent_whatever_the_steps() {
    for (strain, isotropic, kinematic) in [(0.01, 0.1, 0.0), (0.01, 0.0, 0.2), (0.02, 0.0, 0.0)] {
        let law = Yielding { strain, isotropic, kinematic };
        let path = [0.05, -0.03, 0.06, 0.0];
        let run = |parts: usize| {
            let mut block = bar(CableLaw::default(), law);
            let (mut spent, mut work, mut before) = (0.0, 0.0, 0.0);
            for end in path {
                let from = before;
                for k in 1..=parts {
                    let eps = from + (end - from) * k as f64 / parts as f64;
                    let (a, b) = (stretched(before), stretched(eps));
                    let force = block.axial_force(0, &a);
                    spent += block.plastic_work(0, &b);
                    settle(&mut block, &b);
                    work += 0.5 * (force + block.axial_force(0, &b)) * (eps - before) * LENGTH;
                    before = eps;
                }
            }
            (spent, work - block.elastic_energy(&stretched(0.0)))
        };
        // Plastic work is exact for any step; that of the forces by the trapezoidal rule is so up to the steps in which
        // the line begins to yield, second order.
        let (coarse, _) = run(1);
        let (fine, outside) = run(4000);
        assert!((coarse / fine - 1.0).abs() < 1e-12, "{coarse} {fine}");
        assert!((outside / fine - 1.0).abs() < 1e-5, "{outside} {fine}");
    }
}

/// From plastic strains of the past, where some points flow on, some back, and others rest.
#[test]
fn tangent_is_the_derivative_of_the_force_on_every_branch() {
    for law in laws().filter(|law| law.plastic) {
        let block = worked(law);
        let mut branches = [0; 3];
        for seed in 80..90 {
            let q = perturbed(&block, 0.1, seed);
            let zero = vec![0.0; q.len()];
            let motion = Motion { q: &q, v: &zero, a: &zero };
            for e in 0..4 {
                let tangent = symmetric_full(&block.element_tangent(e, motion, STIFFNESS));
                let complete = block.element_jacobian(e, motion).map(|row| row.to_vec());
                assert!(relative_error(&tangent, &complete) < 1e-12, "{law:?}");
                let difference = central_difference(&block.local(e, &q), 1e-7, |q| {
                    let q: [f64; 12] = std::array::from_fn(|k| q[k]);
                    testing::force(&block, e, &q, &[0.0; 12]).to_vec()
                });
                assert!(relative_error(&difference, &tangent) < 1e-5, "{law:?}");
                let mut past = Vec::new();
                block.flowed(e, &q, &mut past);
                let mut before = Vec::new();
                block.flowed(e, &perturbed(&block, 0.15, 72), &mut before);
                for (new, old) in past.chunks(PAST).zip(before.chunks(PAST)) {
                    let way = new[0] - old[0];
                    branches[if way > 0.0 {
                        0
                    } else if way < 0.0 {
                        1
                    } else {
                        2
                    }] += 1;
                }
            }
        }
        let met = if law.tension_only { &branches[..1] } else { &branches[..2] };
        assert!(met.iter().all(|count| *count > 0) && branches[2] > 0, "{law:?}: {branches:?}");
    }
}

/// Where a point stands on the bound the tangent is that of flowing on, or elastic, as it is told.
#[test]
fn tangent_on_the_bound_leads_where_it_is_told() {
    let law = Yielding { strain: 0.01, isotropic: 0.25, kinematic: 0.0 };
    for sign in [1.0, -1.0] {
        let mut block = bar(CableLaw::default(), law);
        let q = stretched(sign * 0.03);
        settle(&mut block, &q);
        let zero = vec![0.0; q.len()];
        let motion = Motion { q: &q, v: &zero, a: &zero };
        let mut stiffness = |lead: f64| {
            block.set_lead(lead);
            block.element_tangent(0, motion, STIFFNESS)[0]
        };
        let (soft, stiff) = (stiffness(1e-9), stiffness(f64::NEG_INFINITY));
        // H / (E + H) = 0.2, beside the same forces on slopes.
        assert!((soft / stiff - 0.2).abs() < 1e-9, "{soft} {stiff}");
    }
}

#[test]
fn slack_lines_do_not_yield_and_flow_back_no_further_than_to_zero_stress() {
    let tension = CableLaw { tension_only: true, ..CableLaw::default() };
    let mut block = bar(tension, Yielding { strain: 0.01, isotropic: 0.1, kinematic: 0.0 });
    let past = |block: &CableBlock, eps: f64| {
        let mut past = Vec::new();
        block.flowed(0, &stretched(eps), &mut past);
        past[2]
    };
    stresses(&mut block, &[0.05, -0.5]);
    // sigma = 0.01 + (0.04) 0.1/1.1 E: what is left of the strain has stayed.
    let left = 0.04 / 1.1;
    assert!((past(&block, -0.5) / left - 1.0).abs() < 1e-12);
    // Taut again where the plastic strain ends, and yielding again at the stress that it had.
    let force = |block: &CableBlock, eps: f64| block.axial_force(0, &stretched(eps)) / EA;
    assert!(force(&block, left - 1e-3).abs() < 1e-6);
    assert!((force(&block, left + 1e-3) / 1e-3 - 1.0).abs() < 1e-3);
    assert!((force(&block, 0.06) - 0.01 - 0.05 / 11.0).abs() < 1e-6);
    // By kinematic hardening the elastic range leaves zero stress behind: X = 0.25 (0.07 / 1.25) beyond Y = 0.01.
    let mut block = bar(tension, Yielding { strain: 0.01, isotropic: 0.0, kinematic: 0.25 });
    stresses(&mut block, &[0.08, 0.0]);
    // It has flowed back to where X = Y.
    assert!((past(&block, 0.0) - 0.04).abs() < 1e-12);
    assert!((past(&block, -0.5) - 0.04).abs() < 1e-12);
}
