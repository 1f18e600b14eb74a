//! Packing true outlines: each model goes to the first free position of a list, the largest first.

use super::silhouette::Bitmap;

/// A model in one of its permitted rotations.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// The cells that it covers and those kept free around it, its middle at node (0, 0).
    pub covered: Bitmap,
    /// Points of its outline that must lie on the bed.
    pub rim: Vec<[f64; 2]>,
}

/// A model's position and rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShapePosition {
    /// Index into its permitted rotations.
    pub turn: usize,
    /// Position of its middle, in cells from the bed's.
    pub at: [i64; 2],
}

/// The order in which positions are tried.
#[derive(Clone, Copy, Debug)]
pub(super) enum SearchOrder {
    /// The middle of the bed: a compact group.
    Middle,
    /// The front left corner: more fits.
    Corner,
}

/// Places models so that no two cover a cell. `shapes` holds each model's rotations, `models` which of them each
/// model is. `fits` says whether a rim, moved, lies on the bed, which reaches `half` cells from its middle.
///
/// `None`: no position is left for the model. The largest comes first, of equals the first. Positions are tried in a fixed order,
/// and never again what was taken for an equal model: O(positions · rows) for each different shape where the bed is not full.
pub(super) fn arrange(
    shapes: &[Vec<Shape>],
    models: &[usize],
    half: [i64; 2],
    search_order: SearchOrder,
    fits: impl Fn(&[[f64; 2]], [i64; 2]) -> bool,
) -> Vec<Option<ShapePosition>> {
    let positions = candidate_positions(half, search_order);
    let reach =
        shapes.iter().flatten().map(|s| s.covered.reach()).max().unwrap_or(0) + half[0].max(half[1]) + 1;
    let mut taken = Bitmap::new([-reach; 2], [reach; 2]);
    let mut order: Vec<usize> = (0..models.len()).collect();
    let size = |model: usize| shapes[models[model]].iter().map(|s| s.covered.count()).max();
    order.sort_by_key(|&model| (std::cmp::Reverse(size(model)), models[model], model));
    // Cells are taken and never given back: what had no position for a shape will have none later.
    let mut tried: Vec<Vec<usize>> = shapes.iter().map(|turns| vec![0; turns.len()]).collect();
    let mut found = vec![None; models.len()];
    for model in order {
        let turns = &shapes[models[model]];
        let mut best: Option<(usize, usize)> = None;
        for (turn, Shape { covered, rim }) in turns.iter().enumerate() {
            let first = &mut tried[models[model]][turn];
            let free = |&at: &usize| fits(rim, positions[at]) && !taken.meets(covered, positions[at]);
            *first = (*first..positions.len()).find(free).unwrap_or(positions.len());
            if *first < best.map_or(positions.len(), |(at, _)| at) {
                best = Some((*first, turn));
            }
        }
        if let Some((at, turn)) = best {
            taken.add(&turns[turn].covered, positions[at]);
            found[model] = Some(ShapePosition { turn, at: positions[at] });
        }
    }
    found
}

/// All nodes of the bed, in the order in which they are tried.
fn candidate_positions([x, y]: [i64; 2], search_order: SearchOrder) -> Vec<[i64; 2]> {
    let mut positions: Vec<[i64; 2]> = (-y..=y).flat_map(|j| (-x..=x).map(move |i| [i, j])).collect();
    if let SearchOrder::Middle = search_order {
        positions.sort_by_key(|[i, j]| i * i + j * j);
    }
    positions
}
