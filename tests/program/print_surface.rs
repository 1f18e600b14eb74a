//! What makes a good surface, asserted on the G-code of bundled models: travels, bridges, overhangs, seams, cooling.

use crate::support::print::{Bead, Print, model, print, settings, solid};
use pathwright::geometry::{Point, Region, clip_polyline, offset, polyline_length_mm};
use pathwright::profile::Settings;

/// Which layer lies at a height.
fn layer_at(z_mm: f64, settings: &Settings) -> usize {
    ((z_mm - settings.layer.first_height.0) / settings.layer.height.0).round() as usize
}

/// The travels of a print between its beads: the points passed, filament pulled back and pushed forward, how
/// often it was pulled back, and the height.
struct Travel {
    points: Vec<[f64; 2]>,
    pulled_mm: f64,
    pushed_mm: f64,
    retractions: usize,
    z_mm: f64,
    /// Where it ended, and whether it was at no other height between.
    to_z_mm: f64,
    level: bool,
}

fn travels(print: &Print) -> Vec<Travel> {
    let mut travels: Vec<Travel> = Vec::new();
    let mut open: Option<Travel> = None;
    for stroke in print.strokes() {
        if stroke.extrudes() {
            travels.extend(open.take().filter(|t| t.points.len() > 1));
            let [x, y, z_mm] = stroke.to;
            open = Some(Travel {
                points: vec![[x, y]],
                pulled_mm: 0.0,
                pushed_mm: 0.0,
                retractions: 0,
                z_mm,
                to_z_mm: z_mm,
                level: true,
            });
        } else if let Some(travel) = &mut open {
            if stroke.e_mm < 0.0 {
                (travel.pulled_mm, travel.retractions) =
                    (travel.pulled_mm - stroke.e_mm, travel.retractions + 1);
            }
            travel.pushed_mm += stroke.e_mm.max(0.0);
            travel.to_z_mm = stroke.to[2];
            travel.level &= stroke.to[2] == travel.z_mm;
            if stroke.xy_mm > 0.0 {
                travel.points.push([stroke.to[0], stroke.to[1]]);
            }
        }
    }
    travels
}

impl Travel {
    fn length_mm(&self) -> f64 {
        self.points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum()
    }

    /// How much of it lies in a region.
    fn inside_mm(&self, region: &Region) -> f64 {
        let points: Vec<Point> = self.points.iter().map(|p| Point::from_mm(p[0], p[1])).collect();
        clip_polyline(region, &points).iter().map(|piece| polyline_length_mm(&piece.points)).sum()
    }
}

#[test]
fn long_travels_are_retracted_once_and_undone_exactly() {
    let settings = quick(&[]);
    for name in ["pin_forest", "thin_wall_comb"] {
        let (print, solid) = (print(name, &settings), solid(&model(name), &settings));
        let mut inside = 0;
        for travel in travels(&print) {
            let length_mm = travel.length_mm();
            let section = offset(&solid.section(Some(layer_at(travel.z_mm, &settings))), -0.14);
            let stays = travel.level && travel.inside_mm(&section) > length_mm - 1e-3;
            assert_eq!(travel.pulled_mm, travel.pushed_mm, "{name}: {length_mm} mm");
            assert!(
                travel.retractions <= 1 && travel.pulled_mm == travel.retractions as f64,
                "{name}: {length_mm} mm"
            );
            if length_mm <= settings.retract.min_travel.0 - 0.01 {
                assert_eq!(travel.retractions, 0, "{name}: {length_mm} mm");
            } else if length_mm > settings.travel.retract_inside.0 + 0.01 {
                assert_eq!(travel.retractions, 1, "{name}: {length_mm} mm");
            } else if stays && length_mm < settings.travel.retract_inside.0 - 0.01 {
                assert_eq!(travel.retractions, 0, "{name}: {length_mm} mm inside");
                inside += 1;
            } else if travel.inside_mm(&offset(&section, 0.14)) < length_mm - 1e-3 {
                assert_eq!(travel.retractions, 1, "{name}: {length_mm} mm over an edge");
            }
        }
        assert!(inside > 0 || name == "pin_forest", "{name} has travels inside");
    }
}

#[test]
fn travels_go_round_holes_where_a_detour_exists() {
    let [straight, round] = [0, 500].map(|detour_mm| {
        let set = format!("travel.max_detour={detour_mm}");
        let settings = quick(&["skirt.loops=0", "layer.height=0.3", "infill.density=0", &set]);
        let solid = solid(&model("plate_with_holes"), &settings);
        let print = print("plate_with_holes", &settings);
        let over_mm =
            |t: &Travel| t.length_mm() - t.inside_mm(&solid.section(Some(layer_at(t.z_mm, &settings))));
        let crossing = travels(&print).iter().filter(|t| t.level && over_mm(t) > 1e-3).count();
        (crossing, print.measure(&settings).link_mm)
    });
    assert!(straight.0 > 10, "the test has travels over holes");
    assert_eq!(round.0, 0, "travels over holes");
    assert!(
        (straight.1 - round.1).abs() < 1e-2,
        "links are straight lines: {} and {} mm",
        straight.1,
        round.1
    );
}

#[test]
fn the_nozzle_lifts_only_over_outer_walls() {
    let settings = quick(&["retract.z_hop=0.3", "travel.retract_inside=0", "travel.max_detour=0"]);
    let (print, solid) = (print("thin_wall_comb", &settings), solid(&model("thin_wall_comb"), &settings));
    let mut counts = [0, 0];
    for travel in travels(&print).iter().filter(|t| t.retractions > 0 && t.to_z_mm == t.z_mm) {
        let section = solid.section(Some(layer_at(travel.z_mm, &settings)));
        let length_mm = travel.length_mm();
        let crosses = travel.inside_mm(&section) < length_mm - 1e-3;
        let stays = travel.inside_mm(&offset(&section, -0.14)) > length_mm - 1e-3;
        if crosses || stays {
            assert_eq!(!travel.level, crosses, "{:?}", travel.points);
            counts[usize::from(crosses)] += 1;
        }
    }
    assert!(counts.iter().all(|&n| n > 0), "the test has both: {counts:?}");
}

/// The default job, ordered quickly, with keys replaced.
fn quick(sets: &[&str]) -> Settings {
    settings(&[], &[&["order.strategy=nearest"], sets].concat())
}

#[test]
fn nothing_is_laid_in_mid_air_but_bridges_with_hold_at_both_ends() {
    let settings = quick(&["skirt.loops=0"]);
    for name in ["overhang_and_bridge", "tilted_bracket"] {
        let solid = solid(&model(name), &settings);
        let mut bridged = false;
        for run in runs(&print(name, &settings)) {
            let layer = layer_at(run.z_mm, &settings);
            let Some(below) = layer.checked_sub(1) else { continue };
            let held = offset(&solid.section(Some(below)), 0.24);
            let over: Vec<(bool, &str)> = run.samples().map(|(p, kind)| (held.contains(p), kind)).collect();
            let mut last_held = false;
            for (i, &(on, kind)) in over.iter().enumerate() {
                let comes_back = || over[i..].iter().any(|(on, _)| *on);
                assert!(
                    on || (last_held && comes_back()) || run.closed,
                    "{name}, layer {layer}: {kind} in mid-air"
                );
                assert!(
                    on || ["Bridge infill", "Overhang perimeter"].contains(&kind),
                    "{name}, layer {layer}: {kind}"
                );
                last_held |= on;
                bridged |= !on;
            }
        }
        assert!(bridged || name != "overhang_and_bridge", "the test has bridges");
    }
}

/// What is laid between two travels.
struct DrawnLine {
    z_mm: f64,
    points: Vec<[f64; 2]>,
    /// `;TYPE:` of each line.
    kinds: Vec<String>,
    closed: bool,
}

fn runs(print: &Print) -> Vec<DrawnLine> {
    let mut runs: Vec<DrawnLine> = Vec::new();
    for bead in print.beads() {
        let kinds = vec![bead.kind.clone(); bead.points.len() - 1];
        match runs.last_mut() {
            Some(run) if run.z_mm == bead.z_mm && run.points.last() == bead.points.first() => {
                run.points.extend(&bead.points[1..]);
                run.kinds.extend(kinds);
            }
            _ => runs.push(DrawnLine { z_mm: bead.z_mm, points: bead.points, kinds, closed: false }),
        }
    }
    for run in &mut runs {
        let (first, last) = (run.points[0], run.points[run.points.len() - 1]);
        run.closed = (first[0] - last[0]).hypot(first[1] - last[1]) < 0.06;
    }
    runs
}

impl DrawnLine {
    /// Places half a millimetre apart or less, with the kind of what is laid there.
    fn samples(&self) -> impl Iterator<Item = (Point, &str)> {
        self.points.windows(2).zip(&self.kinds).flat_map(|(w, kind)| {
            let (a, b) = (w[0], w[1]);
            let steps = ((b[0] - a[0]).hypot(b[1] - a[1]) / 0.5).ceil() as u32;
            (0..=steps).map(move |i| {
                let t = f64::from(i) / f64::from(steps.max(1));
                (Point::from_mm(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])), kind.as_str())
            })
        })
    }
}

#[test]
fn bridges_and_overhangs_have_their_own_speed_and_fan() {
    let settings = quick(&["cooling.fan=30%", "cooling.min_layer_time=0", "cooling.overhang_fan=80%"]);
    let print = print("overhang_and_bridge", &settings);
    let (mut kind, mut fan, mut seen) = (String::new(), 0.0, [0; 2]);
    for line in print.lines() {
        if let Some(name) = line.strip_prefix(";TYPE:") {
            kind = name.into();
        } else if let Some(value) = line.strip_prefix("M106 S") {
            fan = value.parse::<f64>().expect("a number") / 255.0;
        } else if line.starts_with("G1 X") && line.contains(" E") {
            let wanted = match kind.as_str() {
                "Bridge infill" => 1.0,
                "Overhang perimeter" => 0.8,
                _ => fan.min(0.3),
            };
            assert!((fan - wanted).abs() < 0.01, "{kind} with fan {fan}");
            seen[0] += usize::from(kind == "Bridge infill");
            seen[1] += usize::from(kind == "Overhang perimeter");
        }
    }
    assert!(seen.iter().all(|&n| n > 0), "{seen:?}");
    for bead in print.beads() {
        let most = match bead.kind.as_str() {
            "Bridge infill" | "Overhang perimeter" => settings.speed.bridge.0,
            _ => continue,
        };
        assert!(bead.feed_mm_s <= most + 0.01, "{}: {} mm/s", bead.kind, bead.feed_mm_s);
    }
}

#[test]
fn aligned_seams_stay_in_line_from_layer_to_layer() {
    let settings = quick(&["seam.position=aligned", "seam.gap=0"]);
    for (name, most_mm) in [("calibration_cube", 0.1), ("hollow_vase", 1.0), ("helical_gear", 1.0)] {
        let mut layers: Vec<Vec<[f64; 2]>> = Vec::new();
        for bead in
            print(name, &settings).beads().iter().filter(|b| b.kind == "External perimeter" && b.closed())
        {
            let layer = layer_at(bead.z_mm, &settings);
            layers.resize(layers.len().max(layer + 1), Vec::new());
            layers[layer].push(bead.points[0]);
        }
        // Where parts begin or end, seams do.
        for (i, pair) in layers.windows(2).enumerate().filter(|(_, pair)| pair[0].len() == pair[1].len()) {
            for seam in &pair[1] {
                let to = |p: &[f64; 2]| (p[0] - seam[0]).hypot(p[1] - seam[1]);
                let nearest_mm = pair[0].iter().map(to).fold(f64::INFINITY, f64::min);
                assert!(nearest_mm < most_mm, "{name}, layer {}: {nearest_mm} mm from the seam below", i + 1);
            }
        }
    }
}

#[test]
fn loops_end_before_they_close_by_the_gap() {
    let settings = quick(&["seam.gap=0.2", "skirt.loops=0", "walls.gap_fill=false"]);
    for bead in print("calibration_cube", &settings).beads().iter().filter(|b| b.kind.ends_with("erimeter")) {
        let (first, last) = (bead.points[0], bead.points[bead.points.len() - 1]);
        let gap_mm = (first[0] - last[0]).hypot(first[1] - last[1]);
        assert!((gap_mm - 0.2).abs() < 0.01, "{gap_mm} mm at {first:?}");
    }
}

/// The closed walls of which some part hangs over: layer and signed area of each, in the order of the file.
fn overhanging_loops(name: &str, settings: &Settings) -> Vec<(usize, f64)> {
    let mut loops: Vec<(Bead, bool)> = Vec::new();
    for bead in print(name, settings).beads() {
        let hangs = bead.kind == "Overhang perimeter";
        match loops.last_mut() {
            // A wall is cut where it begins to hang over.
            Some((last, over)) if last.z_mm == bead.z_mm && last.points.last() == bead.points.first() => {
                last.points.extend(&bead.points[1..]);
                *over |= hangs;
            }
            _ => loops.push((bead, hangs)),
        }
    }
    let closed = |p: &[[f64; 2]]| {
        let [first, last] = [p[0], p[p.len() - 1]];
        (first[0] - last[0]).hypot(first[1] - last[1]) < 0.1
    };
    let area = |p: &[[f64; 2]]| p.windows(2).map(|p| p[0][0] * p[1][1] - p[1][0] * p[0][1]).sum::<f64>();
    let found = loops.iter().filter(|(bead, over)| *over && closed(&bead.points));
    found.map(|(bead, _)| (layer_at(bead.z_mm, settings), area(&bead.points))).collect()
}

#[test]
fn overhanging_loops_run_the_other_way_round_on_every_other_layer() {
    let [usual, reversed] = [false, true].map(|reversed| {
        let settings = quick(&["skirt.loops=0", &format!("walls.reverse_overhangs={reversed}")]);
        overhanging_loops("overhang_and_bridge", &settings)
    });
    assert!(usual.len() > 10 && usual.len() == reversed.len(), "{} {}", usual.len(), reversed.len());
    for ((layer, before), (also, after)) in usual.into_iter().zip(reversed) {
        let turned = before.signum() != after.signum();
        assert!(layer == also && turned == (layer % 2 == 1), "layer {layer}: {before} {after} mm²");
    }
}

#[test]
fn scarfs_of_thick_layers_beside_other_walls_pass_the_check() {
    // Slicing ends in an error where they do not.
    let settings = quick(&["seam.scarf=5", "layer.height=0.3", "layer.first_height=0.3"]);
    for name in ["nested_shells", "tilted_bracket", "thin_wall_comb"] {
        print(name, &settings);
    }
}

#[test]
fn scarfs_follow_curves_and_leave_corners_alone_where_that_is_wanted() {
    let scarfs = |name: &str, smooth_only: bool| {
        let smooth_only = format!("seam.scarf_smooth_only={smooth_only}");
        let settings = quick(&["seam.position=rear", "seam.scarf=3", "skirt.loops=0", &smooth_only]);
        let strokes = print(name, &settings).strokes();
        strokes.iter().filter(|s| s.extrudes() && s.xy_mm > 0.0 && s.to[2] != s.from[2]).count()
    };
    // The rear of a cube is a corner, that of a vase is a curve.
    assert!(scarfs("calibration_cube", false) > 500 && scarfs("calibration_cube", true) == 0);
    assert!(scarfs("hollow_vase", true) > 500, "{}", scarfs("hollow_vase", true));
}

#[test]
fn a_scarf_changes_the_volume_by_nothing() {
    let [plain, scarf] = ["0", "8"].map(|length| {
        let settings = quick(&["seam.gap=0", &format!("seam.scarf={length}")]);
        print("calibration_cube", &settings).measure(&settings)
    });
    assert!((scarf.volume_mm3 / plain.volume_mm3 - 1.0).abs() < 1e-4, "{} mm³", scarf.volume_mm3);
    assert!(scarf.print_mm > plain.print_mm + 8.0 * 90.0, "each outer wall is longer by the scarf");
}

#[test]
fn wipes_follow_the_loop_and_cross_layer_changes() {
    let settings = quick(&["retract.wipe=1", "skirt.loops=0", "travel.retract_inside=0"]);
    let (mut wiped, mut bare) = (0, 0);
    for travel in travels(&print("pin_forest", &settings)).iter().filter(|t| t.retractions > 0) {
        assert!((travel.pulled_mm - travel.pushed_mm).abs() < 1e-9);
        if travel.retractions > 1 || travel.points.len() > 2 { wiped += 1 } else { bare += 1 }
    }
    assert!(wiped > 100 && bare == 0, "{wiped} retractions with a wipe, {bare} without");
}

#[test]
fn short_layers_slow_outer_walls_last() {
    let settings = quick(&[]);
    let print = print("pin_forest", &settings);
    let mut layers: Vec<Vec<Bead>> = vec![Vec::new(); print.summary.layer_count];
    for bead in print.beads() {
        layers[layer_at(bead.z_mm, &settings)].push(bead);
    }
    let (mut spared, outer_mm_s) = (0, settings.speed.external_perimeter.0);
    for beads in &layers[1..] {
        let (outer, inner): (Vec<_>, Vec<_>) = beads
            .iter()
            .partition(|b| ["External perimeter", "Overhang perimeter"].contains(&b.kind.as_str()));
        let slowed = outer.iter().any(|b| b.kind == "External perimeter" && b.feed_mm_s < outer_mm_s - 1.0);
        let slowest = inner.iter().all(|b| b.feed_mm_s <= settings.cooling.min_speed.0 + 0.02);
        assert!(!slowed || slowest, "an outer wall is slowed before the rest is");
        spared += usize::from(!slowed && inner.iter().any(|b| b.feed_mm_s < 30.0));
    }
    assert!(spared > 0, "the test has layers that are slowed");
}

/// The sharpest turn within a bead of a kind, in degrees.
fn sharpest_turn(print: &Print, kind: &str) -> f64 {
    let direction = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]).atan2(b[0] - a[0]);
    let beads = print.beads().into_iter().filter(|bead| bead.kind == kind);
    let turns = beads.flat_map(|bead| {
        let turn = |w: &[[f64; 2]]| (direction(w[1], w[2]) - direction(w[0], w[1])).to_degrees().abs();
        bead.points.windows(3).map(|w| turn(w).min(360.0 - turn(w))).collect::<Vec<_>>()
    });
    turns.fold(0.0, f64::max)
}

#[test]
fn inner_walls_round_their_corners_and_outer_ones_keep_them() {
    let print = print("calibration_cube", &quick(&[]));
    assert!(sharpest_turn(&print, "Perimeter") < 45.0);
    assert!(sharpest_turn(&print, "External perimeter") > 89.0);
}

#[test]
fn walls_around_holes_never_turn_back() {
    let print = print("plate_with_holes", &quick(&[]));
    let degrees = sharpest_turn(&print, "Perimeter");
    assert!(degrees < 120.0, "{degrees}");
}
