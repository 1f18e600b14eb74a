//! The report of a mesh: its contents and its repairs.

use std::fmt;

use serde::Serialize;

use super::repair::{Doubt, Repairs};
use super::surface::Mesh;

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
    /// Parts connected by edges.
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
    /// Pairs of equal facets of opposite winding that bounded nothing, dropped.
    pub pairs_cancelled: usize,
    /// Facets of fins, and of walls between bodies that touch, dropped.
    pub sheets_dropped: usize,
    /// Facets turned to face outwards.
    pub flipped: usize,
    /// Vertices welded across small gaps.
    pub gaps_welded: usize,
    /// Holes filled with facets.
    pub holes_filled: usize,
    /// Edges with one facet: rims of holes.
    pub open_edges: usize,
    /// Edges with more than two facets.
    pub non_manifold_edges: usize,
    /// Edges whose two facets disagree on the outside, and could not be made to agree.
    pub inconsistent_edges: usize,
    /// The uncertainty of the repair; `None` for a sound mesh or a certain repair.
    pub uncertain: Option<Doubt>,
    /// Warnings about errors in the file and implausible contents.
    pub warnings: Vec<String>,
}

/// One kind of repair, and how often it was done. `Display` gives a line in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Repair {
    /// Name for programs.
    pub kind: &'static str,
    /// How many facets, pairs, vertices or holes.
    pub count: usize,
}

/// Counts of repairs by kind: its name, and the words for one and for several.
const KINDS: [(&str, &str, &str); 7] = [
    ("degenerate-dropped", "facet without area dropped", "facets without area dropped"),
    ("duplicates-dropped", "duplicate facet dropped", "duplicate facets dropped"),
    (
        "pairs-cancelled",
        "pair of facets back to back, with nothing between, dropped",
        "pairs of facets back to back, with nothing between, dropped",
    ),
    ("sheets-dropped", "facet of a fin or a wall inside dropped", "facets of fins or walls inside dropped"),
    ("flipped", "facet turned to face outwards", "facets turned to face outwards"),
    ("gaps-welded", "vertex welded across a small gap", "vertices welded across small gaps"),
    ("holes-filled", "hole filled", "holes filled"),
];

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = KINDS.iter().find(|(kind, ..)| *kind == self.kind);
        let (one, many) = words.map_or((self.kind, self.kind), |(_, one, many)| (one, many));
        f.write_str(&counted(self.count, one, many))
    }
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
        warnings.extend(repairs.doubt.iter().map(|doubt| {
            format!(
                "the repair is uncertain: {doubt}; look at the preview, or repair the model where it was made"
            )
        }));
        if repairs.open > 0 {
            warnings.push(format!("{} edges are open; slices are closed across holes", repairs.open));
        }
        if repairs.clashing > 0 {
            warnings.push(format!("{} edges have facets that disagree on the outside", repairs.clashing));
        }
        // Of an open mesh the volume depends on where it is seen from: seen from the middle.
        let volume_mm3 = if repairs.open > 0 { mesh.volume_and_area().0 } else { repairs.volume_mm3 };
        Self {
            format,
            facets,
            triangles: mesh.triangles.len(),
            vertices: mesh.vertices.len(),
            shells: repairs.shells,
            min_mm,
            max_mm,
            size_mm,
            volume_mm3,
            area_mm2: repairs.area_mm2,
            watertight: mesh.is_closed(),
            degenerate_dropped: repairs.degenerate,
            duplicates_dropped: repairs.duplicates,
            pairs_cancelled: repairs.cancelled,
            sheets_dropped: repairs.sheets,
            flipped: repairs.flipped,
            gaps_welded: repairs.welded,
            holes_filled: repairs.filled,
            open_edges: repairs.open,
            non_manifold_edges: repairs.non_manifold,
            inconsistent_edges: repairs.clashing,
            uncertain: repairs.doubt.clone(),
            warnings,
        }
    }

    /// What was repaired, one entry for each kind of repair that was done.
    pub fn repairs(&self) -> Vec<Repair> {
        let counts = [
            self.degenerate_dropped,
            self.duplicates_dropped,
            self.pairs_cancelled,
            self.sheets_dropped,
            self.flipped,
            self.gaps_welded,
            self.holes_filled,
        ];
        let all = KINDS.iter().zip(counts).map(|(&(kind, ..), count)| Repair { kind, count });
        all.filter(|repair| repair.count > 0).collect()
    }
}

/// A number with the word for one or for several.
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.size_mm;
        let ([x0, y0, z0], [x1, y1, z1]) = (self.min_mm, self.max_mm);
        writeln!(f, "format      {}, {}", self.format, counted(self.facets, "facet", "facets"))?;
        writeln!(f, "size        {x:.3} × {y:.3} × {z:.3} mm")?;
        writeln!(f, "position    x {x0:.3} … {x1:.3}, y {y0:.3} … {y1:.3}, z {z0:.3} … {z1:.3} mm")?;
        writeln!(
            f,
            "mesh        {} triangles, {} vertices, {}",
            self.triangles,
            self.vertices,
            counted(self.shells, "shell", "shells")
        )?;
        writeln!(f, "volume      {:.3} cm³", self.volume_mm3 / 1000.0)?;
        writeln!(f, "surface     {:.3} cm²", self.area_mm2 / 100.0)?;
        writeln!(f, "watertight  {}", if self.watertight { "yes" } else { "no" })?;
        for repair in self.repairs() {
            writeln!(f, "repair      {repair}")?;
        }
        let left = [
            ("open edges", self.open_edges),
            ("non-manifold edges", self.non_manifold_edges),
            ("inconsistent edges", self.inconsistent_edges),
        ];
        for (what, count) in left.into_iter().filter(|(_, count)| *count > 0) {
            writeln!(f, "left        {count} {what}")?;
        }
        self.warnings.iter().try_for_each(|warning| writeln!(f, "warning     {warning}"))
    }
}
