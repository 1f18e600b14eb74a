//! Where models stand on the bed.

use super::Mesh;
use super::arrange::{Shape, Towards, arrange};
use super::pack::{Footprint, group_box, pack};
use super::silhouette::silhouette;
use crate::geom::Point;
use crate::profile::{BedSettings, BedShape};

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
    /// Least distance between models, and what is printed around them.
    pub spacing_mm: f64,
    /// How far brim, raft and supports reach around each model.
    pub reach_mm: f64,
    /// Whether models keep the distance from each other's convex hull, instead of only from the outline.
    pub convex: bool,
    /// Whether models may be turned by quarters about Z to fit.
    pub turn: bool,
    /// Moves everything away from the middle of the bed; a negative Z sinks it, which cuts off the bottom.
    pub shift_mm: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            margin_mm: 0.0,
            spacing_mm: 5.0,
            reach_mm: 0.0,
            convex: false,
            turn: false,
            shift_mm: [0.0; 3],
        }
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
        "{total} models do not fit the printer's {bed} together, {spacing_mm} mm apart: {fitting} do, and there is no \
         room for {}; print the others on another plate, or use --each",
        listed(left)
    )]
    TooMany { total: usize, fitting: usize, left: Vec<String>, spacing_mm: f64, bed: String },
    #[error(
        "{a} and {b} stand closer than {apart_mm:.1} mm where the files put them; leave out --no-arrange, or move them \
         apart"
    )]
    Touching { a: String, b: String, apart_mm: f64 },
    #[error(
        "{name}: where it is put, it reaches {by_mm:.2} mm beyond the printer's {bed}; give a smaller --translate, or \
         leave out --no-arrange"
    )]
    Outside { name: String, by_mm: f64, bed: String },
    #[error(
        "--translate lifts the model {0} mm off the bed; give a Z of 0, or a negative one to cut off the bottom"
    )]
    InTheAir(f64),
}

/// Places models side by side, the whole group in the middle of the bed.
///
/// Models are packed by their outlines, on cells of about a millimetre: around the middle of the bed, or if that does not
/// hold all of them, from a corner. Where neither does, boxes are packed to the micrometre. Outlines never come closer
/// than the spacing.
///
/// # Errors
/// A model larger than the bed, models larger than the bed together, a shift off the bed.
pub fn place(items: Vec<Item>, bed: &BedSettings, options: &Placement) -> Result<Plate, PlacementError> {
    let area = Area::new(bed, options.margin_mm);
    let mut meshes = Vec::with_capacity(items.len());
    let (mut names, mut models, mut footprints) = (Vec::new(), Vec::new(), Vec::new());
    for item in items {
        let mesh = item.mesh.centered();
        let footprint = Footprint::new(&mesh, bed.shape);
        area.check(&item.name, &mesh, &footprint)?;
        for copy in 1..=item.copies {
            names.push(if copy == 1 { item.name.clone() } else { format!("{} ({copy})", item.name) });
            models.push(meshes.len());
        }
        footprints.push(footprint);
        meshes.push(mesh);
    }
    let places =
        packed(&meshes, &footprints, &models, &area, options).map_err(|left| PlacementError::TooMany {
            total: models.len(),
            fitting: models.len() - left.len(),
            left: left.into_iter().map(|model| names[model].clone()).collect(),
            spacing_mm: options.spacing_mm,
            bed: area.to_string(),
        })?;
    let mut plate = Plate { meshes: Vec::with_capacity(meshes.len()), objects: Vec::new() };
    let mut used: Vec<(usize, u32)> = Vec::new();
    for (name, (&model, &(quarters, spot))) in names.into_iter().zip(models.iter().zip(&places)) {
        let mesh = used.iter().position(|u| *u == (model, quarters)).unwrap_or_else(|| {
            used.push((model, quarters));
            plate.meshes.push(meshes[model].quarter_turned(quarters));
            used.len() - 1
        });
        plate.objects.push(Object { name, mesh, offset: Point::from_mm(spot[0], spot[1]) });
    }
    area.settle(plate, bed, options)
}

/// Puts models where their files have them: each item's mesh as it lies, moved by each of its spots (bed coordinates), and
/// let down on the bed.
///
/// # Errors
/// As [`place`], and models that touch.
pub fn keep(
    items: Vec<(Item, Vec<[f64; 2]>)>,
    bed: &BedSettings,
    options: &Placement,
) -> Result<Plate, PlacementError> {
    let area = Area::new(bed, options.margin_mm);
    let middle = bed.middle_mm();
    let mut plate = Plate { meshes: Vec::with_capacity(items.len()), objects: Vec::new() };
    let reach_mm = options.reach_mm + if options.convex { options.spacing_mm / 2.0 } else { 0.0 };
    let mut covered = Vec::new();
    for (item, spots) in items {
        let [min, max] = item.mesh.bounds();
        let mesh = item.mesh.centered();
        area.check(&item.name, &mesh, &Footprint::new(&mesh, bed.shape))?;
        for (copy, spot) in (1..).zip(spots) {
            let name = if copy == 1 { item.name.clone() } else { format!("{} ({copy})", item.name) };
            let at = [0, 1].map(|i| spot[i] + (min[i] + max[i]) / 2.0);
            let mut moved = mesh.clone();
            moved.shift([at[0], at[1], 0.0]);
            covered.push(silhouette(&moved, options.convex, reach_mm, KEPT_CELL_MM));
            let offset = Point::from_mm(at[0] - middle[0], at[1] - middle[1]);
            plate.objects.push(Object { name, mesh: plate.meshes.len(), offset });
        }
        plate.meshes.push(mesh);
    }
    for (i, a) in covered.iter().enumerate() {
        if let Some(j) = (i + 1..covered.len()).find(|&j| a.meets(&covered[j], [0; 2])) {
            let [a, b] = [i, j].map(|k| plate.objects[k].name.clone());
            let apart_mm = 2.0 * reach_mm + 2.0 * KEPT_CELL_MM;
            return Err(PlacementError::Touching { a, b, apart_mm });
        }
    }
    area.settle(plate, bed, options)
}

/// Cells of models that stay where they are.
const KEPT_CELL_MM: f64 = 0.2;

/// The bed's longer side has so many cells when models are packed.
const CELLS: f64 = 256.0;

/// Quarter turn and place of the middle for each model, relative to that of the bed; or the models that do not fit.
fn packed(
    meshes: &[Mesh],
    footprints: &[Footprint],
    models: &[usize],
    area: &Area,
    options: &Placement,
) -> Result<Vec<(u32, [f64; 2])>, Vec<usize>> {
    if models.len() < 2 {
        return Ok(vec![(0, [0.0; 2]); models.len()]);
    }
    let cell_mm = (2.0 * area.half[0].max(area.half[1]) / CELLS).max(0.1);
    let reach_mm = options.reach_mm + options.spacing_mm / 2.0;
    let shape = |mesh: &Mesh| Shape {
        covered: silhouette(mesh, options.convex, reach_mm, cell_mm),
        rim: Footprint::new(mesh, area.shape).rim,
    };
    let quarters = if options.turn { 4 } else { 1 };
    let shapes: Vec<Vec<Shape>> =
        meshes.iter().map(|mesh| (0..quarters).map(|n| shape(&mesh.quarter_turned(n))).collect()).collect();
    let half = area.half.map(|half| (half / cell_mm) as i64);
    let at_mm = |at: [i64; 2]| at.map(|n| n as f64 * cell_mm);
    let fits = |rim: &[[f64; 2]], at: [i64; 2]| {
        let [x, y] = at_mm(at);
        area.excess_mm(rim.iter().map(|p| [p[0] + x, p[1] + y])) <= TOLERANCE_MM
    };
    let mut left: Option<Vec<usize>> = None;
    for towards in [Towards::Middle, Towards::Corner] {
        let spots = arrange(&shapes, models, half, towards, fits);
        let without: Vec<usize> = (0..models.len()).filter(|&model| spots[model].is_none()).collect();
        if without.is_empty() {
            let placed = spots.into_iter().flatten().map(|spot| (spot.turn as u32, at_mm(spot.at))).collect();
            return Ok(area.in_the_middle(placed, |model, turn| &shapes[models[model]][turn as usize].rim));
        }
        if left.as_ref().is_none_or(|left| without.len() < left.len()) {
            left = Some(without);
        }
    }
    let boxes: Vec<Footprint> = models.iter().map(|&model| footprints[model].clone()).collect();
    let spots = pack(&boxes, 2.0 * reach_mm, |placed, spots| area.group_share(placed, spots));
    let unplaced = left.unwrap_or_default();
    match spots {
        Ok(spots) => Ok(spots.into_iter().map(|spot| (0, spot)).collect()),
        Err(boxes_left) if boxes_left.len() < unplaced.len() => Err(boxes_left),
        Err(_) => Err(unplaced),
    }
}

/// The first few of some names.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 5;
    match names.len().checked_sub(SHOWN) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} more", names[..SHOWN].join(", ")),
    }
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

    /// Places moved together so that the box around all models has its middle over the bed's, if all stay on it.
    fn in_the_middle<'a>(
        &self,
        mut places: Vec<(u32, [f64; 2])>,
        rim: impl Fn(usize, u32) -> &'a [[f64; 2]],
    ) -> Vec<(u32, [f64; 2])> {
        let points = |places: &[(u32, [f64; 2])]| -> Vec<[f64; 2]> {
            let moved = |(model, &(turn, at)): (usize, &(u32, [f64; 2]))| {
                rim(model, turn).iter().map(move |p| [p[0] + at[0], p[1] + at[1]])
            };
            places.iter().enumerate().flat_map(moved).collect()
        };
        let extent = |pick: fn(f64, f64) -> f64| {
            points(&places)
                .into_iter()
                .reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])])
                .unwrap_or_default()
        };
        let (low, high) = (extent(f64::min), extent(f64::max));
        let by = [0, 1].map(|i| -(low[i] + high[i]) / 2.0);
        if self.excess_mm(points(&places).into_iter().map(|p| [p[0] + by[0], p[1] + by[1]])) <= TOLERANCE_MM {
            for (_, at) in &mut places {
                *at = [at[0] + by[0], at[1] + by[1]];
            }
        }
        places
    }

    /// The plate, whose offsets are relative to the bed's middle, in bed coordinates and shifted as asked.
    fn settle(
        &self,
        mut plate: Plate,
        bed: &BedSettings,
        options: &Placement,
    ) -> Result<Plate, PlacementError> {
        let middle = bed.middle_mm();
        let [dx, dy, dz] = options.shift_mm;
        let rims: Vec<Vec<[f64; 2]>> =
            plate.meshes.iter().map(|mesh| Footprint::new(mesh, self.shape).rim).collect();
        for object in &mut plate.objects {
            let [x, y] = object.offset.mm();
            let spot = [x + dx, y + dy];
            let by_mm = self.excess_mm(rims[object.mesh].iter().map(|p| [p[0] + spot[0], p[1] + spot[1]]));
            if by_mm > TOLERANCE_MM {
                let (name, bed) = (object.name.clone(), self.to_string());
                return Err(PlacementError::Outside { name, by_mm, bed });
            }
            object.offset = Point::from_mm(spot[0] + middle[0], spot[1] + middle[1]);
        }
        if dz > 0.0 {
            return Err(PlacementError::InTheAir(dz));
        }
        for mesh in &mut plate.meshes {
            mesh.shift([0.0, 0.0, dz]);
        }
        Ok(plate)
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
