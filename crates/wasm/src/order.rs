//! Polylines in, order out.

use ordering::{Effort, OrderOptions, Polyline, chosen};
use pathwright::geometry::Point;
use serde::Deserialize;
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::error::{Fault, Result};
use crate::models::strategy;

/// What is wanted of an order.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Wanted {
    strategy: String,
    effort: String,
    /// Where the machine begins, millimetres.
    start: Option<[f64; 2]>,
    certify: bool,
}

impl Default for Wanted {
    fn default() -> Self {
        Self { strategy: "optimized".into(), effort: "normal".into(), start: None, certify: false }
    }
}

/// Orders polylines: their vertices (two numbers each, millimetres) one after the other, the first vertex of each and the number of
/// all, whether each is closed, and its group; `wanted` is JSON, and so is the answer.
#[wasm_bindgen]
pub fn order(points: &[f64], starts: &[u32], closed: &[u8], groups: &[u32], wanted: &str) -> Result<String> {
    let wanted: Wanted =
        serde_json::from_str(wanted).map_err(|error| Fault::usage(format!("the options: {error}")))?;
    let points: Vec<Point> = points.chunks_exact(2).map(|xy| Point::from_mm(xy[0], xy[1])).collect();
    let polylines = starts.windows(2).zip(closed).zip(groups).map(|((range, &closed), &group)| {
        let points = points.get(range[0] as usize..range[1] as usize).unwrap_or_default().to_vec();
        Polyline { points, closed: closed != 0, group }
    });
    let polylines: Vec<Polyline> = polylines.collect();
    let mut options = OrderOptions::default();
    options.strategy = strategy(&wanted.strategy)?;
    options.effort = chosen(Effort::ALL, "effort", &wanted.effort).map_err(Fault::usage)?;
    options.start = wanted.start.map(|[x, y]| Point::from_mm(x, y));
    options.certify = wanted.certify;
    let ordered = ordering::order(&polylines, &options);
    let visits = &ordered.sequence;
    Ok(json!({
        "order": visits.iter().map(|visit| visit.item).collect::<Vec<_>>(),
        "entries": visits.iter().map(|visit| visit.entry).collect::<Vec<_>>(),
        "length_mm": ordered.length_mm,
        "bound_mm": ordered.bound_mm,
    })
    .to_string())
}
