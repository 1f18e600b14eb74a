//! What the loader takes, what it refuses, and what it says.

mod mesh_shapes;

use mesh_shapes::{cuboid, load, own_models, stl};
use pathwright::mesh::MeshError;

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
    assert!(load(data).unwrap().1.warnings[0].contains("6 bytes after the last facet"));
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
    assert!(refusal(stl(&facets)).starts_with("part.stl: facet 5: coordinate NaN is not a finite number"));
    facets[4][1][2] = f32::NEG_INFINITY;
    assert!(refusal(stl(&facets)).starts_with("part.stl: facet 5: coordinate -inf"));
    facets[4][1][2] = 10_001.0;
    assert!(refusal(stl(&facets)).contains("coordinate 10001 mm lies more than 10 m from the origin"));
    let message = refusal(text("solid box", "").replacen("10 0", "ten 0", 1));
    assert!(message.contains("line 5: `ten` is not a number"), "{message}");
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
fn unlikely_sizes_name_the_unit() {
    let warning = |side: f32| load(stl(&cuboid([0.0; 3], [side; 3]))).unwrap().1.warnings.concat();
    assert!(warning(0.03).contains("metres, use --scale 1000"), "{}", warning(0.03));
    assert!(warning(0.9).contains("inches, use --scale 25.4"), "{}", warning(0.9));
    assert!(warning(9000.0).contains("micrometres, use --scale 0.001"), "{}", warning(9000.0));
    assert_eq!(warning(20.0), "");
}

#[test]
fn our_own_models_are_watertight_but_the_broken_one() {
    let models = own_models();
    assert_eq!(models.len(), 10);
    for path in models {
        let (_, report) = pathwright::mesh::load(&path).unwrap();
        let broken = path.ends_with("broken_box.stl");
        assert_eq!(report.watertight, !broken, "{}", path.display());
        assert_eq!(report.flipped + report.duplicates_dropped + report.non_manifold_edges > 0, broken);
    }
}
