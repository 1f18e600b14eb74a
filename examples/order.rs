//! Orders one layer of paths made here by every strategy: a grid of short lines, each of which may be drawn in either direction.
//!
//!     cargo run --release --example order

use pathwright::geometry::Point;
use pathwright::order::{Cost, Item, Problem, Run, Shape, check, evaluate, strategy};
use pathwright::profile::{Effort, OrderStrategy, Scope};

fn main() {
    let lines = (0..100).map(|i| {
        let (x, y) = (f64::from(i * 37 % 100 % 10) * 4.0, f64::from(i * 37 % 100 / 10) * 4.0);
        [Point::from_mm(x, y), Point::from_mm(x + 2.0, y + 1.0)]
    });
    let problem = Problem {
        items: lines.map(|ends| Item { run: 0, shape: Shape::Open(ends) }).collect(),
        runs: vec![Run { stage: 0, island: 0, layer: 0, rank: 0 }],
        scope: Scope::Feature,
        start: Some(Point::from_mm(0.0, 0.0)),
        end: None,
    };
    for (name, which) in OrderStrategy::ALL {
        let sequence = strategy(*which).solve(&problem, &Cost::Length, Effort::Normal);
        assert_eq!(check(&problem, &sequence), Ok(()), "every path once, precedence kept");
        println!("{name:<18} {:8.1} mm between the lines", evaluate(&problem, &sequence, &Cost::Length));
    }
}
