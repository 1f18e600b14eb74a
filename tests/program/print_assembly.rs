//! Assemblies: what files place relative to each other is printed so, once.

use std::fs;
use std::path::PathBuf;

use crate::support::mesh_shapes::{Facets, box_xml, cuboid, model_xml, package, stl};
use crate::support::print::{Bead, Print, run, settings, standard};
use pathwright::job::{Engine, Job, ObjectSettings};
use pathwright::pipeline::Pipeline;
use pathwright::profile::Settings;

const RELATIONS: &str = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
     <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
     Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// A folder with models.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).expect("written");
        path
    }

    /// A 3MF file of boxes of these sizes, each with its lowest corner here.
    fn boxes(&self, boxes: &[([f32; 3], [f32; 3])]) -> PathBuf {
        let objects = boxes.iter().enumerate().map(|(i, (size, _))| {
            format!("<object id=\"{0}\" name=\"box{0}\">{1}</object>", i + 1, box_xml(*size))
        });
        let items = boxes.iter().enumerate().map(|(i, (_, [x, y, z]))| {
            format!("<item objectid=\"{}\" transform=\"1 0 0 0 1 0 0 0 1 {x} {y} {z}\"/>", i + 1)
        });
        let model = model_xml("", &objects.collect::<String>(), &items.collect::<String>());
        self.file("assembly.3mf", &package(&[("_rels/.rels", RELATIONS), ("3D/3dmodel.model", &model)]))
    }
}

fn job(models: Vec<PathBuf>) -> Job {
    Job::of(models)
}

/// The boxes around outer walls of a layer, in order of their low corners.
fn outlines(print: &Print, z_mm: f64) -> Vec<[f64; 4]> {
    let is_outline =
        |bead: &&Bead| bead.kind == "External perimeter" && bead.closed() && (bead.z_mm - z_mm).abs() < 1e-6;
    let beads = print.beads();
    let boxes = beads.iter().filter(is_outline).map(|bead| {
        bead.points.iter().fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |b, p| {
            [b[0].min(p[0]), b[1].min(p[1]), b[2].max(p[0]), b[3].max(p[1])]
        })
    });
    let mut boxes: Vec<[f64; 4]> = boxes.collect();
    boxes.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    boxes
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 0.02
}

#[test]
fn what_a_3mf_places_relative_to_each_other_is_printed_so() {
    let folder = Folder::new();
    let file = folder.boxes(&[([20.0, 20.0, 2.0], [500.0, 0.0, 7.0]), ([5.0, 5.0, 2.0], [530.0, 3.0, 7.0])]);
    let print = run(&job(vec![file]), &standard(&[])).expect("a print");
    let [large, small] = outlines(&print, 1.0).try_into().expect("two outlines");
    assert!(near(small[0] - large[0], 30.0) && near(small[1] - large[1], 3.0), "{large:?} {small:?}");
    assert!(near(large[0] + small[2], 250.0), "in the middle of the bed");
}

#[test]
fn a_part_within_another_keeps_its_place_and_its_height() {
    // A tray, a ring around its wall, and a lid that rests on the tray.
    let folder = Folder::new();
    let file = folder.boxes(&[([30.0, 30.0, 2.0], [0.0; 3]), ([10.0, 10.0, 4.0], [10.0, 10.0, 2.0])]);
    for set in ["plate.keep_layout=true", "plate.keep_layout=false", "plate.arrange=false"] {
        let arranged = !set.starts_with("plate.arrange");
        let translate_mm = if arranged { [0.0; 3] } else { [100.0, 100.0, 0.0] };
        let job = Job { translate_mm, ..job(vec![file.clone()]) };
        let print = run(&job, &standard(&[set])).expect("a print");
        assert!(near(print.summary.size_mm[2], 6.0), "{set}");
        assert_eq!((outlines(&print, 1.0).len(), outlines(&print, 5.0).len()), (1, 1), "{set}");
        let (tray, on_it) = (outlines(&print, 1.0)[0], outlines(&print, 5.0)[0]);
        assert!(near(on_it[0] - tray[0], 10.0) && near(on_it[1] - tray[1], 10.0), "{set}");
    }
}

#[test]
fn files_of_one_assembly_keep_their_heights_where_nothing_is_arranged() {
    let folder = Folder::new();
    let at = |low: [f32; 3], high: [f32; 3]| stl(&cuboid(low, high));
    let models = vec![
        folder.file("base.stl", &at([100.0, 100.0, 5.0], [130.0, 130.0, 7.0])),
        folder.file("post.stl", &at([110.0, 110.0, 7.0], [120.0, 120.0, 11.0])),
        folder.file("beside.stl", &at([150.0, 100.0, 9.0], [160.0, 110.0, 12.0])),
    ];
    let print = run(&job(models), &standard(&["plate.arrange=false"])).expect("a print");
    assert_eq!(outlines(&print, 1.0).len(), 2, "base and what stands beside it");
    assert!(near(outlines(&print, 5.0)[0][0], 110.225), "{:?}", outlines(&print, 5.0));
}

#[test]
fn objects_that_overlap_are_printed_once_and_told() {
    let folder = Folder::new();
    let boxes = [([20.0, 20.0, 4.0], [0.0; 3]), ([20.0, 20.0, 4.0], [10.0, 0.0, 0.0])];
    let settings = standard(&["infill.density=100%", "skirt.loops=0"]);
    let print = run(&job(vec![folder.boxes(&boxes)]), &settings).expect("a print");
    let one = run(&job(vec![folder.boxes(&[([30.0, 20.0, 4.0], [0.0; 3])])]), &settings).expect("a print");
    let [volume_mm3, of_one] = [&print, &one].map(|print| print.measure(&settings).volume_mm3);
    assert!((volume_mm3 / of_one - 1.0).abs() < 1e-3, "{volume_mm3} for {of_one}");
    let told = &print.summary.warnings[0];
    assert!(
        told.contains("box1 and box2 overlap by 800.0 mm³ from Z 0.20 on; they are printed as one"),
        "{told}"
    );
    assert_eq!(outlines(&print, 2.0).len(), 1);
}

#[test]
fn objects_that_overlap_and_differ_share_nothing() {
    let folder = Folder::new();
    let boxes = [([20.0, 20.0, 4.0], [0.0; 3]), ([20.0, 20.0, 4.0], [10.0, 0.0, 0.0])];
    let plate = standard(&["infill.density=100%", "skirt.loops=0"]);
    let own = standard(&["infill.density=100%", "skirt.loops=0", "walls.count=4"]);
    let objects = vec![ObjectSettings { object: "box2".into(), settings: own }];
    let job = Job { objects, ..job(vec![folder.boxes(&boxes)]) };
    let print = run(&job, &plate).expect("a print");
    let one = self::job(vec![folder.boxes(&[([30.0, 20.0, 4.0], [0.0; 3])])]);
    let one = run(&one, &plate).expect("a print");
    let [volume_mm3, of_one] = [&print, &one].map(|print| print.measure(&plate).volume_mm3);
    assert!((volume_mm3 / of_one - 1.0).abs() < 5e-3, "{volume_mm3} for {of_one}");
    assert!(
        print.summary.warnings[0].contains("is printed as a part of box1"),
        "{:?}",
        print.summary.warnings
    );
}

#[test]
fn objects_that_nearly_touch_are_printed_with_a_warning() {
    let folder = Folder::new();
    let boxes = [([20.0, 20.0, 4.0], [100.0, 100.0, 0.0]), ([20.0, 20.0, 4.0], [120.3, 100.0, 0.0])];
    for set in ["plate.arrange=true", "plate.arrange=false"] {
        let print = run(&job(vec![folder.boxes(&boxes)]), &standard(&[set])).expect("a print");
        let told = &print.summary.warnings;
        assert!(told[0].contains("box1 and box2 come nearer than 0.4 mm"), "{told:?}");
        assert_eq!(outlines(&print, 2.0).len(), 2);
    }
}

#[test]
fn a_body_of_several_objects_is_one_of_those_printed_one_after_the_other() {
    let folder = Folder::new();
    let boxes = [
        ([30.0, 30.0, 2.0], [0.0; 3]),
        ([10.0, 10.0, 4.0], [10.0, 10.0, 2.0]),
        ([10.0, 10.0, 3.0], [90.0, 0.0, 0.0]),
    ];
    let settings = standard(&["print.sequence=object", "gcode.labels=true"]);
    let print = run(&job(vec![folder.boxes(&boxes)]), &settings).expect("a print");
    let lowered = print.strokes().windows(2).filter(|pair| pair[1].to[2] < pair[0].to[2] - 2.0).count();
    assert_eq!(lowered, 1, "two rounds");
    assert!(print.lines().any(|line| line.contains("box1 + box2")));
}

#[test]
fn info_and_slice_agree_on_what_fits() {
    let folder = Folder::new();
    let fits = folder.boxes(&[([20.0, 20.0, 2.0], [0.0; 3]), ([20.0, 20.0, 2.0], [200.0, 0.0, 0.0])]);
    let info = |file: &PathBuf, settings: &Settings| {
        Pipeline.info(&job(vec![file.clone()]), settings).expect("readable")
    };
    let all = settings(&[], &[]);
    assert_eq!((info(&fits, &all).fits, info(&fits, &all).objects, info(&fits, &all).bodies), (true, 2, 2));
    assert!(!info(&fits, &all).text.contains("arranged anew"));
    let apart = folder.boxes(&[([20.0, 20.0, 2.0], [0.0; 3]), ([20.0, 20.0, 2.0], [400.0, 0.0, 0.0])]);
    assert!(info(&apart, &all).fits && info(&apart, &all).text.contains("arranged anew"));
    let print = run(&job(vec![apart.clone()]), &standard(&[])).expect("a print");
    assert!(print.summary.warnings[0].contains("arranged anew: box1"), "{:?}", print.summary.warnings);
    let kept = settings(&[], &["plate.arrange=false"]);
    assert!(!info(&apart, &kept).fits && run(&job(vec![apart]), &kept).is_err());
}

#[test]
fn groups_of_an_obj_file_stay_together() {
    let folder = Folder::new();
    let facets: Facets =
        [cuboid([0.0; 3], [20.0, 20.0, 2.0]), cuboid([30.0, 5.0, 0.0], [35.0, 10.0, 2.0])].concat();
    let mut text = String::new();
    for (i, facet) in facets.iter().enumerate() {
        if i % 12 == 0 {
            text.push_str(&format!("g part{i}\n"));
        }
        facet.iter().for_each(|[x, y, z]| text.push_str(&format!("v {x} {y} {z}\n")));
        text.push_str("f -3 -2 -1\n");
    }
    let print = run(&job(vec![folder.file("two.obj", text.as_bytes())]), &standard(&[])).expect("a print");
    let [large, small] = outlines(&print, 1.0).try_into().expect("two outlines");
    assert!(near(small[0] - large[0], 30.0) && near(small[1] - large[1], 5.0));
}
