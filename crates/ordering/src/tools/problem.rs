//! The problem, what a plan for it costs, and what contradicts itself.

/// The tools of one layer. Each is loaded once on it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ToolLayer {
    /// Each once, in any order.
    pub tools: Vec<u32>,
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
    /// The tool that is loaded when the print begins; `None`: whichever comes first costs nothing.
    pub loaded: Option<u32>,
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
    scale: u64,
}

impl Weights<'_> {
    pub fn of(&self, from: u32, to: u32) -> u64 {
        if from == to { 0 } else { u64::from(self.change[from as usize][to as usize]) * self.scale + 1 }
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
        for (layer, at) in self.layers.iter().enumerate() {
            if let Some(&tool) = at.tools.iter().find(|&&tool| tool as usize >= tools) {
                return Err(ToolError::NoSuchTool { layer, tool, tools });
            }
            let mut sorted = at.tools.clone();
            sorted.sort_unstable();
            if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(ToolError::Twice { layer, tool: pair[0] });
            }
            at.ascending().map_err(|tool| ToolError::Circle { layer, tool })?;
        }
        let changes: u64 = self.layers.iter().map(|layer| layer.tools.len() as u64).sum();
        let most = self.change.iter().flatten().copied().max().unwrap_or(0);
        let scale = changes + 1;
        // What is not possible counts u64::MAX / 4.
        let total = (u64::from(most) + 1).checked_mul(scale).and_then(|weight| weight.checked_mul(scale));
        match total.filter(|&total| total < u64::MAX / 8) {
            Some(_) => Ok(Weights { change: &self.change, scale }),
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
            let sorted = [order, &at.tools].map(|tools| {
                let mut tools = tools.clone();
                tools.sort_unstable();
                tools
            });
            if sorted[0] != sorted[1] {
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
        let sequence: Vec<u32> = self.loaded.into_iter().chain(layers.iter().flatten().copied()).collect();
        let changes = sequence.windows(2).filter(|pair| pair[0] != pair[1]);
        let costs = changes.map(|pair| u64::from(self.change[pair[0] as usize][pair[1] as usize]));
        Ok(costs.fold((0, 0), |(changes, total), cost| (changes + 1, total + cost)))
    }
}
