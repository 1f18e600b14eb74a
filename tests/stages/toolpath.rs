//! What the toolpath stage promises, checked on sections made here.

use std::sync::Arc;

use crate::support::toolpath_plan::{
    HEIGHT_MM, covers_beyond, job, length_mm, of_role, plan, rectangle, ring, with_hole,
};
use crate::toolpath_raster::coverage;
use pathwright::geometry::{self, Bounds, Point, Polygon, Region, Ring};
use pathwright::order::LayerProblem;
use pathwright::profile::{Pattern, Scope, Settings, WallGenerator, WallOrder};
use pathwright::toolpath::infill::{
    self, AdaptiveCubic, FillPattern, FillSpec, Joins, Lightning, LightningLayer,
};
use pathwright::toolpath::{LayerPaths, Path, Role, Width, bead, shell_depth};
use pathwright::units::{Mm, Ratio};
use proptest::prelude::*;

fn volume_mm3<'a>(paths: impl IntoIterator<Item = &'a Path>) -> f64 {
    paths
        .into_iter()
        .map(|p| {
            let n = p.points.len();
            let edges = (0..if p.closed { n } else { n - 1 }).map(|i| (i, (i + 1) % n));
            match &p.width {
                Width::Constant(width_mm) => bead::area_mm2(*width_mm, p.height_mm) * length_mm(p),
                Width::PerVertex(widths) => edges
                    .map(|(a, b)| {
                        let width_mm = f64::from(widths[a] + widths[b]) / 2.0;
                        bead::area_mm2(width_mm, p.height_mm) * p.points[a].distance_mm(p.points[b])
                    })
                    .sum(),
            }
        })
        .sum()
}

#[test]
fn a_cube_has_two_walls_and_shells_of_four_layers() {
    let layers = plan(&vec![rectangle(100.0, 100.0, 120.0, 120.0); 30], &job());
    for layer in &layers {
        assert_eq!(of_role(layer, Role::ExternalPerimeter).len(), 1, "layer {}", layer.index);
        assert_eq!(of_role(layer, Role::Perimeter).len(), 1, "layer {}", layer.index);
        let sparse = !of_role(layer, Role::InternalInfill).is_empty();
        assert_eq!(sparse, (4..26).contains(&layer.index), "layer {}", layer.index);
        let top = !of_role(layer, Role::TopSolidInfill).is_empty();
        assert_eq!(top, layer.index == 29, "layer {}", layer.index);
    }
}

#[test]
fn what_fills_an_island_is_one_run_after_its_walls() {
    let (whole, half) = (rectangle(0.0, 0.0, 20.0, 20.0), rectangle(0.0, 0.0, 10.0, 20.0));
    let layers = plan(&[vec![whole; 15], vec![half; 15]].concat(), &job());
    let layer = &layers[12];
    for role in [Role::SolidInfill, Role::InternalInfill] {
        assert!(!of_role(layer, role).is_empty(), "the test has {role:?}");
    }
    let runs = LayerProblem::new(layer, &None, Scope::Feature).problem.runs;
    assert_eq!(runs.len(), 3, "inner walls, outer walls, the rest: {runs:?}");
}

#[test]
fn walls_come_in_the_order_asked_for() {
    for (order, first) in
        [(WallOrder::InnerFirst, Role::Perimeter), (WallOrder::OuterFirst, Role::ExternalPerimeter)]
    {
        let mut settings = job();
        settings.walls.order = order;
        let layers = plan(&vec![rectangle(0.0, 0.0, 20.0, 20.0); 10], &settings);
        let lowest = layers[5].paths.iter().min_by_key(|p| p.phase).expect("paths");
        assert_eq!(lowest.role, first);
        assert_eq!(layers[5].paths[0].role, first);
    }
}

#[test]
fn beads_of_neighbouring_walls_fill_the_layer_without_void_or_overlap() {
    let layers = plan(&vec![rectangle(0.0, 0.0, 20.0, 20.0); 10], &job());
    let x_max = |role| {
        let points = of_role(&layers[5], role).into_iter().flat_map(|p| p.points.iter().copied());
        geometry::to_mm(Bounds::of(points).expect("walls").max.x)
    };
    let (outer_mm, inner_mm) = (x_max(Role::ExternalPerimeter), x_max(Role::Perimeter));
    assert!((20.0 - outer_mm - 0.45 / 2.0).abs() < 1e-4, "outer wall at {outer_mm}");
    let spacing_mm = bead::spacing_mm(0.45, HEIGHT_MM);
    assert!((outer_mm - inner_mm - spacing_mm).abs() < 1e-4, "inner wall at {inner_mm}");
}

#[test]
fn a_full_layer_deposits_its_own_volume() {
    let hole = rectangle(8.0, 8.0, 14.0, 17.0);
    let section = with_hole(rectangle(0.0, 0.0, 40.0, 30.0), &hole);
    let mut settings = job();
    settings.infill.density = Ratio(1.0);
    let layers = plan(&vec![section.clone(); 12], &settings);
    for layer in &layers {
        let share = volume_mm3(&layer.paths) / (section.area_mm2() * HEIGHT_MM);
        assert!((0.98..=1.02).contains(&share), "layer {}: {share}", layer.index);
    }
}

#[test]
fn every_even_pattern_has_the_density_asked_for() {
    let section = with_hole(rectangle(0.0, 0.0, 40.0, 30.0), &rectangle(8.0, 8.0, 14.0, 17.0));
    for &(name, pattern) in Pattern::ALL.iter().filter(|(_, kind)| infill::pattern(*kind).is_uniform()) {
        for density in [0.05, 0.1, 0.2, 0.5, 0.8] {
            let mut settings = job();
            settings.infill.pattern = pattern;
            settings.infill.density = Ratio(density);
            let layers = plan(&vec![section.clone(); 13], &settings);
            let inside_mm2 =
                geometry::offset(&section, -(0.45 + bead::spacing_mm(0.45, HEIGHT_MM) - 0.0215)).area_mm2();
            let sparse = layers.iter().flat_map(|l| of_role(l, Role::InternalInfill));
            let share = volume_mm3(sparse) / (inside_mm2 * HEIGHT_MM * 5.0);
            assert!((share / density - 1.0).abs() < 0.01, "{name} at {density}: {share}");
        }
    }
}

#[test]
fn without_density_and_at_full_density_all_patterns_are_alike() {
    let section = rectangle(0.0, 0.0, 20.0, 15.0);
    for density in [0.0, 1.0] {
        let of = |pattern: Pattern| {
            let mut settings = job();
            (settings.infill.pattern, settings.infill.density) = (pattern, Ratio(density));
            plan(&vec![section.clone(); 12], &settings)
        };
        let expected = of(Pattern::Rectilinear);
        for &(name, pattern) in Pattern::ALL {
            assert!(of(pattern) == expected, "{name} at {density}");
        }
    }
}

#[test]
fn hardly_any_density_is_no_reason_to_fail() {
    for &(_, pattern) in Pattern::ALL {
        let mut settings = job();
        (settings.infill.pattern, settings.infill.density) = (pattern, Ratio(1e-9));
        assert_eq!(plan(&vec![rectangle(0.0, 0.0, 20.0, 15.0); 12], &settings).len(), 12);
    }
}

/// Directions of the longest sparse lines of a layer, degrees from X.
fn directions(layer: &LayerPaths) -> Vec<f64> {
    let edges = of_role(layer, Role::InternalInfill).into_iter().flat_map(|p| p.points.windows(2));
    let long = edges.filter(|e| e[0].distance_mm(e[1]) > 5.0);
    long.map(|e| {
        let [dx, dy] = (e[1] - e[0]).mm();
        dy.atan2(dx).to_degrees().rem_euclid(180.0)
    })
    .collect()
}

#[test]
fn a_schedule_of_angles_turns_the_lines_layer_by_layer() {
    let mut settings = job();
    settings.infill.angles = vec![10.0, 70.0, 130.0];
    settings.infill.connect = false;
    let layers = plan(&vec![rectangle(0.0, 0.0, 30.0, 30.0); 14], &settings);
    for layer in &layers[4..10] {
        let wanted = settings.infill.angles[layer.index % 3];
        assert!(directions(layer).iter().all(|d| (d - wanted).abs() < 0.1), "{:?}", directions(layer));
    }
}

#[test]
fn one_layer_in_so_many_is_solid() {
    let mut settings = job();
    settings.infill.solid_every = 5;
    let layers = plan(&vec![rectangle(0.0, 0.0, 20.0, 20.0); 30], &settings);
    for layer in &layers[4..26] {
        let sparse = !of_role(layer, Role::InternalInfill).is_empty();
        assert_eq!(sparse, (layer.index + 1) % 5 != 0, "layer {}", layer.index);
        assert_ne!(sparse, !of_role(layer, Role::SolidInfill).is_empty(), "layer {}", layer.index);
    }
}

#[test]
fn combined_layers_hold_the_same_volume_in_higher_beads() {
    let mut settings = job();
    settings.infill.width = Mm(0.5);
    let sections = vec![rectangle(0.0, 0.0, 40.0, 40.0); 32];
    let single = plan(&sections, &settings);
    // Three layers would be higher than the nozzle is wide.
    settings.infill.combine_layers = 3;
    let combined = plan(&sections, &settings);
    let sparse = |layers: &[LayerPaths]| -> f64 {
        volume_mm3(layers.iter().flat_map(|layer| of_role(layer, Role::InternalInfill)))
    };
    let share = sparse(&combined) / sparse(&single);
    assert!((share - 1.0).abs() < 0.01, "{share}");
    let mut filled = 0;
    for layer in &combined {
        let beads = of_role(layer, Role::InternalInfill);
        assert!(beads.iter().all(|p| (p.height_mm - 0.4).abs() < 1e-9), "layer {}", layer.index);
        filled += usize::from(!beads.is_empty());
    }
    assert_eq!(filled, 12);
}

#[test]
fn anchors_run_along_the_wall_from_ends_that_are_not_joined() {
    let mut settings = job();
    settings.infill.connect = false;
    let section = rectangle(0.0, 0.0, 40.0, 40.0);
    let ends_along_the_wall = |settings: &Settings| {
        let layers = plan(&vec![section.clone(); 12], settings);
        let along = |e: &[Point]| e[0].x == e[1].x || e[0].y == e[1].y;
        let lines = of_role(&layers[6], Role::InternalInfill);
        let ends = lines.iter().flat_map(|p| [&p.points[..2], &p.points[p.points.len() - 2..]]);
        let lengths: Vec<f64> = ends.filter(|e| along(e)).map(|e| e[0].distance_mm(e[1])).collect();
        (lengths.len(), 2 * lines.len(), lengths.into_iter().fold(0.0, f64::max))
    };
    assert_eq!(ends_along_the_wall(&settings).0, 0);
    settings.infill.anchor = Mm(0.6);
    let (anchored, ends, longest_mm) = ends_along_the_wall(&settings);
    assert!(10 * anchored > 9 * ends, "{anchored} of {ends}");
    assert!((longest_mm - 0.6).abs() < 1e-3, "{longest_mm}");
}

#[test]
fn ends_of_sparse_lines_meet_the_wall_in_their_full_width() {
    let mut settings = job();
    settings.infill.connect = false;
    let layers = plan(&vec![rectangle(0.0, 0.0, 20.0, 20.0); 11], &settings);
    // Where two walls end: no line may come near the middle of the inner one, all have to come out of the room inside.
    let spacing_mm = bead::spacing_mm(0.45, HEIGHT_MM);
    let (wall_mm, edge_mm) = (0.225 + spacing_mm, 0.225 + 1.5 * spacing_mm);
    for path in of_role(&layers[5], Role::InternalInfill) {
        for [x, y] in [path.points[0], path.points[path.points.len() - 1]].map(Point::mm) {
            let depth_mm = [x, y, 20.0 - x, 20.0 - y].into_iter().fold(f64::MAX, f64::min);
            assert!((wall_mm + 0.1..=edge_mm + 0.01).contains(&depth_mm), "{depth_mm}, wall {wall_mm}");
        }
    }
}

#[test]
fn a_sparse_line_that_passes_a_corner_is_one_bead() {
    let mut settings = job();
    settings.infill.connect = false;
    let deck = rectangle(0.0, 0.0, 30.0, 30.0);
    for step in 0..40 {
        let at_mm = 8.0 + 0.1 * f64::from(step);
        let section = with_hole(deck.clone(), &rectangle(at_mm, 10.0, at_mm + 9.0, 20.0));
        let layers = plan(&vec![section; 11], &settings);
        for layer in &layers[5..=6] {
            let ends = of_role(layer, Role::InternalInfill).into_iter().flat_map(|path| {
                let reversed: Vec<Point> = path.points.iter().rev().copied().collect();
                [&path.points, &reversed].map(|points| [points[1], points[0]])
            });
            let ends: Vec<[Point; 2]> = ends.collect();
            for (i, [from, a]) in ends.iter().enumerate() {
                let near = ends.iter().enumerate().filter(|(j, end)| i != *j && a.distance_mm(end[1]) < 1.0);
                for (_, [_, b]) in near {
                    let ahead = (f64::from(b.x - a.x) * f64::from(a.x - from.x))
                        + (f64::from(b.y - a.y) * f64::from(a.y - from.y));
                    assert!(ahead > 0.0, "two beads in one place at {:?}, the hole at {at_mm}", a.mm());
                }
            }
        }
    }
}

#[test]
fn density_zero_leaves_the_inside_empty() {
    let mut settings = job();
    settings.infill.density = Ratio(0.0);
    let layers = plan(&vec![rectangle(0.0, 0.0, 20.0, 20.0); 20], &settings);
    assert!(layers.iter().all(|l| of_role(l, Role::InternalInfill).is_empty()));
    assert!(!of_role(&layers[0], Role::SolidInfill).is_empty());
}

#[test]
fn skirt_and_brim_keep_their_distance() {
    let section = rectangle(100.0, 100.0, 120.0, 120.0);
    let mut settings = job();
    settings.skirt.loops = 2;
    settings.skirt.distance = Mm(3.0);
    settings.brim.width = Mm(3.0);
    let layers = plan(&vec![section; 6], &settings);
    let reach_mm = |role| {
        let points = of_role(&layers[0], role).into_iter().flat_map(|p| p.points.iter().copied());
        let bounds = Bounds::of(points).expect("loops");
        (geometry::to_mm(bounds.max.x) - 120.0, of_role(&layers[0], role).len())
    };
    let spacing_mm = bead::spacing_mm(0.45, HEIGHT_MM);
    let (brim_mm, brims) = reach_mm(Role::Brim);
    assert_eq!(brims, (3.0 / spacing_mm).round() as usize);
    assert!((brim_mm - (0.225 + (brims - 1) as f64 * spacing_mm)).abs() < 0.01, "{brim_mm}");
    let (skirt_mm, skirts) = reach_mm(Role::Skirt);
    assert_eq!(skirts, 2);
    assert!((skirt_mm - (3.0 + 3.0 + 0.225 + spacing_mm)).abs() < 0.01, "{skirt_mm}");
    assert!(
        layers[1..].iter().all(|l| of_role(l, Role::Skirt).is_empty() && of_role(l, Role::Brim).is_empty())
    );
}

#[test]
fn on_a_slope_every_exposed_place_is_solid_to_the_shell_depth() {
    // A pyramid whose sides move in by 0.5 mm a layer.
    let sections: Vec<Region> = (0..30)
        .map(|i| {
            let d = 0.5 * i as f64;
            rectangle(d, d, 40.0 - d, 40.0 - d)
        })
        .collect();
    let layers = plan(&sections, &job());
    for i in 4..20 {
        let shell = geometry::difference(&sections[i], &sections[i + 4]);
        let sparse: Vec<Point> =
            of_role(&layers[i], Role::InternalInfill).iter().flat_map(|p| p.points.iter().copied()).collect();
        let deep = geometry::offset(&shell, -0.05);
        assert!(sparse.iter().all(|&p| !deep.contains(p)), "sparse infill in the shell of layer {i}");
    }
}

#[test]
fn solid_patches_over_sparse_infill_lie_on_a_line_of_it() {
    // Pockets of about 1 mm from the top, on all places that lines 3 mm apart can leave them.
    let full = rectangle(0.0, 0.0, 60.0, 60.0);
    let mut open = full.clone();
    for (i, j) in (0..7).flat_map(|i| (0..7).map(move |j| (i, j))) {
        let (x, y, wide) = (6.0 + 7.37 * f64::from(i), 6.0 + 7.13 * f64::from(j), 0.8 + 0.1 * f64::from(i));
        open = with_hole(open, &rectangle(x, y, x + wide, y + 1.0));
    }
    let mut settings = job();
    settings.infill.density = Ratio(0.15);
    for pattern in [Pattern::Rectilinear, Pattern::Grid, Pattern::Cubic] {
        settings.infill.pattern = pattern;
        let layers = plan(&[vec![full.clone(); 12], vec![open.clone(); 8]].concat(), &settings);
        let lowest = (5..12).find(|&i| !of_role(&layers[i], Role::SolidInfill).is_empty()).unwrap();
        let beneath: Vec<[Point; 2]> = of_role(&layers[lowest - 1], Role::InternalInfill)
            .iter()
            .flat_map(|p| p.points.windows(2).map(|e| [e[0], e[1]]))
            .collect();
        let rests =
            |p: Point| beneath.iter().any(|[a, b]| geometry::to_segment_mm(p.mm(), a.mm(), b.mm()) < 0.45);
        for path in of_role(&layers[lowest], Role::SolidInfill) {
            let points = path.points.iter().chain(path.points.first().filter(|_| path.closed));
            let points: Vec<Point> = points.copied().collect();
            let places = points.windows(2).flat_map(|e| {
                let ([ax, ay], [bx, by]) = (e[0].mm(), e[1].mm());
                (0..=20)
                    .map(f64::from)
                    .map(move |k| Point::from_mm(ax + (bx - ax) * k / 20.0, ay + (by - ay) * k / 20.0))
            });
            let hangs = length_mm(path) > 1.5 && !places.into_iter().any(rests);
            assert!(!hangs, "{pattern:?}: {:.1} mm at {:?}", length_mm(path), path.points[0].mm());
        }
    }
}

fn star() -> impl Strategy<Value = Region> {
    prop::collection::vec(1.0..12.0f64, 5..40).prop_map(|radii| {
        let n = radii.len() as f64;
        let outer: Ring = radii
            .iter()
            .enumerate()
            .map(|(i, r)| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / n).sin_cos();
                Point::from_mm(50.0 + r * cos, 50.0 + r * sin)
            })
            .collect();
        geometry::unite_rings(&[outer])
    })
}

/// A pattern, planned for a prism whose section is filled sparsely up to a roof at `top_mm`.
fn planned(kind: Pattern, section: &Region, top_mm: f64, line_distance_mm: f64) -> Arc<dyn FillPattern> {
    match kind {
        Pattern::AdaptiveCubic => {
            let corners = [[30.0, 30.0], [70.0, 30.0], [50.0, 70.0]];
            let roof = [corners.map(|[x, y]| [x, y, top_mm])];
            Arc::new(AdaptiveCubic::new(roof.into_iter(), line_distance_mm, 0.3))
        }
        Pattern::Lightning => {
            let hollow = LightningLayer {
                ground: geometry::offset(section, 0.3),
                sparse: section.clone(),
                height_mm: HEIGHT_MM,
            };
            let layers = (top_mm / HEIGHT_MM).round() as usize;
            Arc::new(Lightning::new(&vec![hollow; layers], line_distance_mm))
        }
        _ => infill::pattern(kind),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn walls_stay_inside_the_section(section in star()) {
        let outline = || section.rings().flat_map(|ring| (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]]));
        for layer in plan(&vec![section.clone(); 3], &job()) {
            for path in layer.paths.iter().filter(|p| p.closed && p.role == Role::ExternalPerimeter) {
                for (i, &p) in path.points.iter().enumerate() {
                    let width_mm = match &path.width {
                        Width::Constant(width_mm) => *width_mm,
                        Width::PerVertex(widths) => f64::from(widths[i]),
                    };
                    let far_mm = |[a, b]: [Point; 2]| geometry::to_segment_mm(p.mm(), a.mm(), b.mm());
                    let far_mm = outline().map(far_mm).fold(f64::MAX, f64::min);
                    prop_assert!(section.contains(p) && far_mm >= width_mm / 2.0 - 0.003, "{p:?}: {far_mm} of {width_mm}");
                }
            }
        }
    }

    #[test]
    fn no_pattern_leaves_its_region(
        section in star(), hole in star(), kind in 0..Pattern::ALL.len(),
        layer in 0_usize..20, distance_mm in 0.6..5.0_f64, joined in any::<bool>(), anchor_mm in 0.0..3.0_f64,
    ) {
        let region = geometry::difference(&section, &geometry::offset(&hole, -3.0));
        let (name, kind) = Pattern::ALL[kind];
        let longest_mm = if joined { 2.5 * distance_mm } else { 0.0 };
        let spec = FillSpec {
            line_distance_mm: distance_mm,
            spacing_mm: 0.4,
            angle_rad: 0.3,
            layer,
            z_mm: (layer as f64 + 0.5) * HEIGHT_MM,
            joins: Joins { longest_mm, anchor_mm, ..Joins::default() },
        };
        let room = geometry::offset(&region, 0.005);
        for line in planned(kind, &region, 4.0, distance_mm).fill(&region, &spec) {
            let closing = line.closed.then(|| [line.points[line.points.len() - 1], line.points[0]]);
            for [a, b] in line.points.windows(2).map(|e| [e[0], e[1]]).chain(closing) {
                let steps = (a.distance_mm(b) / 0.2).ceil() as i32;
                for step in 0..=steps {
                    let at = |a: i32, b: i32| a + ((i64::from(b) - i64::from(a)) * i64::from(step) / i64::from(steps.max(1))) as i32;
                    let p = Point::new(at(a.x, b.x), at(a.y, b.y));
                    prop_assert!(room.contains(p), "{name}: {:?}", p.mm());
                }
            }
        }
    }

    #[test]
    fn no_infill_crosses_a_wall(section in star(), hole in star(), kind in 0..Pattern::ALL.len(), density in 0.05..0.8_f64) {
        let section = geometry::difference(&section, &geometry::offset(&hole, -3.0));
        let (name, kind) = Pattern::ALL[kind];
        let mut settings = job();
        (settings.infill.pattern, settings.infill.density) = (kind, Ratio(density));
        let layers = plan(&vec![section.clone(); 11], &settings);
        let of = |wanted: fn(Role) -> bool| {
            let paths = layers[5].paths.iter().filter(move |p| wanted(p.role));
            paths.flat_map(|p| {
                let closing = p.closed.then(|| [p.points[p.points.len() - 1], p.points[0]]);
                p.points.windows(2).map(|e| [e[0], e[1]]).chain(closing)
            })
        };
        let side = |[a, b]: [Point; 2], p: Point| (b - a).cross(p - a).signum();
        for wall in of(Role::is_wall) {
            for bead in of(|role| !role.is_wall() && role != Role::GapFill) {
                let apart = side(wall, bead[0]) * side(wall, bead[1]) >= 0 || side(bead, wall[0]) * side(bead, wall[1]) >= 0;
                prop_assert!(apart, "{name}: {:?} over {:?}", bead.map(Point::mm), wall.map(Point::mm));
            }
        }
    }

    #[test]
    fn any_section_is_filled_but_for_what_no_bead_can_reach(section in star()) {
        let mut settings = job();
        settings.infill.density = Ratio(1.0);
        let layers = plan(&vec![section.clone(); 3], &settings);
        let share = volume_mm3(&layers[1].paths) / (section.area_mm2() * HEIGHT_MM);
        prop_assert!((0.85..=1.05).contains(&share), "{share}");
    }
}

/// The job at full density, one layer from the middle.
fn solid_layer(section: &Region) -> LayerPaths {
    let mut settings = job();
    settings.infill.density = Ratio(1.0);
    plan(&vec![section.clone(); 3], &settings).swap_remove(1)
}

#[test]
fn walls_of_any_thickness_are_filled_without_void_or_overlap() {
    for tenths in 3..=20 {
        let thickness_mm = f64::from(tenths) / 10.0;
        let section = rectangle(0.0, 0.0, thickness_mm, 12.0);
        let layer = solid_layer(&section);
        // What the round sides of the outermost bead leave out is no void.
        let filled = geometry::offset(&section, -bead::rounding_mm(HEIGHT_MM) / 2.0);
        let share = volume_mm3(&layer.paths) / (filled.area_mm2() * HEIGHT_MM);
        // The round ends of a single bead hold less than square ones would.
        assert!((0.95..=1.03).contains(&share), "{thickness_mm} mm: {share} of the volume");
        let found = coverage(&section, &layer.paths);
        assert!(found.void <= 0.012 && found.double <= 0.005, "{thickness_mm} mm: {found:?}");
        assert!(found.outside <= 0.005, "{thickness_mm} mm: {found:?}");
    }
}

#[test]
fn beads_are_between_half_and_one_and_a_half_times_as_wide_as_asked_for() {
    let spacing_mm = bead::spacing_mm(0.45, HEIGHT_MM);
    for tenths in 4..=30 {
        let thickness_mm = f64::from(tenths) / 10.0;
        for path in &solid_layer(&rectangle(0.0, 0.0, thickness_mm, 12.0)).paths {
            let widths: Vec<f64> = match &path.width {
                Width::Constant(width_mm) => vec![*width_mm],
                Width::PerVertex(widths) => widths.iter().map(|&w| f64::from(w)).collect(),
            };
            for width_mm in widths {
                let share = bead::spacing_mm(width_mm, HEIGHT_MM) / spacing_mm;
                assert!((0.45..=1.61).contains(&share), "{thickness_mm} mm: {share} in {path:?}");
            }
        }
    }
}

#[test]
fn where_thin_walls_meet_and_cross_nothing_is_laid_twice() {
    for thickness_mm in [0.35, 0.45, 0.6] {
        let wall = |x: f64, y: f64, wide_mm: f64, long_mm: f64| rectangle(x, y, x + wide_mm, y + long_mm);
        let across = [wall(5.0, 0.0, thickness_mm, 4.1), wall(13.0, 0.0, thickness_mm, 9.0)];
        let along = wall(0.0, 4.0, 20.0, thickness_mm);
        let walls = across.iter().fold(along, |all, wall| geometry::union(&all, wall));
        let found = coverage(&walls, &solid_layer(&walls).paths);
        assert!(found.double <= 0.008, "{thickness_mm} mm: {found:?}");
    }
}

#[test]
fn a_wedge_is_filled_from_its_thin_to_its_thick_end() {
    let outer = ring(&[(0.0, -0.15), (30.0, -1.0), (30.0, 1.0), (0.0, 0.15)]);
    let section = Region::from(Polygon { outer, holes: vec![] });
    let layer = solid_layer(&section);
    let found = coverage(&section, &layer.paths);
    assert!(found.void <= 0.012 && found.double <= 0.02 && found.outside <= 0.003, "{found:?}");
}

#[test]
fn webs_between_slots_are_filled_however_short() {
    for web_mm in [0.35, 0.42, 0.5, 0.58] {
        for slot_mm in [0.4, 0.5, 0.7] {
            let slot = rectangle(2.0, 5.0 - web_mm - 0.5, 8.0, 5.0 - web_mm);
            let mut section = with_hole(rectangle(0.0, 0.0, 10.0, 10.0), &slot);
            for x in [3.0, 6.0] {
                section = with_hole(section, &rectangle(x, 5.0, x + slot_mm, 8.0));
            }
            let layer = solid_layer(&section);
            for x in [3.0, 6.0] {
                let web = rectangle(x, 5.0 - web_mm, x + slot_mm, 5.0);
                let found = coverage(&web, &layer.paths);
                assert!(found.void <= 0.15, "{web_mm} by {slot_mm} mm: {found:?}");
            }
        }
    }
}

#[test]
fn narrow_places_are_filled_however_long_the_outline_is() {
    let corners = [(0.0, 0.0), (300.0, 0.0), (300.0, 300.0), (0.0, 300.0)];
    let plate = |outer: &[(f64, f64)], hole: &[(f64, f64)]| {
        Region::from(Polygon { outer: ring(outer), holes: vec![ring(hole)] })
    };
    // A neck between the edge and a hole, with room for a bead and a bit between the walls; and a tab at the edge.
    let hole = [(60.0, 1.3), (56.6, 8.0), (64.0, 8.0), (60.6, 1.3)];
    let neck = rectangle(60.0, 0.05, 60.6, 1.25);
    let tab = rectangle(100.0, -2.0, 100.4, 0.0);
    let with_tab =
        [&corners[..1], &[(100.0, 0.0), (100.0, -2.0), (100.4, -2.0), (100.4, 0.0)], &corners[1..]];
    for generator in [WallGenerator::Classic, WallGenerator::Variable] {
        let mut settings = job();
        settings.walls.generator = generator;
        for (outer, narrow) in [(&corners[..], &neck), (&with_tab.concat(), &tab)] {
            let layer = plan(&vec![plate(outer, &hole); 3], &settings).swap_remove(1);
            let found = coverage(narrow, &layer.paths);
            assert!(found.void <= 0.05 && found.double <= 0.02, "{generator:?}: {found:?}");
        }
    }
}

#[test]
fn small_rooms_beside_a_large_one_are_filled() {
    let large = rectangle(-5.0, -10.0, 5.0, 0.0);
    for tenths in 32..=36 {
        let half_mm = f64::from(tenths) / 20.0;
        let head = rectangle(-half_mm, 3.0, half_mm, 3.0 + 2.0 * half_mm);
        let neck = rectangle(-1.1, -0.1, 1.1, 3.1);
        let section = geometry::union(&geometry::union(&large, &neck), &head);
        let found = coverage(&head, &solid_layer(&section).paths);
        assert!(found.void <= 0.008, "{half_mm} mm: {found:?}");
    }
}

#[test]
fn lines_fill_strips_of_any_width_from_wall_to_wall() {
    for tenths in 31..=44 {
        let section = rectangle(0.0, 0.0, f64::from(tenths) / 10.0, 12.0);
        let found = coverage(&section, &solid_layer(&section).paths);
        assert!(found.void <= 0.0026 && found.double <= 0.0035, "{tenths} tenths: {found:?}");
    }
}

#[test]
fn corners_of_solid_layers_are_filled_whatever_the_direction_of_their_lines() {
    for degrees in [0, 30, 45, 60] {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let turned = |(x, y): (f64, f64)| (x * cos - y * sin, x * sin + y * cos);
        let corners = [(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0)].map(turned);
        let section = Region::from(Polygon { outer: ring(&corners), holes: vec![] });
        let found = coverage(&section, &solid_layer(&section).paths);
        assert!(found.void <= 0.002 && found.double <= 0.0025, "{degrees}°: {found:?}");
    }
}

#[test]
fn solid_layers_are_closed_around_holes_and_along_slants() {
    let circle = |x: f64, y: f64, radius: f64| {
        let at = |i: i32| f64::from(i) / 32.0 * std::f64::consts::TAU;
        let points = (0..32).map(|i| (x + radius * at(i).cos(), y + radius * at(i).sin()));
        let outer = ring(&points.collect::<Vec<_>>());
        Region::from(Polygon { outer, holes: vec![] })
    };
    let plate = with_hole(
        with_hole(rectangle(0.0, 0.0, 16.0, 12.0), &circle(4.0, 4.0, 1.5)),
        &circle(11.0, 7.0, 2.2),
    );
    let hexagon = ring(&[(6.0, 0.0), (3.0, 5.2), (-3.0, 5.2), (-6.0, 0.0), (-3.0, -5.2), (3.0, -5.2)]);
    let hexagon = Region::from(Polygon { outer: hexagon, holes: vec![] });
    for section in [plate, circle(0.0, 0.0, 5.0), hexagon] {
        let found = coverage(&section, &solid_layer(&section).paths);
        assert!(found.void <= 0.006 && found.double <= 0.02 && found.outside <= 0.001, "{found:?}");
    }
}

#[test]
fn thin_parts_are_printed_down_to_the_width_stated_and_no_further() {
    let mut settings = job();
    (settings.walls.min_feature, settings.walls.min_width) = (Mm(0.2), Mm(0.3));
    let walls =
        |thickness_mm: f64| plan(&vec![rectangle(0.0, 0.0, thickness_mm, 10.0); 3], &settings).swap_remove(1);
    assert!(walls(0.18).paths.is_empty());
    let thin = walls(0.24);
    assert_eq!(thin.paths.len(), 1);
    assert_eq!(thin.paths[0].role, Role::ExternalPerimeter);
    let Width::PerVertex(widths) = &thin.paths[0].width else { panic!("fitting width") };
    assert!(widths.iter().all(|w| (w - 0.3).abs() < 1e-3), "{widths:?}");
}

#[test]
fn ribs_get_one_line_each_from_a_tenth_of_a_millimetre_on() {
    for hundredths in 10..=30 {
        let rib = rectangle(0.0, 0.0, f64::from(hundredths) / 100.0, 10.0);
        let layer = plan(&vec![rib; 3], &Settings::default()).swap_remove(1);
        let lines = of_role(&layer, Role::ExternalPerimeter);
        assert_eq!((layer.paths.len(), lines.len()), (1, 1), "{hundredths} hundredths of a millimetre");
        assert!(length_mm(lines[0]) > 9.5, "{} mm", length_mm(lines[0]));
    }
}

#[test]
fn a_strip_hardly_wider_than_its_pairs_of_walls_is_filled() {
    // From 4.5 and 7 spacings on, there is room for a bead between the pairs, or between the innermost.
    let mut settings = job();
    (settings.walls.count, settings.walls.generator) = (3, WallGenerator::Variable);
    let spacing_mm = bead::spacing_mm(settings.walls.width.0, HEIGHT_MM);
    let edge_mm = bead::rounding_mm(HEIGHT_MM);
    for spacings in [4.5, 7.0] {
        for over_um in [-1.0, 0.2, 1.0, 2.0, 3.0, 5.0, 10.0] {
            let width_mm = spacings * spacing_mm + edge_mm + over_um / 1000.0;
            let strip = rectangle(0.0, 0.0, 40.0, width_mm);
            let layer = plan(&vec![strip; 12], &settings).swap_remove(6);
            let filled_mm2: f64 = layer.paths.iter().map(|path| covers_beyond(path, -1.0)).sum();
            let share = filled_mm2 / (40.0 * width_mm);
            assert!(share > 0.95, "{width_mm} mm: {share}");
        }
    }
}

#[test]
fn specks_fill_the_tips_of_solid_infill_and_not_those_of_sparse_infill() {
    let star: Vec<(f64, f64)> = (0..10)
        .map(|i| {
            let radius_mm = if i % 2 == 0 { 20.0 } else { 9.0 };
            let (sin, cos) = (f64::from(i) / 10.0 * std::f64::consts::TAU).sin_cos();
            (radius_mm * cos, radius_mm * sin)
        })
        .collect();
    let star = Region::from(Polygon { outer: ring(&star), holes: vec![] });
    let layers = plan(&vec![star; 20], &job());
    let specks = |layer: &LayerPaths| {
        of_role(layer, Role::GapFill).into_iter().filter(|path| length_mm(path) < 0.4).count()
    };
    let [solid, sparse] = [1, 10].map(|layer: usize| specks(&layers[layer]));
    assert!(solid >= sparse + 5, "{solid} with solid infill, {sparse} with sparse");
}

#[test]
fn pins_of_any_thickness_are_printed_where_they_stand() {
    let round = |wide_mm: f64| {
        let corner = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
            Point::from_mm(5.0 + wide_mm / 2.0 * cos, 5.0 + wide_mm / 2.0 * sin)
        };
        Region::from(Polygon { outer: (0..24).map(corner).collect(), holes: vec![] })
    };
    for generator in [WallGenerator::Variable, WallGenerator::Classic] {
        let mut settings = job();
        settings.walls.generator = generator;
        for tenths in 2..=14 {
            let wide_mm = 0.1 * f64::from(tenths);
            let (low, high) = (5.0 - wide_mm / 2.0, 5.0 + wide_mm / 2.0);
            for pin in [round(wide_mm), rectangle(low, low, high, high)] {
                let layer = plan(&vec![pin.clone(); 8], &settings).swap_remove(4);
                let share = volume_mm3(&layer.paths) / (pin.area_mm2() * HEIGHT_MM);
                assert!((0.4..1.6).contains(&share), "{generator:?} {wide_mm:.1}: {share:.2} of {pin:?}");
                let out = |p: &&Point| !pin.contains(**p);
                assert_eq!(layer.paths.iter().flat_map(|p| &p.points).find(out), None);
            }
        }
    }
}

#[test]
fn on_a_monotonic_top_every_line_comes_after_the_one_below_it() {
    let section = with_hole(rectangle(0.0, 0.0, 20.0, 15.0), &rectangle(8.0, 5.0, 12.0, 10.0));
    let mut settings = job();
    settings.shell.monotonic = true;
    let top = plan(&vec![section; 6], &settings).swap_remove(5);
    let lines = of_role(&top, Role::TopSolidInfill);
    assert!(lines.len() > 40, "{}", lines.len());
    // The last layer's lines run at 135°.
    let ends = |p: &Path| [p.points[0], p.points[p.points.len() - 1]].map(Point::mm);
    let across = |p: &Path| {
        let [a, b] = ends(p).map(|[x, y]| (-x - y) / 2.0_f64.sqrt());
        a.midpoint(b)
    };
    let along = |p: &Path| {
        let [a, b] = ends(p).map(|[x, y]| (y - x) / 2.0_f64.sqrt());
        (a.min(b), a.max(b))
    };
    for a in &lines {
        for b in &lines {
            let (apart_mm, from, to) = (across(b) - across(a), along(a), along(b));
            let side_by_side = from.0 < to.1 && to.0 < from.1 && apart_mm > 0.3;
            assert!(
                !side_by_side || b.phase > a.phase,
                "{apart_mm} mm above, {:?} after {:?}",
                b.phase,
                a.phase
            );
        }
    }
    // The lines on one side of the hole come before those on the other, not by turns.
    let mut lines = lines;
    lines.sort_by_key(|p| p.phase);
    let far = |pair: &&[&Path]| {
        let (from, to) = (ends(pair[0]), ends(pair[1]));
        let distances = from.iter().flat_map(|a| to.iter().map(|b| (a[0] - b[0]).hypot(a[1] - b[1])));
        distances.fold(f64::INFINITY, f64::min) > 3.0
    };
    assert!(lines.windows(2).filter(far).count() <= 3);
}

#[test]
fn ironing_goes_once_more_over_the_top_and_lays_down_little() {
    let mut settings = job();
    settings.ironing.enabled = true;
    (settings.ironing.flow, settings.ironing.spacing) = (Ratio(0.1), Mm(0.1));
    let section = rectangle(0.0, 0.0, 20.0, 15.0);
    let layers = plan(&vec![section.clone(); 8], &settings);
    assert!(layers[..7].iter().all(|layer| of_role(layer, Role::Ironing).is_empty()));
    let ironing = of_role(&layers[7], Role::Ironing);
    let share =
        volume_mm3(ironing.iter().copied()) / (geometry::offset(&section, -1.0).area_mm2() * HEIGHT_MM);
    assert!((share - 0.1).abs() < 0.01, "{share}");
    assert!(layers[7].paths.iter().all(|p| p.role == Role::Ironing || p.phase < ironing[0].phase));
    let room = geometry::offset(&section, -0.8);
    assert!(ironing.iter().flat_map(|p| &p.points).all(|&p| room.contains(p)));
}

#[test]
fn thin_layers_get_more_of_them_for_the_same_shell() {
    let depth = |height_mm: f64, layers, thickness_mm| {
        shell_depth(std::iter::repeat_n(height_mm, 50), layers, thickness_mm)
    };
    assert_eq!((depth(0.2, 4, 0.7), depth(0.1, 4, 0.7), depth(0.1, 0, 0.7)), (4, 7, 0));
    let mixed = [0.1, 0.1, 0.1, 0.3, 0.3, 0.3];
    assert_eq!(shell_depth(mixed.into_iter(), 2, 0.6), 4, "true heights count");
    assert_eq!(shell_depth(mixed.into_iter(), 2, 2.0), 7, "more than there are");
}
