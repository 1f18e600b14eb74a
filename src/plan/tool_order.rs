//! Which tool prints when: the tools of each layer, in their order.

use crate::toolpath::{LayerPaths, ToolId};

/// The tools that a layer needs, each once, in ascending order.
pub(crate) fn needed(layer: &LayerPaths) -> Vec<ToolId> {
    let mut tools: Vec<ToolId> = layer.paths.iter().filter_map(|path| path.tool).collect();
    tools.sort_unstable();
    tools.dedup();
    tools
}

/// An order of the tools of each layer: begun with the one in use where the layer needs it, ended with one that the next
/// layer needs. What needs no tool of its own is printed by whichever is in use, at first by the first one.
pub(crate) fn by_next(needs: &[Vec<ToolId>], start: Option<ToolId>) -> Vec<Vec<ToolId>> {
    let mut current = start;
    let order = |layer: usize| {
        let mut left = needs[layer].clone();
        let mut order = Vec::with_capacity(left.len().max(1));
        if let Some(place) = left.iter().position(|tool| Some(*tool) == current) {
            order.push(left.remove(place));
        }
        let next = needs[layer + 1..].iter().find(|needs| !needs.is_empty());
        let wanted = |tool: &ToolId| next.is_some_and(|next| next.contains(tool));
        let last = left.iter().position(wanted).map(|place| left.remove(place));
        order.extend(left);
        order.extend(last);
        if order.is_empty() {
            order.extend(current.or_else(|| next.and_then(|next| next.first().copied())).or(Some(0)));
        }
        current = order.last().copied();
        order
    };
    (0..needs.len()).map(order).collect()
}

/// Gives a layer its order of tools; what any may print is printed by the first.
pub(crate) fn settle(layer: &mut LayerPaths, order: Vec<ToolId>) {
    let first = order.first().copied();
    for path in &mut layer.paths {
        path.tool = path.tool.or(first);
    }
    layer.tools = order;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_begins_with_the_tool_in_use_and_ends_with_one_of_the_next() {
        let needs = [vec![0, 1], vec![0, 1], vec![], vec![1, 2], vec![2]];
        assert_eq!(by_next(&needs, None), [vec![1, 0], vec![0, 1], vec![1], vec![1, 2], vec![2]]);
        assert_eq!(by_next(&[vec![], vec![3]], None), [vec![3], vec![3]]);
    }
}
