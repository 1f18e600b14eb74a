//! Meshes as a page draws them.

use rustc_hash::FxHashMap;

use super::surface::Mesh;

/// Of meshes with more triangles than wanted, vertices in one cell of a grid are drawn as one. The finest grid has so many
/// cells along the longest side; each next one has this share of them.
const CELLS: f64 = 1024.0;
const COARSER: f64 = 0.7;

/// What the first bytes of a mesh say.
const MAGIC: &[u8; 4] = b"PWM1";

impl Mesh {
    /// The mesh in packed form, little-endian: `PWM1`, the numbers of vertices and triangles (32 bits each), vertices (three
    /// floats of 32 bits, the middle of the box over the origin, the lowest point at 0, millimetres), triangles (three
    /// numbers of vertices of 32 bits). With more triangles than `most` it is simplified for display.
    pub fn packed(&self, most: usize) -> Vec<u8> {
        let [low, high] = self.bounds();
        let origin = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]];
        let at = |v: &[f64; 3]| [0, 1, 2].map(|i| (v[i] - origin[i]) as f32);
        let mut vertices: Vec<[f32; 3]> = self.vertices.iter().map(at).collect();
        let mut triangles: Vec<[u32; 3]> = self.triangles.to_vec();
        let longest = [0, 1, 2].map(|i| high[i] - low[i]).into_iter().fold(0.0, f64::max);
        let mut cells = CELLS;
        while triangles.len() > most && cells > 1.0 {
            (vertices, triangles) = clustered(&vertices, &triangles, (longest / cells) as f32);
            cells *= COARSER;
        }
        let mut out = Vec::with_capacity(12 + 12 * (vertices.len() + triangles.len()));
        out.extend_from_slice(MAGIC);
        out.extend_from_slice(&(vertices.len() as u32).to_le_bytes());
        out.extend_from_slice(&(triangles.len() as u32).to_le_bytes());
        vertices.iter().flatten().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
        triangles.iter().flatten().for_each(|i| out.extend_from_slice(&i.to_le_bytes()));
        out
    }
}

/// All vertices of a cell as the first of them; triangles that have two corners in one are left out.
fn clustered(vertices: &[[f32; 3]], triangles: &[[u32; 3]], cell: f32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut known: FxHashMap<[i32; 3], u32> = FxHashMap::default();
    let mut kept = Vec::new();
    let mut number = |vertex: &[f32; 3]| {
        *known.entry(vertex.map(|x| (x / cell).floor() as i32)).or_insert_with(|| {
            kept.push(*vertex);
            kept.len() as u32 - 1
        })
    };
    let numbers: Vec<u32> = vertices.iter().map(&mut number).collect();
    let merged = triangles.iter().map(|t| t.map(|v| numbers[v as usize]));
    let triangles = merged.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    (kept, triangles)
}

#[cfg(test)]
mod tests {
    use crate::mesh::load_objects;

    #[test]
    fn a_packed_mesh_is_centred_and_no_larger_than_wanted() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/helical_gear.stl");
        let mesh = load_objects(path.as_ref()).unwrap().remove(0).mesh;
        let number =
            |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        for most in [usize::MAX, 2000] {
            let packed = mesh.packed(most);
            let (vertices, triangles) = (number(&packed, 4), number(&packed, 8));
            assert_eq!((&packed[..4], packed.len()), (b"PWM1".as_slice(), 12 + 12 * (vertices + triangles)));
            assert!(triangles <= most && triangles > 100, "{triangles} of {most}");
            let z = (0..vertices)
                .map(|i| f32::from_le_bytes(packed[20 + 12 * i..24 + 12 * i].try_into().unwrap()));
            assert!(z.fold(f32::INFINITY, f32::min).abs() < 0.2);
            let corners = (0..3 * triangles).map(|i| number(&packed, 12 + 12 * vertices + 4 * i));
            assert!(corners.max().unwrap() < vertices);
        }
    }
}
