//! How much plastic a print has, measured on its G-code, against the mesh.

use crate::support::print::{model, print, solid, standard};

/// Bundled models that are watertight and whose walls are all at least 1.2 mm thick. The teeth of `thin_wall_comb`
/// begin at 0.3 mm, the pins of `pin_forest` at 1 mm; `broken_box` is open.
const THICK: [&str; 7] = [
    "calibration_cube",
    "plate_with_holes",
    "overhang_and_bridge",
    "hollow_vase",
    "tilted_bracket",
    "helical_gear",
    "nested_shells",
];

#[test]
fn a_full_print_deposits_the_volume_of_the_mesh() {
    let settings = standard(&["infill.density=100%", "skirt.loops=0"]);
    let volumes = THICK.map(|name| {
        let printed = print(name, &settings).measure(&settings).volume_mm3;
        (name, printed, solid(&model(name), &settings).volume_mm3)
    });
    for (name, printed, wanted) in volumes {
        assert!((printed / wanted - 1.0).abs() < 0.03, "{name}: {printed} of {wanted} mm³");
    }
    let sum = |of: fn(&(&str, f64, f64)) -> f64| volumes.iter().map(of).sum::<f64>();
    let pooled = sum(|v| v.1) / sum(|v| v.2);
    assert!((pooled - 1.0).abs() < 0.02, "pooled {pooled}");
}

#[test]
fn sparse_infill_fills_its_share_of_the_sparse_region() {
    let settings = standard(&[]);
    // Those with room for it; in thinner ones a line more or less is a tenth of all.
    let models = [
        "calibration_cube",
        "helical_gear",
        "nested_shells",
        "overhang_and_bridge",
        "plate_with_holes",
        "tilted_bracket",
    ];
    for name in models {
        let room = solid(&model(name), &settings).sparse_mm3(&settings);
        let share = print(name, &settings).volume_of("Internal infill", &settings) / room;
        assert!((share - 0.20).abs() <= 0.01, "{name}: {share:.4} of {room:.0} mm³");
    }
}
