//! Costs of relaxed walks: whole numbers of fine units in floating point, of which processors compare several at once, but not of
//! integers so long. They are far fewer than the 2⁵³ up to which sums are exact.

use pathwright_geometry::real;

/// More than any walk costs.
pub(super) const FAR: f64 = 1e15;

/// The least of some costs.
pub(super) fn least(costs: impl Iterator<Item = f64>) -> f64 {
    costs.fold(FAR, real::lesser)
}

/// Numbers that are compared at once.
const LANES: usize = 4;

/// The greatest of some costs.
pub(super) fn greatest(costs: &[f64]) -> f64 {
    let (fours, rest) = costs.as_chunks::<LANES>();
    let mut most = [f64::MIN; LANES];
    for four in fours {
        most.iter_mut().zip(four).for_each(|(most, &cost)| *most = real::greater(cost, *most));
    }
    most.into_iter().chain(rest.iter().copied()).fold(f64::MIN, real::greater)
}

/// Lowers costs to what they are by way of something that costs `so_far`.
pub(super) fn lower(costs: &mut [f64], so_far: f64, lengths: &[f64]) {
    for (cost, &length) in costs.iter_mut().zip(lengths) {
        *cost = real::lesser(so_far + length, *cost);
    }
}
