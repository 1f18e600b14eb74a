//! Where support is wanted, or not, whatever hangs over: in bodies, and under what is painted.

use crate::mesh::{PaintedFacet, Wish};
use crate::plate::Plate;
use crate::profile::Settings;
use crate::slice::{self, Layer, LayerSettings, LayerSpan, Slicer};
use crate::toolpath::support::SupportModifiers;
use crate::units::Mm;
use geometry::{Region, union, union_all, unite_rings};

use crate::parallel::Workers;

/// What is painted on steep surfaces holds so far around them, mm: of one layer they are narrower than what supports are planned by.
const AROUND_MM: f64 = 0.4;

/// What is wanted in each layer of the part, without a raft; empty: nothing is.
#[derive(Default)]
pub(crate) struct Wishes {
    enforced: Vec<Region>,
    blocked: Vec<Region>,
}

impl Wishes {
    /// Those of bodies, the enforcers and the blockers, and of what is painted on the objects of a plate.
    pub fn new(
        layers: &[Layer],
        plate: &Plate,
        bodies: &[Plate; 2],
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Self {
        let of = |wish: Wish, bodies: &Plate| {
            let inside = self::inside(bodies, layers, settings, workers);
            let painted = painted(wish, plate, layers);
            match (inside.is_empty(), painted.is_empty()) {
                (_, true) => inside,
                (true, _) => painted,
                _ => (0..painted.len())
                    .map(|i| union(inside.get(i).unwrap_or(Region::EMPTY), &painted[i]))
                    .collect(),
            }
        };
        let [enforcers, blockers] = bodies;
        Self { enforced: of(Wish::Enforced, enforcers), blocked: of(Wish::Blocked, blockers) }
    }

    /// Whether support is wanted anywhere.
    pub fn any(&self) -> bool {
        self.enforced.iter().any(|region| !region.is_empty())
    }

    /// Those of a layer.
    pub fn of(&self, layer: usize) -> SupportModifiers<'_> {
        let [enforced, blocked] =
            [&self.enforced, &self.blocked].map(|regions| regions.get(layer).unwrap_or(Region::EMPTY));
        SupportModifiers { enforced, blocked }
    }
}

/// The sections of bodies, in the layers of the part.
fn inside(bodies: &Plate, layers: &[Layer], settings: &Settings, workers: Workers<'_>) -> Vec<Region> {
    if bodies.meshes.is_empty() {
        return Vec::new();
    }
    let exact = LayerSettings { xy_compensation: Mm(0.0), elephant_foot: Mm(0.0), ..settings.layer.clone() };
    let slicer = match slice::is_uniform(&exact) {
        true => Slicer::new(bodies, &exact),
        false => Slicer::with_spans(bodies, lowered(layers), &exact),
    };
    workers.map(slicer.spans().len().min(layers.len()), |i| {
        union_all(slicer.layer(i).sections.iter().map(|section| &section.region))
    })
}

/// What is painted on surfaces that face down, seen from below: in each layer what lies between its cut and that of the layer
/// beneath.
fn painted(wish: Wish, plate: &Plate, layers: &[Layer]) -> Vec<Region> {
    let cuts_mm: Vec<f64> = lowered(layers).iter().map(|span| span.cut_mm).collect();
    let mut all: Vec<Region> = Vec::new();
    for object in &plate.objects {
        let facets = plate.meshes[object.mesh].paint().supports.iter();
        let facets: Vec<PaintedFacet<Wish>> =
            facets.filter(|facet| facet.paint == wish && faces_down(facet.corners)).copied().collect();
        if facets.is_empty() {
            continue;
        }
        all.resize(layers.len(), Region::default());
        let (steep, level): (Vec<_>, Vec<_>) =
            facets.iter().partition(|facet| slice::is_steep(&facet.corners));
        for (facets, around_mm) in [(level, 0.0), (steep, AROUND_MM)] {
            for (region, areas) in all.iter_mut().zip(slice::paint_between(facets, &cuts_mm)) {
                if !areas.is_empty() {
                    let rings: Vec<_> = areas.into_iter().map(|area| area.ring).collect();
                    let own = unite_rings(&rings).translated(object.offset);
                    *region = union(region, &geometry::offset(&own, around_mm));
                }
            }
        }
    }
    all
}

/// Whether a triangle is seen from below.
fn faces_down([a, b, c]: [[f64; 3]; 3]) -> bool {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) < 0.0
}

/// Where layers would lie without the raft under them.
fn lowered(layers: &[Layer]) -> Vec<LayerSpan> {
    let down_mm = layers.first().map_or(0.0, |first| first.span.bottom_mm);
    let low = |(index, layer): (usize, &Layer)| LayerSpan {
        index,
        bottom_mm: layer.span.bottom_mm - down_mm,
        top_mm: layer.span.top_mm - down_mm,
        height_mm: layer.span.height_mm,
        cut_mm: layer.span.cut_mm - down_mm,
    };
    layers.iter().enumerate().map(low).collect()
}
