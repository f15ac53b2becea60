//! Small helpers on 3-vectors.

use nalgebra::Vector3;

/// A nalgebra vector of three numbers.
#[must_use]
pub fn vector(x: [f64; 3]) -> Vector3<f64> {
    Vector3::from(x)
}

/// Two unit vectors that complete the unit vector `t` to a right-handed orthonormal triad (t, n1, n2).
#[must_use]
pub fn normals(t: Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let axis = t.iamin();
    let mut e = Vector3::zeros();
    e[axis] = 1.0;
    let n1 = (e - t * t[axis]).normalize();
    (n1, t.cross(&n1))
}
