//! What the loader takes, what it refuses, and what it says.

use std::f64::consts::PI;
use std::path::Path;

use crate::support::mesh_shapes::{
    LATTICES, box_xml, cuboid, lattice_xml, load, model_xml, own_models, package, painted_xml, stl,
};
use pathwright::mesh::{Mesh, MeshError, Transform, Wish, load_objects, objects_from_bytes};
use pathwright::plate::{self, Layout, Placement};
use pathwright::profile::Settings;
use pathwright::slice;
use pathwright::units::Mm;

const FACET: &str =
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

/// A box of 10 mm as text.
fn text(solid: &str, endsolid: &str) -> String {
    let facets = cuboid([0.0; 3], [10.0; 3]).into_iter().map(|f| {
        let corners = f.map(|[x, y, z]| format!("      vertex {x} {y} {z:e}\n")).concat();
        format!("  facet normal 0 0 0\n    outer loop\n{corners}    endloop\n  endfacet\n")
    });
    format!("{solid}\n{}{endsolid}", facets.collect::<String>())
}

fn refusal(data: impl Into<Vec<u8>>) -> String {
    load(data.into()).expect_err("must be refused").to_string()
}

#[test]
fn text_files_as_users_have_them_are_the_same_box() {
    let plain = text("solid box", "endsolid box\n");
    let variants = [
        plain.clone(),
        text("solid", "endsolid"),
        text("solid box with a vertex in its name", ""),
        format!("\n   \t{plain}"),
        format!("\u{feff}{plain}"),
        plain.to_uppercase(),
        plain.replace('\n', "\r"),
        plain.replace('\n', "\r\n"),
        plain.replace('\n', " ").replacen("solid box ", "solid box\n", 1),
        plain.replace("facet normal 0 0 0", "facet"),
        plain.replace("vertex 10 ", "vertex 10,0 "),
        plain.replace("vertex 0 ", "vertex -0.0 "),
    ];
    for variant in variants {
        let (mesh, report) = load(variant.clone().into_bytes()).unwrap_or_else(|e| panic!("{e}\n{variant}"));
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (8, 12), "{variant}");
        assert!(report.watertight && (report.volume_mm3 - 1000.0).abs() < 1e-9);
    }
}

#[test]
fn text_and_the_strict_reader_agree() {
    let plain = text("solid box", "endsolid box\n");
    let strict = stl_io::read_stl(&mut std::io::Cursor::new(plain.as_bytes())).unwrap();
    let (mesh, _) = load(plain.into_bytes()).unwrap();
    let vertices: Vec<[f64; 3]> = strict.vertices.iter().map(|v| v.0.map(f64::from)).collect();
    assert_eq!(mesh.vertices(), vertices);
}

#[test]
fn a_second_solid_is_not_lost() {
    let two = text("solid a", "endsolid a\n") + &text("solid b", "endsolid b\n").replace("10 ", "20 ");
    let (_, report) = load(two.into_bytes()).unwrap();
    assert_eq!(report.facets, 24);
    assert!(report.warnings.iter().any(|w| w.contains("2 solids")), "{:?}", report.warnings);
}

#[test]
fn a_binary_file_may_begin_with_solid() {
    let mut data = stl(&cuboid([0.0; 3], [10.0; 3]));
    data[..10].copy_from_slice(b"solid box\n");
    assert_eq!(load(data).unwrap().1.format, "binary STL");
}

#[test]
fn a_wrong_face_count_is_mended_and_told() {
    let facets = cuboid([0.0; 3], [10.0; 3]);
    for wrong in [0u32, 5, u32::MAX] {
        let mut data = stl(&facets);
        data[80..84].copy_from_slice(&wrong.to_le_bytes());
        let (_, report) = load(data).unwrap();
        assert_eq!(report.triangles, 12);
        assert!(report.warnings[0].contains(&format!("promises {wrong} facets, the file has 12")));
    }
    let mut data = stl(&facets);
    data.extend(b"COLOR=");
    assert!(load(data).unwrap().1.warnings[0].contains("6 bytes after the last were ignored"));
}

#[test]
fn a_truncated_file_is_refused_with_what_is_there() {
    let mut data = stl(&cuboid([0.0; 3], [10.0; 3]));
    data.truncate(400);
    let message = refusal(data);
    assert!(message.contains("12 facets need 684 bytes, 400 found (6 whole facets)"), "{message}");
    let cut = text("solid box", "");
    let message = refusal(&cut[..cut.len() - 40]);
    assert!(message.contains("line 83: the file ends inside a facet"), "{message}");
}

#[test]
fn bad_numbers_are_refused_with_their_place() {
    let mut facets = cuboid([0.0; 3], [10.0; 3]);
    facets[4][1][2] = f32::NAN;
    let damaged = "coordinate NaN is damaged: the rest of the model is 10.00 × 10.00 × 10.00 mm; repair";
    assert!(refusal(stl(&facets)).starts_with(&format!("part.stl: facet 5: {damaged}")));
    facets[4][1][2] = f32::NEG_INFINITY;
    assert!(refusal(stl(&facets)).starts_with("part.stl: facet 5: coordinate -inf"));
    facets[4][1][2] = 1e30;
    let message = refusal(stl(&facets));
    assert!(
        message.contains("facet 5") && message.contains("is damaged: the rest of the model is 10.00"),
        "{message}"
    );
    facets[4][1][2] = 1e7;
    let message = refusal(stl(&facets));
    assert!(
        message.contains("1 of its corners lie far from the rest of the model, which is 10.00"),
        "{message}"
    );
    let message = refusal(text("solid box", "").replacen("10 0", "ten 0", 1));
    assert!(message.contains("line 5: `ten` is not a number"), "{message}");
}

#[test]
fn a_large_file_is_the_same_as_its_bytes() {
    let at = |i: u32, j: u32| {
        let (turn, tilt) = (f64::from(i % 150) / 150.0 * 2.0 * PI, f64::from(j % 80) / 80.0 * 2.0 * PI);
        let radius = 20.0 + 6.0 * tilt.cos();
        [radius * turn.cos(), radius * turn.sin(), 6.0 * tilt.sin()].map(|x| x as f32)
    };
    let quads = (0..150).flat_map(|i| (0..80).map(move |j| (i, j)));
    let ring: Vec<[[f32; 3]; 3]> = quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mut damaged = ring.clone();
    damaged[23_000][1][2] = f32::NAN;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.stl");
    let told =
        |read: Result<Vec<pathwright::mesh::Model>, MeshError>| read.map_err(|error| error.to_string());
    for facets in [&ring, &damaged] {
        let bytes = stl(facets);
        std::fs::write(&path, &bytes).unwrap();
        let by_path = told(load_objects(&path));
        assert_eq!(by_path.is_ok(), facets == &ring);
        assert_eq!(by_path, told(objects_from_bytes(&path, &bytes)));
    }
}

#[test]
fn what_is_no_stl_is_refused() {
    assert!(refusal("").contains("the file is empty"));
    assert!(refusal("<html>not a model</html>".repeat(20)).contains("not an STL file"));
    assert!(refusal([0x89, b'P', b'N', b'G', 0, 1].repeat(100)).contains("not an STL file"));
    assert!(refusal([0u8; 10]).contains("not an STL file"));
    assert!(refusal("solid empty\nendsolid empty\n").contains("no facet"));
    assert!(refusal(stl(&[])).contains("no facet"));
    assert!(
        refusal(format!("solid a\n{}vertex 1 2 3\n", FACET)).contains("line 9: a vertex outside of a facet")
    );
    let two_corners = FACET.replace("vertex 1 0 0\n", "");
    assert!(refusal(format!("solid a\n{two_corners}")).contains("2 corners instead of 3"));
}

#[test]
fn a_surface_without_volume_is_refused() {
    assert!(refusal(format!("solid a\n{FACET}endsolid a")).contains("no volume"));
    let flat = cuboid([0.0; 3], [10.0, 10.0, 0.0]);
    assert!(refusal(stl(&flat)).contains("no volume (10.000 × 10.000 × 0.000 mm"));
    let collapsed = cuboid([1.0; 3], [1.0; 3]);
    assert!(refusal(stl(&collapsed)).contains("no volume"));
}

#[test]
fn a_missing_file_is_named() {
    let error = pathwright::mesh::load("no/such.stl".as_ref()).unwrap_err();
    assert!(matches!(error, MeshError::Read { .. }) && error.to_string().starts_with("no/such.stl: "));
}

#[test]
fn a_count_that_does_not_match_the_length_is_named_as_that() {
    let sound = stl(&cuboid([0.0; 3], [10.0; 3]));
    let promising = |count: u32, tail: &[u8]| {
        let mut data = [sound.as_slice(), tail].concat();
        data[80..84].copy_from_slice(&count.to_le_bytes());
        load(data)
    };
    let facets = |count: u32, tail: &[u8]| promising(count, tail).expect("a model").1.triangles;
    // What stands behind the facets is no facet: text, bytes, a whole number of records.
    let letter: Vec<u8> = b"made with love; ".iter().copied().cycle().take(150).collect();
    assert_eq!((facets(12, b"bye"), facets(12, &letter)), (12, 12));
    assert!(promising(12, &letter).unwrap().1.warnings[0].contains("150 bytes after the last were ignored"));
    // A count that was never filled in.
    assert_eq!((facets(0, b""), facets(u32::MAX, b"")), (12, 12));
    assert!(promising(14, b"").unwrap_err().to_string().contains("ends early: 14 facets need 784 bytes"));
    // Bytes lost before the end: what follows is read at the wrong places.
    let mut shifted = [&sound[..334], &[0xEE; 20], &sound[334..]].concat();
    shifted.truncate(sound.len() + 20);
    let message = load(shifted).unwrap_err().to_string();
    assert!(
        message.contains("its header promises 12 facets, which take 684 bytes, but it has 704"),
        "{message}"
    );
}

#[test]
fn a_model_far_from_the_origin_is_too_long_only_if_it_is_long() {
    let far = stl(&cuboid([20_000.0; 3], [20_010.0; 3]));
    assert!(pathwright::mesh::objects_from_bytes("far.stl".as_ref(), &far).is_ok());
    let long = refusal(stl(&cuboid([0.0; 3], [30_000.0; 3])));
    assert!(
        long.contains("longer than 10 m: it is 30000.00") && long.contains("micrometres, use --unit um"),
        "{long}"
    );
}

#[test]
fn our_own_models_are_watertight_but_the_broken_one() {
    let models = own_models();
    assert_eq!(models.len(), 10);
    for path in models {
        let (_, report) = pathwright::mesh::load(&path).unwrap();
        let broken = path.ends_with("broken_box.stl");
        assert!(report.watertight, "{}", path.display());
        assert_eq!(report.flipped + report.duplicates_dropped + report.holes_filled > 0, broken);
    }
}

/// What the loader makes of a 3MF file with one part.
fn threemf(attributes: &str, resources: &str, build: &str) -> Vec<u8> {
    package(&[("3D/3dmodel.model", &model_xml(attributes, resources, build))])
}

fn objects(data: &[u8]) -> Vec<pathwright::mesh::Model> {
    pathwright::mesh::objects_from_bytes("part.3mf".as_ref(), data).unwrap()
}

#[test]
fn a_3mf_is_put_together_from_its_parts_units_and_transforms() {
    let other = model_xml("", &format!("<object id=\"7\">{}</object>", box_xml([10.0, 20.0, 30.0])), "");
    let root = model_xml(
        "unit=\"inch\" requiredextensions=\"p\" \
         xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" xmlns:x=\"urn:odd\"",
        &format!(
            "<object id=\"1\">{}</object><object id=\"2\" name=\"pair\"><components>\
             <component objectid=\"1\"/><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 3 0 0\"/></components></object>\
             <object id=\"3\"><components><component objectid=\"7\" p:path=\"/3D/other.model\"/></components></object>",
            box_xml([1.0; 3])
        ),
        "<item objectid=\"2\" transform=\"0 2 0 -2 0 0 0 0 2 0 0 0\"/><item objectid=\"3\"/>\
         <item objectid=\"3\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>\
         <item objectid=\"3\" transform=\"1 0 0 0 1 0 0 0 1 4 0 0\"/><item objectid=\"1\" printable=\"0\"/>",
    );
    let relations = "<Relationships><Relationship Target=\"/3D/root.model\" \
        Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    let data = package(&[("_rels/.rels", relations), ("3D/root.model", &root), ("3D/other.model", &other)]);
    let found = objects(&data);
    let sizes: Vec<[f64; 3]> = found.iter().map(|m| m.report.size_mm.map(f64::round)).collect();
    assert_eq!(sizes, [[51.0, 203.0, 51.0], [10.0, 20.0, 30.0], [10.0, 20.0, 30.0]]);
    assert_eq!(found[0].name.as_deref(), Some("pair"));
    assert_eq!(found[0].report.shells, 2);
    assert!((found[0].report.volume_mm3 - 2.0 * 50.8f64.powi(3)).abs() < 1.0);
    assert_eq!(found[1].positions, [[0.0; 3], [4.0 * 25.4, 0.0, 0.0]], "inches of the part that says so");
    assert_eq!((found[2].report.volume_mm3.round(), found[2].report.flipped), (6000.0, 0), "mirrored");
    let warnings = found[0].report.warnings.join("\n");
    assert!(warnings.contains("the extension urn:odd is not understood"), "{warnings}");
    assert!(warnings.contains("1 objects that are marked as not to be printed"), "{warnings}");
    let (together, _) = load(data).unwrap();
    assert_eq!(together.size().map(f64::round), [162.0, 203.0, 51.0]);
}

#[test]
fn an_empty_mesh_of_a_3mf_is_left_out_with_a_warning() {
    let cube = format!("<object id=\"1\">{}</object>", box_xml([10.0; 3]));
    let empty = "<object id=\"2\"><mesh><vertices/><triangles/></mesh></object>";
    let items = "<item objectid=\"2\"/><item objectid=\"1\"/>";
    let found = objects(&threemf("", &format!("{cube}{empty}"), items));
    assert_eq!(found.len(), 1);
    let warnings = found[0].report.warnings.join("\n");
    assert!(warnings.contains("1 objects without a facet were left out"), "{warnings}");
    assert!(load(threemf("", empty, "<item objectid=\"2\"/>")).is_err(), "nothing else is there");
}

#[test]
fn a_bad_3mf_is_refused_with_the_reason_and_the_part() {
    let cube = format!("<object id=\"1\">{}</object>", box_xml([10.0; 3]));
    let item = "<item objectid=\"1\"/>";
    let whole = threemf("", &cube, item);
    assert!(load(whole.clone()).is_ok());
    let component = |id: u32, of: u32| {
        format!(
            "<object id=\"{id}\"><components><component objectid=\"{of}\"/><component objectid=\"{of}\"/></components></object>"
        )
    };
    let tower: String = (2..40).map(|id| component(id, id - 1)).collect();
    let bomb = format!("{cube}<!--{}-->", " ".repeat(40 << 20));
    for (data, wanted) in [
        (whole[..whole.len() - 40].to_vec(), "archive: it is damaged or ends early"),
        (b"PK\x03\x04".to_vec(), "archive: it is damaged or ends early"),
        (package(&[("a.txt", "nothing")]), "the package has no such part"),
        (threemf("", &bomb, item), "it unpacks to far more than a model"),
        (threemf("", &component(1, 1), item), "its components contain each other"),
        (
            threemf("", &format!("{cube}{tower}"), "<item objectid=\"39\"/>"),
            "its components or struts multiply to more than",
        ),
        (
            threemf("", &cube.replace("v1=\"3\"", "v1=\"99\""), item),
            "triangle 2 names vertex 99, but there are only 36",
        ),
        (threemf("", &cube.replace("x=\"10\"", "x=\"nan\""), item), "coordinate NaN is not a finite number"),
        (threemf("", &cube.replace("x=\"10\"", "x=\"1e6\""), item), "longer than 10 m"),
        (
            threemf("", &cube, "<item objectid=\"2\"/>"),
            "it uses object 2, which 3D/3dmodel.model does not hold",
        ),
        (threemf("", &cube, ""), "the build holds nothing to print"),
        (threemf("unit=\"cubit\"", &cube, item), "`cubit` is no unit of length"),
        (
            threemf("xmlns:q=\"urn:q\" requiredextensions=\"q\"", &cube, item),
            "it requires the extension urn:q",
        ),
        (threemf("", &cube, "<item objectid=\"1\" transform=\"1 2\"/>"), "`1 2` is no transform"),
        (package(&[("3D/3dmodel.model", "<!DOCTYPE x><model/>")]), "document type"),
        (package(&[("3D/3dmodel.model", &model_xml("", &cube, item)[..600])]), "3D/3dmodel.model: byte"),
    ] {
        let message = refusal(data);
        assert!(message.starts_with("part.stl: ") && message.contains(wanted), "{wanted}: {message}");
    }
}

#[test]
fn an_obj_is_read_with_all_notations_of_a_vertex() {
    let corners = "v 0 0 0\nv 2 0 0 1.0\nv 2 3 0 0.5 0.5 0.5\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4\n";
    let faces =
        "f 4 3 2 1\nf 5//1 6//1 7//1 8//1\nf 1/9 2/9 6/9 5/9\nf -7 -6 -2 -3\nf 3 4 8 7\nf 4 1 5\nf 4 5 8\n";
    let data =
        [b"# Gr\xfc\xdfe\r\no a\r\n", corners.as_bytes(), b"vn 0 0 1\ng b\nusemtl x\n", faces.as_bytes()]
            .concat();
    let load = |data: &[u8]| pathwright::mesh::from_bytes("part.obj".as_ref(), data);
    let (mesh, report) = load(&data).unwrap();
    assert_eq!((mesh.size(), report.volume_mm3.round(), report.watertight), ([2.0, 3.0, 4.0], 24.0, true));
    for end in ["\n", "\r\n", "\r"] {
        let split = String::from_utf8_lossy(&data).replace("f 4 3 2 1\n", &format!("f 4 3 \\{end}2 1{end}"));
        assert!(load(split.as_bytes()).unwrap().0 == mesh, "a face goes on after {end:?}");
    }
    let refused = |line: &str| load(format!("{corners}{line}\n").as_bytes()).unwrap_err().to_string();
    assert!(refused("f 1 2 \\\n9").contains("line 9: a face names vertex 9"));
    assert!(refused("f 1 2 9").contains("line 9: a face names vertex 9, and 8 were given before it"));
    assert!(refused("f 1 2 -9").contains("a face names vertex -9"));
    assert!(refused("f 0 1 2").contains("a face names vertex 0"));
    assert!(refused("f 1 2").contains("line 9: a face has 2 corners instead of 3"));
    assert!(refused("f a b c").contains("`a` is not the number of a vertex"));
    assert!(refused("v 1 2").contains("a vertex has fewer than 3 coordinates"));
    assert!(refused("v 1 2 x").contains("`x` is not a number"));
    assert!(refused("v 1 2 nan\nf 1 2 9").contains("line 10: coordinate NaN"));
    let flat = load(b"v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nf 1 2 3 4\n").unwrap_err().to_string();
    assert!(flat.contains("no volume (2.000 × 3.000 × 0.000 mm, 1 facet)"), "{flat}");
}

#[test]
fn a_face_is_what_its_outline_encloses() {
    // Prisms 2 high; where a hole is joined to the outline, its corners and those of the joint stand twice.
    let notched = [[0, 0], [4, 0], [4, 4], [2, 1], [0, 4]].as_slice();
    let frame = &[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0], [1, 1], [1, 3], [3, 3], [3, 1], [1, 1]];
    for (outline, mm3) in [(notched, 20.0), (frame, 24.0)] {
        for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            let at = |[x, y]: [i32; 2], z: i32| {
                let place = axes.map(|axis| [x, y, z][axis]);
                format!("v {} {} {}\n", place[0], place[1], place[2])
            };
            let count = outline.len();
            let corners: String = [0, 2].iter().flat_map(|z| outline.iter().map(|p| at(*p, *z))).collect();
            let below: String = (1..=count).rev().map(|i| format!(" {i}")).collect();
            let above: String = (1..=count).map(|i| format!(" {}", i + count)).collect();
            let side = |i: usize| {
                let next = i % count + 1;
                format!("f {i} {next} {} {}\n", next + count, i + count)
            };
            let sides: String = (1..=count).map(side).collect();
            let text = format!("{corners}f{below}\nf{above}\n{sides}");
            let (_, report) = pathwright::mesh::from_bytes("part.obj".as_ref(), text.as_bytes()).unwrap();
            assert_eq!((report.volume_mm3.round(), report.watertight), (mm3, true), "{axes:?}: {report}");
        }
    }
}

#[test]
fn text_in_16_bits_is_read_as_the_same_in_8() {
    let text = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n# Ärger\n";
    let load = |data: &[u8]| pathwright::mesh::from_bytes("part.obj".as_ref(), data).unwrap();
    let units = || "\u{feff}".encode_utf16().chain(text.encode_utf16());
    let [big, little] =
        [u16::to_be_bytes, u16::to_le_bytes].map(|bytes| units().flat_map(bytes).collect::<Vec<u8>>());
    assert!(load(&big) == load(text.as_bytes()) && load(&little) == load(text.as_bytes()));
}

#[test]
fn the_same_mesh_is_the_same_in_every_format() {
    let bracket = own_models().into_iter().find(|p| p.ends_with("tilted_bracket.stl")).unwrap();
    let (mesh, report) = pathwright::mesh::load(&bracket).unwrap();
    for (extension, format) in [("3mf", "3MF"), ("obj", "OBJ")] {
        let (same, found) = pathwright::mesh::load(&bracket.with_extension(extension)).unwrap();
        assert!(same == mesh && found.format == format && found.facets == report.facets, "{extension}");
    }
}

/// The volume of what is printed of a mesh, by sections 0.05 mm apart.
fn sliced_mm3(mesh: Mesh) -> f64 {
    let mut settings = Settings::default();
    settings.layer.elephant_foot = Mm(0.0);
    settings.layer.height = Mm(0.05);
    settings.layer.first_height = Mm(0.05);
    let plate =
        plate::place(vec![Layout::single("part", mesh, 1)], &settings.bed, &Placement::default()).unwrap();
    let layers = slice::slice(&plate, &settings.layer);
    layers.iter().flat_map(|layer| &layer.sections).map(|section| 0.05 * section.region.area_mm2()).sum()
}

/// A 3MF file of one beam lattice.
fn lattice(vertices: &[[f64; 3]], attributes: &str, beams: &[&str], balls: &str) -> Vec<u8> {
    let object = format!("<object id=\"1\">{}</object>", lattice_xml(vertices, attributes, beams, balls));
    threemf(LATTICES, &object, "<item objectid=\"1\"/>")
}

const STRUT: [[f64; 3]; 2] = [[0.0; 3], [6.0, 0.0, 8.0]];

#[test]
fn struts_are_as_large_as_their_radii_and_caps_say() {
    let ball = 4.0 / 3.0 * PI * 27.0;
    for (attributes, beam, wanted) in [
        ("radius=\"3\" cap=\"butt\"", "v1=\"0\" v2=\"1\"", PI * 90.0),
        ("radius=\"3\" cap=\"hemisphere\"", "v1=\"0\" v2=\"1\"", PI * 90.0 + ball),
        ("radius=\"3\"", "v1=\"0\" v2=\"1\"", PI * 90.0 + ball),
        (
            "radius=\"9\"",
            "v1=\"1\" v2=\"0\" r1=\"3\" cap1=\"butt\" cap2=\"hemisphere\"",
            PI * 90.0 + ball / 2.0,
        ),
        ("radius=\"9\" cap=\"butt\"", "v1=\"0\" v2=\"1\" r1=\"3\" r2=\"1\"", PI * 10.0 * 13.0 / 3.0),
    ] {
        let (mesh, report) = load(lattice(&STRUT, attributes, &[beam], "")).unwrap();
        let found = sliced_mm3(mesh);
        assert!((found / wanted - 1.0).abs() < 0.006, "{attributes} {beam}: {found} of {wanted}");
        assert!(report.watertight && report.flipped == 0 && report.repairs().is_empty());
    }
}

#[test]
fn struts_that_cross_and_balls_are_printed_as_their_union() {
    let cross = [[0.0, 5.0, 5.0], [20.0, 5.0, 5.0], [10.0, -5.0, 5.0], [10.0, 15.0, 5.0]];
    let beams = ["v1=\"0\" v2=\"1\"", "v1=\"2\" v2=\"3\""];
    let (mesh, _) = load(lattice(&cross, "radius=\"3\" cap=\"butt\"", &beams, "")).unwrap();
    let (found, wanted) = (sliced_mm3(mesh), 2.0 * PI * 9.0 * 20.0 - 16.0 / 3.0 * 27.0);
    assert!((found / wanted - 1.0).abs() < 0.005, "{found} of {wanted}");

    let dumbbell = [[0.0; 3], [0.0, 0.0, 10.0]];
    let listed = "<bb:balls><bb:ball vindex=\"0\" r=\"3\"/><bb:ball vindex=\"1\"/></bb:balls>";
    for (mode, balls, wanted) in [
        ("bb:ballmode=\"all\" bb:ballradius=\"3\"", "", 239.3),
        ("bb:ballmode=\"mixed\" bb:ballradius=\"3\"", listed, 239.3),
        ("bb:ballmode=\"none\" bb:ballradius=\"3\"", listed, PI * 10.0 + 4.0 / 3.0 * PI),
    ] {
        let (mesh, _) =
            load(lattice(&dumbbell, &format!("radius=\"1\" {mode}"), &["v1=\"0\" v2=\"1\""], balls)).unwrap();
        let found = sliced_mm3(mesh);
        assert!((found / wanted - 1.0).abs() < 0.01, "{mode}: {found} of {wanted}");
    }
}

#[test]
fn a_lattice_is_one_object_with_the_mesh_around_it_in_its_unit_and_transform() {
    let strut = "</triangles><b:beamlattice radius=\"0.1\" minlength=\"0.01\" cap=\"butt\"><b:beams>\
        <b:beam v1=\"0\" v2=\"0\"/><b:beam v1=\"0\" v2=\"1\"/></b:beams></b:beamlattice>";
    let mesh = box_xml([1.0; 3]).replace("</triangles>", strut);
    let data = threemf(
        &format!("unit=\"inch\" {LATTICES}"),
        &format!("<object id=\"1\">{mesh}</object>"),
        "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 2 0 0 0\"/>",
    );
    let found = objects(&data);
    let report = &found[0].report;
    assert_eq!((found.len(), report.shells, report.flipped, report.watertight), (1, 2, 0, true));
    let wanted = 2.0 * 25.4f64.powi(3) * (1.0 + PI * 0.01);
    assert!((report.volume_mm3 / wanted - 1.0).abs() < 1e-3, "{} of {wanted}", report.volume_mm3);
}

#[test]
fn the_same_lattice_is_the_same_facets() {
    let data = lattice(&STRUT, "radius=\"1\"", &["v1=\"0\" v2=\"1\"", "v1=\"1\" v2=\"0\" r1=\"2\""], "");
    assert!(load(data.clone()).unwrap() == load(data).unwrap());
}

#[test]
fn a_bad_lattice_is_refused_with_its_beam() {
    let refused = |attributes: &str, beam: &str, ball: &str| {
        refusal(lattice(&STRUT, attributes, &[beam], &format!("<bb:balls>{ball}</bb:balls>")))
    };
    let (radius, beam) = ("radius=\"1\"", "v1=\"0\" v2=\"1\"");
    for (message, wanted) in [
        (refused("", beam, ""), "object 1: a beam lattice gives no radius"),
        (refused("radius=\"-1\"", beam, ""), "`-1` is no valid radius"),
        (refused("radius=\"1\" clipping=\"outside\"", beam, ""), "clipped by another mesh"),
        (refused(radius, "v1=\"0\" v2=\"2\"", ""), "beam 1 names vertex 2, but there are only 2"),
        (refused(radius, "v1=\"0\"", ""), "beam 1: `` is no valid v2"),
        (refused(radius, "v1=\"0\" v2=\"1\" r1=\"0\"", ""), "`0` is no valid r1"),
        (refused(radius, "v1=\"0\" v2=\"1\" cap1=\"hat\"", ""), "`hat` is no valid cap1"),
        (refused(radius, beam, "<bb:ball vindex=\"9\" r=\"1\"/>"), "ball 1 names vertex 9"),
        (refused(radius, beam, "<bb:ball vindex=\"1\"/>"), "ball 1 has no radius"),
        (refused("radius=\"1\" bb:ballmode=\"all\"", beam, ""), "gives no ballradius"),
        (refused("radius=\"1e30\"", beam, ""), "is damaged"),
        (
            refused("radius=\"1\" clippingmode=\"inside\" clippingmesh=\"2\"", beam, ""),
            "object 1: its beam lattice is clipped by another mesh (clippingmode \"inside\"), which is not understood; \
             export it as a plain mesh",
        ),
    ] {
        assert!(message.contains(wanted), "{wanted}: {message}");
    }
}

#[test]
fn extensions_that_are_not_understood_are_refused_by_name() {
    let cube = format!("<object id=\"1\">{}</object>", box_xml([10.0; 3]));
    for (address, name) in [
        ("http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01", "volumetric"),
        ("http://schemas.3mf.io/3dmanufacturing/implicit/2023/12", "implicit"),
        ("http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07", "boolean operations"),
        ("http://schemas.3mf.io/3dmanufacturing/displacement/2023/10", "displacement"),
        ("http://schemas.microsoft.com/3dmanufacturing/securecontent/2019/04", "secure content"),
        ("http://schemas.microsoft.com/3dmanufacturing/slice/2015/07", "slice"),
    ] {
        let attributes = format!("xmlns:q=\"{address}\" requiredextensions=\"q\"");
        let message = refusal(threemf(&attributes, &cube, "<item objectid=\"1\"/>"));
        let wanted = format!(
            "it requires the extension \"{name}\" ({address}), which is not understood; export it as a plain mesh"
        );
        assert!(message.contains(&wanted), "{message}");
    }
}

/// A box of 10 mm whose first two facets are painted as these attributes say, in a 3MF file with this build.
fn painted(attributes: [&str; 2], build: &str) -> Result<pathwright::mesh::Model, MeshError> {
    let facets = cuboid([0.0; 3], [10.0; 3]);
    let mesh = painted_xml(&facets, |facet| attributes.get(facet).copied().unwrap_or_default().to_owned());
    let names = "xmlns:slic3rpe=\"http://schemas.slic3r.org/3mf/2017/06\"";
    let model = model_xml(names, &format!("<object id=\"1\">{mesh}</object>"), build);
    let data = package(&[("3D/3dmodel.model", &model)]);
    objects_from_bytes(Path::new("a.3mf"), &data).map(|mut models| models.remove(0))
}

#[test]
fn what_is_painted_goes_where_the_mesh_goes() {
    let build = "<item objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 2 5 6 7\"/>";
    let plain =
        painted(["slic3rpe:mmu_segmentation=\"8\"", "paint_color=\"0C\" paint_seam=\"4\""], build).unwrap();
    let paint = plain.mesh.paint();
    assert_eq!(paint.tools.iter().map(|facet| facet.paint).collect::<Vec<_>>(), [2, 3]);
    assert_eq!(paint.seams.iter().map(|facet| facet.paint).collect::<Vec<_>>(), [Wish::Enforced]);
    let turn = Transform { scale: [1.0, -2.0, 1.0], rotate_deg: [30.0, 0.0, 90.0] };
    let mut moved = turn.apply(plain.mesh.clone()).unwrap().centered().quarter_turned(1);
    moved.shift([1.0, 2.0, 3.0]);
    for mesh in [&plain.mesh, &moved] {
        // Painted facets have the corners of facets.
        for corner in mesh.paint().tools.iter().flat_map(|facet| facet.corners) {
            let near = |v: &[f64; 3]| (0..3).all(|i| (v[i] - corner[i]).abs() < 1e-5);
            assert!(mesh.vertices().iter().any(near), "{corner:?}");
        }
    }
}

#[test]
fn what_is_no_paint_is_refused_with_its_triangle() {
    let message = painted(["", "paint_supports=\"43\""], "<item objectid=\"1\"/>").unwrap_err().to_string();
    assert!(message.starts_with("a.3mf: 3D/3dmodel.model: byte "), "{message}");
    assert!(message.contains("triangle 2: `43` is no paint: it ends early; export it again"), "{message}");
}
