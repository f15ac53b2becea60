//! Zones against brute force and closed forms; forces against closed forms and differences.

#![allow(clippy::unwrap_used)]

use nalgebra::{Matrix3, Rotation3, Vector3};
use pliant_contact::bore::Bore;
use pliant_contact::curve::{Piece, sign_changes};
use pliant_contact::friction::{Coulomb, Friction, LuGre};
use pliant_contact::meshes::Mesh;
use pliant_contact::normal::Normal;
use pliant_contact::point::{Blocks, Laws, Motion};
use pliant_contact::shapes::{Placed, Shape};
use pliant_contact::touch::{Master, Patch};
use pliant_contact::zones::{Sample, Stretch};
use proptest::prelude::*;

fn piece(a: Vector3<f64>, t: Vector3<f64>, b: Vector3<f64>, u: Vector3<f64>, radius: f64) -> Piece {
    Piece::new([a, t, b, u], 1.0, radius)
}

/// A straight piece of unit slope.
fn straight(middle: Vector3<f64>, along: Vector3<f64>, radius: f64) -> Piece {
    piece(middle - along * 0.5, along, middle + along * 0.5, along, radius)
}

fn vectors() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from)
}

prop_compose! {
    /// A bent piece about a metre long through the neighbourhood of the origin.
    fn bent(radius: f64)(dir in vectors(), at in vectors(), bend in vectors(), twist in vectors()) -> Piece {
        let along = if dir.norm() > 0.1 { dir.normalize() } else { Vector3::x() };
        let (a, b) = (at * 0.2 - along * 0.5, at * 0.2 + along * 0.5);
        piece(a, along + bend * 0.8, b, along + twist * 0.8, radius)
    }
}

/// Least distance from a point to a piece, on a fine grid refined by golden section.
fn brute_distance(master: &Piece, q: Vector3<f64>) -> f64 {
    let d = |t: f64| (master.at(t) - q).norm();
    let n = 200;
    let best =
        (0..=n).min_by(|&i, &j| d(i as f64 / n as f64).total_cmp(&d(j as f64 / n as f64))).unwrap();
    let (mut a, mut b) =
        ((best as f64 - 1.0).max(0.0) / n as f64, (best as f64 + 1.0).min(n as f64) / n as f64);
    for _ in 0..60 {
        let (c, e) = (b - 0.618 * (b - a), a + 0.618 * (b - a));
        if d(c) < d(e) { b = e } else { a = c }
    }
    d(0.5 * (a + b))
}

/// A box of triangles with a roof, or a bottom pushed in by some height: convex without.
fn roof(dent: f64) -> Mesh {
    let corner = |x: f64, y: f64, z: f64| [0.2 * x, 0.15 * y, z];
    let ring =
        |z: f64| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y, z));
    let tops = [corner(0.0, 0.0, 0.2), corner(0.0, 0.0, -0.1 + dent)];
    let points: Vec<[f64; 3]> = ring(-0.1).into_iter().chain(ring(0.1)).chain(tops).collect();
    let sides = (0..4).flat_map(|k| {
        let next = (k + 1) % 4;
        [[k, next, next + 4], [k, next + 4, k + 4], [k + 4, next + 4, 8], [next, k, 9]]
    });
    let mesh = Mesh::new(&points, &sides.collect::<Vec<_>>()).unwrap();
    assert_eq!(mesh.is_convex(), dent == 0.0);
    mesh
}

/// A bore of a radius along an arc of a radian and 0.4 m.
fn bore(radius: f64) -> Bore {
    let angles: Vec<f64> = (0..=8).map(|k| f64::from(k) / 8.0).collect();
    let points: Vec<[f64; 3]> =
        angles.iter().map(|a| [0.4 * a.sin(), 0.4 - 0.4 * a.cos(), 0.0]).collect();
    let tangents: Vec<[f64; 3]> = angles.iter().map(|a| [a.cos(), a.sin(), 0.0]).collect();
    Bore::new(&points, &tangents, &[0.05; 8], radius).unwrap()
}

proptest! {
    #[test]
    fn no_zone_is_missed(slave in bent(0.03), master in bent(0.03)) {
        let zones = Master::Line(&master, [true, true]).zones(&slave);
        for i in 0..=400 {
            let xi = i as f64 / 400.0;
            let gap = brute_distance(&master, slave.at(xi)) - 0.06;
            let inside = zones.iter().any(|&(a, b)| a <= xi && xi <= b);
            if gap.abs() > 1e-6 {
                prop_assert_eq!(inside, gap < 0.0, "xi = {}, gap = {}, zones {:?}", xi, gap, zones);
            }
        }
    }

    #[test]
    fn no_zone_on_a_shape_is_missed(slave in bent(0.03), which in 0..9_usize, origin in vectors(), turn in vectors()) {
        let shape = [
            Shape::HalfSpace,
            Shape::Ball { radius: 0.2 },
            Shape::Box { half: [0.2, 0.1, 0.15] },
            Shape::Cylinder { radius: 0.1, half: 0.3 },
            Shape::Capsule { radius: 0.1, half: 0.2 },
            Shape::Bore(bore(0.15)),
            Shape::Bore(bore(0.05)),
            Shape::Mesh(roof(0.0)),
            Shape::Mesh(roof(0.1)),
        ][which].clone();
        let axes = *Rotation3::from_scaled_axis(turn * 3.0).matrix();
        let placed = Placed { shape, origin: origin * 0.3, axes };
        let zones = Master::Shape(&placed).zones(&slave);
        let gap = |xi: f64| placed.distance(slave.at(xi)).value - 0.03;
        // Where the middle of a line is beyond the wall of a bore it may have several feet: zones may run together there.
        let beyond = matches!(placed.shape, Shape::Bore(_)) && (0..=100).any(|i| gap(i as f64 / 100.0) < -0.03);
        for i in 0..=2000 {
            let xi = i as f64 / 2000.0;
            let gap = gap(xi);
            let inside = zones.iter().any(|&(a, b)| a <= xi && xi <= b);
            // Grazing contact shorter than the search's floor, 1e-3 R, may be left out.
            if gap.abs() > 1e-5 && !(beyond && gap > 0.0) {
                prop_assert_eq!(inside, gap < 0.0, "xi = {}, gap = {}, zones {:?}", xi, gap, zones);
            }
        }
    }

    #[test]
    fn neighbouring_pieces_share_the_slave(slave in bent(0.03), a in bent(0.03), next in vectors(), slope in vectors()) {
        // A second piece continues the first with the same slope: every point of the slave has its foot on one of them.
        let [_, _, mid, on] = *a.vectors();
        let b = piece(mid, on, mid + on + next * 0.3, on + slope * 0.5, 0.03);
        let first = Master::Line(&a, [true, false]).zones(&slave);
        let second = Master::Line(&b, [false, true]).zones(&slave);
        for i in 1..300 {
            let xi = i as f64 / 300.0;
            let count = first.iter().chain(&second).filter(|&&(a, b)| a < xi && xi < b).count();
            let (to_a, to_b) = (brute_distance(&a, slave.at(xi)), brute_distance(&b, slave.at(xi)));
            let (least, most) = (to_a.min(to_b), to_a.max(to_b));
            // Where both are near, a sharp bend may put two feet on them, and the plane between them parts the zone.
            let parted = ((slave.at(xi) - mid).dot(&a.vectors()[3])).abs() < 1e-6;
            if (least - 0.06).abs() > 1e-6 && !parted {
                if least > 0.06 {
                    prop_assert_eq!(count, 0, "xi = {}", xi);
                } else if most > 0.1 {
                    prop_assert_eq!(count, 1, "xi = {}", xi);
                } else {
                    prop_assert!(count >= 1, "xi = {}", xi);
                }
            }
        }
    }

    #[test]
    fn sign_changes_are_all_found(b in prop::array::uniform4(-1.0..1.0_f64)) {
        let value = |x: f64| {
            let y = 1.0 - x;
            y * y * y * b[0] + 3.0 * y * y * x * b[1] + 3.0 * y * x * x * b[2] + x * x * x * b[3]
        };
        let roots = sign_changes(b);
        let mut sign = value(0.0) > 0.0;
        let mut changes = Vec::new();
        for i in 1..=2000 {
            let x = i as f64 / 2000.0;
            if (value(x) > 0.0) != sign {
                sign = !sign;
                changes.push(x);
            }
        }
        prop_assert!(roots.len() >= changes.len());
        for x in changes {
            prop_assert!(roots.iter().any(|r| *r <= x + 1e-9 && x - 1.0 / 2000.0 <= *r + 1e-9), "{x} {roots:?}");
        }
    }
}

#[test]
fn a_line_across_a_node_touches_once() {
    // Exactly in the plane between both pieces, or ending in it, on straight pieces and on sharply bent ones.
    let on = Vector3::x();
    for bend in [0.0, 3.0] {
        let before = piece(-on, on + Vector3::z() * bend, Vector3::zeros(), on, 0.05);
        let after = piece(Vector3::zeros(), on, on, on - Vector3::z() * bend, 0.05);
        for (from, to) in [(-0.5, 0.5), (0.0, 1.0), (-1.0, 0.0)] {
            let at = |y: f64| Vector3::new(0.0, y, 0.09);
            let slave = piece(at(from), Vector3::y(), at(to), Vector3::y(), 0.05);
            let zones: Vec<(f64, f64)> = [(&before, [true, false]), (&after, [false, true])]
                .into_iter()
                .flat_map(|(master, round)| Master::Line(master, round).zones(&slave))
                .collect();
            assert_eq!(zones.len(), 1, "{from}, {bend}: {zones:?}");
        }
    }
}

#[test]
fn rounding_does_not_tear_zones_apart() {
    // In the plane at a node up to rounding, to one side of it or to the other, or askew: one zone, as wide as ever.
    let on = Vector3::x();
    let before = piece(-on, on, Vector3::zeros(), on, 0.05);
    let after = piece(Vector3::zeros(), on, on, on, 0.05);
    let widths = [[0.0, 0.0], [1e-13, -1e-13], [-1e-13, 1e-13], [-1e-13, -1e-13], [1e-16, -3e-16]];
    for offsets in widths {
        let at = |y: f64, x: f64| Vector3::new(x, y, 0.09);
        let along = (at(0.5, offsets[1]) - at(-0.5, offsets[0])).normalize();
        let slave = piece(at(-0.5, offsets[0]), along, at(0.5, offsets[1]), along, 0.05);
        let found: Vec<Patch> = [(&before, [true, false]), (&after, [false, true])]
            .into_iter()
            .flat_map(|(master, round)| {
                let mut found = Vec::new();
                Master::Line(master, round).touch(&slave, [false; 2], &mut found);
                found
            })
            .collect();
        assert_eq!(found.len(), 1, "{offsets:?}");
        let width = found[0].zone.1 - found[0].zone.0;
        // At a height of 0.09 lines at a right angle are 0.1 apart where y^2 = 0.01 - 0.0081.
        assert!((width - 2.0 * 0.0019_f64.sqrt()).abs() < 1e-9, "{offsets:?}: {width}");
        // The foot slides on to the other piece: the tangent must know.
        assert!(found[0].points().iter().all(|p| p.place.slide.is_some()), "{offsets:?}");
    }
}

#[test]
fn force_is_the_slope_of_the_stored_energy() {
    // Of crossing lines, from inside of the ramp to far beyond it.
    let (r, d_0) = (5e-3, 2.5e-5);
    let law = Normal { k: 1e6, d_0, c: 0.0 };
    let master = straight(Vector3::zeros(), Vector3::x(), r);
    let sums = |depth: f64| {
        let slave = straight(Vector3::z() * (2.0 * r - depth), Vector3::y(), r);
        let mut found = Vec::new();
        Master::Line(&master, [false; 2]).touch(&slave, [false; 2], &mut found);
        let points = found.iter().flat_map(Patch::points).map(|p| &p.place);
        points.fold((0.0, 0.0), |(energy, force), place| {
            let (p, _) = law.elastic(-place.gap);
            // Of each point, along the way between the lines.
            let force = force + place.weight * p * place.n.z.abs();
            (energy + place.weight * law.energy(-place.gap), force)
        })
    };
    for part in [0.2, 0.7, 1.0, 1.3, 2.0, 3.0, 5.0, 20.0] {
        let depth = part * d_0;
        let e = 1e-4 * depth;
        let slope = (sums(depth + e).0 - sums(depth - e).0) / (2.0 * e);
        let force = sums(depth).1;
        // Five points of a zone through the kink of the ramp.
        assert!((slope / force - 1.0).abs() < 7e-3, "{part}: {}", slope / force);
    }
}

#[test]
fn least_gap_is_that_of_the_zone() {
    // The deepest point lies well inside of the piece, where it ends, or beside its end.
    let r = 1e-3;
    let cases = [(90.0, 1e-5), (40.0, 1e-4), (15.0, 3e-4), (60.0, 1e-3)];
    for (degrees, delta) in cases {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let master = straight(Vector3::new(0.1, 0.0, 0.0), Vector3::x(), r);
        for beside in [0.05, 0.5, 0.5 - 1e-4, 0.5 - 1e-3] {
            let along = Vector3::new(cos, sin, 0.0);
            let middle = along * beside + Vector3::z() * (2.0 * r - delta);
            let slave = straight(middle, along, r);
            let (_, found) = normal_force(&slave, &Master::Line(&master, [false, false]), 1e7);
            let error = (found[0].least_gap() + delta).abs() / r;
            // The gap is a cubic between two points but for the fourth power of their distance.
            assert!(
                error < if delta > 3e-4 { 2e-3 } else { 1e-5 },
                "{degrees}, {delta}, {beside}: {error}"
            );
        }
    }
}

#[test]
fn stretches_are_cut_where_the_gap_is_largest() {
    let slave = straight(Vector3::zeros(), Vector3::x(), 1e-2);
    // At a sample, exactly; between two; at neither, for a gap that has its least there.
    for top in [0.5, 0.53] {
        let peak = |xi: f64| Sample { xi, gap: -(xi - top).powi(2), slope: -2.0 * (xi - top) };
        let cut = Stretch::of(&slave, (0.0, 1.0), peak);
        assert_eq!(cut.len(), 2, "{cut:?}");
        assert!((cut[0].zone.1 - top).abs() < 1e-12 && cut[0].zone.1 == cut[1].zone.0, "{cut:?}");
        assert_eq!((cut[0].tops, cut[1].tops), ([false, true], [true, false]));
        let valley = |xi: f64| Sample { gap: -1.0 - peak(xi).gap, slope: -peak(xi).slope, xi };
        assert_eq!(Stretch::of(&slave, (0.0, 1.0), valley).len(), 1);
    }
    assert_eq!(Stretch::of(&slave, (0.0, 1.0), |xi| Sample { xi, gap: 0.0, slope: 0.0 }).len(), 1);
}

#[test]
fn stretches_hand_over_while_a_zone_parts() {
    let slave = straight(Vector3::zeros(), Vector3::x(), 1e-2);
    // Two waves of different height: depth / radius 1 at the ends, `a` and `b` where they are largest.
    let integral = |a: f64, b: f64| {
        let wave = |xi: f64| {
            let height = if xi < 0.5 { 1.0 - a } else { 1.0 - b };
            let x = 4.0 * std::f64::consts::PI * xi;
            let (gap, slope) = (-1.0 + 0.5 * height * (1.0 - x.cos()), 0.5 * height * x.sin());
            Sample { xi, gap, slope: slope * 4.0 * std::f64::consts::PI }
        };
        let all = Stretch::of(&slave, (0.0, 1.0), wave);
        let length: f64 = all.iter().map(|s| (s.zone.1 - s.zone.0) * s.share).sum();
        assert!((length - 1.0).abs() < 1e-14, "{all:?}");
        let spots = all.iter().flat_map(|s| s.spots(&slave));
        // What a ramp of the normal force leaves.
        spots.map(|spot| spot.weight * (-wave(spot.xi).gap).sqrt()).sum::<f64>()
    };
    // From a line that lies flat to one that has parted twice, nothing jumps.
    let mut last = integral(1.0, 1.0);
    for k in 1..=1000 {
        let b = 1.0 - 1e-3 * f64::from(k);
        let now = integral(b * b, b);
        assert!((now - last).abs() < 1.5e-3, "{b}: {last} {now}");
        last = now;
    }
    // Where all is nearly as deep, nothing is cut, wherever it is largest.
    let nearly = |xi: f64| Sample { xi, gap: -1.0 + 1e-9 * (1.0 - xi * xi), slope: -2e-9 * xi };
    assert_eq!(Stretch::of(&slave, (-1.0, 1.0), nearly).len(), 1);
}

fn normal_force(slave: &Piece, master: &Master<'_>, k: f64) -> (f64, Vec<Patch>) {
    // A ramp so short that the law is linear.
    let law = Normal { k, d_0: 1e-9, c: 0.0 };
    let mut found = Vec::new();
    master.touch(slave, [false, false], &mut found);
    let points = found.iter().flat_map(Patch::points);
    let force = points.map(|p| p.place.weight * law.elastic(-p.place.gap).0).sum();
    (force, found)
}

#[test]
fn crossing_lines_press_like_three_halves() {
    // Exact: the integral of k (2R - sqrt(s^2 sin^2 + h^2)) over the zone, and its closed form for small depths.
    for (degrees, delta, exact) in [
        (90.0, 1e-5, 0.026_619_957_658_786_556),
        (90.0, 1e-4, 0.828_380_539_084_698_1),
        (90.0, 3e-4, 4.145_108_331_060_46),
        (30.0, 1e-5, 0.053_239_915_317_573_12),
        (30.0, 1e-4, 1.656_761_078_169_396_7),
        (30.0, 3e-4, 8.290_216_662_120_923),
        (10.0, 1e-5, 0.153_298_226_427_953_35),
        (10.0, 1e-4, 4.770_453_397_291_571),
        (10.0, 3e-4, 23.870_727_506_343_75),
    ] {
        let r = 1e-3;
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let master = straight(Vector3::zeros(), Vector3::x(), r);
        let slave = straight(Vector3::z() * (2.0 * r - delta), Vector3::new(cos, sin, 0.0), r);
        let (force, found) = normal_force(&slave, &Master::Line(&master, [false, false]), 1e7);
        assert_eq!(found.len(), 1);
        // Gauss points leave less than 1e-6; the ramp's half, 5e-10, is 1e-4 of the mean depth at 1e-5.
        assert!(
            (force / exact - 1.0).abs() < 1e-3,
            "{degrees} deg, {delta}: {force}, expected {exact}"
        );
    }
}

#[test]
fn a_sine_over_a_line_has_eleven_zones() {
    let elements = 40;
    let radius = 3e-3;
    let slope = |x: f64| {
        Vector3::new(1.0, 0.5 * std::f64::consts::PI * (10.0 * std::f64::consts::PI * x).cos(), 0.0)
    };
    let at = |x: f64| Vector3::new(x, 0.05 * (10.0 * std::f64::consts::PI * x).sin(), 4e-3);
    let master = straight(Vector3::new(0.5, 0.0, 0.0), Vector3::x(), radius);
    let mut zones: Vec<(f64, f64)> = Vec::new();
    for e in 0..elements {
        let h = 1.0 / elements as f64;
        let (a, b) = (e as f64 * h, (e + 1) as f64 * h);
        let slave = Piece::new([at(a), slope(a), at(b), slope(b)], h, radius);
        for (p, q) in Master::Line(&master, [true, true]).zones(&slave) {
            let (p, q) = (slave.at(p).x, slave.at(q).x);
            match zones.last_mut() {
                Some(last) if p - last.1 < 1e-9 => last.1 = q,
                _ => zones.push((p, q)),
            }
        }
    }
    assert_eq!(zones.len(), 11);
    let width = zones[5].1 - zones[5].0;
    // Cubic elements of a fortieth bend the sine by less than a per mille.
    assert!((width / 0.005_701_719_943_679_198 - 1.0).abs() < 1e-3, "{width}");
}

#[test]
fn parallel_lines_press_evenly() {
    let master = straight(Vector3::zeros(), Vector3::x(), 1e-2);
    let slave = straight(Vector3::new(0.3, 0.0, 0.019), Vector3::x(), 1e-2);
    // They overlap from -0.2 to 0.5, 0.7 long, and are 1 mm deep; the linear law has no error in them.
    let (force, _) = normal_force(&slave, &Master::Line(&master, [false, false]), 1e6);
    assert!((force - 1e6 * 1e-3 * 0.7).abs() < 1e-3, "{force}");
}

fn laws() -> Vec<Laws> {
    let normal = Normal { k: 2e5, d_0: 1e-3, c: 0.7 };
    let lugre = LuGre {
        mu_s: 0.5,
        mu_d: 0.3,
        v_s: 1e-2,
        alpha: 2.0,
        sigma_0: 400.0,
        sigma_1: 0.7,
        sigma_2: 0.1,
        scaled: true,
        v_d: 0.05,
    };
    let coulomb = Coulomb { mu: 0.4, sigma_0: 300.0, sigma_1: 0.1 };
    [None, Some(Friction::LuGre(lugre)), Some(Friction::Coulomb(coulomb))]
        .into_iter()
        .map(|friction| Laws { normal, friction })
        .collect()
}

/// Force of all points on the eight vectors, bristles at rest at the beginning.
fn force_of(
    slave: &Piece,
    master: &Piece,
    laws: &Laws,
    v: &[Vector3<f64>; 8],
    moved: &[Vector3<f64>; 8],
) -> [Vector3<f64>; 8] {
    let mut out = [Vector3::zeros(); 8];
    let mut found = Vec::new();
    Master::Line(master, [true, true]).touch(slave, [false, true], &mut found);
    for point in found.iter().flat_map(Patch::points) {
        let motion = Motion { v, moved, h: 1e-2, z: Vector3::zeros() };
        point.place.add_force(point.place.force(laws, &motion).total, &mut out);
    }
    out
}

/// Derivatives of [`force_of`], by the vectors and by their velocities.
fn tangents_of(
    slave: &Piece,
    master: &Piece,
    laws: &Laws,
    v: &[Vector3<f64>; 8],
    moved: &[Vector3<f64>; 8],
    symmetric: bool,
) -> [Blocks; 2] {
    let mut out = [[[Matrix3::zeros(); 8]; 8]; 2];
    let mut found = Vec::new();
    Master::Line(master, [true, true]).touch(slave, [false, true], &mut found);
    for patch in &found {
        let motion = Motion { v, moved, h: 1e-2, z: Vector3::zeros() };
        for (out, factors) in out.iter_mut().zip([(1.0, 0.0), (0.0, 1.0)]) {
            patch.add_tangent(laws, |_| motion, factors, symmetric, out);
        }
    }
    out
}

/// A piece with vector `l` moved by `by` in direction `c`.
fn shifted(p: &Piece, l: usize, c: usize, by: f64) -> Piece {
    let mut x = *p.vectors();
    x[l][c] += by;
    Piece::new(x, p.length(), p.radius())
}

proptest! {
    #[test]
    fn tangent_is_the_derivative_of_the_force(angle in 0.6..2.5_f64, bend in prop::array::uniform8(-0.1..0.1_f64), v in prop::collection::vec(vectors(), 8), moved in prop::collection::vec(vectors(), 8)) {
        let r = 0.05;
        let along = Vector3::new(angle.cos(), angle.sin(), 0.1);
        let mut master = straight(Vector3::new(0.02, 0.0, 0.0), Vector3::x(), r);
        let mut slave = straight(Vector3::z() * (2.0 * r - 0.01), along, r);
        for k in 0..4 {
            master = shifted(&master, k, 2, 0.02 * bend[k]);
            slave = shifted(&slave, k, 1, 0.1 * bend[4 + k]);
        }
        let v: [Vector3<f64>; 8] = std::array::from_fn(|k| v[k] * 0.02);
        let moved: [Vector3<f64>; 8] = std::array::from_fn(|k| moved[k] * 2e-4);
        for laws in laws() {
            let tangents = tangents_of(&slave, &master, &laws, &v, &moved, false);
            let (mut worst, mut size) = (0.0_f64, 1.0_f64);
            let e = 1e-7;
            for l in 0..8 {
                for c in 0..3 {
                    let there = |by: f64, what: usize| {
                        let (mut s, mut m, mut w, mut u) = (slave, master, v, moved);
                        if what == 0 {
                            if l < 4 { m = shifted(&m, l, c, by) } else { s = shifted(&s, l - 4, c, by) }
                            u[l][c] += by;
                        } else {
                            w[l][c] += by;
                        }
                        force_of(&s, &m, &laws, &w, &u)
                    };
                    for (what, matrix) in tangents.iter().enumerate() {
                        let (up, down) = (there(e, what), there(-e, what));
                        for k in 0..8 {
                            let difference = (up[k] - down[k]) / (2.0 * e);
                            worst = worst.max((difference - matrix[k][l].column(c)).norm());
                            size = size.max(difference.norm());
                        }
                    }
                }
            }
            // The ends of zones are found to 1e-13, a millionth of the step; a point may cross the ramp's end, where the
            // slope of the force has a corner, e/d_0 high.
            prop_assert!(worst < 2e-4 * size, "{worst} of {size}, {laws:?}");
        }
    }

    #[test]
    fn symmetric_tangent_is_the_mean_of_both_ways(slave in bent(0.05), master in bent(0.05)) {
        let still = [Vector3::zeros(); 8];
        let laws = laws()[0];
        let [whole, _] = tangents_of(&slave, &master, &laws, &still, &still, false);
        let [half, _] = tangents_of(&slave, &master, &laws, &still, &still, true);
        for k in 0..8 {
            for l in 0..8 {
                let mean = (whole[k][l] + whole[l][k].transpose()) * 0.5;
                // Rounding.
                prop_assert!((half[k][l] - mean).norm() <= 1e-9 * (1.0 + mean.norm()));
            }
        }
    }

    #[test]
    fn nothing_is_lost_between_the_two(slave in bent(0.05), master in bent(0.05), v in prop::collection::vec(vectors(), 8)) {
        let v: [Vector3<f64>; 8] = std::array::from_fn(|k| v[k]);
        for laws in laws() {
            let f = force_of(&slave, &master, &laws, &v, &v.map(|v| v * 1e-2));
            // Positions of both lines' ends carry the resultant; rounding of sums of forces of this size.
            let total = f[0] + f[2] + f[4] + f[6];
            let size: f64 = f.iter().map(|f| f.norm()).sum();
            prop_assert!(total.norm() <= 1e-13 * size, "{total}");
        }
    }

    #[test]
    fn forces_turn_with_the_scene(slave in bent(0.05), master in bent(0.05), v in prop::collection::vec(vectors(), 8), turn in vectors(), shift in vectors()) {
        let v: [Vector3<f64>; 8] = std::array::from_fn(|k| v[k]);
        let q = Rotation3::from_scaled_axis(turn * 3.0);
        let moved = |p: &Piece| {
            let [r, t, s, u] = *p.vectors();
            Piece::new([q * r + shift, q * t, q * s + shift, q * u], p.length(), p.radius())
        };
        for laws in laws() {
            let here = force_of(&slave, &master, &laws, &v, &v.map(|v| v * 1e-2));
            let w = v.map(|v| q * v);
            let there = force_of(&moved(&slave), &moved(&master), &laws, &w, &w.map(|v| v * 1e-2));
            let size: f64 = here.iter().map(|f| f.norm()).sum();
            for k in 0..8 {
                // Rounding, amplified by the ends of zones, which are found to 1e-13 of a piece.
                prop_assert!((q * here[k] - there[k]).norm() <= 1e-7 * (size + 1e-6), "{} {}", q * here[k], there[k]);
            }
        }
    }
}

#[test]
fn zones_part_and_join_without_a_jump() {
    // A line lies on a ball with a dent in the middle: one zone becomes two where the dent's top leaves the ball.
    let r = 1e-3;
    let law = Normal { k: 1e7, d_0: 5e-3 * r, c: 0.0 };
    let ball = Placed {
        shape: Shape::Ball { radius: 0.5 },
        origin: Vector3::zeros(),
        axes: Matrix3::identity(),
    };
    let force = |rise: f64| {
        // Along the ball but for a bump: cubic pieces that bend a little less than it does at their ends.
        let at = |x: f64, z: f64| Vector3::new(x, 0.0, z);
        let (a, b) = (at(-0.1, 0.4895 + r), at(0.1, 0.4895 + r));
        let slope = |s: f64| Vector3::new(1.0, 0.0, s);
        let slave = Piece::new([a, slope(0.16 + rise), b, slope(-0.16 - rise)], 0.2, r);
        let mut found = Vec::new();
        Master::Shape(&ball).touch(&slave, [false; 2], &mut found);
        let points = found.iter().flat_map(Patch::points).map(|p| &p.place);
        let force: f64 = points.map(|p| p.weight * law.elastic(-p.gap).0).sum();
        (Master::Shape(&ball).zones(&slave).len(), force)
    };
    let (mut low, mut high) = (-0.3, 0.3);
    let (one, two) = (force(low).0, force(high).0);
    assert_eq!((one, two), (1, 2), "{:?} {:?}", force(low), force(high));
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if force(middle).0 == 1 { low = middle } else { high = middle }
    }
    let (before, after) = (force(low).1, force(high).1);
    // The zones' ends leave each other as the square root of what the slope has changed by, 1e-6.
    assert!((before / after - 1.0).abs() < 1e-6, "{before}, {after}");
}
