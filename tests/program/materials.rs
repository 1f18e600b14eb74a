//! Materials and colours of 3MF files as tools.

use std::path::PathBuf;

use crate::support::mesh_shapes::{Facets, cuboid, model_xml, package, painted_xml};
use crate::support::print::{Print, run, standard};
use crate::support::strokes::{Line, lines, volume_mm3};
use pathwright::job::Job;
use pathwright::profile::Settings;

const COLORS: &str = "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"";

fn two_tools() -> Settings {
    standard(&[
        "tools.1.filament.color=#FFFFFF",
        "tools.2.filament.color=#000000",
        "skirt.loops=0",
        "infill.density=100%",
        "prime_tower.enabled=false",
    ])
}

fn file(folder: &tempfile::TempDir, resources: &str, build: &str) -> PathBuf {
    let path = folder.path().join("made-of.3mf");
    std::fs::write(&path, package(&[("3D/3dmodel.model", &model_xml(COLORS, resources, build))]))
        .expect("written");
    path
}

fn sliced(resources: &str, build: &str, settings: &Settings) -> Print {
    let folder = tempfile::tempdir().expect("a folder");
    run(&Job::of([file(&folder, resources, build)]), settings).expect("a print")
}

fn body(id: u32, attributes: &str, facets: &Facets, of_facet: impl Fn(usize) -> String) -> String {
    format!("<object id=\"{id}\" {attributes}>{}</object>", painted_xml(facets, of_facet))
}

/// Volumes of the first and the second tool.
fn by_tool(lines: &[Line]) -> [f64; 2] {
    [1, 2].map(|tool| volume_mm3(lines.iter().filter(|line| line.tool == tool)))
}

const BASE: &str = "<basematerials id=\"7\"><base name=\"Unused\" displaycolor=\"#123456FF\"/>\
    <base name=\"PLA white\" displaycolor=\"#FFFFFFFF\"/><base name=\"PLA black\" displaycolor=\"#000000\"/></basematerials>";

fn left() -> Facets {
    cuboid([-15.0, -5.0, 0.0], [0.0, 5.0, 3.0])
}

fn right() -> Facets {
    cuboid([0.0, -5.0, 0.0], [10.0, 5.0, 3.0])
}

#[test]
fn the_materials_in_use_are_the_tools_in_their_order() {
    let settings = two_tools();
    let objects = body(1, "pid=\"7\" pindex=\"2\"", &left(), |_| String::new())
        + &body(2, "pid=\"7\" pindex=\"1\"", &right(), |_| String::new());
    let components = "<object id=\"3\"><components><component objectid=\"1\"/><component objectid=\"2\"/></components></object>";
    let apart =
        sliced(&format!("{BASE}{objects}"), "<item objectid=\"1\"/><item objectid=\"2\"/>", &settings);
    let together = sliced(&format!("{BASE}{objects}{components}"), "<item objectid=\"3\"/>", &settings);
    for print in [apart, together] {
        let found = lines(&print, &settings);
        let [white, black] = by_tool(&found);
        assert!((white / 300.0 - 1.0).abs() < 0.03 && (black / 450.0 - 1.0).abs() < 0.03, "{white}, {black}");
        let told = print.summary.warnings.join("\n");
        assert!(told.contains("tool 1 is PLA white (#FFFFFF), tool 2 is PLA black (#000000)"), "{told}");
    }
}

#[test]
fn colors_of_facets_are_painted() {
    let settings = two_tools();
    let colors =
        "<m:colorgroup id=\"4\"><m:color color=\"#FF0000FF\"/><m:color color=\"#0000FFFF\"/></m:colorgroup>";
    let cube = cuboid([-10.0, -10.0, 0.0], [10.0, 10.0, 8.0]);
    // Of the sides of a box the last two facets look to the right.
    let object = body(1, "pid=\"4\" pindex=\"0\"", &cube, |facet| match facet {
        10 | 11 => "pid=\"4\" p1=\"1\"".to_owned(),
        _ => String::new(),
    });
    let print = sliced(&format!("{colors}{object}"), "<item objectid=\"1\"/>", &settings);
    let found = lines(&print, &settings);
    // The lowest and the highest layer have what is on bottom and top; borders run inside.
    let outer = |line: &&Line| {
        let is_side = line.at[0].abs() > 9.5 && line.at[1].abs() < 9.0;
        is_side && line.kind == "External perimeter" && (1..39).contains(&line.layer)
    };
    for line in found.iter().filter(outer) {
        assert_eq!(line.tool, if line.at[0] > 9.0 { 2 } else { 1 }, "{:?}", line.at);
    }
    assert!(found.iter().any(|line| line.tool == 2));
}

#[test]
fn of_a_gradient_each_place_has_the_color_of_the_corner_with_the_largest_share() {
    let settings = two_tools();
    let colors =
        "<m:colorgroup id=\"4\"><m:color color=\"#FF0000FF\"/><m:color color=\"#0000FFFF\"/></m:colorgroup>";
    let cube = cuboid([-10.0, -10.0, 0.0], [10.0, 10.0, 20.0]);
    let object = body(1, "pid=\"4\" pindex=\"0\"", &cube, |facet| match facet {
        10 => "pid=\"4\" p1=\"0\" p2=\"1\" p3=\"1\"".to_owned(),
        _ => String::new(),
    });
    let print = sliced(&format!("{colors}{object}"), "<item objectid=\"1\"/>", &settings);
    let found = lines(&print, &settings);
    let side = |line: &&Line| line.kind == "External perimeter" && line.at[0] > 9.6 && line.at[1].abs() < 9.5;
    let volume_mm3 = |tool: u32| volume_mm3(found.iter().filter(side).filter(|line| line.tool == tool));
    // Two thirds of one of the two triangles of the side.
    let share = volume_mm3(2) / (volume_mm3(1) + volume_mm3(2));
    assert!((share - 1.0 / 3.0).abs() < 0.04, "{share}");
}

#[test]
fn with_one_tool_nothing_changes() {
    let one = Settings { tools: Vec::new(), ..two_tools() };
    let plain = |attributes: &str| body(1, attributes, &left(), |_| String::new());
    let pair = |first: &str, second: &str| {
        let objects = plain(first) + &body(2, second, &right(), |_| String::new());
        sliced(&format!("{BASE}{objects}"), "<item objectid=\"1\"/><item objectid=\"2\"/>", &one)
    };
    let with = pair("pid=\"7\" pindex=\"2\"", "pid=\"7\" pindex=\"1\"");
    let without = pair("", "");
    assert!(with.text == without.text);
    assert_eq!(with.summary.warnings, without.summary.warnings);
}
