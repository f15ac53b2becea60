//! Element matrices and graphs of chains for the tests and benchmarks of the linear solvers.
#![allow(dead_code)]

use pliant_dae::structure::{Slot, Storage, Structure, entries, entry_number};

/// A small deterministic generator of numbers.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.next() * n as f64) as usize).min(n - 1)
    }
}

/// How the element matrices are made.
#[derive(Clone, Copy)]
pub struct Material {
    pub length: f64,
    pub line_density: f64,
    pub axial: f64,
    pub bending: f64,
    pub tension: (f64, f64),
    pub step: f64,
    /// Relative size of an unsymmetric part.
    pub skew: f64,
}

/// Well conditioned.
pub const SOFT: Material = Material {
    length: 0.1,
    line_density: 0.08,
    axial: 800.0,
    bending: 5e-3,
    tension: (-2.0, 5.0),
    step: 1e-3,
    skew: 0.0,
};

/// The cables of a mesh reflector, in a moderate step.
pub const STIFF: Material = Material {
    length: 0.047,
    line_density: 1.1e-3,
    axial: 4.7e4,
    bending: 2.9e-3,
    tension: (-2.0, 5.0),
    step: 5e-3,
    skew: 0.0,
};

/// The same under compression beyond buckling, in a long step.
pub const INDEFINITE: Material = Material { tension: (-60.0, 5.0), step: 20e-3, ..STIFF };

/// Iteration matrix of a 12-coordinate Hermite line element of random direction.
pub fn line_element(random: &mut Random, m: Material) -> Vec<f64> {
    let l = m.length;
    let mass = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
    ];
    let bending = [
        [12.0, 6.0 * l, -12.0, 6.0 * l],
        [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l],
        [-12.0, -6.0 * l, 12.0, -6.0 * l],
        [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l],
    ];
    let stretch = [
        [36.0, 3.0 * l, -36.0, 3.0 * l],
        [3.0 * l, 4.0 * l * l, -3.0 * l, -l * l],
        [-36.0, -3.0 * l, 36.0, -3.0 * l],
        [3.0 * l, -l * l, -3.0 * l, 4.0 * l * l],
    ];
    let mut d = [0.0; 3];
    loop {
        for d in &mut d {
            *d = random.range(-1.0, 1.0);
        }
        let norm = d.iter().map(|d| d * d).sum::<f64>().sqrt();
        if norm > 0.1 && norm < 1.0 {
            for d in &mut d {
                *d /= norm;
            }
            break;
        }
    }
    let tension = random.range(m.tension.0, m.tension.1);
    let mut a = vec![0.0; 144];
    for p in 0..4 {
        for q in 0..4 {
            for i in 0..3 {
                for j in 0..3 {
                    let unit = f64::from(i == j);
                    a[(3 * p + i) * 12 + 3 * q + j] =
                        4.0 / m.step.powi(2) * m.line_density * l / 420.0 * mass[p][q] * unit
                            + m.bending / l.powi(3) * bending[p][q] * unit
                            + stretch[p][q] / (30.0 * l)
                                * (m.axial * d[i] * d[j] + tension * (unit - d[i] * d[j]));
                }
            }
        }
    }
    if m.skew > 0.0 {
        let size = a[0].abs();
        for (k, a) in a.iter_mut().enumerate() {
            // Slopes are scaled by a length, forces on them too.
            let (i, j) = (k / 12, k % 12);
            let scale = |i: usize| if (i / 3) % 2 == 1 { l } else { 1.0 };
            *a += m.skew * size * scale(i) * scale(j) * random.range(-0.2, 0.2);
        }
    }
    a
}

/// A structure with its element values.
#[derive(Clone)]
pub struct System {
    pub structure: Structure,
    pub values: Vec<f64>,
}

/// Collects groups and elements; multipliers are numbered after all velocity-level unknowns.
pub struct Builder {
    groups: Vec<(usize, bool)>,
    elements: Vec<(Vec<usize>, Vec<f64>)>,
    pub random: Random,
    pub material: Material,
    /// Store all matrices completely.
    pub full: bool,
    /// Store symmetric 12 x 12 matrices in lanes of eight.
    pub lanes: bool,
}

impl Builder {
    pub fn new(seed: u64, material: Material) -> Self {
        Self {
            groups: Vec::new(),
            elements: Vec::new(),
            random: Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1),
            material,
            full: material.skew > 0.0,
            lanes: false,
        }
    }

    pub fn group(&mut self, size: usize) -> usize {
        self.groups.push((size, false));
        self.groups.len() - 1
    }

    pub fn multipliers(&mut self, size: usize) -> usize {
        self.groups.push((size, true));
        self.groups.len() - 1
    }

    pub fn nodes(&mut self, count: usize) -> Vec<usize> {
        (0..count).map(|_| self.group(6)).collect()
    }

    /// An element with a matrix given row by row.
    pub fn element(&mut self, groups: &[usize], matrix: Vec<f64>) {
        let n: usize = groups.iter().map(|&g| self.groups[g].0).sum();
        assert_eq!(matrix.len(), n * n);
        self.elements.push((groups.to_vec(), matrix));
    }

    pub fn line(&mut self, groups: &[usize]) {
        let matrix = line_element(&mut self.random, self.material);
        self.element(groups, matrix);
    }

    /// Links all successive nodes.
    pub fn chain(&mut self, nodes: &[usize]) {
        for k in 1..nodes.len() {
            self.line(&[nodes[k - 1], nodes[k]]);
        }
    }

    /// Constraints between groups with a random Jacobian.
    pub fn joint(&mut self, groups: &[usize], count: usize) -> usize {
        let lambda = self.multipliers(count);
        let m: usize = groups.iter().map(|&g| self.groups[g].0).sum();
        let n = m + count;
        let mut matrix = vec![0.0; n * n];
        for c in 0..count {
            for j in 0..m {
                let a = f64::from(j == c) + 0.3 * self.random.range(-1.0, 1.0);
                matrix[(m + c) * n + j] = a;
                matrix[j * n + m + c] = a;
            }
        }
        let mut all = groups.to_vec();
        all.push(lambda);
        self.element(&all, matrix);
        lambda
    }

    pub fn mass(&mut self, group: usize, mass: f64) {
        let n = self.groups[group].0;
        let mut matrix = vec![0.0; n * n];
        for i in 0..n {
            matrix[i * n + i] = 4.0 / self.material.step.powi(2) * mass;
        }
        self.element(&[group], matrix);
    }

    /// A line of `n >= 2` elements between two shared positions, with slopes of its own at its ends.
    pub fn span(&mut self, a: usize, b: usize, n: usize) {
        let first = self.group(3);
        let nodes = self.nodes(n - 1);
        let last = self.group(3);
        self.line(&[a, first, nodes[0]]);
        self.chain(&nodes);
        self.line(&[nodes[n - 2], b, last]);
    }

    pub fn build(self) -> System {
        let count = |multipliers: bool| -> usize {
            self.groups.iter().filter(|g| g.1 == multipliers).map(|g| g.0).sum()
        };
        let velocities = count(false);
        let mut structure = Structure::new(velocities, count(true));
        let (mut next, mut next_multiplier) = (0, velocities);
        for &(size, multiplier) in &self.groups {
            let at = if multiplier { &mut next_multiplier } else { &mut next };
            structure.add_group(*at..*at + size);
            *at += size;
        }
        let storage = if self.full { Storage::Full } else { Storage::Symmetric };
        let in_lanes = |m: &Vec<f64>| self.lanes && !self.full && m.len() == 144;
        let lanes = self.elements.iter().filter(|(_, m)| in_lanes(m)).count();
        let base = structure.reserve(lanes.div_ceil(8) * 8 * 78);
        let mut lane = 0;
        for (groups, matrix) in &self.elements {
            if in_lanes(matrix) {
                let base = base + lane / 8 * 8 * 78 + lane % 8;
                structure.add_element_at(groups, Slot { base, stride: 8, storage });
                lane += 1;
            } else {
                structure.add_element(groups, storage);
            }
        }
        let mut values = vec![0.0; structure.values()];
        for (e, (_, matrix)) in self.elements.iter().enumerate() {
            let n = matrix.len().isqrt();
            let slot = structure.slot(e);
            assert!(entries(n, storage) <= n * n);
            for i in 0..n {
                for j in 0..n {
                    let k = entry_number(n, i, j, storage);
                    values[slot.base + k * slot.stride] = matrix[i * n + j];
                }
            }
        }
        System { structure, values }
    }
}

/// A single chain of `n` elements, pinned at its first node.
pub fn pinned_chain(n: usize, material: Material) -> System {
    let mut b = Builder::new(n as u64, material);
    b.lanes = true;
    let nodes = b.nodes(n + 1);
    b.chain(&nodes);
    b.joint(&[nodes[0]], 3);
    b.build()
}

/// A net of concentric rings with radial lines: each line has `n` elements; positions of the knots are shared.
pub fn net(rings: usize, bays: usize, n: usize, material: Material) -> System {
    let mut b = Builder::new(7, material);
    b.lanes = true;
    let centre = b.group(3);
    let mut inner = vec![centre; bays];
    for _ in 0..rings {
        let ring: Vec<usize> = (0..bays).map(|_| b.group(3)).collect();
        for k in 0..bays {
            b.span(inner[k], ring[k], n);
            b.span(ring[k], ring[(k + 1) % bays], n);
        }
        inner = ring;
    }
    b.build()
}

/// `A x`, and a bound of its rounding.
pub fn product(system: &System, x: &[f64], transposed: bool) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    system.structure.multiply_add(&system.values, x, &mut y, transposed);
    y
}

/// Largest residual of `A x = b` relative to the largest row sum of |A| |x| and to b.
pub fn residual(system: &System, x: &[f64], b: &[f64], transposed: bool) -> f64 {
    let y = product(system, x, transposed);
    let absolute = System {
        structure: system.structure.clone(),
        values: system.values.iter().map(|v| v.abs()).collect(),
    };
    let xa: Vec<f64> = x.iter().map(|x| x.abs()).collect();
    let size = product(&absolute, &xa, transposed);
    (0..b.len())
        .map(|i| (y[i] - b[i]).abs() / (size[i] + b[i].abs()).max(1e-300))
        .fold(0.0, f64::max)
}

/// Right-hand side of a known solution of size one.
pub fn right_side(system: &System, seed: u64, transposed: bool) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random(seed | 1);
    for _ in 0..8 {
        random.next();
    }
    let x: Vec<f64> = (0..system.structure.unknowns()).map(|_| random.range(-1.0, 1.0)).collect();
    let b = product(system, &x, transposed);
    (x, b)
}
