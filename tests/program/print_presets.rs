//! What presets of other slicers ask for, read back from the G-code.

use crate::support::print::{Print, print, settings, standard};
use pathwright::gcode::Stroke;

/// Strokes with what is pulled back when each begins.
fn pulled(print: &Print) -> Vec<(f64, Stroke)> {
    let mut pulled_mm = 0.0;
    let with_pulled = |stroke: Stroke| {
        let before_mm: f64 = pulled_mm;
        pulled_mm = (pulled_mm - stroke.e_mm).max(0.0);
        (before_mm, stroke)
    };
    print.strokes().into_iter().map(with_pulled).collect()
}

/// How many rises of the nozzle happen with filament pulled back, and how many without.
fn rises(print: &Print) -> [usize; 2] {
    let rises =
        pulled(print).into_iter().filter(|(_, stroke)| stroke.to[2] > stroke.from[2] && stroke.from[2] > 0.0);
    rises.fold([0; 2], |[with, without], (pulled_mm, _)| match pulled_mm > 0.1 {
        true => [with + 1, without],
        false => [with, without + 1],
    })
}

#[test]
fn filament_is_pulled_back_at_every_change_of_layer() {
    let [_, without] = rises(&print("calibration_cube", &standard(&["travel.retract_inside=100"])));
    assert!(without > 50, "{without}: by itself the next layer begins near");
    let sets = ["travel.retract_inside=100", "retract.layer_change=true"];
    let [with, without] = rises(&print("calibration_cube", &standard(&sets)));
    assert!(with >= 99 && without <= 1, "{with}, {without}");
}

#[test]
fn half_of_the_filament_is_pulled_back_before_a_wipe() {
    let sets = ["retract.wipe=2", "retract.length=1", "retract.before_wipe=50%"];
    let strokes = print("pin_forest", &standard(&sets)).strokes();
    let (mut wipes, mut wiped_mm, mut before_mm) = (0, 0.0, 0.0);
    for stroke in strokes {
        match (stroke.e_mm < 0.0, stroke.xy_mm > 0.0) {
            (true, false) => (before_mm, wiped_mm) = (-stroke.e_mm, 0.0),
            (true, true) => wiped_mm -= stroke.e_mm,
            (false, _) if wiped_mm > 0.0 => {
                assert!(
                    (wiped_mm - 0.5_f64).abs() < 1e-4 && (before_mm - 0.5_f64).abs() < 1e-4,
                    "{wiped_mm}"
                );
                (wiped_mm, wipes) = (0.0, wipes + 1);
            }
            _ => {}
        }
    }
    assert!(wipes > 100, "{wipes}");
}

/// Heights of travels over the layer that they begin on.
fn hops(print: &Print) -> Vec<(f64, f64)> {
    let mut layer_mm = 0.0;
    let mut hops = Vec::new();
    for stroke in print.strokes() {
        if stroke.extrudes() {
            layer_mm = stroke.to[2];
        } else {
            hops.push((layer_mm, stroke.to[2] - layer_mm));
        }
    }
    hops
}

#[test]
fn travels_lift_between_two_heights_only() {
    let sets =
        ["retract.z_hop=0.6", "retract.z_hop_inside=true", "retract.z_hop_above=2", "retract.z_hop_below=4"];
    let hops = hops(&print("pin_forest", &standard(&sets)));
    let lifts = |low: f64, high: f64| {
        hops.iter().filter(|(z, hop)| *z > low && *z < high && *hop > 0.5 && *hop < 1.0).count()
    };
    assert_eq!((lifts(0.1, 1.7), lifts(4.3, 100.0)), (0, 0));
    assert!(lifts(1.9, 4.1) > 100, "{}", lifts(1.9, 4.1));
}

#[test]
fn the_nozzle_rises_at_an_angle_while_it_travels() {
    let sets = [
        "retract.z_hop=0.6",
        "retract.z_hop_inside=true",
        "retract.z_hop_slope=5",
        "travel.retract_inside=0",
    ];
    let strokes = print("plate_with_holes", &standard(&sets)).strokes();
    let travels = strokes.iter().filter(|stroke| !stroke.extrudes() && stroke.to[2] > stroke.from[2]);
    let (level, upright): (Vec<&Stroke>, Vec<&Stroke>) = travels.partition(|stroke| stroke.xy_mm > 0.0);
    let degrees = |stroke: &Stroke| ((stroke.to[2] - stroke.from[2]) / stroke.xy_mm).atan().to_degrees();
    let as_asked = level.iter().filter(|stroke| (degrees(stroke) - 5.0).abs() < 0.1).count();
    assert!(2 * as_asked > level.len(), "{as_asked} of {}; {} go straight up", level.len(), upright.len());
    assert!(level.len() > 4 * upright.len(), "{} of {}", upright.len(), level.len());
    let steepest = level.iter().map(|stroke| degrees(stroke)).fold(0.0, f64::max);
    assert!(steepest < 60.0, "none is shorter than half a millimetre: {steepest}");
    let lowest = level.iter().map(|stroke| degrees(stroke)).fold(90.0, f64::min);
    assert!(lowest > 4.8, "{lowest}");
}

#[test]
fn the_nozzle_rises_no_steeper_outside_the_part_where_it_need_not_be_up_there() {
    let sets = ["retract.z_hop=0.6", "retract.z_hop_slope=5", "retract.z_hop_before_leaving=false"];
    let strokes = print("pin_forest", &standard(&sets)).strokes();
    let travels = strokes.iter().filter(|stroke| !stroke.extrudes() && stroke.to[2] > stroke.from[2]);
    let (level, upright): (Vec<&Stroke>, Vec<&Stroke>) = travels.partition(|stroke| stroke.xy_mm > 0.0);
    let degrees = |stroke: &Stroke| ((stroke.to[2] - stroke.from[2]) / stroke.xy_mm).atan().to_degrees();
    let steeper = level.iter().filter(|stroke| degrees(stroke) > 5.1).count();
    // Where a layer begins, the nozzle has to be above it.
    assert!(20 * steeper < level.len(), "{steeper} of {}", level.len());
    assert!(level.len() > 10 * upright.len(), "{} of {}", upright.len(), level.len());
}

#[test]
fn short_layers_have_more_fan() {
    let fan = [
        "cooling.fan=20%",
        "cooling.min_layer_time=5",
        "cooling.fan_off_layers=1",
        "cooling.full_fan_layer=1",
    ];
    let short =
        ["cooling.short_layer_time=60", "cooling.short_layer_fan=[0.3, 0.9]", "order.strategy=nearest"];
    let settings = settings(&["default"], &[&fan[..], &short].concat());
    let found = print("calibration_cube", &settings);
    let fans: Vec<f64> = found
        .lines()
        .filter_map(|line| line.strip_prefix("M106 S")?.parse::<f64>().ok())
        .map(|s| s / 255.0)
        .collect();
    let seconds = found.summary.layers[50].measures.total_s;
    let share = (seconds - 5.0) / 55.0;
    let wanted = share * 0.3 + (1.0 - share) * 0.9;
    assert!(seconds > 5.0 && seconds < 60.0, "{seconds}");
    assert!(fans.iter().any(|fan| (fan - wanted).abs() < 0.003), "{wanted} is not among {fans:?}");
    assert_eq!(fans[0], 0.0, "off on the first layer");
}

/// Lines with the type that they belong to.
fn typed(print: &Print) -> Vec<(&str, &str)> {
    let mut kind = "";
    let with_kind = |line| {
        kind = Option::unwrap_or(str::strip_prefix(line, ";TYPE:"), kind);
        (kind, line)
    };
    print.lines().map(with_kind).collect()
}

#[test]
fn a_print_stands_in_the_middle_of_a_bed_that_lies_elsewhere() {
    let strokes = print("calibration_cube", &standard(&["bed.offset=[5, -8]"])).strokes();
    let beads = strokes.iter().filter(|stroke| stroke.extrudes());
    let ends: Vec<[f64; 3]> = beads.map(|stroke| stroke.to).collect();
    let middle = [0, 1].map(|i| {
        let along = || ends.iter().map(|end| end[i]);
        (along().fold(f64::INFINITY, f64::min) + along().fold(f64::NEG_INFINITY, f64::max)) / 2.0
    });
    assert!((middle[0] - 130.0).abs() < 0.1 && (middle[1] - 117.0).abs() < 0.1, "{middle:?}");
}

#[test]
fn each_role_is_drawn_with_its_own_acceleration_and_the_first_layer_with_its_own() {
    const OWN: [(&str, &str, u32); 6] = [
        ("Internal infill", "acceleration.infill=1201", 1201),
        ("External perimeter", "acceleration.external_perimeter=1202", 1202),
        ("Perimeter", "acceleration.perimeter=1203", 1203),
        ("Solid infill", "acceleration.solid=1204", 1204),
        ("Top solid infill", "acceleration.top=1205", 1205),
        ("Bridge infill", "acceleration.bridge=1206", 1206),
    ];
    let sets = [&OWN.map(|(_, set, _)| set)[..], &["first_layer.acceleration=1207"]].concat();
    let found = print("overhang_and_bridge", &standard(&sets));
    let (mut force, mut layer, mut counts) = (0, 0, [0; OWN.len()]);
    for (kind, line) in typed(&found) {
        if let Some(given) = line.strip_prefix("M204 P") {
            force = given.parse().expect("a number");
        }
        if let Some(number) = line.strip_prefix(";LAYER:") {
            layer = number.parse().expect("a number");
        }
        if !line.starts_with("G1 X") || !line.contains(" E") {
            continue;
        }
        if layer == 0 {
            assert_eq!(force, 1207, "{kind}: {line}");
        } else if let Some(i) = OWN.iter().position(|(own, _, _)| *own == kind) {
            assert_eq!(force, OWN[i].2, "{kind}: {line}");
            counts[i] += 1;
        }
    }
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

#[test]
fn small_walls_have_a_speed_of_their_own() {
    let speed = |name: &str, sets: &[&str]| {
        let strokes = print(name, &standard(sets)).strokes();
        let beads = strokes.iter().filter(|stroke| stroke.extrudes() && stroke.from[2] > 5.0);
        beads.map(|stroke| stroke.feed_mm_s).fold(0.0, f64::max)
    };
    let walls_only = [
        "infill.density=0",
        "shell.top_layers=0",
        "shell.bottom_layers=0",
        "walls.gap_fill=false",
        "speed.small_perimeter=17",
    ];
    assert!((speed("pin_forest", &walls_only) - 17.0).abs() < 0.1, "pins are small");
    assert!((speed("calibration_cube", &walls_only) - 50.0).abs() < 0.1, "a cube is not");
}

#[test]
fn bridges_may_be_as_high_as_the_layer() {
    let heights = |thick: &str| {
        let found = print("overhang_and_bridge", &standard(&[thick]));
        let lines = typed(&found)
            .into_iter()
            .filter(|(kind, line)| *kind == "Bridge infill" && line.starts_with(";HEIGHT:"));
        let heights: Vec<String> = lines.map(|(_, line)| line.to_owned()).collect();
        (heights, found.lines().any(|line| line == ";TYPE:Bridge infill"))
    };
    let (thick, thin) = (heights("bridge.thick=true"), heights("bridge.thick=false"));
    assert!(!thick.0.is_empty() && thick.0.iter().all(|height| height == ";HEIGHT:0.4"), "{thick:?}");
    assert_eq!(thin, (Vec::new(), true), "the layer's own height needs no comment");
}

#[test]
fn small_patches_of_sparse_infill_are_solid() {
    let has = |area: &str| {
        let found = print("calibration_cube", &standard(&[area]));
        found.lines().any(|line| line == ";TYPE:Internal infill")
    };
    assert!(has("infill.solid_area=100") && !has("infill.solid_area=1000"));
}
