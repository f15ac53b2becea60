//! Sliding along a cable: Jacobian, Hessian, acceleration and jerk against finite differences, within an element and
//! where elements meet.

use pliant_multibody::dof_map::CableMap;
use pliant_multibody::joints::slide_cable::SlideCable;
use pliant_multibody::joints::{Draft, Joint};
use pliant_multibody::point::{Interpolation, Support};
use pliant_multibody::signal::Moment;

/// Three nodes of a cable (6 coordinates each), the point (3), the arc length.
const UNKNOWNS: usize = 22;
const S: usize = 21;

fn joint() -> Box<dyn Joint> {
    let nodes = [0_u32, 6, 12].map(|r| pliant_elements::NodeOffsets { r, t: r + 3 }).to_vec();
    let cable = CableMap {
        name: String::new(),
        nodes,
        strands: std::iter::once(0..2).collect(),
        lengths: vec![0.7, 0.4],
    };
    let point = Interpolation::weighted([(18, 1.0)]);
    let draft = Box::new(SlideCable::new(point, &cable, S));
    assert_eq!(draft.windows().len(), 2);
    draft.placed(Support { groups: Vec::new(), unknowns: (0..UNKNOWNS).collect() })
}

fn noise(seed: usize) -> Vec<f64> {
    (0..UNKNOWNS).map(|i| (1.7 * (i + 1) as f64 + 12.3 * seed as f64).sin()).collect()
}

fn along(q: &[f64], v: &[f64], a: &[f64], t: f64) -> Vec<f64> {
    (0..UNKNOWNS).map(|i| q[i] + t * v[i] + 0.5 * t * t * a[i]).collect()
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let joint = joint();
    let (v, a) = (noise(3), noise(4));
    for s in [0.2, 0.69, 0.9] {
        let mut q = noise(2);
        q[S] = s;
        let phi = |t: f64| {
            let mut phi = [0.0; 3];
            joint.residual(Moment::at(0.0), &along(&q, &v, &a, t), &mut phi);
            phi
        };
        // Central differences of fourth order of a polynomial in t: the error is h^4, rounding 1e-16 / h^3.
        let h = 2e-3;
        let [f2, f1, f0, g1, g2] = [2.0, 1.0, 0.0, -1.0, -2.0].map(|k| phi(k * h));
        let mut jacobian = vec![0.0; 3 * UNKNOWNS];
        joint.jacobian(Moment::at(0.0), &q, &mut jacobian);
        let rows = |x: &[f64]| -> Vec<f64> {
            jacobian.chunks(UNKNOWNS).map(|r| r.iter().zip(x).map(|(r, x)| r * x).sum()).collect()
        };
        let (mut second, mut third) = (vec![0.0; 3], vec![0.0; 3]);
        joint.acceleration(Moment::at(0.0), &q, &v, &mut second);
        joint.jerk(Moment::at(0.0), &q, &v, &a, &mut third);
        let (slope, bend) = (rows(&v), rows(&a));
        for k in 0..3 {
            let first = (8.0 * (f1[k] - g1[k]) - (f2[k] - g2[k])) / (12.0 * h);
            assert!((slope[k] - first).abs() < 1e-7, "slope {k} at {s}");
            let both = (16.0 * (f1[k] + g1[k]) - (f2[k] + g2[k]) - 30.0 * f0[k]) / (12.0 * h * h);
            assert!((second[k] + bend[k] - both).abs() < 1e-6, "acceleration {k} at {s}");
            let d = 4e-4;
            let [a2, a1, b1, b2] = [2.0, 1.0, -1.0, -2.0].map(|n| phi(n * d)[k]);
            let jerk = (a2 - 2.0 * a1 + 2.0 * b1 - b2) / (2.0 * d * d * d);
            // Second order: the fifth derivative of the path is some ten thousand.
            assert!((third[k] - jerk).abs() < 5e-3, "jerk {k} at {s}: {} and {jerk}", third[k]);
        }
        let lambda_ = [0.3, -1.2, 0.8];
        let mut hessian = vec![0.0; UNKNOWNS * UNKNOWNS];
        joint.add_hessian(Moment::at(0.0), &q, &lambda_, 1.0, &mut hessian);
        let force = |t: f64| -> Vec<f64> {
            let zero = vec![0.0; UNKNOWNS];
            let mut jacobian = vec![0.0; 3 * UNKNOWNS];
            joint.jacobian(Moment::at(0.0), &along(&q, &v, &zero, t), &mut jacobian);
            (0..UNKNOWNS)
                .map(|j| (0..3).map(|i| lambda_[i] * jacobian[i * UNKNOWNS + j]).sum())
                .collect()
        };
        let (plus, minus) = (force(1e-5), force(-1e-5));
        for i in 0..UNKNOWNS {
            let row: f64 =
                hessian[i * UNKNOWNS..(i + 1) * UNKNOWNS].iter().zip(&v).map(|(h, v)| h * v).sum();
            assert!((row - (plus[i] - minus[i]) / 2e-5).abs() < 1e-7, "Hessian {i} at {s}");
        }
    }
}

#[test]
fn the_ends_are_told() {
    let joint = joint();
    let mut q = noise(2);
    for (s, told) in [(0.0, false), (1.1, false), (0.5, false), (1.2, true), (-0.1, true)] {
        q[S] = s;
        assert_eq!(joint.strayed(&q).is_some(), told, "{s}");
    }
    for (s, window) in [(-0.1, 0), (0.3, 0), (0.7, 1), (5.0, 1)] {
        q[S] = s;
        assert_eq!(joint.window(&q), window);
    }
}
