//! Polylines in, order out.

use pathwright_geometry::Point;

use super::{
    Cost, Effort, Item, Known, OrderStrategy, Problem, Run, Sequence, Shape, Watch, bound, evaluate, strategy,
};

/// Steps per polyline, beside those of a layer's path, with normal effort. A drawing is ordered once, a print layer by layer; and its
/// clusters of short strokes need more.
const MORE_STEPS: u64 = 12_600;

/// A stroke that is drawn without a stop.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// Its vertices, at least one.
    pub points: Vec<Point>,
    /// Whether it returns from the last vertex to the first: then it is entered at any.
    pub closed: bool,
    /// All of a group come before any of the next: layers of a drawing, colours of pens.
    pub group: u32,
}

/// How polylines are ordered.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OrderOptions {
    /// How the order is found.
    pub strategy: OrderStrategy,
    /// How long is searched.
    pub effort: Effort,
    /// What is minimised.
    pub cost: Cost,
    /// Where the machine begins; `None`: anywhere.
    pub start: Option<Point>,
    /// Whether a lower bound is computed.
    pub certify: bool,
}

impl Default for OrderOptions {
    fn default() -> Self {
        Self {
            strategy: OrderStrategy::Optimized,
            effort: Effort::Normal,
            cost: Cost::Length,
            start: None,
            certify: false,
        }
    }
}

/// Polylines in order.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ordered {
    /// Which polyline is next, and how it is drawn: an open one forwards (entry 0) or backwards (1), a closed one from this
    /// vertex.
    pub sequence: Sequence,
    /// Length of the links from the start, where there is one, and between polylines, mm.
    pub length_mm: f64,
    /// A length that no order can stay below, mm.
    pub bound_mm: Option<f64>,
}

/// Orders polylines such that the links between them cost little.
///
/// # Panics
/// If a polyline has no vertex.
///
/// # Examples
/// ```
/// use pathwright_geometry::Point;
/// use pathwright_ordering::{OrderOptions, Polyline, order};
///
/// let line = |y: f64| Polyline {
///     points: vec![Point::from_mm(0.0, y), Point::from_mm(50.0, y)],
///     closed: false,
///     group: 0,
/// };
/// let ordered = order(&[line(0.0), line(2.0), line(1.0)], &OrderOptions::default());
/// assert_eq!(ordered.length_mm, 2.0);
/// ```
pub fn order(polylines: &[Polyline], options: &OrderOptions) -> Ordered {
    order_watched(polylines, options, Watch::default())
}

/// As [`order`], unless who watches ends it.
///
/// # Panics
/// If a polyline has no vertex.
pub fn order_watched(polylines: &[Polyline], options: &OrderOptions, watch: Watch<'_>) -> Ordered {
    let mut groups: Vec<u32> = polylines.iter().map(|polyline| polyline.group).collect();
    groups.sort_unstable();
    groups.dedup();
    let runs =
        (0..groups.len() as u32).map(|stage| Run { stage, island: stage, layer: 0, rank: 0 }).collect();
    let items = polylines.iter().map(|Polyline { points, closed, group }| Item {
        run: groups.partition_point(|known| known < group) as u32,
        shape: match closed {
            true => Shape::Loop(points),
            false => Shape::Open([points[0], points[points.len() - 1]]),
        },
    });
    let problem = Problem { items: items.collect(), runs, start: options.start, ..Problem::of([]) };
    let more_steps = if options.effort == Effort::Normal { MORE_STEPS } else { 0 };
    let known = Known { more_steps, watch, ..Known::default() };
    let sequence = strategy(options.strategy).solve_knowing(&problem, &options.cost, options.effort, known);
    Ordered {
        length_mm: evaluate(&problem, &sequence, &Cost::Length),
        bound_mm: options.certify.then(|| bound::layer(&problem, &Cost::Length, options.effort)),
        sequence,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_come_one_after_the_other() {
        let dot = |x: f64, group| Polyline { points: vec![Point::from_mm(x, 0.0)], closed: true, group };
        let ordered = order(&[dot(0.0, 7), dot(1.0, 2), dot(2.0, 7), dot(3.0, 2)], &OrderOptions::default());
        let groups: Vec<u32> =
            ordered.sequence.iter().map(|visit| [7, 2, 7, 2][visit.item as usize]).collect();
        assert_eq!(groups, [2, 2, 7, 7]);
    }

    #[test]
    fn no_order_is_below_the_bound() {
        let line = |i: i32| Polyline {
            points: vec![Point::from_mm(f64::from(i * 7 % 11), 0.0), Point::from_mm(f64::from(i), 9.0)],
            closed: false,
            group: 0,
        };
        let lines: Vec<Polyline> = (0..20).map(line).collect();
        let ordered = order(&lines, &OrderOptions { certify: true, ..OrderOptions::default() });
        assert!(ordered.bound_mm.is_some_and(|bound| bound > 0.0 && bound <= ordered.length_mm));
    }
}
