//! Unit quaternions `[w, x, y, z]` and rotation vectors.

/// A unit quaternion, scalar part first.
pub type Quaternion = [f64; 4];

/// The identity.
pub const IDENTITY: Quaternion = [1.0, 0.0, 0.0, 0.0];

/// `p q`: first q, then p.
#[must_use]
pub fn multiply(p: Quaternion, q: Quaternion) -> Quaternion {
    [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]
}

/// The inverse rotation.
#[must_use]
pub fn conjugate(q: Quaternion) -> Quaternion {
    [q[0], -q[1], -q[2], -q[3]]
}

/// `q` scaled to unit norm.
#[must_use]
pub fn normalize(q: Quaternion) -> Quaternion {
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    q.map(|c| c / norm)
}

/// The vector `v` rotated by `q`.
#[must_use]
pub fn rotate(q: Quaternion, v: [f64; 3]) -> [f64; 3] {
    let u = [q[1], q[2], q[3]];
    let w = cross(u, v);
    let ww = cross(u, w);
    std::array::from_fn(|k| v[k] + 2.0 * (q[0] * w[k] + ww[k]))
}

/// Rotation matrix, by rows.
#[must_use]
pub fn matrix(q: Quaternion) -> [[f64; 3]; 3] {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| rotate(q, e));
    std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
}

/// The rotation by the angle `|theta|` about `theta`.
#[must_use]
pub fn exp(theta: [f64; 3]) -> Quaternion {
    let half = 0.5 * norm(theta);
    // sin(x)/x from its series where the quotient would lose digits.
    let sinc = if half < 1e-4 { 1.0 - half * half / 6.0 } else { half.sin() / half };
    let s = 0.5 * sinc;
    [half.cos(), s * theta[0], s * theta[1], s * theta[2]]
}

/// The rotation vector of `q`, of length at most pi.
#[must_use]
pub fn log(q: Quaternion) -> [f64; 3] {
    let q = if q[0] < 0.0 { q.map(|c| -c) } else { q };
    let v = [q[1], q[2], q[3]];
    let sine = norm(v);
    let factor = if sine < 1e-8 { 2.0 / q[0] } else { 2.0 * sine.atan2(q[0]) / sine };
    v.map(|c| factor * c)
}

/// The tangent operator `T`, by rows: the body-frame angular velocity of `exp(theta(t))` is `T(theta) dtheta/dt`.
///
/// `T = I - (1 - cos a)/a^2 [theta]x + (a - sin a)/a^3 [theta]x^2`, a = |theta| (Brüls, Cardona & Arnold 2012).
#[must_use]
pub fn tangent_operator(theta: [f64; 3]) -> [[f64; 3]; 3] {
    let a = norm(theta);
    let (b, c) = if a < 1e-2 {
        let a2 = a * a;
        (0.5 - a2 / 24.0 + a2 * a2 / 720.0, 1.0 / 6.0 - a2 / 120.0 + a2 * a2 / 5040.0)
    } else {
        ((1.0 - a.cos()) / (a * a), (a - a.sin()) / (a * a * a))
    };
    let [x, y, z] = theta;
    let spin = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let square: f64 = (0..3).map(|k| spin[i][k] * spin[k][j]).sum();
            f64::from(u8::from(i == j)) - b * spin[i][j] + c * square
        })
    })
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_rotates_by_the_right_hand_rule_and_log_undoes_it() {
        let turned = rotate(exp([0.0, 0.0, std::f64::consts::FRAC_PI_2]), [1.0, 0.0, 0.0]);
        assert!((turned[1] - 1.0).abs() < 1e-15 && turned[0].abs() < 1e-15);
        for theta in [[0.3, -1.2, 0.7], [1e-9, 2e-9, -1e-9], [0.0; 3], [1e-3, 0.0, 2e-4]] {
            let back = log(exp(theta));
            for k in 0..3 {
                assert!((back[k] - theta[k]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn product_composes_rotations() {
        let (p, q, v) = (exp([0.2, 0.5, -0.3]), exp([-1.0, 0.1, 0.4]), [0.3, -2.0, 1.0]);
        let (a, b) = (rotate(multiply(p, q), v), rotate(p, rotate(q, v)));
        for k in 0..3 {
            assert!((a[k] - b[k]).abs() < 1e-14);
        }
    }

    #[test]
    fn tangent_operator_is_the_body_rate() {
        for theta in [[0.4, -0.9, 1.3], [2e-3, 1e-3, -3e-3]] {
            let (rate, h) = ([0.7, 0.2, -0.5], 1e-6);
            let at = |s: f64| exp(std::array::from_fn(|k| theta[k] + s * rate[k]));
            // Body frame: q(-h)^-1 q(+h) is the rotation by 2 h omega.
            let omega = log(multiply(conjugate(at(-h)), at(h))).map(|c| c / (2.0 * h));
            let t = tangent_operator(theta);
            for k in 0..3 {
                let expected: f64 = (0..3).map(|j| t[k][j] * rate[j]).sum();
                assert!((omega[k] - expected).abs() < 1e-9);
            }
        }
    }
}
