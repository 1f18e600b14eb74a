//! Makes one spiral of a whole print on its solid bottom.

use std::borrow::Cow;

use crate::job::{InputError, JobError};
use crate::profile::Settings;
use crate::slice::{Layer, LayerSpan};
use crate::toolpath::{
    self, Island, IslandId, LayerKind, LayerPaths, Path, Phase, Revolution, Role, SpiralSpec, Width,
};
use crate::units::Ratio;
use geometry::{Region, Ring};

use crate::parallel::Workers;

/// Layers above the bottom as revolutions.
pub(crate) struct Spiral {
    /// The layer of the first revolution.
    first: usize,
    revolutions: Vec<Revolution>,
    width_mm: f64,
    /// Warnings about parts that are not printed.
    pub warning: Option<String>,
}

/// The settings that the bottom of a spiral is printed with: one wall, nothing inside, no top.
pub(crate) fn effective(settings: &Settings) -> Cow<'_, Settings> {
    if !settings.spiral.enabled {
        return Cow::Borrowed(settings);
    }
    let mut settings = settings.clone();
    settings.walls.count = 1;
    settings.shell.top_layers = 0;
    settings.infill.density = Ratio(0.0);
    settings.ironing.enabled = false;
    Cow::Owned(settings)
}

impl Spiral {
    /// Makes a spiral of the layers from `first` on.
    ///
    /// # Errors
    /// More than one object is on the plate, or a layer in the middle has no outline to follow.
    pub fn new(
        layers: &[Layer],
        objects: usize,
        first: usize,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<Self, JobError> {
        if objects > 1 {
            return Err(InputError::SpiralOfSeveral { objects }.into());
        }
        let spec = SpiralSpec { width_mm: settings.walls.external_width.0, smooth: settings.spiral.smooth };
        let body = layers.get(first..).unwrap_or_default();
        let mut outlines: Vec<Option<Ring>> =
            workers.map(body.len(), |i| toolpath::outline(section(&body[i]), spec.width_mm));
        while outlines.last().is_some_and(Option::is_none) {
            outlines.pop();
        }
        if let Some(gap) = outlines.iter().position(Option::is_none) {
            return Err(InputError::SpiralEnds { z_mm: body[gap].span.top_mm, hints: Vec::new() }.into());
        }
        let mut outlines: Vec<Ring> = outlines.into_iter().flatten().collect();
        let warning = warning(body, outlines.len());
        toolpath::align(&mut outlines);
        let mut revolutions = workers.map(outlines.len(), |i| {
            let below = i.checked_sub(1).map(|below| outlines[below].as_slice());
            toolpath::revolution(&outlines[i], below, body[i].span.height_mm, &spec)
        });
        if let (Some(last), Some(outline)) = (revolutions.last_mut(), outlines.last()) {
            last.extend(toolpath::level(outline));
        }
        Ok(Self { first, revolutions, width_mm: spec.width_mm, warning })
    }

    /// Whether a layer is a revolution.
    pub fn has(&self, layer: usize) -> bool {
        layer >= self.first
    }

    /// The revolution of a layer; `None`: it belongs to the bottom.
    pub fn layer(&self, span: &LayerSpan, section: &Region, beneath: &Region) -> Option<LayerPaths> {
        let revolution = self.revolutions.get(span.index.checked_sub(self.first)?);
        let Revolution { points, rises } = revolution.cloned().unwrap_or_default();
        let path = Path {
            role: Role::ExternalPerimeter,
            closed: false,
            points,
            width: Width::Constant(self.width_mm),
            height_mm: span.height_mm,
            island: Some(IslandId(0)),
            phase: Phase::Wall(0),
            tool: None,
        };
        Some(LayerPaths {
            index: span.index,
            top_mm: span.top_mm,
            height_mm: span.height_mm,
            islands: vec![Island { object: 0, repeats: false, meets_others: false }],
            paths: if rises.is_empty() { Vec::new() } else { vec![path] },
            outline: section.clone(),
            beneath: Some(beneath.clone()),
            kind: if rises.is_empty() { LayerKind::Flat } else { LayerKind::Spiral(rises) },
            entries: Default::default(),
            tools: Vec::new(),
            rams: Vec::new(),
            turn: Default::default(),
        })
    }
}

/// The section of the only object.
fn section(layer: &Layer) -> &Region {
    layer.sections.first().map_or(Region::EMPTY, |section| &section.region)
}

/// Tells of parts beside the one that is followed, and of a tip too thin for the line.
fn warning(body: &[Layer], revolutions: usize) -> Option<String> {
    let mut split = body.iter().filter(|layer| section(layer).polygons().len() > 1);
    let mut parts = Vec::new();
    if let Some(first) = split.next() {
        parts.push(format!(
            "{} layers, the first at {:.2} mm, are in several parts, of which the spiral follows the largest",
            1 + split.count(),
            first.span.top_mm
        ));
    }
    if let Some(tip) = body.get(revolutions) {
        parts.push(format!(
            "from {:.2} mm on the model is thinner than the line and left out",
            tip.span.bottom_mm
        ));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}
