//! Where models stand on the bed.

use super::Mesh;
use super::pack::{Footprint, group_box, pack};
use crate::geom::Point;
use crate::profile::{BedOrigin, BedSettings, BedShape};

/// A model to place.
#[derive(Clone, Debug)]
pub struct Item {
    /// What messages and G-code call it.
    pub name: String,
    /// The model, wherever it lies.
    pub mesh: Mesh,
    /// How many of it.
    pub copies: usize,
}

/// How models are placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Width to keep free along the bed's edge, for skirt and brim.
    pub margin_mm: f64,
    /// Least distance between models.
    pub spacing_mm: f64,
    /// Moves everything away from the middle of the bed; a negative Z sinks it, which cuts off the bottom.
    pub shift_mm: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self { margin_mm: 0.0, spacing_mm: 5.0, shift_mm: [0.0; 3] }
    }
}

/// One model on the plate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Object {
    /// The item's name; copies are numbered, `part (2)`.
    pub name: String,
    /// Index into [`Plate::meshes`].
    pub mesh: usize,
    /// Where the mesh's origin stands on the bed.
    pub offset: Point,
}

/// Everything that is printed in one go. Copies share a mesh, so that it is cut once.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// Meshes, the middle of their box over the origin, standing on z = 0.
    pub meshes: Vec<Mesh>,
    /// What stands where, in the order of the items.
    pub objects: Vec<Object>,
}

/// Models that do not fit (exit code 5).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum PlacementError {
    #[error(
        "{name}: {:.2} × {:.2} × {:.2} mm does not fit the printer's {bed}: {excess}; --scale-to-fit would scale it by {factor}",
        size[0], size[1], size[2]
    )]
    TooLarge { name: String, size: [f64; 3], bed: String, excess: String, factor: f64 },
    #[error(
        "{total} models do not fit the printer's {bed} together: {fitting} do; print the others on another plate, \
         or use --each"
    )]
    TooMany { total: usize, fitting: usize, bed: String },
    #[error(
        "{name}: moved as asked, it reaches {by_mm:.2} mm beyond the printer's {bed}; give a smaller --translate"
    )]
    Outside { name: String, by_mm: f64, bed: String },
    #[error(
        "--translate lifts the model {0} mm off the bed; give a Z of 0, or a negative one to cut off the bottom"
    )]
    InTheAir(f64),
}

/// Places models side by side, the whole group in the middle of the bed.
///
/// Greedy by falling footprint: each model goes where it touches (at the spacing) one that stands, so that the group
/// takes the least share of the bed. Boxes never come closer than the spacing. O(n³) for n models.
///
/// # Errors
/// A model larger than the bed, a group larger than the bed, a shift off the bed.
pub fn place(items: Vec<Item>, bed: &BedSettings, options: &Placement) -> Result<Plate, PlacementError> {
    let area = Area::new(bed, options.margin_mm);
    let mut plate = Plate { meshes: Vec::with_capacity(items.len()), objects: Vec::new() };
    let mut footprints = Vec::new();
    for item in items {
        let mesh = item.mesh.centered();
        let footprint = Footprint::new(&mesh, bed.shape);
        area.check(&item.name, &mesh, &footprint)?;
        for copy in 1..=item.copies {
            let name = if copy == 1 { item.name.clone() } else { format!("{} ({copy})", item.name) };
            plate.objects.push(Object { name, mesh: plate.meshes.len(), offset: Point::default() });
            footprints.push(footprint.clone());
        }
        plate.meshes.push(mesh);
    }
    let total = footprints.len();
    let spots = pack(&footprints, options.spacing_mm, |placed, spots| area.group_share(placed, spots))
        .map_err(|fitting| PlacementError::TooMany { total, fitting, bed: area.to_string() })?;
    let center = match bed.origin {
        BedOrigin::Center => [0.0; 2],
        BedOrigin::Corner => [bed.size[0].0 / 2.0, bed.size[1].0 / 2.0],
    };
    let [dx, dy, dz] = options.shift_mm;
    for ((object, spot), footprint) in plate.objects.iter_mut().zip(&spots).zip(&footprints) {
        let spot = [spot[0] + dx, spot[1] + dy];
        let by_mm = area.excess_mm(footprint.rim.iter().map(|p| [p[0] + spot[0], p[1] + spot[1]]));
        if by_mm > TOLERANCE_MM && (dx, dy) != (0.0, 0.0) {
            return Err(PlacementError::Outside { name: object.name.clone(), by_mm, bed: area.to_string() });
        }
        object.offset = Point::from_mm(spot[0] + center[0], spot[1] + center[1]);
    }
    if dz > 0.0 {
        return Err(PlacementError::InTheAir(dz));
    }
    for mesh in &mut plate.meshes {
        mesh.shift([0.0, 0.0, dz]);
    }
    Ok(plate)
}

/// The largest factor, at most 1, that makes a mesh fit the bed.
pub fn fit_factor(mesh: &Mesh, bed: &BedSettings, margin_mm: f64) -> f64 {
    let area = Area::new(bed, margin_mm);
    let mesh = mesh.clone().centered();
    let share = area.share(&mesh, &Footprint::new(&mesh, bed.shape));
    if share <= 1.0 {
        return 1.0;
    }
    // Four digits are enough, rounded down so that the result fits.
    ((1.0 / share) * 1e4).floor() / 1e4
}

/// Fits may be exact: a 250 mm plate on a 250 mm bed, with the noise of binary floating point.
const TOLERANCE_MM: f64 = 1e-4;

/// The usable part of the bed, its middle at the origin.
struct Area {
    shape: BedShape,
    half: [f64; 2],
    height: f64,
    margin_mm: f64,
}

impl Area {
    fn new(bed: &BedSettings, margin_mm: f64) -> Self {
        let half = bed.size.map(|side| (side.0 / 2.0 - margin_mm).max(0.0));
        Self { shape: bed.shape, half, height: bed.height.0, margin_mm }
    }

    /// How far points reach beyond the edge; negative inside.
    fn excess_mm(&self, points: impl Iterator<Item = [f64; 2]>) -> f64 {
        let beyond = |p: [f64; 2]| match self.shape {
            BedShape::Rectangular => (p[0].abs() - self.half[0]).max(p[1].abs() - self.half[1]),
            BedShape::Round => p[0].hypot(p[1]) - self.half[0],
        };
        points.map(beyond).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The part of the bed's extent that is needed: more than 1 does not fit.
    fn share(&self, mesh: &Mesh, footprint: &Footprint) -> f64 {
        let flat = self.group_share(&[footprint], &[[0.0; 2]]);
        flat.max((mesh.size()[2] - TOLERANCE_MM) / self.height)
    }

    /// As `share`, of footprints in place, the middle of their common box taken to the middle of the bed.
    fn group_share(&self, footprints: &[&Footprint], spots: &[[f64; 2]]) -> f64 {
        let [min, max] = group_box(footprints, spots);
        let usable = |half: f64| half + TOLERANCE_MM;
        match self.shape {
            BedShape::Rectangular => {
                let share = |i: usize| (max[i] - min[i]) / 2.0 / usable(self.half[i]);
                share(0).max(share(1))
            }
            BedShape::Round => {
                let middle = [(min[0] + max[0]) / 2.0, (min[1] + max[1]) / 2.0];
                let rims = footprints.iter().zip(spots).flat_map(|(f, s)| f.rim.iter().map(move |p| (p, s)));
                let reach = rims.map(|(p, s)| (p[0] + s[0] - middle[0]).hypot(p[1] + s[1] - middle[1]));
                reach.fold(0.0, f64::max) / usable(self.half[0])
            }
        }
    }

    fn check(&self, name: &str, mesh: &Mesh, footprint: &Footprint) -> Result<(), PlacementError> {
        let share = self.share(mesh, footprint);
        if share <= 1.0 {
            return Ok(());
        }
        let size = mesh.size();
        let mut excess = Vec::new();
        match self.shape {
            BedShape::Rectangular => {
                for (axis, by) in ["X", "Y"].into_iter().zip([0, 1].map(|i| size[i] - 2.0 * self.half[i])) {
                    if by > TOLERANCE_MM {
                        excess.push(format!("{by:.2} mm too long in {axis}"));
                    }
                }
            }
            BedShape::Round => {
                let by = self.excess_mm(footprint.rim.iter().copied());
                if by > TOLERANCE_MM {
                    excess.push(format!("it reaches {by:.2} mm beyond the edge"));
                }
            }
        }
        if size[2] > self.height + TOLERANCE_MM {
            excess.push(format!("{:.2} mm too high", size[2] - self.height));
        }
        Err(PlacementError::TooLarge {
            name: name.to_string(),
            size,
            bed: self.to_string(),
            excess: excess.join(", "),
            factor: ((1.0 / share) * 1e4).floor() / 1e4,
        })
    }
}

impl std::fmt::Display for Area {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [w, d] = self.half.map(|half| 2.0 * (half + self.margin_mm));
        match self.shape {
            BedShape::Rectangular => write!(f, "{w} × {d} × {} mm", self.height)?,
            BedShape::Round => write!(f, "round bed of {w} mm, {} mm high", self.height)?,
        }
        if self.margin_mm > 0.0 {
            write!(f, " less {} mm at the edge for skirt and brim", self.margin_mm)?;
        }
        Ok(())
    }
}
