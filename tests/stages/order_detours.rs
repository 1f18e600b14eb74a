//! Ordering knows what travels cost that are led round what is not printed.

use std::slice;

use pathwright::geometry::{Point, unite_rings};
use pathwright::order::{
    Chain, Cost, DetourRule, LayerProblem, LinkKind, PathVisit, Watch, check, ends_on_path,
};
use pathwright::profile::{CostKind, OrderSettings, Scope, SeamPosition, Settings};
use pathwright::toolpath::{IslandId, LayerKind, LayerPaths, Path, Phase, Role, Width};
use pathwright::units::Mm;
use proptest::prelude::*;

fn path(points: &[(f64, f64)]) -> Path {
    Path {
        role: Role::SolidInfill,
        closed: points.len() > 2,
        points: points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect(),
        width: Width::Constant(0.4),
        height_mm: 0.2,
        island: Some(IslandId(0)),
        phase: Phase::Wall(0),
        tool: None,
    }
}

/// Two posts of 5 × 20 mm on a foot of 14 × 2 mm, 4 mm apart.
fn posts(paths: Vec<Path>) -> LayerPaths {
    let outer = [(0., 0.), (14., 0.), (14., 20.), (9., 20.), (9., 2.), (5., 2.), (5., 20.), (0., 20.)];
    LayerPaths {
        index: 0,
        top_mm: 0.2,
        height_mm: 0.2,
        islands: Vec::new(),
        paths,
        outline: unite_rings(&[outer.map(|(x, y)| Point::from_mm(x, y)).to_vec()]),
        beneath: None,
        kind: LayerKind::Flat,
        entries: Default::default(),
        tools: Vec::new(),
        rams: Vec::new(),
        turn: Default::default(),
    }
}

fn settings() -> Settings {
    let mut settings = Settings::default();
    settings.travel.max_detour = Mm(100.0);
    settings
}

/// The order found with detours known or not.
fn sequence(layer: &LayerPaths, cost: Cost, scope: Scope, detours: Option<DetourRule>) -> Vec<PathVisit> {
    let settings = OrderSettings { scope, ..OrderSettings::default() };
    let chain = Chain { settings, cost, detours, seam: SeamPosition::Free, corners: None, origin: None };
    chain
        .solve_chunk(slice::from_ref(layer), &[None], Some(Point::from_mm(3.0, 19.5)), Watch::default())
        .swap_remove(0)
}

/// Cost of the travels of an order, those from where the nozzle was left out.
fn travel_cost(layer: &LayerPaths, cost: Cost, sequence: &[PathVisit]) -> f64 {
    let rule = settings().detour_rule().unwrap();
    let router = pathwright::geometry::Router::new(&layer.outline, rule.wall_width_mm, rule.max_mm);
    let ends: Vec<_> = sequence.iter().map(|&visit| ends_on_path(layer, visit)).collect();
    ends.windows(2).map(|pair| rule.cost(&router, &cost, [pair[0].1.mm(), pair[1].0.mm()], false)).sum()
}

#[test]
fn posts_are_left_where_the_travel_to_the_next_is_short() {
    // Ten upright lines in each post, 0.5 mm apart; straight, the posts are as near to each other at the top.
    let rows = [3.5, 10.5].into_iter().flat_map(|x| (0..10).map(move |i| (x, 2.0 + 1.7 * f64::from(i))));
    let layer = posts(rows.map(|(x, y)| path(&[(x, y), (x, y + 1.2)])).collect());
    let found = sequence(&layer, Cost::Length, Scope::Layer, settings().detour_rule());
    let travel_mm = travel_cost(&layer, Cost::Length, &found);
    assert!(travel_mm < 18.0 * 0.5 + 9.0, "{travel_mm} mm");
}

#[test]
fn without_detours_there_is_no_rule() {
    let mut settings = settings();
    settings.travel.avoid_crossing = false;
    assert_eq!(settings.detour_rule(), None);
}

/// Lines and squares in either post.
fn paths() -> impl Strategy<Value = Vec<Path>> {
    let one = (any::<bool>(), any::<bool>(), 0.5..4.0_f64, 0.5..18.0_f64, 0.2..0.5_f64, 0.3..1.4_f64);
    let one = one.prop_map(|(left, square, x, y, dx, dy)| {
        let x = if left { x } else { x + 9.0 };
        match square {
            true => path(&[(x, y), (x + dx, y), (x + dx, y + dy), (x, y + dy)]),
            false => path(&[(x, y), (x + dx, y + dy)]),
        }
    });
    prop::collection::vec(one, 1..30)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn knowing_detours_never_makes_travel_dearer(paths in paths(), time in any::<bool>(), ranked in any::<bool>()) {
        let mut layer = posts(paths);
        let scope = if ranked { Scope::Feature } else { Scope::Layer };
        layer.paths.iter_mut().for_each(|path| path.phase = Phase::Found(u32::from(path.closed)));
        let cost = settings().order_cost(if time { CostKind::Time } else { CostKind::Length });
        let straight = sequence(&layer, cost, scope, None);
        let led = sequence(&layer, cost, scope, settings().detour_rule());
        let problem = LayerProblem::new(&layer, &None, scope);
        prop_assert_eq!(check(&problem.problem, &problem.from_paths(&led)), Ok(()));
        // The travel to the first path counts in both, as what was minimised: the nozzle climbs from wherever it is.
        let first = |sequence: &[PathVisit]| {
            let to = ends_on_path(&layer, sequence[0]).0;
            cost.of(Point::from_mm(3.0, 19.5).distance_mm(to), LinkKind::UP)
        };
        let total = |sequence: &[PathVisit]| first(sequence) + travel_cost(&layer, cost, sequence);
        prop_assert!(total(&led) <= total(&straight) + 1e-6, "{} and {}", total(&led), total(&straight));
    }
}
