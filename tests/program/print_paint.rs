//! What is painted on a model is printed so.

use std::fs;
use std::path::PathBuf;

use crate::support::mesh_shapes::{Facets, cuboid, model_xml, package, painted_xml, prism};
use crate::support::print::{Print, run, settings, standard};
use crate::support::strokes::{Line, lines, volume_mm3};
use pathwright::geometry::{Point, Polygon, Region, intersection, opening, union_all};
use pathwright::job::Job;
use pathwright::profile::{SeamPosition, Settings};

const SIDES: usize = 48;

/// A 3MF file of one object with these facets and their attributes.
fn file(folder: &tempfile::TempDir, facets: &Facets, attributes: impl Fn(usize) -> String) -> PathBuf {
    let namespace = "xmlns:slic3rpe=\"http://schemas.slic3r.org/3mf/2017/06\"";
    let object = format!("<object id=\"1\">{}</object>", painted_xml(facets, attributes));
    let model = model_xml(namespace, &object, "<item objectid=\"1\"/>");
    let path = folder.path().join("painted.3mf");
    fs::write(&path, package(&[("3D/3dmodel.model", &model)])).expect("written");
    path
}

/// A round tower of 6 mm on which sides are painted.
fn tower(painted: impl Fn(usize) -> String, settings: &Settings) -> Print {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, &prism(SIDES, 10.0, 6.0), |facet| {
        if facet < 2 * SIDES { painted(facet / 2) } else { String::new() }
    });
    run(&Job { models: vec![path.into()], ..Job::default() }, settings).expect("a print")
}

/// The sides, as a real number, at which walls begin.
fn seams(print: &Print, settings: &Settings) -> Vec<f64> {
    let middle = settings.bed.middle_mm();
    let walls =
        print.beads().into_iter().filter(|bead| bead.kind.contains("erimeter") && bead.length_mm() > 30.0);
    let side = |[x, y]: [f64; 2]| {
        let turns = (y - middle[1]).atan2(x - middle[0]) / std::f64::consts::TAU;
        turns.rem_euclid(1.0) * SIDES as f64
    };
    walls.map(|bead| side(bead.points[0])).collect()
}

#[test]
fn every_seam_lies_where_it_is_painted_and_none_where_it_is_blocked() {
    let enforced = |side: usize| match side {
        6 | 7 => "slic3rpe:custom_seam=\"4\"".to_owned(),
        8 => "slic3rpe:custom_seam=\"8\"".to_owned(),
        _ => String::new(),
    };
    let blocked = |side: usize| if side < 40 { "paint_seam=\"8\"".to_owned() } else { String::new() };
    for (name, position) in SeamPosition::ALL {
        for more in [&[][..], &["walls.generator=variable"]] {
            let settings = standard(&[&[&*format!("seam.position={name}")], more].concat());
            let found = seams(&tower(enforced, &settings), &settings);
            assert_eq!(found.len(), 2 * 30);
            assert!(found.iter().all(|side| (6.0..=8.0).contains(side)), "{position:?}: {found:?}");
            let found = seams(&tower(blocked, &settings), &settings);
            assert!(found.iter().all(|side| (40.0..=48.0).contains(side)), "{position:?}: {found:?}");
        }
    }
}

#[test]
fn seams_are_where_they_are_painted_by_default_too() {
    let settings = settings(&[], &["order.cost=time", "seam.scarf=5"]);
    let strip = |side: usize| if side == 20 { "paint_seam=\"4\"".to_owned() } else { String::new() };
    let found = seams(&tower(strip, &settings), &settings);
    assert!(found.len() > 50 && found.iter().all(|side| (20.0..=21.0).contains(side)), "{found:?}");
}

/// A printer with two tools that fills everything.
fn two_tools(more: &[&str]) -> Settings {
    let own = [
        "tools.1.filament.color=#FFFFFF",
        "tools.2.filament.color=#000000",
        "infill.density=100%",
        "skirt.loops=0",
    ];
    standard(&[&own, more].concat())
}

#[test]
fn painted_sides_are_printed_with_their_tool_to_the_middle_or_as_deep_as_is_wanted() {
    let half = |side: usize| {
        if side < SIDES / 2 { "slic3rpe:mmu_segmentation=\"8\"".to_owned() } else { String::new() }
    };
    for (depth, share) in [("0", 0.5), ("2", 0.18)] {
        let settings = two_tools(&[&format!("tool_of.paint_depth={depth}")]);
        let print = tower(half, &settings);
        let lines = lines(&print, &settings);
        // The top and the bottom are not painted.
        let middle = || lines.iter().filter(|line| (4..26).contains(&line.layer));
        for line in middle().filter(|line| line.at[0].hypot(line.at[1]) > 9.5 && line.at[1].abs() > 0.5) {
            assert_eq!(
                line.tool,
                if line.at[1] > 0.0 { 2 } else { 1 },
                "{:?} on layer {}",
                line.at,
                line.layer
            );
        }
        let black = volume_mm3(middle().filter(|line| line.tool == 2)) / volume_mm3(middle());
        assert!((black - share).abs() < 0.01, "{black} of the middle");
        assert!(lines.iter().filter(|line| matches!(line.layer, 0 | 29)).all(|line| line.tool == 1));
        let plain = volume_mm3(self::lines(&tower(|_| String::new(), &settings), &settings).iter());
        let all = volume_mm3(lines.iter());
        assert!((all / plain - 1.0).abs() < 0.01, "{all} of {plain}");
    }
}

#[test]
fn a_painted_top_is_as_thick_as_the_shell_and_its_walls_are_not() {
    let settings = two_tools(&[]);
    let folder = tempfile::tempdir().expect("a folder");
    // The second half of the lids' facets are on top.
    let path = file(&folder, &prism(SIDES, 10.0, 6.0), |facet| match facet % 2 {
        1 if facet >= 2 * SIDES => "paint_color=\"8\"".to_owned(),
        _ => String::new(),
    });
    let print = run(&Job { models: vec![path.into()], ..Job::default() }, &settings).expect("a print");
    let lines = lines(&print, &settings);
    let tools = |layer: usize, outer: bool| {
        let here =
            lines.iter().filter(|line| line.layer == layer && (line.kind == "External perimeter") == outer);
        let mut tools: Vec<u32> =
            here.filter(|line| (line.at[0].hypot(line.at[1]) > 9.5) == outer).map(|line| line.tool).collect();
        tools.sort_unstable();
        tools.dedup();
        tools
    };
    let layers = settings.shell.top_layers as usize;
    assert_eq!((tools(29, true), tools(29, false)), (vec![2], vec![2]));
    for layer in 30 - layers..29 {
        assert_eq!(tools(layer, true), [1], "layer {layer}");
        assert!(tools(layer, false).contains(&2), "layer {layer}");
    }
    assert!(lines.iter().filter(|line| line.layer < 30 - layers).all(|line| line.tool == 1));
}

/// A bar on a pillar, whose ledges are painted.
fn bar(painted: [&str; 2], sets: &[&str]) -> Vec<Line> {
    let pillar = cuboid([-3.0, -5.0, 0.0], [3.0, 5.0, 6.0]);
    let halves = [cuboid([-15.0, -5.0, 6.0], [0.0, 5.0, 9.0]), cuboid([0.0, -5.0, 6.0], [15.0, 5.0, 9.0])];
    let facets = [pillar, halves.concat()].concat();
    let folder = tempfile::tempdir().expect("a folder");
    // The first two facets of a box are its bottom.
    let path = file(&folder, &facets, |facet| match facet {
        12 | 13 => painted[0].to_owned(),
        24 | 25 => painted[1].to_owned(),
        _ => String::new(),
    });
    let settings = standard(&[&["skirt.loops=0"], sets].concat());
    lines(&run(&Job::of([path]), &settings).expect("a print"), &settings)
}

/// Volumes of support on the left and on the right.
fn support(lines: &[Line]) -> [f64; 2] {
    [false, true].map(|right| {
        let here = |line: &&Line| line.kind.starts_with("Support material") && (line.at[0] > 0.0) == right;
        volume_mm3(lines.iter().filter(here))
    })
}

#[test]
fn support_stands_under_what_is_painted_so_and_not_where_it_is_blocked() {
    let (here, not) = ("slic3rpe:custom_supports=\"4\"", "paint_supports=\"8\"");
    for style in ["support.style=grid", "support.style=tree"] {
        let off = [style, "support.enabled=false"];
        let on = [style, "support.enabled=true", "support.max_bridge=0"];
        assert_eq!(support(&bar(["", ""], &off)), [0.0, 0.0], "{style}");
        let [left, right] = support(&bar([here, ""], &off));
        assert!(left > 10.0 && right == 0.0, "{style}: {left}, {right}");
        let [both, other] = support(&bar(["", ""], &on));
        assert!(both > 10.0 && other > 10.0, "{style}: {both}, {other}");
        assert!((left / both - 1.0).abs() < 0.1, "{style}: as much as without paint: {left}, {both}");
        let [left, right] = support(&bar([here, not], &on));
        assert!(left > 10.0 && right == 0.0, "{style}: {left}, {right}");
    }
}

#[test]
fn a_slope_that_needs_no_support_gets_it_where_it_is_painted() {
    // 40° and 20° from the vertical: not as far as is held by default, and steep.
    for reach_mm in [8.4, 3.64] {
        let slope = [[0.0, -6.0, 0.0], [0.0, 6.0, 0.0], [reach_mm, 6.0, 10.0], [reach_mm, -6.0, 10.0]];
        let base: Facets = cuboid([-6.0, -6.0, 0.0], [0.0, 6.0, 10.0]);
        let [a, b, c, d] = slope;
        let [e, f] = [[0.0, -6.0, 10.0], [0.0, 6.0, 10.0]];
        let wedge: Facets =
            vec![[a, b, c], [a, c, d], [e, d, c], [e, c, f], [a, d, e], [b, f, c], [a, e, f], [a, f, b]];
        let facets = [wedge, base].concat();
        let settings = standard(&["skirt.loops=0"]);
        let volume = |paint: &str| {
            let folder = tempfile::tempdir().expect("a folder");
            let path =
                file(&folder, &facets, |facet| if facet < 2 { paint.to_owned() } else { String::new() });
            let lines = lines(&run(&Job::of([path]), &settings).expect("a print"), &settings);
            volume_mm3(lines.iter().filter(|line| line.kind.starts_with("Support material")))
        };
        assert_eq!(volume(""), 0.0);
        let painted = volume("paint_supports=\"4\"");
        assert!(painted > f64::from(6.0 * reach_mm), "{painted} mm³ under {reach_mm} mm");
    }
}

/// What strokes of a tool fill of a layer, 0.2 mm high, as rectangles of their volume: their round sides press into each other.
fn covered(lines: &[Line], layer: usize, tool: u32) -> Region {
    let rectangle = |line: &Line| {
        let [a, b] = line.ends;
        let length_mm = (b[0] - a[0]).hypot(b[1] - a[1]);
        let width_mm = line.volume_mm3 / length_mm / 0.2;
        let aside = [(a[1] - b[1]), (b[0] - a[0])].map(|d| d / length_mm * width_mm / 2.0);
        let corner =
            |end: [f64; 2], side: f64| Point::from_mm(end[0] + side * aside[0], end[1] + side * aside[1]);
        Region::from(Polygon {
            outer: vec![corner(a, -1.0), corner(b, -1.0), corner(b, 1.0), corner(a, 1.0)],
            holes: Vec::new(),
        })
    };
    let of_tool = lines.iter().filter(|line| (line.layer, line.tool) == (layer, tool));
    let rectangles: Vec<Region> = of_tool.map(rectangle).collect();
    union_all(&rectangles)
}

/// A tower whose sides and lids are painted by a rule of the side.
fn painted_through(tool: impl Fn(usize) -> usize, settings: &Settings) -> Vec<Line> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, &prism(SIDES, 10.0, 6.0), |facet| {
        let side = if facet < 2 * SIDES { facet / 2 } else { (facet - 2 * SIDES) / 2 };
        ["", "paint_color=\"8\"", "paint_color=\"0C\""][tool(side)].to_owned()
    });
    lines(&run(&Job::of([path]), settings).expect("a print"), settings)
}

#[test]
fn each_tool_prints_as_much_as_of_its_part_alone() {
    let settings = two_tools(&[]);
    let found = painted_through(|side| usize::from(side < SIDES / 2), &settings);
    // Half of the prism, as a solid of its own.
    let half = {
        let at = |k: usize, z: f32| {
            let angle = k as f32 / SIDES as f32 * std::f32::consts::TAU;
            [10.0 * angle.cos(), 10.0 * angle.sin(), z]
        };
        let quad = |[a, b, c, d]: [[f32; 3]; 4]| [[a, b, c], [a, c, d]];
        let side = |k: usize| quad([at(k, 0.0), at(k + 1, 0.0), at(k + 1, 6.0), at(k, 6.0)]);
        let mut facets: Facets = (0..SIDES / 2).flat_map(side).collect();
        facets.extend(quad([at(SIDES / 2, 0.0), at(0, 0.0), at(0, 6.0), at(SIDES / 2, 6.0)]));
        facets.extend((1..SIDES / 2).flat_map(|k| {
            [[at(0, 0.0), at(k + 1, 0.0), at(k, 0.0)], [at(0, 6.0), at(k, 6.0), at(k + 1, 6.0)]]
        }));
        facets
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = file(&folder, &half, |_| String::new());
    let one = Settings { tools: Vec::new(), ..settings.clone() };
    let alone = volume_mm3(lines(&run(&Job::of([path]), &one).expect("a print"), &one).iter());
    for tool in [1, 2] {
        let own = volume_mm3(found.iter().filter(|line| line.tool == tool));
        assert!((own / alone - 1.0).abs() < 0.005, "tool {tool}: {own} of {alone}");
    }
}

#[test]
fn beads_of_two_tools_overlap_nowhere() {
    let more = ["tools.3.filament.color=#FF0000"];
    let ringed = ["tools.3.filament.color=#FF0000", "tool_of.paint_depth=1.5", "infill.density=20%"];
    // Five sides of a tool, or one, which then has a tip in the middle.
    for (sets, sides) in [(&more[..], 5), (&ringed, 5), (&more, 1)] {
        let settings = two_tools(sets);
        let found = painted_through(|side| side / sides % 3, &settings);
        for layer in [0, 1, 9, 15, 27, 29] {
            let of_tool = [1, 2, 3].map(|tool| covered(&found, layer, tool));
            for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                let shared = intersection(&of_tool[a], &of_tool[b]);
                let deep = opening(&shared, 0.025);
                assert!(deep.is_empty(), "layer {layer}, tools {} and {}: {deep:?}", a + 1, b + 1);
            }
        }
    }
}
