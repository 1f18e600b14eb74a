//! Physical claims, read back from the G-code.

use proptest::prelude::*;

use crate::support::gcode_fixture::{
    bare, layer, mixed, path, plan, print, ring, seconds, volume_mm3, zigzag,
};
use pathwright::gcode::{Action, Measure, Step, Stroke, lines, measure, replay};
use pathwright::geometry::Point;
use pathwright::motion::{LayerSums, Move, PauseAt};
use pathwright::profile::{Flavor, Settings};
use pathwright::toolpath::{LayerPaths, Path, Role, Width};
use pathwright::units::{Mm, Mm3PerS, MmPerS, Seconds};

const FLAVORS: [Flavor; 3] = [Flavor::Marlin, Flavor::Klipper, Flavor::RepRapFirmware];

fn read(text: &str) -> Measure {
    measure(text.as_bytes(), Mm(1.75))
}

fn strokes(text: &str) -> Vec<(usize, Stroke)> {
    let stroke = |step: Step<'_>| match step.action {
        Action::Stroke(stroke) => Some((step.line.number, stroke)),
        _ => None,
    };
    replay(text.as_bytes()).filter_map(stroke).collect()
}

/// The default settings and some that change how moves are written.
fn variants() -> Vec<(&'static str, Settings)> {
    let base = bare();
    let with = |change: &dyn Fn(&mut Settings)| {
        let mut settings = base.clone();
        change(&mut settings);
        settings
    };
    vec![
        ("default", base.clone()),
        ("absolute E", with(&|s| s.gcode.relative_e = false)),
        ("arcs", with(&|s| s.gcode.arcs = true)),
        ("wipe and hop", with(&|s| (s.retract.wipe, s.retract.z_hop) = (Mm(2.0), Mm(0.4)))),
        ("wipe, absolute E", with(&|s| (s.retract.wipe, s.gcode.relative_e) = (Mm(2.0), false))),
        ("flow", with(&|s| (s.filament.flow, s.first_layer.flow) = (0.97, 1.1))),
        (
            "flow by role",
            with(&|s| (s.flow.external_perimeter, s.flow.perimeter, s.flow.top) = (0.9, 0.8, 1.2)),
        ),
        ("klipper", with(&|s| s.printer.flavor = Flavor::Klipper)),
        ("reprapfirmware", with(&|s| s.printer.flavor = Flavor::RepRapFirmware)),
    ]
}

#[test]
fn corners_that_are_fitted_to_another_tools_part_are_drawn_as_planned() {
    let corners = [(100.0, 100.0), (110.0, 100.0), (110.0, 110.0), (105.0, 113.0), (100.0, 110.0)];
    let mut walls = layer(0, vec![path(Role::Perimeter, true, &corners)]);
    let drawn = |walls: &LayerPaths| strokes(&print(std::slice::from_ref(walls), &bare(), &[])).len();
    let rounded = drawn(&walls);
    walls.islands[0].meets_others = true;
    let fitted = drawn(&walls);
    assert!(fitted < rounded, "{fitted} pieces, {rounded} where corners are rounded");
}

#[test]
fn the_volume_read_back_is_that_of_the_paths() {
    let layers = mixed(4);
    for (name, settings) in variants() {
        let (read, wanted) =
            (read(&print(&layers, &settings, &[])).volume_mm3, volume_mm3(&layers, &settings));
        assert!((read / wanted - 1.0).abs() < 1e-4, "{name}: {read} of {wanted} mm³");
    }
}

#[test]
fn absolute_and_relative_extrusion_put_down_the_same() {
    let layers = mixed(3);
    let mut settings = bare();
    let relative = strokes(&print(&layers, &settings, &[]));
    settings.gcode.relative_e = false;
    let absolute = strokes(&print(&layers, &settings, &[]));
    assert_eq!(relative.len(), absolute.len());
    for ((_, r), (line, a)) in relative.iter().zip(&absolute) {
        assert!((r.e_mm - a.e_mm).abs() < 1e-9 && r.to == a.to, "line {line}: {r:?} {a:?}");
    }
}

#[test]
fn long_travels_are_retracted_exactly_once_and_pushed_back_by_as_much() {
    for (name, settings) in variants() {
        let text = print(&mixed(3), &settings, &[]);
        let (mut retracted_mm, mut retractions) = (0.0_f64, 0);
        let mut last_end: Option<[f64; 3]> = None;
        for (line, stroke) in strokes(&text) {
            retractions += usize::from(stroke.e_mm < 0.0 && retracted_mm == 0.0);
            retracted_mm = ((retracted_mm - stroke.e_mm.min(0.0)) * 1e5).round() / 1e5;
            if stroke.extrudes() {
                assert_eq!(retracted_mm, 0.0, "{name}, line {line}: extrudes while retracted");
                if let Some(end) = last_end {
                    let link_mm = (stroke.from[0] - end[0]).hypot(stroke.from[1] - end[1]);
                    let wanted = usize::from(link_mm > settings.retract.min_travel.0);
                    assert_eq!(retractions, wanted, "{name}, line {line}: travel of {link_mm} mm");
                }
                (last_end, retractions) = (Some(stroke.to), 0);
            } else if stroke.e_mm > 0.0 {
                assert!((stroke.e_mm - settings.retract.length.0).abs() < 1e-9, "{name}, line {line}");
                assert!((retracted_mm - settings.retract.length.0).abs() < 1e-9, "{name}, line {line}");
                retracted_mm = 0.0;
            }
        }
    }
}

#[test]
fn nothing_is_extruded_in_place() {
    // Beads shorter than the writer can tell, alone and in a row.
    let mut dust = path(Role::GapFill, false, &[(120.0, 120.0), (120.0, 120.0)]);
    dust.points[1].x += 30;
    let mut crumbs =
        path(Role::GapFill, false, &[(121.0, 120.0), (121.0, 120.0), (121.0, 120.0), (122.0, 120.0)]);
    (crumbs.points[1].x, crumbs.points[2].x) = (crumbs.points[0].x + 20, crumbs.points[0].x + 45);
    let layers = [layer(0, vec![dust, crumbs, zigzag(Role::SolidInfill, (100.0, 100.0), 5.0)])];
    for (name, settings) in variants() {
        let text = print(&layers, &settings, &[]);
        for (line, stroke) in strokes(&text) {
            assert!(stroke.xy_mm > 0.0 || stroke.fresh_mm.abs() < 1e-9, "{name}, line {line}: {stroke:?}");
        }
    }
}

#[test]
fn loops_return_exactly_to_their_start() {
    let layers = [layer(0, vec![ring(Role::Perimeter, (110.0, 110.0), 7.77, 77)])];
    for (name, settings) in variants() {
        let drawn: Vec<Stroke> = strokes(&print(&layers, &settings, &[]))
            .into_iter()
            .map(|s| s.1)
            .filter(Stroke::extrudes)
            .collect();
        assert_eq!(drawn.first().map(|s| s.from), drawn.last().map(|s| s.to), "{name}");
    }
}

#[test]
fn arcs_stay_within_their_tolerance_and_shorten_the_file() {
    let layers = [layer(0, vec![ring(Role::ExternalPerimeter, (110.0, 110.0), 10.0, 200)])];
    let mut settings = bare();
    let straight = print(&layers, &settings, &[]);
    settings.gcode.arcs = true;
    let text = print(&layers, &settings, &[]);
    let arcs: Vec<Stroke> = strokes(&text).into_iter().map(|s| s.1).filter(|s| s.arc.is_some()).collect();
    assert!(!arcs.is_empty() && strokes(&text).len() < strokes(&straight).len() / 4);
    // Chords of the ring lie up to 1.2 µm inside it, and positions are written to a micrometre.
    let allowed_mm = settings.gcode.arc_tolerance.0 + 0.003;
    for arc in &arcs {
        for i in 0..=20 {
            let [x, y, _] = arc.at(f64::from(i) / 20.0);
            let off_mm = ((x - 110.0).hypot(y - 110.0) - 10.0).abs();
            assert!(off_mm <= allowed_mm, "{off_mm} mm off at {x}, {y}");
        }
    }
    assert!((read(&text).volume_mm3 / read(&straight).volume_mm3 - 1.0).abs() < 1e-4);
    assert!((read(&text).print_mm / read(&straight).print_mm - 1.0).abs() < 1e-3);
}

#[test]
fn the_fan_is_off_on_the_first_layer_and_on_at_the_fourth() {
    for flavor in FLAVORS {
        let mut settings = bare();
        settings.printer.flavor = flavor;
        let text = print(&mixed(5), &settings, &[]);
        let (mut layer_index, mut fan, mut seen) = (None, None, Vec::new());
        for line in lines(text.as_bytes()) {
            if let Some(number) = line.comment.and_then(|c| c.strip_prefix(b"LAYER:")) {
                seen.push((layer_index, fan));
                layer_index = String::from_utf8_lossy(number).parse::<usize>().ok();
            } else if line.code.is_some_and(|c| (c.letter, c.number) == (b'M', 106)) {
                fan = line.words().get(b'S');
            }
        }
        let full = if flavor == Flavor::RepRapFirmware { 1.0 } else { 255.0 };
        assert_eq!(seen[1], (Some(0), Some(0.0)), "{flavor:?}");
        assert_eq!(seen[4], (Some(3), Some(full)), "{flavor:?}");
    }
}

#[test]
fn small_layers_last_as_long_as_they_should_and_large_ones_keep_their_speed() {
    let small: Vec<_> =
        (1..3).map(|i| layer(i, vec![ring(Role::Perimeter, (110.0, 110.0), 5.0, 60)])).collect();
    let mut settings = bare();
    for wanted_s in [3.0, 2.0, 1.0] {
        settings.cooling.min_layer_time = Seconds(wanted_s);
        for time in seconds(&small, &settings) {
            assert!((wanted_s..=wanted_s * 1.01).contains(&time.0), "{} of {wanted_s} s", time.0);
        }
    }
    settings.cooling.min_layer_time = Seconds(1e6);
    let slowest = strokes(&print(&small, &settings, &[]));
    for (line, stroke) in slowest.iter().filter(|s| s.1.extrudes()) {
        assert!((stroke.feed_mm_s - settings.cooling.min_speed.0).abs() < 1e-9, "line {line}: {stroke:?}");
    }
    settings.cooling.min_layer_time = Seconds(0.01);
    assert!(plan(&small, &settings, &[]).iter().flat_map(|(l, _)| &l.moves).all(|m| match m {
        Move::Extrude { speed, .. } => *speed == settings.speed.perimeter,
        _ => true,
    }));
}

#[test]
fn the_flow_limit_is_kept() {
    let mut settings = bare();
    settings.filament.max_flow = Mm3PerS(3.0);
    settings.cooling.min_layer_time = Seconds(0.0);
    settings.speed.infill = MmPerS(200.0);
    let area_mm2 = std::f64::consts::PI / 4.0 * 1.75 * 1.75;
    let text = print(&[layer(1, vec![zigzag(Role::InternalInfill, (100.0, 100.0), 20.0)])], &settings, &[]);
    for (line, s) in strokes(&text).iter().filter(|s| s.1.extrudes()) {
        let flow = s.fresh_mm * area_mm2 * s.feed_mm_s / s.xy_mm;
        // Ends are rounded to a micrometre.
        let most = 3.0 * (1.001 + 0.0015 / s.xy_mm);
        assert!(flow <= most && flow > 2.85, "line {line}: {flow} mm³/s");
    }
}

#[test]
fn the_nozzle_is_at_the_layers_height_before_it_travels_there() {
    let mut settings = bare();
    settings.layer.z_offset = Mm(0.05);
    for hop_mm in [0.0, 0.3] {
        settings.retract.z_hop = Mm(hop_mm);
        let text = print(&mixed(2), &settings, &[]);
        let strokes = strokes(&text);
        assert!((strokes[0].1.e_mm + 1.0).abs() < 1e-9, "retracts first: {:?}", strokes[0]);
        assert!((strokes[1].1.to[2] - 0.25 - hop_mm).abs() < 1e-9 && strokes[1].1.xy_mm == 0.0);
        let heights = read(&text).heights_um;
        assert_eq!(heights, [250, 450]);
    }
}

#[test]
fn a_pause_comes_before_its_layer_while_retracted() {
    for (flavor, command) in FLAVORS.into_iter().zip(["M600", "PAUSE", "M600"]) {
        let mut settings = bare();
        settings.printer.flavor = flavor;
        let text = print(&mixed(4), &settings, &["3".parse().expect("a layer"), PauseAt::Height(0.7)]);
        let at = |needle: &str| text.lines().position(|l| l == needle).expect("is there");
        let pauses: Vec<usize> =
            text.lines().enumerate().filter(|(_, l)| *l == command).map(|(n, _)| n).collect();
        assert_eq!(pauses.len(), 2, "{flavor:?}");
        assert!(at(";LAYER:2") < pauses[0] && pauses[0] < at(";LAYER:3") && at(";LAYER:3") < pauses[1]);
        let before = text.lines().nth(pauses[0] - 1).expect("a line");
        assert!(before.starts_with("G1 E-1"), "{before}");
    }
    let mut settings = bare();
    settings.gcode.pause = "M25\nM117 change".into();
    assert!(print(&mixed(2), &settings, &[PauseAt::Layer(1)]).contains("\nM25\nM117 change\nG90\nM83\n"));
}

#[test]
fn firmware_retraction_writes_no_lengths() {
    let mut settings = bare();
    settings.retract.firmware = true;
    let text = print(&mixed(2), &settings, &[]);
    let count = |code: &str| text.lines().filter(|l| *l == code).count();
    assert!(count("G10") > 0 && count("G10") == count("G11"));
    assert!(strokes(&text).iter().all(|s| s.1.e_mm >= 0.0 && (s.1.e_mm == 0.0 || s.1.xy_mm > 0.0)));
}

#[test]
fn layers_do_not_depend_on_each_other() {
    let settings = Settings {
        gcode: pathwright::profile::GcodeSettings { relative_e: false, ..Default::default() },
        ..Default::default()
    };
    let text = print(&mixed(3), &settings, &[]);
    for part in text.split(";LAYER_CHANGE\n").skip(1) {
        let body: Vec<&str> = part.lines().take_while(|l| *l != ";TYPE:Custom").collect();
        assert!(body.contains(&"G92 E0"));
        let first = body.iter().find(|l| l.starts_with("G1 X")).expect("a move");
        assert!(first.contains('Y') && first.contains('F'), "{first}");
    }
}

#[test]
fn header_and_footer_say_what_moonraker_reads() {
    let text = print(&mixed(3), &bare(), &[]);
    assert!(text.starts_with("; generated by Pathwright 0.1.0 on 2000-01-01 at 00:00:00"));
    let value = |part: &str, key: &str| {
        let line = part.lines().find_map(|l| l.strip_prefix(&format!("; {key} = ")).map(str::trim));
        line.unwrap_or_else(|| panic!("no {key}")).to_owned()
    };
    let (head, foot) = text.split_at(text.len() / 2);
    for key in
        ["estimated printing time (normal mode)", "filament used [mm]", "filament used [g]", "filament cost"]
    {
        assert_eq!(value(head, key), value(foot, key));
        assert!(value(head, key).starts_with(|c: char| c.is_ascii_digit()));
    }
    assert_eq!([value(head, "total layers count"), value(head, "layer_height")], ["3", "0.2"]);
    let filament_mm: f64 = value(foot, "filament used [mm]").parse().expect("a number");
    assert!((filament_mm * 2.40528 / read(&text).volume_mm3 - 1.0).abs() < 1e-3);
    assert!(text.contains("\nM73 P0 R"));
}

#[test]
fn a_start_script_without_heating_gets_it() {
    let mut settings = bare();
    settings.gcode.start = "G28".into();
    let text = print(&mixed(1), &settings, &[]);
    assert!(
        text.contains("M140 S60\nM104 S210\nM190 S60\nM109 S210\n;TYPE:Custom\nG28\nG21\nG90\nM83\n"),
        "{text}"
    );
    settings.gcode.start = "M190 S{bed_temp}\nM109 S{nozzle_temp}\nG28".into();
    let text = print(&mixed(1), &settings, &[]);
    assert!(text.contains(";TYPE:Custom\nM190 S60\nM109 S210\nG28\nG21\n"), "{text}");
}

#[test]
fn the_sums_of_the_moves_are_those_of_the_file() {
    for (name, settings) in variants() {
        let layers = mixed(3);
        let file = read(&print(&layers, &settings, &[]));
        let mut sums = LayerSums::default();
        for (moves, _) in plan(&layers, &settings, &[]) {
            sums += moves.sums();
        }
        for (ours, theirs) in [
            (sums.print.0, file.print_mm),
            (sums.travel.0, file.travel_mm),
            (sums.link.0, file.link_mm),
            (sums.volume.0, file.volume_mm3),
        ] {
            assert!((ours / theirs - 1.0).abs() < 1e-4, "{name}: {ours}, file {theirs}");
        }
        assert_eq!((sums.travels, sums.retractions), (file.travels, file.retractions), "{name}");
    }
}

/// Paths on a coarse grid (so that ends coincide) and of any size, some with repeated vertices.
fn any_path() -> impl Strategy<Value = Path> {
    let point = (0..2000_i32, 0..2000_i32, prop_oneof![Just(1), Just(40), Just(5000)]);
    let points = prop::collection::vec(point, 2..12);
    (points, any::<bool>(), 0.05..0.9_f64, 0..4_usize).prop_map(|(points, closed, width_mm, role)| {
        let roles = [Role::Perimeter, Role::ExternalPerimeter, Role::BridgeInfill, Role::GapFill];
        let mut path = path(roles[role], closed, &[]);
        path.points =
            points.iter().map(|p| Point::new(10_000_000 + p.0 * p.2, 10_000_000 + p.1 * p.2)).collect();
        path.width = if points.len() % 2 == 0 {
            Width::Constant(width_mm)
        } else {
            Width::PerVertex(points.iter().map(|p| 0.1 + p.0 as f32 / 3000.0).collect())
        };
        path
    })
}

/// What round outsides leave open at most in the corners of inner walls and solid infill, which turn by up to 2 rad.
fn open_mm3(layers: &[LayerPaths]) -> f64 {
    let is_rounded =
        |path: &&Path| matches!(path.role, Role::Perimeter | Role::SolidInfill | Role::TopSolidInfill);
    let open_mm3 = |path: &Path| {
        let half_mm = match &path.width {
            Width::Constant(width_mm) => 0.5 * width_mm,
            Width::PerVertex(widths) => 0.5 * f64::from(widths.iter().copied().fold(0.0, f32::max)),
        };
        path.points.len() as f64 * half_mm * half_mm * path.height_mm * (1.0_f64.tan() - 1.0)
    };
    layers.iter().flat_map(|layer| &layer.paths).filter(is_rounded).map(open_mm3).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_paths_give_sound_gcode_of_their_volume(
        layers in prop::collection::vec(prop::collection::vec(any_path(), 0..6), 1..4)
    ) {
        let layers: Vec<_> = layers.into_iter().enumerate().map(|(i, paths)| layer(i, paths)).collect();
        for (name, settings) in variants() {
            let text = print(&layers, &settings, &[]);
            let (read, wanted) = (read(&text).volume_mm3, volume_mm3(&layers, &settings));
            // What is left of each layer's last bead is less than a digit of E; rounded corners hold more.
            let (off, open) = (1e-4 * wanted + 1e-3, open_mm3(&layers));
            prop_assert!((wanted - off..wanted + open + off).contains(&read), "{}: {} of {} mm³", name, read, wanted);
            let mut pulled_mm = 0.0_f64;
            for (line, stroke) in strokes(&text) {
                prop_assert!(stroke.xy_mm > 0.0 || stroke.fresh_mm < 1e-9, "{}, line {}", name, line);
                prop_assert!(!stroke.extrudes() || pulled_mm.abs() < 1e-9, "{}, line {}", name, line);
                prop_assert!(stroke.feed_mm_s > 0.0);
                pulled_mm -= stroke.e_mm - stroke.fresh_mm;
            }
            prop_assert!(pulled_mm.abs() < 1e-9);
        }
    }
}
