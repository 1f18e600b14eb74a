//! What is laid over air, checked on sections made here.

use crate::support::toolpath_plan::{
    covers_beyond, job, length_mm, of_role, plan, rectangle, ring, with_hole,
};
use pathwright::geometry::{self, Point, Polygon, Region};
use pathwright::profile::WallGenerator;
use pathwright::toolpath::{LayerPaths, Path, Role};
use pathwright::units::Ratio;

/// The layer that closes an opening: full sections on top of sections with it.
fn roof(open: &Region, full: &Region) -> LayerPaths {
    let sections = [vec![open.clone(); 6], vec![full.clone(); 6]].concat();
    plan(&sections, &job()).swap_remove(6)
}

/// Whether all long bridge lines of a layer's bridges run in a direction (degrees from X), and end over `hold`.
fn bridges_run(layer: &LayerPaths, degrees: f64, hold: &Region) -> bool {
    let lines: Vec<[Point; 2]> = of_role(layer, Role::BridgeInfill)
        .iter()
        .flat_map(|p| p.points.windows(2).map(|e| [e[0], e[1]]))
        .filter(|[a, b]| a.distance_mm(*b) > 3.0)
        .collect();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let along = |[a, b]: &[Point; 2]| {
        let [dx, dy] = (*b - *a).mm();
        (dx * sin - dy * cos).abs() < 0.01 * a.distance_mm(*b)
    };
    let held = |p: &Point| hold.contains(*p);
    !lines.is_empty() && lines.iter().all(|t| along(t) && t.iter().all(held))
}

#[test]
fn bridges_span_the_short_side_of_a_rectangle() {
    for (pit, degrees) in [(rectangle(10.0, 5.0, 30.0, 15.0), 90.0), (rectangle(15.0, 2.0, 22.0, 18.0), 0.0)]
    {
        let full = rectangle(0.0, 0.0, 40.0, 20.0);
        let open = with_hole(full.clone(), &pit);
        assert!(bridges_run(&roof(&open, &full), degrees, &open), "{degrees}");
    }
}

#[test]
fn lines_beside_a_bridge_that_lie_on_the_part_are_no_thicker_than_the_layer() {
    let full = rectangle(0.0, 0.0, 40.0, 20.0);
    let open = with_hole(full.clone(), &rectangle(15.0, 2.0, 22.0, 18.0));
    let roof = roof(&open, &full);
    let deep = geometry::offset(&open, -0.3);
    let longest_mm = |role| {
        let edges = of_role(&roof, role).into_iter().flat_map(|p| p.points.windows(2));
        let lies = |e: &&[Point]| {
            let [[ax, ay], [bx, by]] = [e[0].mm(), e[1].mm()];
            [e[0], Point::from_mm((ax + bx) / 2.0, (ay + by) / 2.0), e[1]].iter().all(|p| deep.contains(*p))
        };
        edges.filter(lies).map(|e| e[0].distance_mm(e[1])).fold(0.0, f64::max)
    };
    let (thick_mm, laid_mm) = (longest_mm(Role::BridgeInfill), longest_mm(Role::SolidInfill));
    assert!(thick_mm < 3.0 && laid_mm > 6.0, "{thick_mm} mm as thick as a bridge line, {laid_mm} mm not");
}

#[test]
fn bridges_between_two_pillars_go_from_one_to_the_other() {
    let full = rectangle(0.0, 0.0, 40.0, 8.0);
    let mut pillars = rectangle(0.0, 0.0, 8.0, 8.0);
    pillars.add_disjoint(rectangle(32.0, 0.0, 40.0, 8.0).into_polygons());
    assert!(bridges_run(&roof(&pillars, &full), 0.0, &pillars));
}

#[test]
fn no_line_of_a_bridge_ends_halfway_along_an_edge_that_is_nearly_straight() {
    let full = |slant_mm: f64| {
        let outer = ring(&[(0.0, 0.0), (40.0, slant_mm), (40.0, 8.0), (0.0, 8.0 - slant_mm)]);
        Region::from(Polygon { outer, holes: vec![] })
    };
    let mut pillars = rectangle(0.0, 0.0, 8.0, 8.0);
    pillars.add_disjoint(rectangle(32.0, 0.0, 40.0, 8.0).into_polygons());
    for slant_mm in [-0.03, -0.01, 0.01, 0.03] {
        let open = geometry::intersection(&pillars, &full(slant_mm));
        assert!(bridges_run(&roof(&open, &full(slant_mm)), 0.0, &pillars), "{slant_mm}");
    }
}

#[test]
fn bridges_over_a_c_go_from_arm_to_arm() {
    let full = rectangle(0.0, 0.0, 30.0, 20.0);
    let open = geometry::difference(&full, &rectangle(8.0, -1.0, 22.0, 12.0));
    assert!(bridges_run(&roof(&open, &full), 0.0, &open));
}

#[test]
fn bridges_over_an_l_are_shorter_than_its_arms_and_have_hold_at_both_ends() {
    let full = rectangle(0.0, 0.0, 40.0, 40.0);
    let pit = geometry::union(&rectangle(10.0, 10.0, 18.0, 32.0), &rectangle(10.0, 10.0, 30.0, 18.0));
    let open = geometry::difference(&full, &pit);
    let roof = roof(&open, &full);
    let degrees = (0..180).find(|&degrees| bridges_run(&roof, f64::from(degrees), &open));
    assert!(degrees.is_some(), "all in one direction, from hold to hold");
    let spans = of_role(&roof, Role::BridgeInfill).into_iter().flat_map(|p| p.points.windows(2));
    let longest_mm = spans.map(|e| e[0].distance_mm(e[1])).fold(0.0, f64::max);
    assert!(longest_mm < 20.0, "along an arm it would be 20 mm and more, not {longest_mm}");
}

#[test]
fn solid_infill_never_hangs_where_a_bridge_could() {
    let full = rectangle(0.0, 0.0, 40.0, 20.0);
    let pit = rectangle(10.0, 5.0, 30.0, 15.0);
    let roof = roof(&with_hole(full.clone(), &pit), &full);
    let air = geometry::offset(&pit, -0.1);
    let flat = roof.paths.iter().filter(|p| p.role != Role::BridgeInfill);
    assert!(flat.flat_map(|p| &p.points).all(|&p| !air.contains(p)));
}

#[test]
fn every_bead_of_a_strip_over_air_has_hold_at_both_ends_or_comes_after_those_that_have() {
    // Walls of 0.9 mm hold two of the three loops; what is inside of the third begins before them.
    for (wall_mm, widest, generator) in
        [(1.2, 40, WallGenerator::Classic), (0.9, 31, WallGenerator::Variable)]
    {
        for tenths in 4..=widest {
            let width_mm = f64::from(tenths) / 10.0;
            let layer = strip_over_air(wall_mm, width_mm, generator);
            let over: Vec<&Path> =
                layer.paths.iter().filter(|p| length_mm(p) > 1.5 && is_over_the_gap(p)).collect();
            let held_beside = |path: &Path, x: f64| {
                let near = |p: &Point| p.mm()[0] < 0.24 && x == 0.0 || p.mm()[0] > GAP_MM - 0.24 && x > 0.0;
                path.points.iter().any(near)
            };
            let spans = |path: &Path| held_beside(path, 0.0) && held_beside(path, GAP_MM);
            assert!(over.iter().any(|path| spans(path)), "{width_mm} {generator:?}: nothing over the gap");
            for path in &over {
                let what = format!("{width_mm} {generator:?}: {:?} of {:.1} mm", path.role, length_mm(path));
                if path.closed {
                    let before = |other: &&&Path| other.phase < path.phase && other.closed;
                    let follows = over.iter().filter(before).any(|other| spans(other));
                    assert!(spans(path) || follows, "{what}");
                } else {
                    let ends = [path.points[0], path.points[path.points.len() - 1]].map(|p| p.mm()[0]);
                    assert!(
                        ends.iter().all(|&x| !(0.24..GAP_MM - 0.24).contains(&x)),
                        "{what}, ends {ends:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_surface_goes_on_under_ribs_of_walls_alone_but_not_under_what_has_infill() {
    let deck = rectangle(0.0, 0.0, 40.0, 40.0);
    for tenths in (10..=60).step_by(5) {
        let width_mm = f64::from(tenths) / 10.0;
        let rib = rectangle(18.03, 10.0, 18.03 + width_mm, 30.0);
        let layers = plan(&[vec![deck.clone(); 10], vec![rib.clone(); 10]].concat(), &job());
        let has_infill = of_role(&layers[10], Role::GapFill).is_empty()
            && layers[10].paths.iter().any(|path| !path.role.is_wall());
        let under = geometry::offset(&rib, -0.4);
        let sparse = of_role(&layers[9], Role::InternalInfill);
        let hollow = sparse.iter().flat_map(|path| &path.points).any(|&p| under.contains(p))
            || sparse
                .iter()
                .flat_map(|path| path.points.windows(2))
                .any(|e| under.contains(Point { x: (e[0].x + e[1].x) / 2, y: (e[0].y + e[1].y) / 2 }));
        assert_eq!(hollow, has_infill, "{width_mm} mm");
    }
}

#[test]
fn a_thin_plate_is_one_surface_under_its_ribs() {
    // As thin as its shells, so that nothing of it is sparse.
    let deck = rectangle(0.0, 0.0, 40.0, 40.0);
    let rib = rectangle(18.03, 10.0, 18.63, 30.0);
    let layers = plan(&[vec![deck; 4], vec![rib.clone(); 10]].concat(), &job());
    assert!(!of_role(&layers[3], Role::TopSolidInfill).is_empty());
    let patches = of_role(&layers[3], Role::SolidInfill).len() + of_role(&layers[3], Role::GapFill).len();
    assert_eq!(patches, 0, "under the rib");
}

/// A strip with these corners that leads from one wall to another, in the layer where it does so first.
fn strip_of(corners: &[(f64, f64)]) -> LayerPaths {
    let wall = |x: f64| rectangle(x, -10.0, x + 1.2, 10.0);
    let open = geometry::union(&wall(-1.2), &wall(GAP_MM));
    let strip = Region::from(Polygon { outer: ring(corners), holes: vec![] });
    let full = geometry::union(&open, &strip);
    let mut settings = job();
    (settings.walls.count, settings.walls.generator) = (3, WallGenerator::Variable);
    plan(&[vec![open; 6], vec![full; 6]].concat(), &settings).swap_remove(6)
}

/// Whether a position between two walls lies on one of them, or hardly beside it.
fn is_held(p: &Point) -> bool {
    !(0.24..GAP_MM - 0.24).contains(&p.mm()[0])
}

#[test]
fn a_thin_strip_over_air_that_becomes_a_loop_does_not_end_before_it() {
    // One bead, and from the middle on two.
    let strip = strip_of(&[(-0.1, 0.0), (30.1, 0.0), (30.1, 0.9), (16.0, 0.9), (14.0, 0.55), (-0.1, 0.55)]);
    let open: Vec<&Path> =
        strip.paths.iter().filter(|p| !p.closed && length_mm(p) > 1.5 && is_over_the_gap(p)).collect();
    assert!(open.iter().any(|path| length_mm(path) > 2.0 * GAP_MM - 20.0), "there and around");
    for path in open {
        let passes = |end: &Point| path.points.iter().filter(|p| *p == end).count() > 1;
        let ends = [&path.points[0], &path.points[path.points.len() - 1]];
        assert!(ends.iter().all(|end| is_held(end) || passes(end)), "{:?}", ends.map(|end| end.mm()));
        assert!(ends.iter().any(|end| is_held(end)));
    }
}

#[test]
fn what_fills_a_gap_in_the_middle_of_a_span_begins_and_ends_on_the_walls() {
    let strip =
        strip_of(&[(-0.1, -0.7), (30.1, -0.7), (30.1, 0.92), (27.0, 1.35), (3.0, 1.35), (-0.1, 0.92)]);
    let gaps: Vec<&Path> =
        of_role(&strip, Role::GapFill).into_iter().filter(|p| is_over_the_gap(p)).collect();
    assert!(!gaps.is_empty());
    for path in gaps {
        let ends = [path.points[0], path.points[path.points.len() - 1]];
        assert!(ends.iter().all(is_held), "{:?}", ends.map(|end| end.mm()));
    }
}

#[test]
fn bridges_end_on_walls_that_are_thinner_than_those_above() {
    for tenths in 0..8 {
        let full = rectangle(0.0, 0.0, 40.0, 20.0);
        let open = with_hole(full.clone(), &rectangle(10.0, 0.7, 30.0 + f64::from(tenths) / 10.0, 15.0));
        let hold = geometry::offset(&open, 0.25);
        let roof = roof(&open, &full);
        let bridges = of_role(&roof, Role::BridgeInfill);
        assert!(!bridges.is_empty());
        for path in bridges {
            let ends = [path.points[0], path.points[path.points.len() - 1]];
            assert!(ends.iter().all(|end| hold.contains(*end)), "{tenths}: {:?}", ends.map(|end| end.mm()));
        }
    }
}

/// Distance of two walls, in millimetres.
const GAP_MM: f64 = 30.0;

/// The layer in which a strip leads from one wall to another, with three perimeters at most.
fn strip_over_air(wall_mm: f64, width_mm: f64, generator: WallGenerator) -> LayerPaths {
    let wall = |x: f64| rectangle(x, -10.0, x + wall_mm, 10.0);
    let open = geometry::union(&wall(-wall_mm), &wall(GAP_MM));
    // Its sides are not quite straight, as those of models are.
    let (low, high, bend) = (-0.7, width_mm - 0.7, 0.005);
    let outer = ring(&[
        (-0.1, low),
        (13.0, low + bend),
        (GAP_MM + 0.1, low),
        (GAP_MM + 0.1, high),
        (20.0, high + bend),
        (-0.1, high),
    ]);
    let full = geometry::union(&open, &Region::from(Polygon { outer, holes: vec![] }));
    let mut settings = job();
    (settings.walls.count, settings.walls.generator) = (3, generator);
    plan(&[vec![open; 6], vec![full; 6]].concat(), &settings).swap_remove(6)
}

/// Whether part of a path is over the gap.
fn is_over_the_gap(path: &Path) -> bool {
    let ends = path.points.iter().map(|p| p.mm()[0]);
    let (low, high) = ends.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    high > 2.0 && low < GAP_MM - 2.0
}

/// A tongue that sticks out of a block over air, and the block.
fn tongue() -> (Region, Region) {
    let block = rectangle(0.0, 0.0, 20.0, 30.0);
    (geometry::union(&block, &rectangle(20.0, 8.0, 28.0, 22.0)), block)
}

#[test]
fn perimeters_over_a_tongue_begin_and_end_on_the_block() {
    let (full, block) = tongue();
    let roof = roof(&block, &full);
    let over_air = |path: &&Path| path.points.iter().any(|p| p.mm()[0] > 22.0);
    let extra: Vec<&Path> =
        of_role(&roof, Role::Perimeter).into_iter().filter(|p| !p.closed).filter(over_air).collect();
    assert!(of_role(&roof, Role::BridgeInfill).is_empty(), "nothing is held at both ends there");
    assert!(extra.len() > 10, "{} lines", extra.len());
    for path in extra {
        let ends = [path.points[0], *path.points.last().unwrap()];
        assert!(ends.iter().all(|p| block.contains(*p)), "{:?}", ends.map(|p| p.mm()));
    }
}

#[test]
fn perimeters_over_a_tongue_fill_it() {
    let (full, block) = tongue();
    let mut settings = job();
    settings.bridge.thick = false;
    let sections = [vec![block.clone(); 6], vec![full.clone(); 6]].concat();
    let roof = plan(&sections, &settings).swap_remove(6);
    let covered_mm2: f64 = roof.paths.iter().map(|path| covers_beyond(path, 20.0)).sum();
    let air_mm2 = geometry::difference(&full, &block).area_mm2();
    assert!((covered_mm2 / air_mm2 - 1.0).abs() < 0.03, "{covered_mm2} of {air_mm2} mm²");
}

#[test]
fn without_extra_perimeters_a_tongue_is_filled_with_bridge_lines() {
    let (full, block) = tongue();
    let mut settings = job();
    settings.walls.extra_on_overhangs = false;
    let sections = [vec![block; 6], vec![full; 6]].concat();
    let roof = plan(&sections, &settings).swap_remove(6);
    assert!(!of_role(&roof, Role::BridgeInfill).is_empty());
}

#[test]
fn solid_lines_over_sparse_infill_end_where_that_holds_them() {
    let full = rectangle(0.0, 0.0, 40.0, 30.0);
    let mut settings = job();
    settings.infill.density = Ratio(0.1);
    let mut lines = 0;
    for k in 0..8 {
        let at_mm = 6.0 + 0.7 * f64::from(k);
        let pocket = rectangle(at_mm, 8.0, at_mm + 9.0, 15.0 + 0.9 * f64::from(k));
        let sections = [vec![full.clone(); 14], vec![with_hole(full.clone(), &pocket); 8]].concat();
        let layers = plan(&sections, &settings);
        // The lowest layer of the pocket's floor lies on sparse infill.
        let floor = (4..14).find(|&i| !of_role(&layers[i], Role::SolidInfill).is_empty()).expect("a floor");
        let beneath = &layers[floor - 1].paths;
        for path in of_role(&layers[floor], Role::SolidInfill) {
            lines += 1;
            for hanging_mm in [hanging_mm(&path.points, beneath), {
                let mut back = path.points.clone();
                back.reverse();
                hanging_mm(&back, beneath)
            }] {
                assert!(hanging_mm <= 3.0, "pocket {k}: a line hangs over {hanging_mm:.2} mm");
            }
        }
    }
    assert!(lines >= 8, "{lines}");
}

/// How far a line runs from its start until it touches a bead beneath.
fn hanging_mm(points: &[Point], beneath: &[Path]) -> f64 {
    const STEP_MM: f64 = 0.1;
    let held = |p: [f64; 2]| {
        beneath.iter().any(|path| {
            path.points.windows(2).any(|edge| geometry::to_segment_mm(p, edge[0].mm(), edge[1].mm()) < 0.4)
        })
    };
    let mut walked_mm = 0.0;
    for edge in points.windows(2) {
        let length_mm = edge[0].distance_mm(edge[1]);
        let ([ax, ay], [bx, by]) = (edge[0].mm(), edge[1].mm());
        for step in 0..=(length_mm / STEP_MM) as u32 {
            let share = f64::from(step) * STEP_MM / length_mm;
            if held([ax + share * (bx - ax), ay + share * (by - ay)]) {
                return walked_mm + share * length_mm;
            }
        }
        walked_mm += length_mm;
    }
    walked_mm
}

#[test]
fn infill_that_goes_on_to_where_it_is_held_stays_behind_the_outermost_wall() {
    let mut settings = job();
    settings.infill.density = Ratio(0.1);
    for walls in [1, 2] {
        settings.walls.count = walls;
        let leaning = |i: u32| {
            let by_mm = 0.4 * f64::from(i);
            rectangle(by_mm, by_mm, 44.0 - by_mm, 37.0 - by_mm)
        };
        let sections: Vec<Region> = (0..14).map(leaning).collect();
        for (layer, section) in plan(&sections, &settings).iter().zip(&sections).skip(1) {
            let behind = geometry::offset(section, -0.3);
            let infill = layer.paths.iter().filter(|path| !path.role.is_wall() && path.role != Role::GapFill);
            for point in infill.flat_map(|path| &path.points) {
                assert!(behind.contains(*point), "{walls} walls, layer {}: {:?}", layer.index, point.mm());
            }
        }
    }
}
