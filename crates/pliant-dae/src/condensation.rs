//! Exact elimination of chains: paths of nodes that touch nothing but their neighbours. What is left, the interface,
//! is solved by the dense or the sparse back end.
//!
//! A matrix may be regular though a chain's own part of it is not (or nearly so). Blocks that needed pivoting have
//! the factorisation probed by a known solution: a poor one is refined, a useless one replaced by the sparse back
//! end for this factorisation.

mod arm;
mod block;
mod cap;
mod chain;
mod graph;

use crate::linear_solver::{FactorError, LinearSolver, Options, choose, non_finite_element};
use crate::sparse::Sparse;
use crate::structure::{Slot, Storage, Structure, entries};
use chain::Chain;
use rayon::prelude::*;

/// Fewer nodes than this in all chains are not worth other threads.
const WORTH_THREADS: usize = 2000;
/// Relative residual of the probe above which solutions are refined.
const POOR: f64 = 1e-8;
/// Relative residual of the probe above which the factors are useless.
const USELESS: f64 = 1e-3;

/// How solutions come about after the last factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Plain,
    Refined,
    Sparse,
}

/// Back end for chains.
pub(crate) struct Condensed {
    chains: Vec<Chain>,
    nodes: usize,
    parallel: bool,
    interface: Option<Interface>,
    mode: Mode,
    /// Takes over where condensation fails; made when it first does.
    sparse: Option<Box<Sparse>>,
    /// The matrix, kept only where solutions are refined.
    kept: Option<(Structure, Vec<f64>)>,
    right: Vec<f64>,
}

/// What chains leave: a smaller system of the same form.
struct Interface {
    structure: Structure,
    values: Vec<f64>,
    solver: Box<dyn LinearSolver>,
    /// Elements outside of all chains: their place in the problem's values and here, and their number of entries.
    moves: Vec<(Slot, usize, usize)>,
    /// For each entry of each chain's condensed matrix, its place here.
    condensed: Vec<Vec<(u32, u32)>>,
    /// The unknown of the problem for each unknown here, and the inverse.
    unknowns: Vec<u32>,
    place: Vec<u32>,
    x: Vec<f64>,
}

impl Condensed {
    /// The back end, if there are chains.
    pub(crate) fn new(
        structure: &Structure,
        options: Options,
    ) -> Result<Option<Self>, FactorError> {
        let paths = graph::paths(structure);
        if paths.is_empty() {
            return Ok(None);
        }
        let mut used = vec![false; structure.elements()];
        let mut gone = vec![false; structure.groups().len()];
        let mut chains = Vec::with_capacity(paths.len());
        for path in &paths {
            let inner = path.links.iter().chain(&path.own).flatten();
            let at_ends = path.ends.iter().flat_map(|end| &end.elements);
            let mut symmetric = true;
            for &e in inner.chain(at_ends) {
                used[e] = true;
                symmetric &= structure.slot(e).storage == Storage::Symmetric;
            }
            for &g in path.nodes.iter().chain(path.ends.iter().flat_map(|end| &end.cap)) {
                gone[g as usize] = true;
            }
            chains.push(Chain::new(structure, path, symmetric));
        }
        Ok(Some(Self {
            nodes: chains.iter().map(Chain::len).sum(),
            interface: Interface::new(structure, &chains, &used, &gone, options)?,
            chains,
            parallel: options.parallel,
            mode: Mode::Plain,
            sparse: None,
            kept: None,
            right: Vec::new(),
        }))
    }

    fn in_threads(&self) -> bool {
        self.parallel && self.nodes >= WORTH_THREADS
    }

    /// Applies `task` to all chains, in threads where that pays; chains share nothing.
    fn for_all(&mut self, task: impl Fn(&mut Chain, bool) + Sync + Send) {
        let threads = self.in_threads();
        match &mut self.chains[..] {
            [single] => task(single, threads),
            many if threads => {
                let grain = (WORTH_THREADS / 4 * many.len() / self.nodes).max(1);
                many.par_iter_mut().with_min_len(grain).for_each(|chain| task(chain, false));
            }
            few => few.iter_mut().for_each(|chain| task(chain, false)),
        }
    }

    fn condense(&mut self, values: &[f64]) -> bool {
        self.for_all(|chain, threads| chain.factor(values, threads));
        if self.chains.iter().any(|chain| chain.failed.is_some()) {
            return false;
        }
        let Self { interface, chains, .. } = self;
        interface.as_mut().is_none_or(|interface| interface.factor(chains, values).is_ok())
    }

    fn solve_condensed(&mut self, x: &mut [f64], transposed: bool, exact: bool) {
        let b = &*x;
        self.for_all(|chain, threads| chain.forward(b, transposed, threads));
        let Self { interface, chains, .. } = self;
        if let Some(interface) = interface {
            interface.solve(chains, x, transposed, exact);
        }
        let known = &*x;
        self.for_all(|chain, threads| {
            chain.set_known(|u| known[u]);
            chain.backward(transposed, threads);
        });
        for chain in &self.chains {
            chain.scatter(x);
        }
    }

    /// Relative residual of a system with a known solution of size one.
    fn probe(&mut self, structure: &Structure, values: &[f64]) -> f64 {
        let n = structure.unknowns();
        let known: Vec<f64> =
            (0..n).map(|i| if (i * 2_654_435_761) & 64 == 0 { 1.0 } else { -1.0 }).collect();
        let mut b = vec![0.0; n];
        structure.multiply_add(values, &known, &mut b, false);
        let mut x = b.clone();
        self.solve_condensed(&mut x, false, true);
        let error: Vec<f64> = x.iter().zip(&known).map(|(x, k)| x - k).collect();
        let mut residual = vec![0.0; n];
        structure.multiply_add(values, &error, &mut residual, false);
        let size = b.iter().fold(f64::MIN_POSITIVE, |m, b| m.max(b.abs()));
        let worst = residual.iter().map(|r| r.abs() / size);
        worst.fold(0.0, |m, r| if r.is_nan() { f64::INFINITY } else { f64::max(m, r) })
    }

    fn solve_with(&mut self, x: &mut [f64], transposed: bool, exact: bool) {
        match (self.mode, &mut self.sparse) {
            (Mode::Sparse, Some(sparse)) if transposed => return sparse.solve_transposed(x),
            (Mode::Sparse, Some(sparse)) if exact => return sparse.solve(x),
            (Mode::Sparse, Some(sparse)) => return sparse.correct(x),
            _ => {}
        }
        if self.mode == Mode::Plain {
            return self.solve_condensed(x, transposed, exact);
        }
        let mut right = std::mem::take(&mut self.right);
        right.clear();
        right.extend(x.iter().map(|x| -x));
        self.solve_condensed(x, transposed, true);
        if let Some((structure, values)) = &self.kept {
            structure.multiply_add(values, x, &mut right, transposed);
            self.solve_condensed(&mut right, transposed, true);
            for (x, correction) in x.iter_mut().zip(&right) {
                *x -= correction;
            }
        }
        self.right = right;
    }

    fn keep(&mut self, structure: &Structure, values: &[f64]) {
        match &mut self.kept {
            Some((_, kept)) => kept.copy_from_slice(values),
            None => self.kept = Some((structure.clone(), values.to_vec())),
        }
    }
}

impl LinearSolver for Condensed {
    fn factor(&mut self, structure: &Structure, values: &[f64]) -> Result<(), FactorError> {
        self.mode = Mode::Plain;
        if self.condense(values) {
            if !self.chains.iter().any(|chain| chain.suspect) {
                return Ok(());
            }
            let residual = self.probe(structure, values);
            if residual < POOR {
                return Ok(());
            }
            if residual < USELESS {
                self.mode = Mode::Refined;
                self.keep(structure, values);
                return Ok(());
            }
        }
        if let Some(element) = non_finite_element(structure, values) {
            return Err(FactorError::NotFinite { element });
        }
        self.mode = Mode::Sparse;
        let mut sparse = match self.sparse.take() {
            Some(sparse) => sparse,
            None => Box::new(Sparse::new(structure)?),
        };
        let outcome = sparse.factor(structure, values);
        self.sparse = Some(sparse);
        outcome
    }

    fn solve(&mut self, x: &mut [f64]) {
        self.solve_with(x, false, true);
    }

    fn correct(&mut self, x: &mut [f64]) {
        self.solve_with(x, false, false);
    }

    fn solve_transposed(&mut self, x: &mut [f64]) {
        self.solve_with(x, true, true);
    }

    fn factor_cost(&self) -> f64 {
        let interface = self.interface.as_ref().map_or(0.0, |interface| {
            let part = interface.structure.unknowns() as f64 / (6 * self.nodes) as f64;
            part.min(1.0) * interface.solver.factor_cost()
        });
        5.5 + interface
    }

    fn describe(&self) -> String {
        let count = self.chains.len();
        let plural = if count == 1 { "" } else { "s" };
        let chains = format!("condensed: {count} chain{plural} of {} nodes", self.nodes);
        match &self.interface {
            None => chains,
            Some(interface) => format!("{chains}, interface {}", interface.solver.describe()),
        }
    }
}

impl Interface {
    fn new(
        structure: &Structure,
        chains: &[Chain],
        used: &[bool],
        gone: &[bool],
        options: Options,
    ) -> Result<Option<Self>, FactorError> {
        let mut left: Vec<usize> = (0..gone.len()).filter(|&g| !gone[g]).collect();
        if left.is_empty() {
            return Ok(None);
        }
        left.sort_unstable_by_key(|&g| structure.groups()[g].start);
        let count = |multipliers: bool| -> usize {
            let groups = left.iter().map(|&g| &structure.groups()[g]);
            let kind = groups.filter(|r| (r.start >= structure.velocities()) == multipliers);
            kind.map(|r| r.len()).sum()
        };
        let mut reduced = Structure::new(count(false), count(true));
        let mut unknowns = Vec::new();
        let mut place = vec![u32::MAX; structure.unknowns()];
        let mut group_here = vec![usize::MAX; gone.len()];
        let mut group_of = vec![0; structure.unknowns()];
        for &g in &left {
            let range = structure.groups()[g].clone();
            group_here[g] = reduced.add_group(unknowns.len()..unknowns.len() + range.len());
            for u in range {
                place[u] = unknowns.len() as u32;
                group_of[u] = group_here[g];
                unknowns.push(u as u32);
            }
        }
        let mut moves = Vec::new();
        for e in (0..structure.elements()).filter(|&e| !used[e]) {
            let groups: Vec<usize> =
                structure.element(e).iter().map(|&g| group_here[g as usize]).collect();
            let slot = structure.slot(e);
            let here = reduced.add_element(&groups, slot.storage);
            let size = entries(structure.element_unknowns(e).count(), slot.storage);
            moves.push((slot, reduced.slot(here).base, size));
        }
        let condensed = chains
            .iter()
            .map(|chain| add_condensed(&mut reduced, chain, &place, &group_of))
            .collect();
        let solver = choose(&reduced, Options { condense: false, ..options })?;
        Ok(Some(Self {
            values: vec![0.0; reduced.values()],
            solver,
            moves,
            condensed,
            x: vec![0.0; unknowns.len()],
            structure: reduced,
            unknowns,
            place,
        }))
    }

    fn factor(&mut self, chains: &[Chain], values: &[f64]) -> Result<(), FactorError> {
        self.values.fill(0.0);
        for &(slot, to, count) in &self.moves {
            for k in 0..count {
                self.values[to + k] = values[slot.base + k * slot.stride];
            }
        }
        for (chain, moves) in chains.iter().zip(&self.condensed) {
            for &(from, to) in moves {
                self.values[to as usize] += chain.condensed[from as usize];
            }
        }
        self.solver.factor(&self.structure, &self.values)
    }

    /// Replaces the interface's part of the right-hand side by the solution, unless `exact` by one good for corrections.
    fn solve(&mut self, chains: &[Chain], x: &mut [f64], transposed: bool, exact: bool) {
        for (here, &u) in self.x.iter_mut().zip(&self.unknowns) {
            *here = x[u as usize];
        }
        for chain in chains {
            for (share, &u) in chain.share.iter().zip(&chain.interface) {
                self.x[self.place[u as usize] as usize] -= share;
            }
        }
        if transposed {
            self.solver.solve_transposed(&mut self.x);
        } else if exact {
            self.solver.solve(&mut self.x);
        } else {
            self.solver.correct(&mut self.x);
        }
        for (here, &u) in self.x.iter().zip(&self.unknowns) {
            x[u as usize] = *here;
        }
    }
}

/// Adds the element that a chain leaves; returns where each entry of its matrix goes.
fn add_condensed(
    reduced: &mut Structure,
    chain: &Chain,
    place: &[u32],
    group_of: &[usize],
) -> Vec<(u32, u32)> {
    let m = chain.interface.len();
    if m == 0 {
        return Vec::new();
    }
    let mut groups: Vec<usize> = chain.interface.iter().map(|&u| group_of[u as usize]).collect();
    groups.sort_unstable();
    // Both ends may share a group.
    groups.dedup();
    let symmetric = chain.is_symmetric();
    let storage = if symmetric { Storage::Symmetric } else { Storage::Full };
    let element = reduced.add_element(&groups, storage);
    let local: Vec<usize> = reduced.element_unknowns(element).collect();
    let n = local.len();
    let position = |c: usize| -> usize {
        let here = place[chain.interface[c] as usize] as usize;
        local.iter().position(|&u| u == here).unwrap_or(0)
    };
    let base = reduced.slot(element).base;
    let mut moves = Vec::with_capacity(m * m);
    for a in 0..m {
        for b in 0..m {
            let (i, j) = (position(a), position(b));
            if !symmetric || j <= i {
                let k = crate::structure::entry_number(n, i, j, storage);
                moves.push(((a * m + b) as u32, (base + k) as u32));
            }
        }
    }
    moves
}
