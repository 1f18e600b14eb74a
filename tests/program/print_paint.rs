//! What is painted on a model is printed so.

use std::fs;
use std::path::PathBuf;

use crate::support::mesh_shapes::{Facets, model_xml, package, painted_xml, prism};
use crate::support::print::{Print, run, settings, standard};
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
