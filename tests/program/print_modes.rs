//! Print modes that change what a layer is: spiral, heights that differ, rough walls. Read back from the G-code.

use std::f64::consts::PI;

use crate::support::print::{Print, model, print, run, solid, standard};
use pathwright::Observer;
use pathwright::gcode::Stroke;
use pathwright::geometry::{EdgeGrid, Point, Region, offset};
use pathwright::job::{Engine, Job, ReorderJob};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile::Settings;
use pathwright::slice::cusp_limit_mm;
use pathwright::toolpath::bead;

const MODELS: [&str; 3] = ["calibration_cube", "hollow_vase", "helical_gear"];

/// The moves of a spiral from its first rising bead on.
fn body(print: &Print) -> Vec<Stroke> {
    let strokes = print.strokes();
    let rises = |s: &Stroke| s.extrudes() && s.to[2] > s.from[2];
    let first = strokes.iter().position(rises).expect("a spiral");
    strokes[first..].to_vec()
}

#[test]
fn a_spiral_is_one_line_that_never_goes_down() {
    for name in MODELS {
        let body = body(&print(name, &standard(&["spiral.enabled=true"])));
        assert!(body.len() > 500, "{name}");
        assert!(body.iter().all(|s| s.xy_mm == 0.0 || s.extrudes()), "{name}: a travel");
        assert!(body.iter().all(|s| s.e_mm >= 0.0), "{name}: a retraction");
        assert!(body.iter().all(|s| s.to[2] >= s.from[2]), "{name}: it goes down");
    }
}

#[test]
fn a_spiral_rises_by_a_layer_on_each_turn_at_a_constant_slope() {
    for name in MODELS {
        let settings = standard(&["spiral.enabled=true"]);
        let (body, height_mm) = (body(&print(name, &settings)), settings.layer.height.0);
        let top_mm = body.last().unwrap().to[2];
        let rises: Vec<&Stroke> = body.iter().filter(|s| s.to[2] < top_mm - 1e-9).collect();
        let mut from = 0;
        while from < rises.len() {
            let floor_mm = rises[from].from[2];
            let turn: Vec<&&Stroke> =
                rises[from..].iter().take_while(|s| s.to[2] <= floor_mm + height_mm + 1e-6).collect();
            let length_mm: f64 = turn.iter().map(|s| s.xy_mm).sum();
            let whole = (turn.last().unwrap().to[2] - floor_mm - height_mm).abs() < 1e-6;
            let mut done_mm = 0.0;
            for stroke in turn.iter().filter(|_| whole) {
                done_mm += stroke.xy_mm;
                let off_mm = stroke.to[2] - floor_mm - height_mm * done_mm / length_mm;
                assert!(off_mm.abs() < 2e-3, "{name}: {off_mm} mm at {floor_mm}");
            }
            from += turn.len();
        }
    }
}

#[test]
fn a_spiral_holds_its_length_times_its_cross_section() {
    for name in MODELS {
        let settings = standard(&["spiral.enabled=true"]);
        let (body, height_mm) = (body(&print(name, &settings)), settings.layer.height.0);
        let filament_mm2 = PI / 4.0 * settings.filament.diameter.0.powi(2);
        let area_mm2 = bead::area_mm2(settings.walls.external_width.0, height_mm);
        let (base_mm, top_mm) = (body[0].from[2], body.last().unwrap().to[2]);
        let swells = |s: &Stroke| s.to[2] <= base_mm + height_mm + 1e-6;
        let fades = |s: &Stroke| s.from[2] >= top_mm - 1e-9;
        // What swells or fades holds half.
        let share = |s: &Stroke| if swells(s) || fades(s) { 0.5 } else { 1.0 };
        let wanted: f64 = body.iter().map(|s| s.xy_mm * area_mm2 * share(s)).sum();
        let held: f64 = body.iter().map(|s| s.e_mm * filament_mm2).sum();
        assert!((held / wanted - 1.0).abs() < 0.01, "{name}: {held} of {wanted} mm³");
        let of = |part: &dyn Fn(&Stroke) -> bool| {
            let strokes = body.iter().filter(|s| part(s));
            let (e, mm) = strokes.fold((0.0, 0.0), |(e, mm), s| (e + s.e_mm, mm + s.xy_mm));
            e * filament_mm2 / (mm * area_mm2)
        };
        assert!((of(&swells) - 0.5).abs() < 0.02 && (of(&fades) - 0.5).abs() < 0.02, "{name}");
    }
}

#[test]
fn a_spiral_has_a_solid_bottom_and_neither_top_nor_infill() {
    let settings = standard(&["spiral.enabled=true", "skirt.loops=0"]);
    let print = print("calibration_cube", &settings);
    let solid_mm3 = print.volume_of("Solid infill", &settings);
    // Four layers, less one wall around each.
    let inside_mm2 = (20.0 - 2.0 * 0.43_f64).powi(2);
    assert!((solid_mm3 / (4.0 * 0.2 * inside_mm2) - 1.0).abs() < 0.05, "{solid_mm3}");
    for kind in ["Internal infill", "Top solid infill", "Perimeter"] {
        assert_eq!(print.volume_of(kind, &settings), 0.0, "{kind}");
    }
    assert_eq!(body(&print)[0].from[2], 0.8);
}

#[test]
fn a_spiral_is_of_one_object() {
    let job = Job::of([model("calibration_cube")]).with_copies(2);
    let refused = run(&job, &standard(&["spiral.enabled=true"])).err().expect("refused");
    assert!(refused.to_string().contains("--each"), "{refused}");
}

#[test]
fn reordering_leaves_a_spiral_alone() {
    let settings = standard(&["spiral.enabled=true", "order.strategy=as-sliced"]);
    let print = print("helical_gear", &settings);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("spiral.gcode");
    std::fs::write(&file, &print.text).unwrap();
    let mut output = Output::memory();
    let job = ReorderJob { file, ..ReorderJob::default() };
    Pipeline.reorder(&job, &standard(&[]), &mut output, &Observer::none()).expect("reordered");
    let body = |text: &[u8]| {
        let text = String::from_utf8_lossy(text).into_owned();
        let moves = text.split(";LAYER:4\n").nth(1).expect("the first turn").to_owned();
        moves
            .lines()
            .filter(|l| l.starts_with("G1") && l.contains('Z') && l.contains('E'))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let reordered = output.into_bytes();
    assert_eq!(body(&reordered), body(&print.text));
}

/// The heights that a file states of its layers.
fn heights(print: &Print) -> Vec<f64> {
    let mut lines = print.lines();
    let mut heights = Vec::new();
    while let Some(line) = lines.next() {
        if line == ";LAYER_CHANGE" {
            let height = lines.by_ref().find_map(|line| line.strip_prefix(";HEIGHT:")).expect("a height");
            heights.push(height.parse().expect("a number"));
        }
    }
    heights
}

fn adaptive(quality: &str) -> Settings {
    standard(&[
        "layer.adaptive=true",
        &format!("layer.quality={quality}"),
        "infill.density=100%",
        "skirt.loops=0",
    ])
}

#[test]
fn adaptive_layers_hold_the_volume_of_the_mesh() {
    for (name, quality) in [("calibration_cube", "0.5"), ("tilted_bracket", "1"), ("helical_gear", "0.5")] {
        let settings = adaptive(quality);
        let print = print(name, &settings);
        let (printed, wanted) =
            (print.measure(&settings).volume_mm3, solid(&model(name), &settings).volume_mm3);
        assert!((printed / wanted - 1.0).abs() < 0.03, "{name}: {printed} of {wanted} mm³");
        let (least, most) = (settings.layer.min_height.0 - 1e-9, settings.layer.max_height.0 + 1e-9);
        assert!(heights(&print)[1..].iter().all(|h| (least..=most).contains(h)), "{name}");
    }
}

#[test]
fn upright_walls_are_printed_in_the_highest_layers() {
    let settings = adaptive("1");
    let heights = heights(&print("calibration_cube", &settings));
    let full = heights.iter().filter(|h| (**h - settings.layer.max_height.0).abs() < 1e-9).count();
    assert!(full + 3 >= heights.len(), "{heights:?}");
    assert!((cusp_limit_mm(&settings.layer) - settings.layer.min_height.0).abs() < 1e-9);
}

#[test]
fn adaptive_layers_and_rough_walls_are_the_same_on_any_number_of_threads() {
    let settings = standard(&["layer.adaptive=true", "fuzzy.walls=all"]);
    let on = |threads| {
        let job =
            Job { models: vec![model("tilted_bracket").into()], threads: Some(threads), ..Job::default() };
        run(&job, &settings).expect("a print").text
    };
    assert!(on(1) == on(3));
}

#[test]
fn a_table_of_heights_holds_from_its_heights_on() {
    let print = print("calibration_cube", &standard(&["layer.heights=5:0.1, 10:0.25"]));
    let mut top_mm = 0.0;
    for height_mm in heights(&print) {
        let expected = [0.2, 0.1, 0.25][usize::from(top_mm > 4.999) + usize::from(top_mm > 9.999)];
        assert!((height_mm - expected).abs() < 1e-9, "{height_mm} at {top_mm}");
        top_mm += height_mm;
    }
    assert!((top_mm - 20.0).abs() < 0.13);
}

#[test]
fn rough_walls_stay_within_their_thickness() {
    let plain = standard(&["walls.generator=classic"]);
    let rough = standard(&["walls.generator=classic", "fuzzy.walls=outer"]);
    for name in ["calibration_cube", "plate_with_holes"] {
        let (before, after) = (print(name, &plain), print(name, &rough));
        let part = solid(&model(name), &plain);
        let mut most_mm: f64 = 0.0;
        for bead in after.beads().iter().filter(|b| b.kind == "External perimeter") {
            let layer = (bead.z_mm / 0.2).round() as usize - 1;
            let line: Region = offset(&part.section(Some(layer)), -0.225);
            let grid = EdgeGrid::new(&line);
            let off = bead.points.iter().map(|p| grid.distance_mm(Point::from_mm(p[0], p[1]), 2.0));
            let off_mm = off.fold(0.0, f64::max);
            assert!(off_mm <= if layer == 0 { 0.02 } else { 0.31 }, "{name}: {off_mm} mm on layer {layer}");
            most_mm = most_mm.max(off_mm);
        }
        assert!(most_mm > 0.2, "{name}: {most_mm}");
        let inner = |print: &Print| print.volume_of("Perimeter", &plain);
        assert!((inner(&after) / inner(&before) - 1.0).abs() < 1e-3, "{name}: inner walls are as they were");
    }
}
