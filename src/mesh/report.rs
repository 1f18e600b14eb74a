//! What is in a mesh, and what was done to it.

use std::fmt;

use serde::Serialize;

use super::Mesh;
use super::repair::Repairs;

/// Facts and counts of a loaded mesh. `Display` gives the text of `pathwright info`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshReport {
    /// Kind of file.
    pub format: &'static str,
    /// Facets in the file.
    pub facets: usize,
    /// Triangles after repair.
    pub triangles: usize,
    /// Vertices after welding.
    pub vertices: usize,
    /// Parts that hang together by edges.
    pub shells: usize,
    /// Lower corner of the bounding box.
    pub min_mm: [f64; 3],
    /// Upper corner of the bounding box.
    pub max_mm: [f64; 3],
    /// Extents of the bounding box.
    pub size_mm: [f64; 3],
    /// Enclosed volume; an estimate where the mesh is open.
    pub volume_mm3: f64,
    /// Surface.
    pub area_mm2: f64,
    /// Every edge has two facets, or an even number of them in alternating directions.
    pub watertight: bool,
    /// Facets dropped because two corners were equal.
    pub degenerate_dropped: usize,
    /// Facets dropped because they repeated another one.
    pub duplicates_dropped: usize,
    /// Facets turned to face outwards.
    pub flipped: usize,
    /// Vertices welded across small gaps.
    pub gaps_welded: usize,
    /// Holes of the size of one facet, filled.
    pub holes_filled: usize,
    /// Edges with one facet: rims of holes.
    pub open_edges: usize,
    /// Edges with more than two facets.
    pub non_manifold_edges: usize,
    /// Edges whose two facets disagree on the outside, and could not be made to agree.
    pub inconsistent_edges: usize,
    /// What was overlooked in the file, and what looks wrong.
    pub warnings: Vec<String>,
}

impl MeshReport {
    pub(super) fn new(
        mesh: &Mesh,
        format: &'static str,
        facets: usize,
        repairs: &Repairs,
        mut warnings: Vec<String>,
    ) -> Self {
        let [min_mm, max_mm] = mesh.bounds();
        let size_mm = std::array::from_fn(|i| max_mm[i] - min_mm[i]);
        warnings.extend(unit_warning(size_mm));
        if repairs.open > 0 {
            warnings.push(format!("{} edges are open; slices are closed across holes", repairs.open));
        }
        if repairs.doubtful > 0 {
            warnings.push(format!(
                "in {} shells nearly as many facets faced in as out; which side is the outside was guessed",
                repairs.doubtful
            ));
        }
        if repairs.clashing > 0 {
            warnings.push(format!(
                "{} edges have facets that disagree on the outside; inside is where a ray crosses the surface an \
                 odd number of times",
                repairs.clashing
            ));
        }
        Self {
            format,
            facets,
            triangles: mesh.triangles.len(),
            vertices: mesh.vertices.len(),
            shells: repairs.shells,
            min_mm,
            max_mm,
            size_mm,
            volume_mm3: repairs.volume_mm3,
            area_mm2: repairs.area_mm2,
            watertight: !mesh.twins.contains(&super::NO_TWIN),
            degenerate_dropped: repairs.degenerate,
            duplicates_dropped: repairs.duplicates,
            flipped: repairs.flipped,
            gaps_welded: repairs.welded,
            holes_filled: repairs.filled,
            open_edges: repairs.open,
            non_manifold_edges: repairs.non_manifold,
            inconsistent_edges: repairs.clashing,
            warnings,
        }
    }
}

/// Units that programs export in, as the factor that makes them millimetres.
const UNITS: [(&str, f64); 4] =
    [("inches", 25.4), ("metres", 1000.0), ("centimetres", 10.0), ("micrometres", 1e-3)];

/// Parts whose longest side is below 1 mm or above 2 m are rarely meant; the unit that brings it nearest to 50 mm (on
/// a logarithmic scale) is guessed.
fn unit_warning(size_mm: [f64; 3]) -> Option<String> {
    let longest = size_mm.into_iter().fold(0.0, f64::max);
    if (1.0..=2000.0).contains(&longest) || longest == 0.0 {
        return None;
    }
    let distance = |factor: f64| (longest * factor / 50.0).ln().abs();
    let (unit, factor) = UNITS.into_iter().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    Some(format!("the part is {longest:.4} mm long; if it was made in {unit}, use --scale {factor}"))
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.size_mm;
        let ([x0, y0, z0], [x1, y1, z1]) = (self.min_mm, self.max_mm);
        writeln!(f, "format      {}, {} facets", self.format, self.facets)?;
        writeln!(f, "size        {x:.3} × {y:.3} × {z:.3} mm")?;
        writeln!(f, "position    x {x0:.3} … {x1:.3}, y {y0:.3} … {y1:.3}, z {z0:.3} … {z1:.3} mm")?;
        writeln!(
            f,
            "mesh        {} triangles, {} vertices, {} {}",
            self.triangles,
            self.vertices,
            self.shells,
            if self.shells == 1 { "shell" } else { "shells" }
        )?;
        writeln!(f, "volume      {:.3} cm³", self.volume_mm3 / 1000.0)?;
        writeln!(f, "surface     {:.3} cm²", self.area_mm2 / 100.0)?;
        writeln!(f, "watertight  {}", if self.watertight { "yes" } else { "no" })?;
        let counts = [
            ("degenerate facets dropped", self.degenerate_dropped),
            ("duplicate facets dropped", self.duplicates_dropped),
            ("facets turned", self.flipped),
            ("vertices welded across gaps", self.gaps_welded),
            ("small holes filled", self.holes_filled),
            ("open edges", self.open_edges),
            ("non-manifold edges", self.non_manifold_edges),
            ("inconsistent edges", self.inconsistent_edges),
        ];
        for (what, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
            writeln!(f, "repair      {count} {what}")?;
        }
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning     {warning}"))
    }
}
