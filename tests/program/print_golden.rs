//! What the standard job makes of every bundled model, compared with what it made before.
//!
//! A change that is meant to alter the figures rewrites them: `PATHWRIGHT_BLESS=1 cargo test --test program print_golden`.

use std::fmt::Write;
use std::path::Path;

use crate::support::print::{print, standard};

/// Every bundled model.
const MODELS: [&str; 10] = [
    "broken_box",
    "calibration_cube",
    "helical_gear",
    "hollow_vase",
    "nested_shells",
    "overhang_and_bridge",
    "pin_forest",
    "plate_with_holes",
    "thin_wall_comb",
    "tilted_bracket",
];

/// By how much layers, lengths, volumes, travels and retractions may differ: a share, and for counts two, for they
/// depend on which of two equal routes is taken.
const TOLERANCES: [(f64, f64); 5] = [(0.0, 0.0), (0.005, 0.0), (0.005, 0.0), (0.02, 2.0), (0.02, 2.0)];

#[test]
fn the_standard_job_prints_what_it_did() {
    let settings = standard(&[]);
    let mut table = String::from("model\tlayers\tprint_mm\tvolume_mm3\ttravels\tretractions\n");
    for name in MODELS {
        let summary = print(name, &settings).summary;
        let total = &summary.total;
        writeln!(
            table,
            "{name}\t{}\t{:.0}\t{:.1}\t{}\t{}",
            summary.layer_count, total.print_mm, total.volume_mm3, total.travels, total.retractions
        )
        .expect("a string");
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/standard-job.tsv");
    if std::env::var_os("PATHWRIGHT_BLESS").is_some() {
        std::fs::write(file, table).expect("written");
        return;
    }
    let golden = std::fs::read_to_string(file).expect("the golden table");
    assert_eq!(golden.lines().count(), table.lines().count());
    for (was, is) in golden.lines().zip(table.lines()) {
        let mut fields = was.split('\t').zip(is.split('\t'));
        let names_agree = fields.next().is_some_and(|(was, is)| was == is);
        let near = fields.zip(TOLERANCES).all(|((was, is), (share, least))| {
            match (was.parse::<f64>(), is.parse::<f64>()) {
                (Ok(was), Ok(is)) => (is - was).abs() <= (share * was).max(least),
                _ => was == is,
            }
        });
        assert!(names_agree && near, "was {was}\n is {is}");
    }
}
