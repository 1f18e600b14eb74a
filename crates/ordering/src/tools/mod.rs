//! Which tool when: the order of the tools on every layer of a print, such that the changes of the whole print cost least.

mod exact;
mod large;
mod paths;
mod problem;
mod rules;

pub use problem::{ToolError, ToolLayer, ToolPlan, ToolProblem};

use crate::choice;

choice! {
    /// How the order of tools is found.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
    ToolOrder {
        /// By ascending number on every layer.
        Fixed = "fixed",
        /// The loaded tool first if the layer has it, the others by ascending number, as PrusaSlicer does.
        LoadedFirst = "loaded-first",
        /// As `loaded-first`, and the first tool that the next layer has as well comes last.
        NextLast = "next-last",
        /// The order of each layer that costs least after the tool that is loaded when it begins.
        LayerByLayer = "layer-by-layer",
        /// The order of all layers together that costs least.
        Optimal = "optimal",
    }
}

/// The order of tools on every layer by a rule, and what it costs.
///
/// # Errors
/// Where the problem contradicts itself, with the layer.
///
/// # Examples
/// ```
/// use pathwright_ordering::tools::{ToolLayer, ToolOrder, ToolProblem, order_tools};
///
/// let layer = |tools: &[u32]| ToolLayer { tools: tools.to_vec(), before: Vec::new() };
/// let problem = ToolProblem {
///     layers: vec![layer(&[0, 1]), layer(&[1, 2]), layer(&[0, 2])],
///     change: vec![vec![0, 5, 9], vec![5, 0, 5], vec![9, 5, 0]],
///     loaded: None,
/// };
/// let plan = order_tools(&problem, ToolOrder::Optimal)?;
/// assert_eq!(plan.layers, [[0, 1], [1, 2], [2, 0]]);
/// assert_eq!((plan.changes, plan.cost, plan.bound), (3, 19, Some(19)));
/// assert_eq!(order_tools(&problem, ToolOrder::Fixed)?.changes, 4);
/// # Ok::<(), pathwright_ordering::tools::ToolError>(())
/// ```
pub fn order_tools(problem: &ToolProblem, order: ToolOrder) -> Result<ToolPlan, ToolError> {
    let weights = problem.weights()?;
    let (layers, bound) = match order {
        ToolOrder::Fixed => (rules::fixed(problem), None),
        ToolOrder::LoadedFirst => (rules::loaded_first(problem), None),
        ToolOrder::NextLast => (rules::next_last(problem), None),
        ToolOrder::LayerByLayer => (exact::layer_by_layer(problem, &weights), None),
        ToolOrder::Optimal => {
            let (layers, bound) = exact::optimal(problem, &weights);
            (layers, Some(bound))
        }
    };
    let (changes, cost) = problem.evaluate(&layers)?;
    Ok(ToolPlan { layers, changes, cost, bound })
}
