//! Bounds a layer of circles and lines and prints the certificate: `cargo run --features highs,serde --example certificate |
//! python3 crates/ordering/examples/check_certificate.py`.

use pathwright_geometry::Point;
use pathwright_ordering::{Effort, Problem, Shape, bound};

fn main() -> Result<(), serde_json::Error> {
    let circle = |k: i32| -> Vec<Point> {
        let center = (15.0 * f64::from(k % 4) + f64::from(k % 3), 13.0 * f64::from(k / 4) + f64::from(k % 5));
        let turn = |at: i32| f64::from(at) * std::f64::consts::TAU / 24.0;
        let at = |turn: f64| Point::from_mm(center.0 + 5.0 * turn.cos(), center.1 + 5.0 * turn.sin());
        (0..24).map(|vertex| at(turn(vertex))).collect()
    };
    let middle = |a: Point, b: Point| Point { x: i32::midpoint(a.x, b.x), y: i32::midpoint(a.y, b.y) };
    let circles: Vec<Vec<Point>> = (0..12).map(circle).collect();
    let lines = circles
        .iter()
        .map(|circle| Shape::Open([middle(circle[3], circle[15]), middle(circle[5], circle[20])]));
    let problem = Problem::of(circles.iter().map(|circle| Shape::Loop(circle)).chain(lines));
    match bound::certificate(&problem, Effort::High) {
        Some(certificate) => println!("{}", serde_json::to_string(&certificate)?),
        None => eprintln!("the solver failed"),
    }
    Ok(())
}
