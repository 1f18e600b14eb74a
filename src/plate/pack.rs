//! Packing the boxes around models seen from above.
//!
//! Greedy by falling size: each box goes where it touches (at the spacing) one that stands, so that the group takes the
//! least share of the bed. O(n³) for n boxes.

/// Something seen from above, its box centred on the origin.
#[derive(Clone)]
pub(super) struct Footprint {
    half: [f64; 2],
    /// How high it is.
    pub height_mm: f64,
    /// Points that determine the distance from the middle: corners of the box, or the convex hull for a round bed.
    pub rim: Vec<[f64; 2]>,
}

impl Footprint {
    /// Of this size; without a rim it is that of the box.
    pub fn new(size: [f64; 3], rim: Option<Vec<[f64; 2]>>) -> Self {
        let half = [size[0] / 2.0, size[1] / 2.0];
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let rim = rim.unwrap_or_else(|| corners.map(|(x, y)| [x * half[0], y * half[1]]).to_vec());
        Self { half, height_mm: size[2], rim }
    }

    /// Extents.
    pub fn size(&self) -> [f64; 3] {
        [2.0 * self.half[0], 2.0 * self.half[1], self.height_mm]
    }
}

pub(super) fn group_box(footprints: &[&Footprint], positions: &[[f64; 2]]) -> [[f64; 2]; 2] {
    footprints.iter().zip(positions).fold(
        [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
        |[min, max], (f, s)| {
            [
                std::array::from_fn(|i| min[i].min(s[i] - f.half[i])),
                std::array::from_fn(|i| max[i].max(s[i] + f.half[i])),
            ]
        },
    )
}

/// Middles of the footprints, the whole group around the origin. `share` says what part of the bed a group needs.
///
/// # Errors
/// Those for which there is no room, if not all fit.
pub(super) fn pack(
    footprints: &[Footprint],
    spacing_mm: f64,
    share: impl Fn(&[&Footprint], &[[f64; 2]]) -> f64,
) -> Result<Vec<[f64; 2]>, Vec<usize>> {
    let mut order: Vec<usize> = (0..footprints.len()).collect();
    let size = |i: usize| footprints[i].half[0] * footprints[i].half[1];
    order.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
    let mut placed: Vec<&Footprint> = Vec::with_capacity(order.len());
    let mut positions: Vec<[f64; 2]> = Vec::with_capacity(order.len());
    for (rank, &next) in order.iter().enumerate() {
        let footprint = &footprints[next];
        placed.push(footprint);
        let mut best: Option<([f64; 2], [f64; 2])> = None;
        for position in candidates(&placed, &positions, spacing_mm) {
            let touches = placed.iter().zip(&positions).any(|(f, s)| {
                (0..2).all(|i| (s[i] - position[i]).abs() < f.half[i] + footprint.half[i] + spacing_mm - 1e-9)
            });
            if touches {
                continue;
            }
            positions.push(position);
            let [min, max] = group_box(&placed, &positions);
            let cost = [share(&placed, &positions), (max[0] - min[0]) * (max[1] - min[1])];
            positions.pop();
            if best.is_none_or(|(_, least)| cost < least) {
                best = Some((position, cost));
            }
        }
        // Beyond the rightmost model there is always a free candidate.
        let (position, cost) = best.unwrap_or_default();
        if cost[0] > 1.0 {
            return Err(order[rank..].to_vec());
        }
        positions.push(position);
    }
    let [min, max] = group_box(&placed, &positions);
    let mut result = vec![[0.0; 2]; footprints.len()];
    for (&index, position) in order.iter().zip(&positions) {
        result[index] = std::array::from_fn(|i| position[i] - (min[i] + max[i]) / 2.0);
    }
    Ok(result)
}

/// Positions for the last footprint beside each of those that stand: four sides, flush at either end or in the middle.
fn candidates(placed: &[&Footprint], positions: &[[f64; 2]], spacing_mm: f64) -> Vec<[f64; 2]> {
    let Some((new, standing)) = placed.split_last().filter(|(_, s)| !s.is_empty()) else {
        return vec![[0.0; 2]];
    };
    let mut found = Vec::with_capacity(12 * standing.len());
    for (f, s) in standing.iter().zip(positions) {
        for axis in 0..2 {
            let other = 1 - axis;
            for side in [1.0, -1.0] {
                for flush in [-1.0, 1.0, 0.0] {
                    let mut position = [0.0; 2];
                    position[axis] = s[axis] + side * (f.half[axis] + new.half[axis] + spacing_mm);
                    position[other] = s[other] + flush * (f.half[other] - new.half[other]);
                    found.push(position);
                }
            }
        }
    }
    found
}
