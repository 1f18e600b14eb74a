//! Lower bounds on what any order of a layer, or of a print, must travel.

mod ascent;
mod model;
mod pricing;

use super::Problem;
use ascent::Relaxation;
use model::{Model, to_mm};

/// A length in millimetres that the links of no solution of the problem can stay below.
pub fn layer(problem: &Problem) -> f64 {
    let model = Model::new(problem);
    if model.bodies.is_empty() {
        return 0.0;
    }
    let mut relaxation = Relaxation::new(&model);
    if let Some(start) = problem.start {
        relaxation.start_from(start);
    }
    if let Some(end) = problem.end {
        relaxation.end_at(end);
    }
    to_mm(relaxation.ascend().0.max(0))
}
