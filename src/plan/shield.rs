//! The ooze shield: a wall around all objects, at which each tool leaves what has oozed out of it.

use crate::profile::Settings;
use crate::toolpath::{LayerPaths, Path, Phase, Role, ToolId, Width};
use geometry::{Point, Region, Ring};

/// How far on the arcs begin from one layer to the next, as a share of a loop, so that their ends do not stand over one another.
const STAGGER: f64 = 0.38;

/// An ooze shield, up to the last layer on which a tool is changed.
pub(crate) struct Shield {
    loops: Vec<Ring>,
    layers: usize,
    /// Of the lines of each tool, on the first layer and on others.
    widths_mm: [Vec<f64>; 2],
}

impl Shield {
    /// The shield around what is printed; `None`: none is wanted, or no tool is changed.
    pub fn plan(
        layers: &[LayerPaths],
        printed: &Region,
        widths_mm: &[Vec<f64>; 2],
        settings: &Settings,
    ) -> Option<Self> {
        let change = &settings.tool_change;
        let changes = |layer: &&[LayerPaths]| {
            let tools = layer.iter().flat_map(|layer| &layer.tools).collect::<Vec<_>>();
            tools.windows(2).any(|pair| pair[0] != pair[1])
        };
        let is_wanted = change.ooze_shield && changes(&layers);
        // The last layer that has a tool that the one before does not end with.
        let mut last = 0;
        for (index, pair) in layers.windows(2).enumerate() {
            let before = pair[0].tools.last();
            if pair[1].tools.iter().any(|tool| Some(tool) != before) {
                last = index + 1;
            }
        }
        let away_mm = change.ooze_shield_distance.0 + widest_mm(&widths_mm[1..]) / 2.0;
        let around =
            geometry::offset(printed, away_mm).into_polygons().into_iter().map(|polygon| polygon.outer);
        is_wanted.then(|| Self { loops: around.collect(), layers: last + 1, widths_mm: widths_mm.clone() })
    }

    /// What it covers, with what it encloses.
    pub fn covered(&self) -> Region {
        geometry::offset(&geometry::unite_rings(&self.loops), widest_mm(&self.widths_mm) / 2.0)
    }

    /// Its paths in a layer: every tool has an arc of each loop.
    pub fn paths(&self, number: usize, layer: &LayerPaths) -> Vec<Path> {
        if number >= self.layers {
            return Vec::new();
        }
        let path = |points: Vec<Point>, closed: bool, tool: ToolId| Path {
            role: Role::Skirt,
            closed,
            points,
            width: Width::Constant(self.widths_mm[usize::from(number > 0)][usize::from(tool)]),
            height_mm: layer.height_mm,
            island: None,
            phase: Phase::Tower(0),
            tool: Some(tool),
        };
        let mut paths = Vec::new();
        for ring in &self.loops {
            match layer.tools[..] {
                [] => {}
                [tool] => paths.push(path(ring.clone(), true, tool)),
                _ => {
                    let count = layer.tools.len();
                    let begin = STAGGER * number as f64;
                    let arc = |part: usize| {
                        let at = |part: usize| begin + part as f64 / count as f64;
                        arc(ring, at(part), at(part + 1))
                    };
                    let arcs = layer.tools.iter().enumerate().map(|(part, tool)| (arc(part), *tool));
                    paths.extend(
                        arcs.filter(|(arc, _)| arc.len() > 1).map(|(arc, tool)| path(arc, false, tool)),
                    );
                }
            }
        }
        paths
    }
}

fn widest_mm(widths_mm: &[Vec<f64>]) -> f64 {
    widths_mm.iter().flatten().copied().fold(0.0, f64::max)
}

/// The part of a ring between two shares of its length, of which the second is larger by less than 1.
fn arc(ring: &[Point], from: f64, to: f64) -> Vec<Point> {
    let length_mm = geometry::ring_length_mm(ring);
    let from_mm = from.rem_euclid(1.0) * length_mm;
    let to_mm = from_mm + (to - from) * length_mm;
    let mut points: Vec<Point> = Vec::new();
    let mut passed_mm = 0.0;
    for edge in 0..2 * ring.len() {
        let (a, b) = (ring[edge % ring.len()], ring[(edge + 1) % ring.len()]);
        let edge_mm = a.distance_mm(b);
        let on_edge = |at_mm: f64| {
            let share = ((at_mm - passed_mm) / edge_mm.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let (a, b) = (a.mm(), b.mm());
            Point::from_mm(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
        };
        let ends_mm = passed_mm + edge_mm;
        if points.is_empty() && ends_mm > from_mm {
            points.push(on_edge(from_mm));
        }
        if !points.is_empty() {
            points.push(on_edge(to_mm.min(ends_mm)));
            if ends_mm >= to_mm {
                break;
            }
        }
        passed_mm = ends_mm;
    }
    points.dedup();
    points
}
