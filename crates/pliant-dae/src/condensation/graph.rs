//! Finds chains: paths of nodes that touch nothing but their two neighbours.

use crate::condensation::block::N;
use crate::structure::Structure;
use std::collections::HashMap;

/// Shorter chains are left to the interface.
const SHORTEST: usize = 3;
/// Largest private component, and widest interface, of an end [unknowns].
const WIDEST: usize = 18;

/// What a chain ends in.
#[derive(Clone, Debug, Default)]
pub(super) struct End {
    /// Groups that belong to this end alone; they are eliminated with the chain.
    pub(super) cap: Vec<u32>,
    /// Groups shared with others.
    pub(super) interface: Vec<u32>,
    /// Elements over the cap, the first node and the interface, counted here.
    pub(super) elements: Vec<usize>,
}

/// A path of nodes.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) nodes: Vec<u32>,
    /// Elements between successive nodes.
    pub(super) links: Vec<Vec<usize>>,
    /// Elements over one node alone.
    pub(super) own: Vec<Vec<usize>>,
    pub(super) ends: [End; 2],
}

/// Elements over the same set of several groups.
struct Edge {
    groups: Vec<u32>,
    elements: Vec<usize>,
}

/// The structure as a graph of groups.
struct Graph<'a> {
    structure: &'a Structure,
    edges: Vec<Edge>,
    /// Edges of each group.
    incident: Vec<Vec<u32>>,
    /// Elements over one group alone.
    own: Vec<Vec<usize>>,
    /// Whether a group may be inside a chain.
    inside: Vec<bool>,
}

impl<'a> Graph<'a> {
    fn new(structure: &'a Structure) -> Self {
        let count = structure.groups().len();
        let mut graph = Self {
            structure,
            edges: Vec::new(),
            incident: vec![Vec::new(); count],
            own: vec![Vec::new(); count],
            inside: Vec::new(),
        };
        let mut known: HashMap<Vec<u32>, usize> = HashMap::new();
        let mut repeated = vec![false; count];
        for e in 0..structure.elements() {
            let mut groups = structure.element(e).to_vec();
            groups.sort_unstable();
            let listed = groups.len();
            groups.dedup();
            if groups.len() < listed {
                for &g in &groups {
                    repeated[g as usize] = true;
                }
            }
            if let [group] = groups[..] {
                graph.own[group as usize].push(e);
            } else {
                let next = graph.edges.len();
                let edge = *known.entry(groups.clone()).or_insert(next);
                if edge == next {
                    for &g in &groups {
                        graph.incident[g as usize].push(next as u32);
                    }
                    graph.edges.push(Edge { groups, elements: Vec::new() });
                }
                graph.edges[edge].elements.push(e);
            }
        }
        let is_node = |g: u32| {
            let range = &structure.groups()[g as usize];
            range.len() == N && range.end <= structure.velocities()
        };
        graph.inside = (0..count as u32)
            .map(|g| {
                let edges = &graph.incident[g as usize];
                let linked = edges.iter().any(|&e| {
                    let groups = &graph.edges[e as usize].groups;
                    groups.len() == 2 && groups.iter().all(|&g| is_node(g))
                });
                is_node(g) && linked && edges.len() <= 2 && !repeated[g as usize]
            })
            .collect();
        // Where several nodes meet more than each other, none of them is inside a chain.
        for edge in &graph.edges {
            let nodes = edge.groups.iter().filter(|&&g| graph.inside[g as usize]).count();
            if nodes >= 2 && edge.groups.len() > 2 {
                for &g in &edge.groups {
                    graph.inside[g as usize] = false;
                }
            }
        }
        graph
    }

    fn size(&self, groups: &[u32]) -> usize {
        groups.iter().map(|&g| self.structure.groups()[g as usize].len()).sum()
    }

    /// The node beyond an edge, if it is inside a chain too.
    fn beyond(&self, edge: u32, node: u32) -> Option<u32> {
        match self.edges[edge as usize].groups[..] {
            [a, b] => Some(a + b - node).filter(|&g| self.inside[g as usize]),
            _ => None,
        }
    }

    fn neighbours(&self, node: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.incident[node as usize]
            .iter()
            .filter_map(move |&edge| self.beyond(edge, node).map(|next| (edge, next)))
    }

    /// Walks from an end node; returns nodes and the edges between them.
    fn walk(&self, start: u32, visited: &mut [bool]) -> (Vec<u32>, Vec<u32>) {
        let (mut nodes, mut edges) = (vec![start], Vec::new());
        visited[start as usize] = true;
        let mut at = start;
        while let Some((edge, next)) = self.neighbours(at).find(|(_, g)| !visited[*g as usize]) {
            visited[next as usize] = true;
            nodes.push(next);
            edges.push(edge);
            at = next;
        }
        (nodes, edges)
    }

    /// All paths; those too short, and one node of each ring, are taken out of the inside.
    fn walks(&mut self) -> Vec<(Vec<u32>, Vec<u32>)> {
        let count = self.inside.len() as u32;
        let mut visited = vec![false; count as usize];
        let mut walks = Vec::new();
        for rings in [false, true] {
            for g in 0..count {
                if !self.inside[g as usize] || visited[g as usize] {
                    continue;
                }
                let mut start = g;
                if rings {
                    let Some((_, next)) = self.neighbours(g).next() else { continue };
                    self.inside[g as usize] = false;
                    start = next;
                } else if self.neighbours(g).count() > 1 {
                    continue;
                }
                walks.push(self.walk(start, &mut visited));
            }
        }
        walks.retain(|(nodes, _)| {
            let long = nodes.len() >= SHORTEST;
            if !long {
                for &g in nodes {
                    self.inside[g as usize] = false;
                }
            }
            long
        });
        walks
    }

    /// The edge through which an end node leaves its chain.
    fn terminal(&self, node: u32, inner: u32) -> Option<u32> {
        self.incident[node as usize].iter().copied().find(|&e| e != inner)
    }
}

/// Sets of groups outside the chains that are connected outside of them.
struct Components {
    parent: Vec<u32>,
    members: Vec<Vec<u32>>,
    /// Number of chain ends at each.
    ends: Vec<usize>,
}

impl Components {
    fn new(graph: &Graph<'_>, walks: &[(Vec<u32>, Vec<u32>)]) -> Self {
        let count = graph.inside.len();
        let mut parent: Vec<u32> = (0..count as u32).collect();
        for edge in &graph.edges {
            let mut outside = edge.groups.iter().filter(|&&g| !graph.inside[g as usize]);
            if let Some(&first) = outside.next() {
                for &other in outside {
                    let (a, b) = (root(&mut parent, first), root(&mut parent, other));
                    parent[a.max(b) as usize] = a.min(b);
                }
            }
        }
        let mut members = vec![Vec::new(); count];
        for g in 0..count as u32 {
            let r = root(&mut parent, g);
            members[r as usize].push(g);
        }
        let mut this = Self { parent, members, ends: vec![0; count] };
        for (nodes, edges) in walks {
            for (node, inner) in end_nodes(nodes, edges) {
                if let Some(r) = graph.terminal(node, inner).and_then(|t| this.at(graph, t)) {
                    this.ends[r] += 1;
                }
            }
        }
        this
    }

    /// The component that an edge touches.
    fn at(&mut self, graph: &Graph<'_>, edge: u32) -> Option<usize> {
        let groups = &graph.edges[edge as usize].groups;
        let outside = groups.iter().find(|&&g| !graph.inside[g as usize])?;
        Some(root(&mut self.parent, *outside) as usize)
    }
}

fn root(parent: &mut [u32], mut g: u32) -> u32 {
    while parent[g as usize] != g {
        parent[g as usize] = parent[parent[g as usize] as usize];
        g = parent[g as usize];
    }
    g
}

/// Both end nodes of a walk, with the edge that leads inwards.
fn end_nodes(nodes: &[u32], edges: &[u32]) -> [(u32, u32); 2] {
    [(nodes[0], edges[0]), (nodes[nodes.len() - 1], edges[edges.len() - 1])]
}

/// All chains of a structure.
pub(super) fn paths(structure: &Structure) -> Vec<Path> {
    let mut graph = Graph::new(structure);
    let walks = graph.walks();
    let mut components = Components::new(&graph, &walks);
    let mut paths = Vec::with_capacity(walks.len());
    for (nodes, edges) in walks {
        let elements = |e: &u32| graph.edges[*e as usize].elements.clone();
        let mut path = Path {
            links: edges.iter().map(elements).collect(),
            own: nodes.iter().map(|&g| graph.own[g as usize].clone()).collect(),
            ends: Default::default(),
            nodes: nodes.clone(),
        };
        for (side, (node, inner)) in end_nodes(&nodes, &edges).into_iter().enumerate() {
            if let Some(terminal) = graph.terminal(node, inner) {
                finish(&graph, &mut components, &mut path, side, terminal);
            }
        }
        paths.push(path);
    }
    paths
}

/// Sorts what lies beyond an end into cap and interface.
fn finish(
    graph: &Graph<'_>,
    components: &mut Components,
    path: &mut Path,
    side: usize,
    terminal: u32,
) {
    let edge = &graph.edges[terminal as usize];
    let mut end = End { elements: edge.elements.clone(), ..End::default() };
    let component = components.at(graph, terminal);
    match component {
        Some(r) if components.ends[r] == 1 && graph.size(&components.members[r]) <= WIDEST => {
            end.cap.clone_from(&components.members[r]);
            let mut inner: Vec<u32> =
                end.cap.iter().flat_map(|&g| graph.incident[g as usize].clone()).collect();
            inner.sort_unstable();
            inner.dedup();
            for e in inner.into_iter().filter(|&e| e != terminal) {
                end.elements.extend(&graph.edges[e as usize].elements);
            }
        }
        _ => {
            for &g in edge.groups.iter().filter(|&&g| !graph.inside[g as usize]) {
                let private = graph.incident[g as usize].len() == 1;
                if private { &mut end.cap } else { &mut end.interface }.push(g);
            }
        }
    }
    for &g in &end.cap {
        end.elements.extend(&graph.own[g as usize]);
    }
    let velocities = graph.structure.velocities();
    let constrained =
        end.cap.iter().any(|&g| graph.structure.groups()[g as usize].start >= velocities);
    let wide = graph.size(&end.cap).max(graph.size(&end.interface)) > WIDEST;
    if constrained || wide {
        // Constraints need the node that they act on to be solvable; a crowd is left to the interface with it.
        let (node, own, link) = if side == 0 {
            (path.nodes.remove(0), path.own.remove(0), path.links.remove(0))
        } else {
            let last = path.nodes.len() - 1;
            (path.nodes.remove(last), path.own.remove(last), path.links.remove(last - 1))
        };
        if wide {
            end = End { interface: vec![node], ..End::default() };
        } else {
            end.cap.push(node);
            end.elements.extend(own);
        }
        end.elements.extend(link);
    }
    path.ends[side] = end;
}
