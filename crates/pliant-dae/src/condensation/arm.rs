//! One half of a chain: its nodes from an end inwards, up to but without the middle node.

use super::block::{
    Block, N, Row, ZERO, add_part, combine, invert, invert_pivoted, pick, product,
    subtract_transposed_product, transpose,
};
use super::cap::Cap;
use super::graph::Path;
use crate::structure::{Slot, Storage, Structure};
use pulp::{Simd, WithSimd};

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
    /// Columns of D^-1 and rows of the forward factor.
    inward: Vec<[Block; 2]>,
    /// Columns of `W = D^-1 C`.
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
                inward: vec![[ZERO; 2]; n],
                outward: vec![ZERO; n],
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
    pub(super) fn eliminate<const FMA: bool, const SYMMETRIC: bool>(
        &mut self,
        carry: &mut Carry,
        k: usize,
        values: &[f64],
    ) {
        let link = self.links[k];
        let mut diagonal = carry.diagonal;
        let mut coupling;
        let mut back = ZERO;
        let mut next;
        let Slot { base, stride, storage } = link.slot;
        if SYMMETRIC && stride == 8 {
            (coupling, next) = pick::<8>(values, base, link.swapped, &mut diagonal);
        } else if SYMMETRIC && stride == 1 && storage == Storage::Symmetric {
            (coupling, next) = pick::<1>(values, base, link.swapped, &mut diagonal);
        } else {
            (coupling, next) = (ZERO, ZERO);
            link.add(values, &mut diagonal, &mut coupling, &mut back, &mut next);
        }
        if self.next_own < self.own.len() || self.next_double < self.doubles.len() {
            self.extras(k, values, &mut diagonal, &mut coupling, &mut back, &mut next);
        }
        let (mut inverse, safe) = invert::<FMA>(&diagonal);
        if !safe {
            carry.suspect = true;
            match invert_pivoted(&diagonal) {
                Ok(pivoted) => inverse = pivoted,
                Err(_) => {
                    carry.failed = carry.failed.or(Some(k));
                }
            }
        }
        let w = product::<FMA>(&inverse, &coupling);
        let [plain, transposed] = &mut self.sides;
        if SYMMETRIC {
            subtract_transposed_product::<FMA>(&mut next, &coupling, &w);
            plain.inward[k] = [inverse, w];
            plain.outward[k] = transpose(&w);
            if self.width > 0 {
                self.extend::<FMA>(k, &inverse, &coupling);
            }
        } else {
            // `back` holds E^T; x = D^-T E^T carries right-hand sides inwards.
            let inverse_columns = transpose(&inverse);
            let x = product::<FMA>(&inverse_columns, &back);
            subtract_transposed_product::<FMA>(&mut next, &back, &w);
            plain.inward[k] = [inverse_columns, x];
            plain.outward[k] = transpose(&w);
            transposed.inward[k] = [inverse, w];
            transposed.outward[k] = transpose(&x);
            if self.width > 0 {
                self.extend_both::<FMA>(k, &inverse, &coupling, &back);
            }
        }
        carry.diagonal = next;
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
    fn extend<const FMA: bool>(&mut self, k: usize, inverse: &Block, coupling: &Block) {
        let m = self.width;
        let factors = &mut self.sides[0];
        let spread = &mut factors.spread[k * m..(k + 1) * m];
        for c in 0..m {
            spread[c] = combine::<FMA>(inverse, &self.reach[c]);
        }
        for c in 0..m {
            for d in 0..m {
                let mut lanes = Row::default();
                lanes.add_products::<FMA>(&self.reach[c], &spread[d]);
                self.schur[c * m + d] -= lanes.sum();
            }
        }
        for c in 0..m {
            self.reach[c] = Row::default().minus(&combine::<FMA>(coupling, &spread[c]));
        }
    }

    /// The same for an unsymmetric matrix.
    #[inline(always)]
    fn extend_both<const FMA: bool>(
        &mut self,
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
            plain.spread[at + c] = combine::<FMA>(&inverse_columns, &self.reach[c]);
            plain.gather[at + c] = combine::<FMA>(inverse, &self.reach_rows[c]);
            transposed.gather[at + c] = plain.spread[at + c];
            transposed.spread[at + c] = plain.gather[at + c];
        }
        for c in 0..m {
            for d in 0..m {
                let mut lanes = Row::default();
                lanes.add_products::<FMA>(&self.reach_rows[c], &plain.spread[at + d]);
                self.schur[c * m + d] -= lanes.sum();
            }
        }
        for c in 0..m {
            let (v, u) = (&plain.spread[at + c], &plain.gather[at + c]);
            self.reach[c] = Row::default().minus(&combine::<FMA>(back, v));
            self.reach_rows[c] = Row::default().minus(&combine::<FMA>(coupling, u));
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
    fn inward<const FMA: bool>(&mut self, carry: &mut Row, k: usize, b: &[f64], side: usize) {
        let y = Row::load(&b[self.nodes[k] as usize..]).minus(carry);
        let factors = &self.sides[side];
        let [inverse, forward] = &factors.inward[k];
        *carry = combine::<FMA>(forward, &y);
        self.z[k] = combine::<FMA>(inverse, &y);
        let m = self.width;
        if m > 0 {
            let rows = if self.symmetric { &factors.spread } else { &factors.gather };
            for (share, row) in self.shares.iter_mut().zip(&rows[k * m..(k + 1) * m]) {
                share.add_products::<FMA>(row, &y);
            }
        }
    }

    /// Takes the solution from the next node to node `k`.
    #[inline(always)]
    fn outward<const FMA: bool>(&mut self, x: &mut Row, k: usize, known: &[f64], side: usize) {
        let factors = &self.sides[side];
        let mut z = self.z[k];
        let m = self.width;
        if m > 0 {
            for (x, row) in known.iter().zip(&factors.spread[k * m..(k + 1) * m]) {
                z.add::<FMA>(-x, row);
            }
        }
        *x = z.minus(&combine::<FMA>(&factors.outward[k], x));
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

/// A sweep over one or both arms: inwards with a right-hand side, or outwards with the solution.
pub(super) struct Sweep<'a> {
    arms: [Option<&'a mut Arm>; 2],
    side: usize,
    way: Way<'a>,
}

enum Way<'a> {
    Inwards(&'a [f64]),
    Outwards([&'a [f64]; 2], Row),
}

impl<'a> Sweep<'a> {
    /// Inwards; the output is what both arms take from the middle node.
    pub(super) fn forward(arms: [Option<&'a mut Arm>; 2], b: &'a [f64], side: usize) -> Self {
        Self { arms, side, way: Way::Inwards(b) }
    }

    /// Outwards from the solution `middle`, with the interface `known` at each end.
    pub(super) fn backward(
        arms: [Option<&'a mut Arm>; 2],
        known: [&'a [f64]; 2],
        middle: Row,
        side: usize,
    ) -> Self {
        Self { arms, side, way: Way::Outwards(known, middle) }
    }

    #[inline(always)]
    fn run<const FMA: bool>(self) -> [Row; 2] {
        let side = self.side;
        let mut carries = [Row::default(); 2];
        let [mut left, mut right] = self.arms;
        let length = |arm: &Option<&mut Arm>| arm.as_ref().map_or(0, |arm| arm.len());
        let (n, m) = (length(&left), length(&right));
        match self.way {
            Way::Inwards(b) => {
                for (carry, arm) in carries.iter_mut().zip([&left, &right]) {
                    *carry = arm.as_ref().map_or(Row::default(), |arm| arm.start);
                }
                for k in 0..n.max(m) {
                    if let Some(arm) = left.as_mut().filter(|_| k < n) {
                        arm.inward::<FMA>(&mut carries[0], k, b, side);
                    }
                    if let Some(arm) = right.as_mut().filter(|_| k < m) {
                        arm.inward::<FMA>(&mut carries[1], k, b, side);
                    }
                }
            }
            Way::Outwards(known, middle) => {
                carries = [middle; 2];
                for back in 1..=n.max(m) {
                    if let Some(arm) = left.as_mut().filter(|_| back <= n) {
                        arm.outward::<FMA>(&mut carries[0], n - back, known[0], side);
                    }
                    if let Some(arm) = right.as_mut().filter(|_| back <= m) {
                        arm.outward::<FMA>(&mut carries[1], m - back, known[1], side);
                    }
                }
            }
        }
        carries
    }
}

impl WithSimd for Sweep<'_> {
    type Output = [Row; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [Row; 2] {
        if S::IS_SCALAR { self.run::<false>() } else { self.run::<true>() }
    }
}
