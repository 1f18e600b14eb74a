//! Infill that depends on more than a layer: planned for the whole plate before any layer is.

use std::sync::Arc;

use crate::plate::Plate;
use crate::profile::Settings;
use crate::toolpath::Pattern;
use crate::toolpath::PlateLayer;
use crate::toolpath::bead;
use crate::toolpath::infill::{AdaptiveCubic, FillPattern, Lightning, LightningLayer};
use geometry::Region;

use crate::parallel::Workers;

/// Outlines are simplified to this before branches grow in them: a quarter of a bead.
const ROUGH_MM: f64 = 0.1;

/// The pattern, where it must know all layers; `up_mm`: where the part begins over the bed.
pub(crate) fn plan<'l>(
    plate: &Plate,
    up_mm: f64,
    layers: usize,
    layer: impl Fn(usize) -> PlateLayer<'l> + Sync + Send,
    settings: &Settings,
    workers: Workers<'_>,
) -> Option<Arc<dyn FillPattern>> {
    let infill = &settings.infill;
    if !(infill.density.0 > 0.0 && infill.density.0 < 1.0) {
        return None;
    }
    let line_distance_mm = bead::spacing_mm(infill.width.0, settings.layer.height.0) / infill.density.0;
    match infill.pattern {
        Pattern::AdaptiveCubic => {
            let surface = surface(plate, up_mm);
            Some(Arc::new(AdaptiveCubic::new(surface, line_distance_mm, infill.angle.to_radians())))
        }
        Pattern::Lightning => {
            let hollows = workers.map(layers, |i| lightning_layer(&layer(i), settings));
            Some(Arc::new(Lightning::new(&hollows, line_distance_mm)))
        }
        _ => None,
    }
}

/// Every triangle of the plate, lifted.
fn surface(plate: &Plate, up_mm: f64) -> impl Iterator<Item = [[f64; 3]; 3]> {
    plate.objects.iter().flat_map(move |object| {
        let (mesh, [x, y]) = (&plate.meshes[object.mesh], object.offset.mm());
        let corner = move |v: u32| {
            let [vx, vy, vz] = mesh.vertices()[v as usize];
            [vx + x, vy + y, vz + up_mm]
        };
        mesh.triangles().iter().map(move |triangle| triangle.map(corner))
    })
}

/// A layer as branches see it, all objects together.
fn lightning_layer(layer: &PlateLayer<'_>, settings: &Settings) -> LightningLayer {
    let walls = &settings.walls;
    let wall_mm = |width_mm: f64| bead::spacing_mm(width_mm, layer.height_mm);
    let thick_mm = match walls.count {
        0 => 0.0,
        count => wall_mm(walls.external_width.0) + f64::from(count - 1) * wall_mm(walls.width.0),
    };
    let (mut ground, mut sparse) = (Region::default(), Region::default());
    for object in &layer.objects {
        let rough = geometry::simplify(object.section, ROUGH_MM);
        let inside = geometry::offset(&rough, -thick_mm);
        let roofed = object
            .windows
            .top
            .map_or_else(|| inside.clone(), |above| geometry::intersection(&inside, above.region()));
        ground.add_disjoint(geometry::offset(&rough, -thick_mm / 2.0).into_polygons());
        sparse.add_disjoint(roofed.into_polygons());
    }
    LightningLayer { ground, sparse, height_mm: layer.height_mm }
}
