//! Meshes to test with.

pub mod broken;

use std::path::{Path, PathBuf};

use pathwright::mesh::{Mesh, MeshError, MeshReport, from_bytes};

/// Corners of facets, counter-clockwise seen from outside.
pub type Facets = Vec<[[f32; 3]; 3]>;

/// A box between two corners.
pub fn cuboid(low: [f32; 3], high: [f32; 3]) -> Facets {
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]].map(|t| t.map(corner))).collect()
}

/// Three facets of ten turned, some repeated and some collapsed to a line, as `seed` says.
pub fn damaged(facets: &Facets, seed: &[u8]) -> Facets {
    let mut broken = Facets::new();
    for (facet, byte) in facets.iter().zip(seed.iter().cycle()) {
        let mut facet = *facet;
        if byte % 10 < 3 {
            facet.swap(0, 1);
        }
        broken.push(facet);
        if byte % 16 == 5 {
            broken.push([facet[1], facet[2], facet[0]]);
        }
        if byte % 16 == 6 {
            broken.push([facet[1], facet[1], facet[0]]);
        }
    }
    broken
}

/// A ball of subdivided octahedron faces.
pub fn ball(middle: [f32; 3], radius: f32, subdivisions: u32) -> Facets {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut facets: Vec<[[f32; 3]; 3]> = (0..8)
        .map(|i| {
            let sign = |axis: usize| if i >> axis & 1 == 0 { 1.0 } else { -1.0 };
            let [a, b, c] = [0, 1, 2].map(|axis| axes[axis].map(|x: f32| x * sign(axis)));
            if sign(0) * sign(1) * sign(2) > 0.0 { [a, b, c] } else { [a, c, b] }
        })
        .collect();
    for _ in 0..subdivisions {
        let half = |p: [f32; 3], q: [f32; 3]| unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]);
        facets = facets
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let place = |p: [f32; 3]| [0, 1, 2].map(|i| middle[i] + radius * p[i]);
    facets.into_iter().map(|f| f.map(place)).collect()
}

fn unit(p: [f32; 3]) -> [f32; 3] {
    let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
    // Sorted sums would be needed for exact symmetry; equal corners come from equal operands here.
    p.map(|x| x / length)
}

/// A ring around the Z axis.
pub fn torus(large: f32, small: f32, count: usize) -> Facets {
    let point = |i: usize, j: usize| {
        let angle = |k: usize| (k % count) as f32 / count as f32 * std::f32::consts::TAU;
        let r = large + small * angle(j).cos();
        [r * angle(i).cos(), r * angle(i).sin(), small * angle(j).sin()]
    };
    let cells = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// The facets turned over.
pub fn inside_out(mut facets: Facets) -> Facets {
    facets.iter_mut().for_each(|f| f.swap(1, 2));
    facets
}

/// A binary STL file.
pub fn stl(facets: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut data = vec![0; 80];
    data.extend((facets.len() as u32).to_le_bytes());
    for facet in facets {
        data.extend([0; 12]);
        data.extend(facet.iter().flatten().flat_map(|x| x.to_le_bytes()));
        data.extend([0; 2]);
    }
    data
}

/// A ZIP archive of named texts.
pub fn package(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in parts {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).expect("a part");
        std::io::Write::write_all(&mut zip, text.as_bytes()).expect("written");
    }
    zip.finish().expect("an archive").into_inner()
}

/// A prism with an even number of sides around the Z axis, its first corner on the X axis, standing on z = 0; two facets for each
/// side come first.
pub fn prism(sides: usize, radius: f32, height: f32) -> Facets {
    let at = |k: usize, z: f32| {
        let angle = (k % sides) as f32 / sides as f32 * std::f32::consts::TAU;
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    let walls = (0..sides).flat_map(|k| {
        let [a, b, c, d] = [at(k, 0.0), at(k + 1, 0.0), at(k + 1, height), at(k, height)];
        [[a, b, c], [a, c, d]]
    });
    let lids = (0..sides).flat_map(|k| {
        let middle = |z| [0.0, 0.0, z];
        [[middle(0.0), at(k + 1, 0.0), at(k, 0.0)], [middle(height), at(k, height), at(k + 1, height)]]
    });
    walls.chain(lids).collect()
}

/// A box from the origin as the mesh of a 3MF object.
pub fn box_xml(size: [f32; 3]) -> String {
    painted_xml(&cuboid([0.0; 3], size), |_| String::new())
}

/// Facets as the mesh of a 3MF object, each with more attributes.
pub fn painted_xml(facets: &Facets, attributes: impl Fn(usize) -> String) -> String {
    let corners = facets.iter().flatten().map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
    let triangles = (0..facets.len()).map(|i| {
        let [a, b, c] = [3 * i, 3 * i + 1, 3 * i + 2];
        format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" {}/>", attributes(i))
    });
    format!(
        "<mesh><vertices>{}</vertices><triangles>{}</triangles></mesh>",
        corners.collect::<String>(),
        triangles.collect::<String>()
    )
}

/// Attributes of a 3MF model that requires beam lattices; the prefixes are `b` and `bb`.
pub const LATTICES: &str = "xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\" \
    xmlns:bb=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07\" requiredextensions=\"b bb\"";

/// A beam lattice as the mesh of a 3MF object: vertices, attributes of the lattice, those of each beam, the balls.
pub fn lattice_xml(vertices: &[[f64; 3]], attributes: &str, beams: &[&str], balls: &str) -> String {
    let corners = vertices.iter().map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
    let beams = beams.iter().map(|beam| format!("<b:beam {beam}/>"));
    format!(
        "<mesh><vertices>{}</vertices><b:beamlattice minlength=\"0.01\" {attributes}><b:beams>{}</b:beams>\
         {balls}</b:beamlattice></mesh>",
        corners.collect::<String>(),
        beams.collect::<String>()
    )
}

/// A 3MF model part: attributes of its root, what is in its resources, and what is built.
pub fn model_xml(attributes: &str, resources: &str, build: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?><model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" {attributes}>\
         <resources>{resources}</resources><build>{build}</build></model>"
    )
}

/// Loads bytes under the name `part.stl`.
pub fn load(data: Vec<u8>) -> Result<(Mesh, MeshReport), MeshError> {
    from_bytes(Path::new("part.stl"), &data)
}

/// Loads facets.
pub fn mesh(facets: &[[[f32; 3]; 3]]) -> (Mesh, MeshReport) {
    load(stl(facets)).expect("the facets make a mesh")
}

/// The models that the project makes itself.
pub fn own_models() -> Vec<PathBuf> {
    stl_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("models"))
}

fn stl_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|e| e.path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "stl"));
    files.sort();
    files
}
