//! How long ordering lines takes, seconds: `time_order FILE`, four coordinates (64-bit floats, little-endian, mm) for each line.
//! `bindings/python/benches/overhead.py` sets it beside `pathwright.order`.

use std::time::Instant;

use pathwright_geometry::Point;
use pathwright_ordering::{OrderOptions, Polyline, order};

fn main() -> std::io::Result<()> {
    let bytes = std::fs::read(std::env::args().nth(1).unwrap_or_default())?;
    let number = |bytes: &[u8]| bytes.try_into().map(f64::from_le_bytes).unwrap_or_default();
    let numbers: Vec<f64> = bytes.chunks_exact(8).map(number).collect();
    let line = |ends: &[f64]| Polyline {
        points: vec![Point::from_mm(ends[0], ends[1]), Point::from_mm(ends[2], ends[3])],
        closed: false,
        group: 0,
    };
    let lines: Vec<Polyline> = numbers.chunks_exact(4).map(line).collect();
    let began = Instant::now();
    let ordered = order(&lines, &OrderOptions::default());
    println!("{} {}", began.elapsed().as_secs_f64(), ordered.length_mm);
    Ok(())
}
