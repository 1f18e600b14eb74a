//! Bodies of 3MF files that change what is inside of them: negative volumes, and modifiers with settings of their own.

use std::path::PathBuf;

use crate::support::mesh_shapes::{Facets, cuboid, model_xml, package, painted_xml};
use crate::support::print::{Print, run, standard};
use crate::support::saved_project::{Part, Saved, part, project};
use crate::support::strokes::{Line, lines, volume_mm3};
use pathwright::job::Job;
use pathwright::profile::Settings;

const PART: &str = "ModelPart";
const CUT: &str = "NegativeVolume";
const MODIFIER: &str = "ParameterModifier";

/// A plate of 30 × 20 × 4 mm around the origin.
fn plate() -> Facets {
    cuboid([-15.0, -10.0, 0.0], [15.0, 10.0, 4.0])
}

/// A frame around the origin, between two rectangles of half these sizes.
fn frame(outer: [f32; 2], inner: [f32; 2], height: f32) -> Facets {
    let corner = |half: [f32; 2], k: usize, z: f32| {
        [[-half[0], half[0], half[0], -half[0]][k % 4], [-half[1], -half[1], half[1], half[1]][k % 4], z]
    };
    let quad = |[a, b, c, d]: [[f32; 3]; 4]| [[a, b, c], [a, c, d]];
    let side = |k: usize| {
        let (out, hole) = (|k, z| corner(outer, k, z), |k, z| corner(inner, k, z));
        [
            quad([out(k, 0.0), out(k + 1, 0.0), out(k + 1, height), out(k, height)]),
            quad([hole(k + 1, 0.0), hole(k, 0.0), hole(k, height), hole(k + 1, height)]),
            quad([out(k, height), out(k + 1, height), hole(k + 1, height), hole(k, height)]),
            quad([out(k + 1, 0.0), out(k, 0.0), hole(k, 0.0), hole(k + 1, 0.0)]),
        ]
    };
    (0..4).flat_map(side).flatten().collect()
}

fn sliced(path: PathBuf, settings: &Settings) -> Print {
    run(&Job::of([path]), settings).expect("a print")
}

fn print(saved: Saved, own: &[(&str, &str)], parts: &[Part<'_>], settings: &Settings) -> Print {
    let folder = tempfile::tempdir().expect("a folder");
    sliced(project(&folder, saved, own, parts), settings)
}

/// The layers of a print, without header and scripts.
fn layers(print: &Print) -> String {
    let text = String::from_utf8(print.text.clone()).expect("text");
    let body = text.split_once(";LAYER_CHANGE").expect("layers").1;
    body.split(";TYPE:Custom").next().unwrap_or_default().to_owned()
}

fn is_wall(line: &Line) -> bool {
    line.kind.contains("erimeter")
}

/// Of what lies between the layers of shells, where a test is true.
fn inner<'a>(lines: &'a [Line], test: impl Fn([f64; 2]) -> bool + 'a) -> impl Iterator<Item = &'a Line> {
    lines.iter().filter(move |line| (5..15).contains(&line.layer) && test(line.at))
}

#[test]
fn a_negative_volume_is_a_hole_of_all_parts() {
    let settings = standard(&["skirt.loops=0"]);
    let hole = || cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 5.0]);
    let folder = tempfile::tempdir().expect("a folder");
    let pierced = frame([15.0, 10.0], [4.0, 4.0], 4.0);
    let object = format!("<object id=\"1\">{}</object>", painted_xml(&pierced, |_| String::new()));
    let path = folder.path().join("parts.3mf");
    let model = model_xml("", &object, "<item objectid=\"1\"/>");
    std::fs::write(&path, package(&[("3D/3dmodel.model", &model)])).expect("written");
    let wanted = layers(&sliced(path, &settings));
    for saved in [Saved::Prusa, Saved::Orca] {
        // Whether it comes before or after what it is cut off.
        let after = print(saved, &[], &[part(plate(), PART, &[]), part(hole(), CUT, &[])], &settings);
        let before = print(saved, &[], &[part(hole(), CUT, &[]), part(plate(), PART, &[])], &settings);
        assert!(layers(&after) == wanted && layers(&before) == wanted, "{saved:?}");
    }
}

#[test]
fn infill_is_as_dense_as_a_modifier_says_and_the_walls_stay() {
    let settings = standard(&["skirt.loops=0", "infill.density=10%"]);
    let right = || cuboid([0.0, -20.0, -1.0], [20.0, 20.0, 10.0]);
    let plain = |settings: &Settings| {
        lines(&print(Saved::Prusa, &[], &[part(plate(), PART, &[])], settings), settings)
    };
    let plain = plain(&settings);
    for (saved, key) in [(Saved::Prusa, "fill_density"), (Saved::Orca, "sparse_infill_density")] {
        let keys = [(key, "40%")];
        let print = print(saved, &[], &[part(plate(), PART, &[]), part(right(), MODIFIER, &keys)], &settings);
        let found = lines(&print, &settings);
        let infill = |lines: &[Line], low: f64, high: f64| {
            let here = inner(lines, |at| (low..high).contains(&at[0]));
            volume_mm3(here.filter(|line| line.kind == "Internal infill"))
        };
        // Ten layers of what is within two walls.
        let inside_mm3 = 14.1 * 18.2 * 2.0;
        for (low, density) in [(-15.0, 0.1), (0.0, 0.4)] {
            let found = infill(&found, low, low + 15.0) / inside_mm3;
            assert!((found / density - 1.0).abs() < 0.05, "{saved:?}: {found} from {low} mm on");
        }
        let walls = |lines: &[Line]| volume_mm3(lines.iter().filter(|line| is_wall(line)));
        let (have, had) = (walls(&found), walls(&plain));
        assert!((have / had - 1.0).abs() < 1e-3, "{saved:?}: walls of {have}, {had} without");
        let solid =
            |lines: &[Line]| volume_mm3(lines.iter().filter(|line| line.kind.contains("olid infill")));
        let (have, had) = (solid(&found), solid(&plain));
        assert!((have / had - 1.0).abs() < 0.03, "{saved:?}: solid infill of {have}, {had} without");
    }
}

#[test]
fn walls_shells_and_pattern_may_differ_in_a_modifier() {
    let settings = standard(&["skirt.loops=0", "infill.density=10%"]);
    let right = || cuboid([0.0, -20.0, -1.0], [20.0, 20.0, 10.0]);
    let with = |keys: &[(&str, &str)]| {
        let parts = [part(plate(), PART, &[]), part(right(), MODIFIER, keys)];
        lines(&print(Saved::Prusa, &[], &parts, &settings), &settings)
    };
    let plain = with(&[]);
    // Without what crosses the border, or runs along it.
    let side = |lines: &[Line], right: bool, kind: &str| {
        let is_beside =
            |line: &&Line| line.ends.iter().all(|end| (end[0] > 0.0) == right && end[0].abs() > 2.0);
        volume_mm3(lines.iter().filter(is_beside).filter(|line| line.kind == kind))
    };
    let walls = with(&[("perimeters", "6")]);
    let (more, had) = (side(&walls, true, "Perimeter"), side(&plain, true, "Perimeter"));
    assert!(more > 3.0 * had, "{more} of walls, {had} without");
    // Loops begin at places of their own on the sides that cross the border.
    let upright = |lines: &[Line]| {
        let left = lines.iter().filter(|l| l.kind == "Perimeter" && l.ends.iter().all(|end| end[0] < -14.0));
        volume_mm3(left.filter(|line| (line.ends[0][0] - line.ends[1][0]).abs() < 1e-3))
    };
    let (left, had) = (upright(&walls), upright(&plain));
    assert!((left / had - 1.0).abs() < 0.01, "{left} of walls on the left, {had} without");
    let tops = with(&[("top_solid_layers", "9"), ("top_solid_min_thickness", "0")]);
    let solid = |lines: &[Line], right| side(lines, right, "Solid infill");
    let (more, had) = (solid(&tops, true), solid(&plain, true));
    assert!(more > 1.5 * had, "{more} of solid infill, {had} without");
    let (left, had) = (solid(&tops, false), solid(&plain, false));
    assert!((left / had - 1.0).abs() < 0.05, "{left} of solid infill on the left, {had} without");
    let pattern = with(&[("fill_pattern", "concentric")]);
    let level = |right: bool| {
        let infill = || pattern.iter().filter(|l| l.kind == "Internal infill" && (l.at[0] > 0.0) == right);
        let is_level = |l: &&Line| (0..2).any(|i| (l.ends[0][i] - l.ends[1][i]).abs() < 1e-3);
        volume_mm3(infill().filter(is_level)) / volume_mm3(infill())
    };
    assert!(level(true) > 0.9 && level(false) < 0.6, "{} and {}", level(true), level(false));
}

#[test]
fn modifiers_take_effect_one_after_the_other() {
    let settings =
        standard(&["skirt.loops=0", "infill.density=0%", "shell.top_layers=0", "shell.bottom_layers=0"]);
    let low = [-20.0, -20.0, -1.0];
    let parts = [
        part(plate(), PART, &[]),
        // The right two thirds with 20 %, the right third with two walls more besides.
        part(cuboid([-5.0, low[1], low[2]], [20.0, 20.0, 10.0]), MODIFIER, &[("fill_density", "20%")]),
        part(cuboid([5.0, low[1], low[2]], [20.0, 20.0, 10.0]), MODIFIER, &[("perimeters", "5")]),
    ];
    let found = lines(&print(Saved::Prusa, &[], &parts, &settings), &settings);
    let infill = |low: f64, high: f64| {
        volume_mm3(inner(&found, |at| (low..high).contains(&at[0])).filter(|l| l.kind == "Internal infill"))
    };
    assert_eq!(infill(-15.0, -6.0), 0.0);
    assert!(
        infill(-4.0, 4.0) > 10.0 && infill(8.0, 12.0) > 5.0,
        "{}, {}",
        infill(-4.0, 4.0),
        infill(8.0, 12.0)
    );
}

#[test]
fn a_modifier_may_have_a_tool_of_its_own() {
    let settings = standard(&[
        "tools.1.filament.color=#FFFFFF",
        "tools.2.filament.color=#000000",
        "skirt.loops=0",
        "infill.density=100%",
    ]);
    let middle = || cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 10.0]);
    for saved in [Saved::Prusa, Saved::Orca] {
        let keys = [("extruder", "2")];
        let parts = [part(plate(), PART, &[]), part(middle(), MODIFIER, &keys)];
        let found = lines(&print(saved, &[], &parts, &settings), &settings);
        for line in &found {
            let reach = line.at[0].abs().max(line.at[1].abs());
            assert!(
                (reach - 5.0).abs() < 0.1 || (line.tool == 2) == (reach < 5.0),
                "{saved:?}: {:?}",
                line.at
            );
        }
        let of_tool = |tool: u32| volume_mm3(found.iter().filter(|line| line.tool == tool));
        let (white, black) = (of_tool(1), of_tool(2));
        // A full print is a little fuller than full.
        assert!((white / 2000.0 - 1.0).abs() < 0.03, "{white}");
        // All around, walls press into others by half of what the round sides of beads leave out.
        let half_mm = 5.0 + 0.1 * (1.0 - std::f32::consts::FRAC_PI_4);
        let larger = || cuboid([-half_mm, -half_mm, 0.0], [half_mm, half_mm, 4.0]);
        let one = Settings { tools: Vec::new(), ..settings.clone() };
        let alone = volume_mm3(lines(&print(saved, &[], &[part(larger(), PART, &[])], &one), &one).iter());
        assert!((black / alone - 1.0).abs() < 0.005, "{black}, {alone} alone");
    }
}

#[test]
fn settings_of_objects_and_parts_hold_and_those_that_cannot_are_told() {
    let settings = standard(&["skirt.loops=0", "infill.density=0%"]);
    let own = [("fill_density", "30%"), ("layer_height", "0.1"), ("perimeter_speed", "20")];
    let parts = [
        part(cuboid([-15.0, -10.0, 0.0], [0.0, 10.0, 4.0]), PART, &[]),
        part(cuboid([0.0, -10.0, 0.0], [15.0, 10.0, 4.0]), PART, &[("fill_density", "60%")]),
    ];
    let print = print(Saved::Prusa, &own, &parts, &settings);
    let found = lines(&print, &settings);
    let density = |low: f64, high: f64| {
        let here = inner(&found, |at| at[1].abs() < 9.0 && (low..high).contains(&at[0]));
        volume_mm3(here.filter(|line| line.kind == "Internal infill")) / ((high - low) * 18.0 * 2.0)
    };
    let (left, right) = (density(-13.0, -2.0), density(2.0, 13.0));
    // Lines are counted by their middles, and they reach into the walls.
    assert!((left - 0.33).abs() < 0.02 && (right - 0.69).abs() < 0.03, "{left}, {right}");
    let told = print.summary.warnings.join("\n");
    assert!(told.contains("layer_height") && told.contains("perimeter_speed"), "{told}");
    assert!(!told.contains("fill_density"), "{told}");
}

#[test]
fn what_the_user_says_of_an_object_wins_over_its_file() {
    let settings = standard(&["skirt.loops=0", "infill.density=0%"]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = project(&folder, Saved::Prusa, &[("fill_density", "30%")], &[part(plate(), PART, &[])]);
    let own = settings.clone().set("infill.density", "50%").expect("a density");
    let objects = vec![pathwright::job::ObjectSettings { object: "parts".into(), settings: own }];
    let print = run(&Job { objects, ..Job::of([path]) }, &settings).expect("a print");
    let found = lines(&print, &settings);
    let here = inner(&found, |at| at[1].abs() < 9.0 && at[0].abs() < 13.0);
    let density = volume_mm3(here.filter(|line| line.kind == "Internal infill")) / (26.0 * 18.0 * 2.0);
    assert!((density - 0.5).abs() < 0.03, "{density}");
}

#[test]
fn support_enforcers_and_blockers_of_a_file_say_where_support_stands() {
    let bar = || {
        [cuboid([-3.0, -5.0, 0.0], [3.0, 5.0, 6.0]), cuboid([-15.0, -5.0, 6.0], [15.0, 5.0, 9.0])].concat()
    };
    let left = || cuboid([-16.0, -6.0, 0.0], [0.0, 6.0, 10.0]);
    let support = |saved: Saved, purpose: &str, enabled: bool| {
        let settings = standard(&[
            "skirt.loops=0",
            "support.max_bridge=0",
            if enabled { "support.enabled=true" } else { "support.enabled=false" },
        ]);
        let parts = [part(bar(), PART, &[]), part(left(), purpose, &[])];
        let found = lines(&print(saved, &[], &parts, &settings), &settings);
        [false, true].map(|right| {
            let here =
                |line: &&Line| line.kind.starts_with("Support material") && (line.at[0] > 0.0) == right;
            volume_mm3(found.iter().filter(here))
        })
    };
    for saved in [Saved::Prusa, Saved::Orca] {
        let [left, right] = support(saved, "SupportEnforcer", false);
        assert!(left > 10.0 && right == 0.0, "{saved:?}: {left}, {right}");
        let [left, right] = support(saved, "SupportBlocker", true);
        assert!(left == 0.0 && right > 10.0, "{saved:?}: {left}, {right}");
    }
}
