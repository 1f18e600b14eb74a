//! The problem, what a plan for it costs, and what contradicts itself.

/// Heating counts on layers of up to so many tools: each such layer has a table of its own.
const MOST_HEATED: usize = 8;

/// The tools of one layer. Each is loaded once on it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ToolLayer {
    /// Each once, in any order.
    pub tools: Vec<u32>,
    /// How long each of them prints, while others are heated, in the unit of the costs; empty: long enough for any.
    pub prints: Vec<u32>,
    /// Pairs of which the first comes before the second; those of which the layer has only one say nothing.
    pub before: Vec<(u32, u32)>,
}

/// Which tools each layer of a print needs, and what changes cost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ToolProblem {
    /// From the bottom up; layers without tools are passed over.
    pub layers: Vec<ToolLayer>,
    /// What it costs to change `[from]` a tool `[to]` another, in any unit, say milliseconds; as many rows and columns as tools.
    pub change: Vec<Vec<u32>>,
    /// What heating each tool again takes; empty: none has cooled down.
    pub heating: Vec<ToolHeating>,
    /// The tool that is loaded when the print begins; `None`: whichever comes first costs nothing.
    pub loaded: Option<u32>,
}

/// A tool that cools down while others print. It is heated again in time for its turn, but not before the layer begins: what is
/// then left to wait for adds to the cost of the change. Layers of more than eight tools are ordered as if none had to be
/// waited for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ToolHeating {
    /// How long the change to it takes, until it prints, in the unit of the costs.
    pub change: u32,
    /// How long before the change it must be heated.
    pub ahead: u32,
}

/// The order of tools on every layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToolPlan {
    /// The tools of each layer in the order in which they print.
    pub layers: Vec<Vec<u32>>,
    /// How often the tool is changed.
    pub changes: u64,
    /// What the changes cost together.
    pub cost: u64,
    /// What no order costs less than; only of [`Optimal`](super::ToolOrder::Optimal), where it equals the cost unless a layer has
    /// more than 20 tools.
    pub bound: Option<u64>,
}

/// Why a problem or the order given for it contradicts itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum ToolError {
    #[error("there is no tool {tool} on layer {layer}: costs are given for {tools}")]
    NoSuchTool { layer: usize, tool: u32, tools: usize },
    #[error("tool {tool} is loaded at first, but costs are given for {tools} tools")]
    NoSuchLoaded { tool: u32, tools: usize },
    #[error("tool {tool} is listed twice on layer {layer}")]
    Twice { layer: usize, tool: u32 },
    #[error("on layer {layer} tool {tool} must come before itself")]
    Circle { layer: usize, tool: u32 },
    #[error("row {row} of the costs has {found} columns instead of {wanted}")]
    NotSquare { row: usize, found: usize, wanted: usize },
    #[error("heating is given for {found} tools instead of {wanted}")]
    Heating { found: usize, wanted: usize },
    #[error("layer {layer} has {wanted} tools, but says of {found} how long they print")]
    Prints { layer: usize, found: usize, wanted: usize },
    #[error("a change that costs {most} is too much for {changes} changes; use a larger unit")]
    TooMuch { most: u32, changes: u64 },
    #[error("the order of layer {layer} is not that of its tools")]
    OtherTools { layer: usize },
    #[error("on layer {layer} tool {first} has to come before tool {second}")]
    Precedence { layer: usize, first: u32, second: u32 },
    #[error("{found} layers were ordered of {wanted}")]
    Layers { found: usize, wanted: usize },
}

/// Costs for which fewer changes are better among orders that cost the same.
pub(super) struct Weights<'a> {
    change: &'a [Vec<u32>],
    heating: &'a [ToolHeating],
    scale: u64,
}

/// How long it is since a layer began, at least, when the next tool is taken: what its tools took, and what the last to be waited
/// for could not be before. A set of tools and its first say both, whatever the order.
#[derive(Clone, Copy, Default)]
pub(super) struct Elapsed {
    sum: u64,
    waited: u64,
}

/// When the tools of a layer are hot.
pub(super) struct Heat<'a> {
    weights: &'a Weights<'a>,
    /// How long each prints; `None`: none is waited for.
    prints: Option<&'a [u32]>,
}

impl<'a> Heat<'a> {
    /// `prints`: of the tools of a layer, ascending, [where that matters](ToolLayer::waited_for).
    pub fn new(prints: Option<&'a [u32]>, weights: &'a Weights<'a>) -> Self {
        Self { weights, prints }
    }

    /// When a tool, which is the layer's n-th, has printed as well. `change`: it had to be taken.
    pub fn after(&self, before: Elapsed, n: usize, tool: u32, change: bool) -> Elapsed {
        let Some(prints) = self.prints else { return before };
        let own = self.weights.heating(tool);
        let change_and_prints = u64::from(own.change) + u64::from(prints[n]);
        let (took, waited) = match change {
            true => (change_and_prints, u64::from(own.ahead) + change_and_prints),
            false => (u64::from(prints[n]), 0),
        };
        Elapsed { sum: before.sum + took, waited: before.waited.max(waited) }
    }

    /// Weight of the waiting for a tool that is taken then.
    pub fn wait(&self, at: Elapsed, tool: u32) -> u64 {
        if self.prints.is_none() {
            return 0;
        }
        u64::from(self.weights.heating(tool).ahead).saturating_sub(at.sum.max(at.waited)) * self.weights.scale
    }
}

impl Weights<'_> {
    pub fn of(&self, from: u32, to: u32) -> u64 {
        if from == to { 0 } else { u64::from(self.change[from as usize][to as usize]) * self.scale + 1 }
    }

    fn heating(&self, tool: u32) -> ToolHeating {
        self.heating.get(tool as usize).copied().unwrap_or_default()
    }

    /// Weight of the waiting for a tool that a layer begins with and that was not loaded.
    pub fn first_wait(&self, layer: usize, tool: u32) -> u64 {
        if layer > MOST_HEATED { 0 } else { u64::from(self.heating(tool).ahead) * self.scale }
    }

    /// The cost that a sum of weights stands for.
    pub fn cost(&self, weight: u64) -> u64 {
        weight / self.scale
    }

    pub fn tools(&self) -> u32 {
        self.change.len() as u32
    }
}

impl ToolLayer {
    /// How long each of its tools, ascending, prints, where one of them may have to be waited for after another.
    pub(super) fn waited_for(&self, weights: &Weights) -> Option<Vec<u32>> {
        if self.tools.len() > MOST_HEATED || self.prints.is_empty() {
            return None;
        }
        let longest = self.tools.iter().map(|tool| weights.heating(*tool).ahead).max()?;
        if self.prints.iter().all(|prints| *prints >= longest) {
            return None;
        }
        let mut both: Vec<(u32, u32)> = self.tools.iter().copied().zip(self.prints.iter().copied()).collect();
        both.sort_unstable();
        Some(both.into_iter().map(|(_, prints)| prints.min(longest)).collect())
    }

    pub(super) fn sorted(&self) -> Vec<u32> {
        let mut tools = self.tools.clone();
        tools.sort_unstable();
        tools
    }

    /// Tools that have to be done when `tool` is begun.
    pub(super) fn needed(&self, tool: u32) -> impl Iterator<Item = u32> {
        let pairs = self.before.iter().filter(move |pair| pair.1 == tool);
        pairs.map(|pair| pair.0).filter(|first| self.tools.contains(first))
    }

    /// Its tools by ascending number, later only where one must wait for another.
    ///
    /// # Errors
    /// A tool that waits for itself.
    pub(super) fn ascending(&self) -> Result<Vec<u32>, u32> {
        let mut left = self.tools.clone();
        left.sort_unstable();
        let mut order = Vec::with_capacity(left.len());
        while let Some(&stuck) = left.first() {
            let free = left
                .iter()
                .position(|&tool| self.needed(tool).all(|first| order.contains(&first)))
                .ok_or(stuck)?;
            order.push(left.remove(free));
        }
        Ok(order)
    }
}

impl ToolProblem {
    /// The costs, after everything was looked at that can be wrong.
    pub(super) fn weights(&self) -> Result<Weights<'_>, ToolError> {
        let tools = self.change.len();
        if let Some((row, costs)) = self.change.iter().enumerate().find(|(_, costs)| costs.len() != tools) {
            return Err(ToolError::NotSquare { row, found: costs.len(), wanted: tools });
        }
        if let Some(tool) = self.loaded.filter(|&tool| tool as usize >= tools) {
            return Err(ToolError::NoSuchLoaded { tool, tools });
        }
        if !self.heating.is_empty() && self.heating.len() != tools {
            return Err(ToolError::Heating { found: self.heating.len(), wanted: tools });
        }
        for (layer, at) in self.layers.iter().enumerate() {
            let (found, wanted) = (at.prints.len(), at.tools.len());
            if found > 0 && found != wanted {
                return Err(ToolError::Prints { layer, found, wanted });
            }
            if let Some(&tool) = at.tools.iter().find(|&&tool| tool as usize >= tools) {
                return Err(ToolError::NoSuchTool { layer, tool, tools });
            }
            if let Some(pair) = at.sorted().windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(ToolError::Twice { layer, tool: pair[0] });
            }
            at.ascending().map_err(|tool| ToolError::Circle { layer, tool })?;
        }
        let changes: u64 = self.layers.iter().map(|layer| layer.tools.len() as u64).sum();
        let most = self.change.iter().flatten().copied().max().unwrap_or(0);
        let most = most.saturating_add(self.heating.iter().map(|own| own.ahead).max().unwrap_or(0));
        let scale = changes + 1;
        // What is not possible counts u64::MAX / 4.
        let total = (u64::from(most) + 1).checked_mul(scale).and_then(|weight| weight.checked_mul(scale));
        match total.filter(|&total| total < u64::MAX / 8) {
            Some(_) => Ok(Weights { change: &self.change, heating: &self.heating, scale }),
            None => Err(ToolError::TooMuch { most, changes }),
        }
    }

    /// Changes and cost of an order of tools on every layer.
    ///
    /// # Errors
    /// Where the order is not one of this problem.
    pub fn evaluate(&self, layers: &[Vec<u32>]) -> Result<(u64, u64), ToolError> {
        if layers.len() != self.layers.len() {
            return Err(ToolError::Layers { found: layers.len(), wanted: self.layers.len() });
        }
        for (layer, (order, at)) in layers.iter().zip(&self.layers).enumerate() {
            let mut sorted = order.clone();
            sorted.sort_unstable();
            if sorted != at.sorted() {
                return Err(ToolError::OtherTools { layer });
            }
            let place = |tool: u32| order.iter().position(|&other| other == tool);
            let broken = |&&(first, second): &&(u32, u32)| {
                place(first).zip(place(second)).is_some_and(|(first, second)| first > second)
            };
            if let Some(&(first, second)) = at.before.iter().find(broken) {
                return Err(ToolError::Precedence { layer, first, second });
            }
        }
        let weights = Weights { change: &self.change, heating: &self.heating, scale: 1 };
        let (mut changes, mut cost, mut loaded) = (0, 0, self.loaded);
        for (order, at) in layers.iter().zip(&self.layers) {
            let (prints, ascending) = (at.waited_for(&weights), at.sorted());
            let heat = Heat::new(prints.as_deref(), &weights);
            let mut elapsed = Elapsed::default();
            for (turn, &tool) in order.iter().enumerate() {
                let before = loaded.replace(tool).filter(|before| *before != tool);
                if let Some(before) = before {
                    changes += 1;
                    cost += u64::from(self.change[before as usize][tool as usize]);
                    cost += match turn {
                        0 => weights.first_wait(order.len(), tool),
                        _ => heat.wait(elapsed, tool),
                    };
                }
                let n = ascending.partition_point(|other| *other < tool);
                elapsed = heat.after(elapsed, n, tool, before.is_some());
            }
        }
        Ok((changes, cost))
    }
}
