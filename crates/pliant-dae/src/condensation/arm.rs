//! One half of a chain: its nodes from an end inwards, up to but without the middle node.

use super::block::{
    Block, Lanes, N, PLAIN, Row, Wide, ZERO, add_part, combine, invert, invert_pivoted,
    minus_transposed_product, multiply, pick, product, transpose, transposed_product,
};
use super::cap::Cap;
use super::graph::Path;
use crate::structure::{Slot, Structure};
use pulp::{Simd, WithSimd};

/// Arms of at least this number of nodes do not stay in the cache between sweeps.
const LONG: usize = 1000;

/// The matrix of the element between a node and the next one inwards.
#[derive(Clone, Copy, Debug)]
struct Link {
    slot: Slot,
    /// Whether the node is the element's second one.
    swapped: bool,
}

/// The matrix of an element over one node alone, or of a further element along a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Own {
    at: u32,
    slot: Slot,
}

impl Own {
    /// Adds the element to the node's block.
    pub(super) fn add(&self, block: &mut Block, values: &[f64]) {
        add_part(block, values, self.slot, N, 0, 0);
    }
}

/// Elements over node number `at` alone.
pub(super) fn own(structure: &Structure, elements: &[usize], at: usize) -> Vec<Own> {
    elements.iter().map(|&e| Own { at: at as u32, slot: structure.slot(e) }).collect()
}

/// What the elimination carries from node to node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carry {
    pub(super) diagonal: Block,
    pub(super) suspect: bool,
    /// Number of the node that could not be eliminated.
    pub(super) failed: Option<usize>,
}

/// Factors of all nodes, for solving with the matrix (or with its transpose).
#[derive(Default)]
struct Factors {
    /// Columns of D^-1.
    inverse: Vec<Block>,
    /// Rows of the forward factor.
    forward: Vec<Block>,
    /// Columns of `W = D^-1 C`; empty in long symmetric arms, where another array in memory costs more than to
    /// multiply by the rows.
    outward: Vec<Block>,
    /// For each node and interface unknown, a row to gather the interface's share with.
    gather: Vec<Row>,
    /// For each node and interface unknown, a row of V.
    spread: Vec<Row>,
}

/// One half of a chain with its factors.
pub(super) struct Arm {
    nodes: Vec<u32>,
    links: Vec<Link>,
    /// Further elements along links, by node.
    doubles: Vec<(u32, Link)>,
    own: Vec<Own>,
    next_double: usize,
    next_own: usize,
    pub(super) cap: Cap,
    width: usize,
    /// Coupling of the current node to the interface, by columns and by rows.
    reach: Vec<Row>,
    reach_rows: Vec<Row>,
    /// What is left for the interface.
    pub(super) schur: Vec<f64>,
    sides: [Factors; 2],
    symmetric: bool,
    z: Vec<Row>,
    /// The interface's share of the right-hand side, lane by lane.
    pub(super) shares: Vec<Row>,
    start: Row,
}

impl Arm {
    /// The arm over `order`, positions in the path from the outside inwards, at end `side`.
    pub(super) fn new(
        structure: &Structure,
        path: &Path,
        order: Vec<usize>,
        side: usize,
        symmetric: bool,
    ) -> Self {
        let mut links = Vec::with_capacity(order.len());
        let mut doubles = Vec::new();
        let mut all_own = Vec::new();
        for (k, &at) in order.iter().enumerate() {
            let elements = &path.links[if side == 0 { at } else { at - 1 }];
            for (number, &e) in elements.iter().enumerate() {
                let swapped = structure.element(e)[0] != path.nodes[at];
                let link = Link { slot: structure.slot(e), swapped };
                if number == 0 {
                    links.push(link);
                } else {
                    doubles.push((k as u32, link));
                }
            }
            all_own.extend(own(structure, &path.own[at], k));
        }
        let middle = path.nodes.len() / 2;
        let first = order.first().map_or(path.nodes[middle], |&at| path.nodes[at]);
        let cap = Cap::new(structure, &path.ends[side], first as usize);
        let width = cap.interface();
        let n = order.len();
        let factors = |used: bool| {
            let n = if used { n } else { 0 };
            Factors {
                inverse: vec![ZERO; n],
                forward: vec![ZERO; n],
                outward: vec![ZERO; if symmetric && n >= LONG { 0 } else { n }],
                gather: vec![Row::default(); n * width],
                spread: vec![Row::default(); n * width],
            }
        };
        let start = |&at: &usize| structure.groups()[path.nodes[at] as usize].start as u32;
        Self {
            nodes: order.iter().map(start).collect(),
            links,
            doubles,
            own: all_own,
            next_double: 0,
            next_own: 0,
            cap,
            width,
            reach: vec![Row::default(); width],
            reach_rows: vec![Row::default(); width],
            schur: vec![0.0; width * width],
            sides: [factors(true), factors(!symmetric)],
            symmetric,
            z: vec![Row::default(); n],
            shares: vec![Row::default(); width],
            start: Row::default(),
        }
    }

    /// Number of nodes.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Number of interface unknowns.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// First unknown of node `k`.
    pub(super) fn unknown(&self, k: usize) -> usize {
        self.nodes[k] as usize
    }

    /// Coupling of the current node to interface unknown `c`, as a column.
    pub(super) fn reach(&self, c: usize) -> &Row {
        &self.reach[c]
    }

    /// Coupling of interface unknown `c` to the current node, as a row.
    pub(super) fn reach_row(&self, c: usize) -> &Row {
        if self.symmetric { &self.reach[c] } else { &self.reach_rows[c] }
    }

    /// What the cap leaves for the first node and the interface.
    pub(super) fn first(&mut self) -> Carry {
        let rest = N + self.width;
        let schur = &self.cap.schur;
        let mut carry = Carry::default();
        for i in 0..N {
            carry.diagonal[i] = Row::load(&schur[i * rest..]);
        }
        for c in 0..self.width {
            for i in 0..N {
                self.reach[c].0[i] = schur[i * rest + N + c];
            }
            self.reach_rows[c] = Row::load(&schur[(N + c) * rest..]);
            for d in 0..self.width {
                self.schur[c * self.width + d] = schur[(N + c) * rest + N + d];
            }
        }
        self.next_own = 0;
        self.next_double = 0;
        carry
    }

    /// Eliminates node `k`.
    #[inline(always)]
    pub(super) fn eliminate<L: Lanes, const SYMMETRIC: bool>(
        &mut self,
        l: L,
        carry: &mut Carry,
        k: usize,
        values: &[f64],
    ) {
        let link = self.links[k];
        let mut back = ZERO;
        let Slot { base, stride, .. } = link.slot;
        let [mut diagonal, mut coupling, mut next] = if !SYMMETRIC {
            link.parts(values, &carry.diagonal, &mut back)
        } else {
            match (stride, link.swapped) {
                (8, false) => pick::<8, false>(values, base, &carry.diagonal),
                (8, true) => pick::<8, true>(values, base, &carry.diagonal),
                (1, false) => pick::<1, false>(values, base, &carry.diagonal),
                (1, true) => pick::<1, true>(values, base, &carry.diagonal),
                _ => link.parts(values, &carry.diagonal, &mut back),
            }
        };
        if self.next_own < self.own.len() || self.next_double < self.doubles.len() {
            self.extras(k, values, &mut diagonal, &mut coupling, &mut back, &mut next);
        }
        let (mut inverse, safe) = invert(l, &diagonal);
        if !safe {
            carry.suspect = true;
            match invert_pivoted(&diagonal) {
                Ok(pivoted) => inverse = pivoted,
                Err(_) => {
                    carry.failed = carry.failed.or(Some(k));
                }
            }
        }
        let w = product(l, &inverse, &coupling);
        let [plain, transposed] = &mut self.sides;
        if SYMMETRIC {
            carry.diagonal = minus_transposed_product(l, &next, &coupling, &w);
            plain.inverse[k] = inverse;
            plain.forward[k] = w;
            if let Some(columns) = plain.outward.get_mut(k) {
                *columns = transposed_product(l, &coupling, &inverse);
            }
            if self.width > 0 {
                self.extend(l, k, &inverse, &coupling);
            }
        } else {
            // `back` holds E^T; x = D^-T E^T carries right-hand sides inwards.
            let inverse_columns = transpose(&inverse);
            let x = product(l, &inverse_columns, &back);
            carry.diagonal = minus_transposed_product(l, &next, &back, &w);
            plain.inverse[k] = inverse_columns;
            plain.forward[k] = x;
            plain.outward[k] = transpose(&w);
            transposed.inverse[k] = inverse;
            transposed.forward[k] = w;
            transposed.outward[k] = transpose(&x);
            if self.width > 0 {
                self.extend_both(l, k, &inverse, &coupling, &back);
            }
        }
    }

    /// Adds the elements over node `k` alone and further elements along its link.
    #[inline(never)]
    fn extras(
        &mut self,
        k: usize,
        values: &[f64],
        diagonal: &mut Block,
        coupling: &mut Block,
        back: &mut Block,
        next: &mut Block,
    ) {
        while let Some(own) = self.own.get(self.next_own).filter(|own| own.at as usize == k) {
            own.add(diagonal, values);
            self.next_own += 1;
        }
        while let Some((_, link)) =
            self.doubles.get(self.next_double).filter(|(at, _)| *at as usize == k)
        {
            link.add(values, diagonal, coupling, back, next);
            self.next_double += 1;
        }
    }

    /// Extends the coupling to the interface from node `k` to the next one.
    #[inline(always)]
    fn extend<L: Lanes>(&mut self, l: L, k: usize, inverse: &Block, coupling: &Block) {
        let m = self.width;
        let factors = &mut self.sides[0];
        let spread = &mut factors.spread[k * m..(k + 1) * m];
        for c in 0..m {
            spread[c] = combine(l, inverse, &self.reach[c]);
        }
        for c in 0..m {
            for d in 0..m {
                let mut lanes = Row::default();
                lanes.add_products(l, &self.reach[c], &spread[d]);
                self.schur[c * m + d] -= lanes.sum();
            }
        }
        for c in 0..m {
            self.reach[c] = Row::default().minus(l, &combine(l, coupling, &spread[c]));
        }
    }

    /// The same for an unsymmetric matrix.
    #[inline(always)]
    fn extend_both<L: Lanes>(
        &mut self,
        l: L,
        k: usize,
        inverse: &Block,
        coupling: &Block,
        back: &Block,
    ) {
        let m = self.width;
        let inverse_columns = transpose(inverse);
        let at = k * m;
        let [plain, transposed] = &mut self.sides;
        for c in 0..m {
            plain.spread[at + c] = combine(l, &inverse_columns, &self.reach[c]);
            plain.gather[at + c] = combine(l, inverse, &self.reach_rows[c]);
            transposed.gather[at + c] = plain.spread[at + c];
            transposed.spread[at + c] = plain.gather[at + c];
        }
        for c in 0..m {
            for d in 0..m {
                let mut lanes = Row::default();
                lanes.add_products(l, &self.reach_rows[c], &plain.spread[at + d]);
                self.schur[c * m + d] -= lanes.sum();
            }
        }
        for c in 0..m {
            let (v, u) = (&plain.spread[at + c], &plain.gather[at + c]);
            self.reach[c] = Row::default().minus(l, &combine(l, back, v));
            self.reach_rows[c] = Row::default().minus(l, &combine(l, coupling, u));
        }
    }

    /// Begins a forward sweep: what the cap takes from the first node, and keeps for itself.
    pub(super) fn start(&mut self, b: &[f64], transposed: bool) {
        self.cap.keep(b, transposed);
        for i in 0..N {
            self.start.0[i] = self.cap.forward(b, i, transposed);
        }
        self.shares.fill(Row::default());
    }

    /// Ends a backward sweep: the cap's solution from that of the first node.
    pub(super) fn stop(&mut self, middle: &Row, known: &[f64], transposed: bool) {
        let first = self.z.first().unwrap_or(middle);
        self.cap.backward(&first.0, known, transposed);
    }

    /// Takes the right-hand side from node `k` to the next one.
    #[inline(always)]
    fn inward<L: Lanes>(&mut self, l: L, carry: &mut Row, k: usize, b: &[f64], side: usize) {
        let y = Row::load(&b[self.nodes[k] as usize..]).minus(l, carry);
        let factors = &self.sides[side];
        *carry = combine(l, &factors.forward[k], &y);
        self.z[k] = combine(l, &factors.inverse[k], &y);
        let m = self.width;
        if m > 0 {
            let rows = if self.symmetric { &factors.spread } else { &factors.gather };
            for (share, row) in self.shares.iter_mut().zip(&rows[k * m..(k + 1) * m]) {
                share.add_products(l, row, &y);
            }
        }
    }

    /// Takes the solution from the next node to node `k`.
    #[inline(always)]
    fn outward<L: Lanes>(&mut self, l: L, x: &mut Row, k: usize, known: &[f64], side: usize) {
        let factors = &self.sides[side];
        let mut z = self.z[k];
        let m = self.width;
        if m > 0 {
            for (x, row) in known.iter().zip(&factors.spread[k * m..(k + 1) * m]) {
                z.add(l, -x, row);
            }
        }
        let wx = match factors.outward.get(k) {
            Some(columns) => combine(l, columns, x),
            None => multiply(l, &factors.forward[k], x),
        };
        *x = z.minus(l, &wx);
        self.z[k] = *x;
    }

    /// Writes the solution.
    pub(super) fn scatter(&self, x: &mut [f64]) {
        for (&u, z) in self.nodes.iter().zip(&self.z) {
            let u = u as usize;
            x[u..u + N].copy_from_slice(&z.0[..N]);
        }
        self.cap.scatter(x);
    }
}

impl Link {
    /// Its parts added to the node's block and to nothing, like those of [`pick`]; the coupling back goes to `back`.
    #[inline(never)]
    fn parts(&self, values: &[f64], diagonal: &Block, back: &mut Block) -> [Block; 3] {
        let mut parts = [*diagonal, ZERO, ZERO];
        let [diagonal, coupling, next] = &mut parts;
        self.add(values, diagonal, coupling, back, next);
        parts
    }

    /// Adds its parts to the node's block, to the couplings to and (transposed) from the next one, and to the next
    /// block.
    #[inline(never)]
    fn add(
        &self,
        values: &[f64],
        diagonal: &mut Block,
        coupling: &mut Block,
        back: &mut Block,
        next: &mut Block,
    ) {
        let (here, there) = if self.swapped { (N, 0) } else { (0, N) };
        add_part(diagonal, values, self.slot, 2 * N, here, here);
        add_part(coupling, values, self.slot, 2 * N, here, there);
        add_part(next, values, self.slot, 2 * N, there, there);
        let mut rows = ZERO;
        add_part(&mut rows, values, self.slot, 2 * N, there, here);
        for i in 0..N {
            for j in 0..N {
                back[j].0[i] += rows[i].0[j];
            }
        }
    }
}

/// A sweep over one or two arms: inwards with a right-hand side, or outwards with the solution.
pub(super) struct Sweep<'a> {
    pub(super) arm: &'a mut Arm,
    pub(super) other: Option<&'a mut Arm>,
    pub(super) way: Way<'a>,
    /// Which factors: of the matrix, or of its transpose.
    pub(super) side: usize,
}

/// Direction of a sweep.
#[derive(Clone, Copy)]
pub(super) enum Way<'a> {
    /// With the right-hand side; the output is what the middle node's is lessened by.
    Inwards(&'a [f64]),
    /// With the interface's solution at each end, and that of the middle node.
    Outwards([&'a [f64]; 2], Row),
}

impl Sweep<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> [Row; 2] {
        let Self { arm, other, way, side } = self;
        let n = arm.len();
        match (way, other) {
            (Way::Inwards(b), Some(other)) => {
                let (mut c, mut d) = (arm.start, other.start);
                for k in 0..other.len() {
                    arm.inward(l, &mut c, k, b, side);
                    other.inward(l, &mut d, k, b, side);
                }
                for k in other.len()..n {
                    arm.inward(l, &mut c, k, b, side);
                }
                [c, d]
            }
            (Way::Inwards(b), None) => {
                let mut c = arm.start;
                for k in 0..n {
                    arm.inward(l, &mut c, k, b, side);
                }
                [c; 2]
            }
            (Way::Outwards(known, middle), Some(other)) => {
                let (mut x, mut y) = (middle, middle);
                for k in (other.len()..n).rev() {
                    arm.outward(l, &mut x, k, known[0], side);
                }
                for k in (0..other.len()).rev() {
                    arm.outward(l, &mut x, k, known[0], side);
                    other.outward(l, &mut y, k, known[1], side);
                }
                [x, y]
            }
            (Way::Outwards(known, middle), None) => {
                let mut x = middle;
                for k in (0..n).rev() {
                    arm.outward(l, &mut x, k, known[0], side);
                }
                [x; 2]
            }
        }
    }
}

impl WithSimd for Sweep<'_> {
    type Output = [Row; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Row; 2] {
        match S::F64_LANES {
            8 => self.run(Wide::<S, 1>(simd)),
            4 => self.run(Wide::<S, 2>(simd)),
            2 => self.run(Wide::<S, 4>(simd)),
            _ => self.run(PLAIN),
        }
    }
}
