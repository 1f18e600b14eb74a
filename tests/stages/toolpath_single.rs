//! Where a layer has its outermost wall alone, and how far the next one keeps off it.

use crate::support::toolpath_plan::{HEIGHT_MM, job, of_role, plan, rectangle};
use crate::toolpath_raster::coverage;
use pathwright::geometry::{self, Point, Region};
use pathwright::profile::{Settings, SingleOnTop, WallGenerator};
use pathwright::toolpath::{LayerPaths, Role, bead};
use pathwright::units::Mm;
use proptest::prelude::*;

/// Ten layers of 40 mm with ten of 20 mm on a corner of them.
fn step() -> Vec<Region> {
    let (wide, narrow) = (rectangle(0.0, 0.0, 40.0, 40.0), rectangle(0.0, 0.0, 20.0, 20.0));
    [vec![wide; 10], vec![narrow; 10]].concat()
}

fn single(on_top: SingleOnTop) -> Settings {
    let mut settings = job();
    settings.walls.count = 3;
    settings.walls.single_on_top = on_top;
    settings
}

/// Vertices of the inner walls of a layer.
fn inner_walls(layer: &LayerPaths) -> Vec<Point> {
    of_role(layer, Role::Perimeter).into_iter().flat_map(|p| p.points.iter().copied()).collect()
}

#[test]
fn the_bare_part_of_a_step_has_one_wall_and_top_lines_up_to_it() {
    for generator in [WallGenerator::Classic, WallGenerator::Variable] {
        let mut settings = single(SingleOnTop::Top);
        settings.walls.generator = generator;
        let layers = plan(&step(), &settings);
        let walls = inner_walls(&layers[9]);
        let under = rectangle(0.0, 0.0, 20.0, 20.0);
        assert!(walls.len() >= 8 && walls.iter().all(|p| under.contains(*p)), "{generator:?}");
        assert_eq!(of_role(&layers[9], Role::ExternalPerimeter).len(), 1);
        let spacing_mm = bead::spacing_mm(0.45, HEIGHT_MM);
        let top = of_role(&layers[9], Role::TopSolidInfill);
        let furthest = top.iter().flat_map(|p| &p.points).map(|p| p.mm()[0]).fold(0.0, f64::max);
        assert!(40.0 - furthest < 0.45 + spacing_mm, "{generator:?}: top lines end at {furthest}");
        // Layers of which all or nothing is covered are as ever, and one.
        assert_eq!(of_role(&layers[8], Role::Perimeter).len(), 2);
        assert_eq!(inner_walls(&layers[19]), []);
    }
}

#[test]
fn a_step_with_one_wall_on_top_is_as_full_as_any() {
    for generator in [WallGenerator::Classic, WallGenerator::Variable] {
        let void = |on_top| {
            let mut settings = single(on_top);
            settings.walls.generator = generator;
            coverage(&step()[9], &plan(&step(), &settings)[9].paths)
        };
        let (ours, usual) = (void(SingleOnTop::Top), void(SingleOnTop::None));
        assert!(ours.void <= usual.void + 0.003, "{generator:?}: {} instead of {}", ours.void, usual.void);
        assert!(ours.double <= usual.double + 0.01, "{generator:?}: {} of {}", ours.double, usual.double);
    }
}

#[test]
fn narrow_top_surfaces_and_those_over_air_keep_their_walls() {
    // A pyramid with steps of 1.5 mm, less than the outermost wall and the least width.
    let steps: Vec<Region> = (0..8)
        .map(|i| {
            let edge_mm = 1.5 * f64::from(i);
            rectangle(edge_mm, edge_mm, 40.0 - edge_mm, 40.0 - edge_mm)
        })
        .collect();
    assert!(plan(&steps, &single(SingleOnTop::Top))[..7] == plan(&steps, &single(SingleOnTop::None))[..7]);
    // A single layer that reaches out over air on one side.
    let (base, roof) = (rectangle(0.0, 0.0, 20.0, 20.0), rectangle(0.0, 0.0, 40.0, 20.0));
    let sections = [vec![base.clone(); 8], vec![roof], vec![base; 8]].concat();
    let layer = &plan(&sections, &single(SingleOnTop::Top))[8];
    assert!(inner_walls(layer).iter().any(|p| p.mm()[0] > 39.0));
}

#[test]
fn only_the_last_layer_or_the_first_has_one_wall_where_that_is_asked_for() {
    let counts = |settings: &Settings| -> Vec<usize> {
        plan(&step(), settings).iter().map(|layer| of_role(layer, Role::Perimeter).len()).collect()
    };
    let all_but = |which: usize| (0..20).map(|i| if i == which { 0 } else { 2 }).collect::<Vec<_>>();
    assert_eq!(counts(&single(SingleOnTop::Topmost)), all_but(19));
    let mut first = single(SingleOnTop::None);
    first.walls.single_on_first_layer = true;
    assert_eq!(counts(&first), all_but(0));
}

proptest! {
    /// Whatever lies on a plate, its inner walls are under it or, around a narrow rest, all there.
    #[test]
    fn bare_surfaces_have_no_inner_walls(x in 2.0..30.0, y in 2.0..30.0, w in 3.0..10.0, d in 3.0..10.0) {
        let above = rectangle(x, y, x + w, y + d);
        let sections = [vec![rectangle(0.0, 0.0, 42.0, 42.0); 6], vec![above.clone(); 6]].concat();
        let layer = &plan(&sections, &single(SingleOnTop::Top))[5];
        let far = geometry::offset(&above, 2.0);
        prop_assert!(inner_walls(layer).iter().all(|p| far.contains(*p)));
        prop_assert!(!of_role(layer, Role::TopSolidInfill).is_empty());
    }
}

#[test]
fn a_precise_outermost_wall_is_not_overlapped_by_the_next() {
    let x_max = |layer: &LayerPaths, role| {
        of_role(layer, role).iter().flat_map(|p| &p.points).map(|p| p.mm()[0]).fold(0.0, f64::max)
    };
    for generator in [WallGenerator::Classic, WallGenerator::Variable] {
        // A slot that is too narrow for all walls makes the generators do their work.
        for narrow in [false, true] {
            let mut settings = job();
            (settings.walls.generator, settings.walls.precise) = (generator, true);
            settings.walls.width = Mm(0.5);
            let mut section = rectangle(0.0, 0.0, 20.0, 20.0);
            if narrow {
                section = geometry::union(&section, &rectangle(-10.0, 5.0, 1.0, 5.6));
            }
            let layer = &plan(&vec![section; 10], &settings)[5];
            let (outer, inner) = (x_max(layer, Role::ExternalPerimeter), x_max(layer, Role::Perimeter));
            assert!((outer - (20.0 - 0.45 / 2.0)).abs() < 1e-4, "outermost wall at {outer}");
            assert!((outer - inner - (0.45 + 0.5) / 2.0).abs() < 1e-4, "{generator:?}: {}", outer - inner);
        }
    }
}
