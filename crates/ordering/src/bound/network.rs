//! Least cuts in a graph.

/// A graph with capacities.
pub(super) struct Network {
    rows: Vec<u32>,
    /// Head of each arc, and the number of the arc back.
    arcs: Vec<(u32, u32)>,
    capacities: Vec<u32>,
}

impl Network {
    /// One in which edges lead either way.
    pub(super) fn new(nodes: u32, edges: impl Iterator<Item = (u32, u32, u32)>) -> Self {
        Self::of(nodes, edges.flat_map(|(u, v, used)| [(u, v, used), (v, u, used)]))
    }

    /// One in which edges lead from their first node to their second only.
    #[cfg(feature = "highs")]
    pub(super) fn directed(nodes: u32, edges: impl Iterator<Item = (u32, u32, u32)>) -> Self {
        Self::of(nodes, edges.filter(|edge| edge.2 > 0).flat_map(|(u, v, used)| [(u, v, used), (v, u, 0)]))
    }

    /// One with these arcs and, if they have capacity, those back.
    fn of(nodes: u32, arcs: impl Iterator<Item = (u32, u32, u32)>) -> Self {
        let mut arcs: Vec<_> = arcs.filter(|arc| arc.0 != arc.1).collect();
        arcs.sort_unstable();
        let both: Vec<(u32, u32, u32)> = arcs
            .chunk_by(|e, f| (e.0, e.1) == (f.0, f.1))
            .map(|same| (same[0].0, same[0].1, same.iter().map(|arc| arc.2).sum()))
            .collect();
        let row = |u: u32, v: u32| both.partition_point(|arc| (arc.0, arc.1) < (u, v)) as u32;
        Self {
            rows: (0..=nodes).map(|u| row(u, 0)).collect(),
            arcs: both.iter().map(|&(u, v, _)| (v, row(v, u))).collect(),
            capacities: both.iter().map(|arc| arc.2).collect(),
        }
    }

    /// The sources' side of a least cut, if it is below `enough`; each source gives no more than its limit. Edmonds & Karp 1972
    /// (<https://doi.org/10.1145/321694.321699>).
    pub(super) fn least_cut(&self, sources: &[(u32, u32)], sinks: &[u32], enough: u32) -> Option<Vec<bool>> {
        const NONE: u32 = u32::MAX;
        let nodes = self.rows.len() - 1;
        let mut left = self.capacities.clone();
        let mut limits: Vec<u32> = sources.iter().map(|&(_, limit)| limit).collect();
        let mut flow = 0;
        let (mut by, mut reached, mut queue) = (vec![NONE; nodes], vec![false; nodes], Vec::new());
        while flow < enough {
            by.fill(NONE);
            reached.fill(false);
            queue.clear();
            for (&(source, _), _) in sources.iter().zip(&limits).filter(|&(_, &limit)| limit > 0) {
                reached[source as usize] = true;
                queue.push(source);
            }
            if queue.is_empty() {
                return None;
            }
            let mut at = 0;
            while at < queue.len() && !sinks.iter().any(|&sink| reached[sink as usize]) {
                let u = queue[at];
                at += 1;
                for arc in self.rows[u as usize]..self.rows[u as usize + 1] {
                    let (v, _) = self.arcs[arc as usize];
                    if left[arc as usize] > 0 && !std::mem::replace(&mut reached[v as usize], true) {
                        by[v as usize] = arc;
                        queue.push(v);
                    }
                }
            }
            let Some(&sink) = sinks.iter().find(|&&sink| reached[sink as usize]) else {
                return Some(reached);
            };
            let path = || {
                std::iter::successors(Some(by[sink as usize]), |&arc| {
                    let (tail, _) = self.arcs[self.arcs[arc as usize].1 as usize];
                    Some(by[tail as usize]).filter(|&arc| arc != NONE)
                })
            };
            let source = path().last().map_or(sink, |arc| self.arcs[self.arcs[arc as usize].1 as usize].0);
            let from = sources.iter().zip(&mut limits).find(|((at, _), limit)| *at == source && **limit > 0);
            let (_, limit) = from?;
            let more = path().map(|arc| left[arc as usize]).min().unwrap_or(enough).min(*limit);
            *limit -= more;
            for arc in path() {
                left[arc as usize] -= more;
                left[self.arcs[arc as usize].1 as usize] += more;
            }
            flow += more;
        }
        None
    }
}
