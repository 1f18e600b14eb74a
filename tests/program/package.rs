//! Packages with G-code (`.gcode.3mf`): read wherever text is, and reordered.

use std::fs::{self, File};
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use assert_cmd::cargo::cargo_bin_cmd;
use md5::{Digest, Md5};
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use crate::support::program::reorder;

const PLATE: &str = "Metadata/plate_1.gcode";

/// The same print as text and in a package.
static PRINTS: LazyLock<(TempDir, PathBuf, PathBuf)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("part.stl");
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl"), &model).unwrap();
    let [text, package] = ["part.gcode", "part.gcode.3mf"].map(|name| folder.path().join(name));
    let (code, said) = run(&["slice", str(&model), "-o", str(&text), "--set", "layer.height=0.3"]);
    assert_eq!(code, 0, "{said}");
    fs::write(&package, packed(&[("3D/3dmodel.model", b"<model/>"), (PLATE, &fs::read(&text).unwrap())]))
        .unwrap();
    (folder, text, package)
});

fn str(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Runs the program: exit code, and what it says.
fn run(arguments: &[&str]) -> (i32, String) {
    let output = cargo_bin_cmd!("pathwright").args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
    (output.status.code().unwrap(), said)
}

fn part(bytes: &[u8], name: &str) -> Vec<u8> {
    let mut part = Vec::new();
    ZipArchive::new(Cursor::new(bytes)).unwrap().by_name(name).unwrap().read_to_end(&mut part).unwrap();
    part
}

fn sum(bytes: &[u8]) -> Vec<u8> {
    let sum: String = Md5::digest(bytes).iter().map(|byte| format!("{byte:02X}")).collect();
    sum.into_bytes()
}

fn packed(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut package = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in parts {
        package.start_file(*name, SimpleFileOptions::default()).unwrap();
        package.write_all(bytes).unwrap();
    }
    package.finish().unwrap().into_inner()
}

#[test]
fn whatever_reads_text_reads_a_package() {
    let (_, text, package) = &*PRINTS;
    for command in ["time", "check"] {
        let [of_text, of_package] = [text, package].map(|path| {
            let (code, said) = run(&[command, str(path)]);
            (code, said.replace(str(path), ""))
        });
        assert_eq!(of_package, of_text, "{command}");
    }
    let page = package.with_extension("html");
    assert_eq!(run(&["view", str(package), "-o", str(&page)]).0, 0);
}

#[test]
fn a_reordered_package_keeps_all_else_that_is_in_it() {
    let (folder, ..) = &*PRINTS;
    // Lines in a bad order.
    let lines = [0, 5, 2, 7, 1, 6, 3, 4].map(|i| format!("G0 X10 Y{}\nG1 X30 Y{} E.5 F1200\n", 5 * i, 5 * i));
    let text = format!("G28\nM83\nG1 Z.2 F600\n{}", lines.concat());
    let (code, wanted, said) = reorder(text.as_bytes(), &[]);
    assert_eq!(code, 0, "{said}");
    let plate = "Metadata/plate_3.gcode";
    let package = folder.path().join("bad.gcode.3mf");
    let parts: [(&str, &[u8]); 4] = [
        ("Metadata/slice_info.config", b"<config/>"),
        (plate, text.as_bytes()),
        ("Metadata/plate_3.gcode.md5", b"0"),
        ("Metadata/plate_3.png", b"a picture"),
    ];
    fs::write(&package, packed(&parts)).unwrap();
    let (code, said) = run(&["reorder", "--in-place", str(&package)]);
    assert_eq!(code, 0, "{said}");
    let result = fs::read(&package).unwrap();
    assert_eq!(part(&result, plate), wanted.clone().unwrap());
    assert_eq!(part(&result, "Metadata/plate_3.gcode.md5"), sum(&wanted.unwrap()));
    assert_eq!(part(&result, "Metadata/plate_3.png"), b"a picture");
    assert_eq!(part(&result, "Metadata/slice_info.config"), b"<config/>");
    assert_eq!(ZipArchive::new(File::open(&package).unwrap()).unwrap().len(), 4);
}

#[test]
fn packages_without_gcode_with_several_plates_and_broken_ones_are_refused() {
    let (folder, _, package) = &*PRINTS;
    let whole = fs::read(package).unwrap();
    let cases = [
        (packed(&[("3D/3dmodel.model", b"<model/>")]), "without G-code"),
        (packed(&[(PLATE, b"G28\n"), ("Metadata/plate_2.gcode", b"G28\n")]), "of 2 plates"),
        (packed(&[("../plate_1.gcode", b"G28\n")]), "without G-code"),
        (whole[..whole.len() / 2].to_vec(), "damaged or ends early"),
    ];
    for (index, (bytes, reason)) in cases.iter().enumerate() {
        let file = folder.path().join(format!("wrong{index}.gcode.3mf"));
        fs::write(&file, bytes).unwrap();
        for command in [&["time"][..], &["check"], &["reorder", "--in-place"]] {
            let (code, said) = run(&[command, &[str(&file)]].concat());
            assert_eq!(code, 3, "{command:?}: {said}");
            assert!(said.contains(reason), "{command:?}: {said}");
        }
        assert_eq!(&fs::read(&file).unwrap(), bytes);
    }
}

#[test]
fn no_package_is_made_anew() {
    let (folder, text, _) = &*PRINTS;
    let (model, package) = (folder.path().join("part.stl"), folder.path().join("new.gcode.3mf"));
    for arguments in
        [["slice", str(&model), "-o", str(&package)], ["reorder", str(text), "-o", str(&package)]]
    {
        let (code, said) = run(&arguments);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains("not made anew") && said.contains("name a .gcode file"), "{said}");
        assert!(!package.exists());
    }
}
