//! Parts of objects that have a tool or settings of their own.

use crate::profile::Settings;
use crate::slice::{Layer, Section};
use crate::toolpath::{ToolId, bead};
use geometry::{Join, Region};

use super::modifiers::Modified;
use super::piece::Piece;
use super::slivers;
use super::styles::Styles;

/// A part of a section with walls of its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    pub tool: ToolId,
    /// Walls are made around it.
    pub region: Region,
    /// What different settings fill of it, where there are several: the first prints the walls.
    pub fills: Vec<(Option<usize>, Region)>,
    /// The settings, where there is one.
    pub style: Option<usize>,
}

/// The parts of a section, which make up the whole, and overlap no more than their walls press into each other; empty: it is all
/// of one kind.
pub(crate) type Parts = Vec<Part>;

/// What is painted: a tool's share of a layer.
pub(crate) type Painted = (ToolId, Region);

/// Walls of parts press into each other by so much more than those of one do, mm: offsets and coordinates are rounded.
const ROUNDED_MM: f64 = 0.003;

const ROUND: Join = Join::Round { tolerance_mm: 0.02 };

/// What objects have in common.
pub(crate) struct Kinds {
    /// Objects with equal numbers have the same settings, but for their tool.
    alike: Vec<usize>,
    tools: Vec<ToolId>,
    /// The narrowest that is printed by itself of each object, millimetres.
    lines_mm: Vec<f64>,
    /// The narrowest bead of each object, millimetres.
    beads_mm: Vec<f64>,
}

impl Kinds {
    /// Those of so many objects.
    pub fn new(count: usize, styles: &Styles<'_>, settings: &Settings) -> Self {
        let style = |object: usize| styles.of_objects().get(object).copied().flatten();
        let tool = |object: usize| {
            let own = styles.settings(object, settings).tool_of.base();
            styles.tool(object).unwrap_or(own)
        };
        let tools = (0..count).map(tool).collect();
        let mut seen: Vec<(Option<usize>, Settings)> = Vec::new();
        let number = |object: usize| {
            if let Some(known) = seen.iter().position(|(known, _)| *known == style(object)) {
                return known;
            }
            let mut own = styles.settings(object, settings).for_toolpaths();
            own.tool_of.object = 1;
            // Where there is one tool, what has settings of its own is kept apart.
            let several = settings.tools.len() > 1;
            let like = seen.iter().position(|(_, other)| several && *other == own);
            seen.push((style(object), own));
            like.unwrap_or(seen.len() - 1)
        };
        let alike: Vec<usize> = (0..count).map(number).collect();
        let walls = |object: usize| &styles.settings(object, settings).walls;
        let lines_mm = (0..count).map(|object| walls(object).width.0).collect();
        let beads_mm = (0..count).map(|object| walls(object).min_width.0).collect();
        Self { alike, tools, lines_mm, beads_mm }
    }

    /// Whether two objects have the same settings, but for their tool.
    pub fn are_alike(&self, [a, b]: [usize; 2]) -> bool {
        self.alike[a] == self.alike[b]
    }

    /// Whether two objects have the same tool.
    pub fn share_tool(&self, [a, b]: [usize; 2]) -> bool {
        self.tools[a] == self.tools[b]
    }

    /// The pieces of a section that several objects of a layer became, of which `first` is each one's: the later ones take what
    /// they share.
    pub fn pieces(&self, layer: &Layer, united: &Section, first: &[usize]) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut taken = Region::default();
        for member in layer.sections.iter().rev().filter(|other| first[other.object] == united.object) {
            let region = geometry::difference(&member.region, &taken);
            taken = geometry::union(&taken, &member.region);
            add(&mut pieces, Piece { tool: self.tools[member.object], style: None, region });
        }
        // What another object has taken.
        pieces.iter_mut().for_each(|piece| {
            if !geometry::difference(&piece.region, &united.region).is_empty() {
                piece.region = geometry::intersection(&piece.region, &united.region);
            }
        });
        pieces
    }

    /// The parts of a section of a layer so high, of the pieces that it is made up of, after what is modified in it and what is
    /// painted on it.
    pub fn parts(
        &self,
        (section, height_mm): (&Section, f64),
        mut pieces: Vec<Piece>,
        modified: &[Modified],
        painted: &[Painted],
        styles: &Styles<'_>,
        settings: &Settings,
    ) -> Parts {
        if pieces.is_empty() && modified.is_empty() && painted.is_empty() {
            return Parts::new();
        }
        let own = self.tools[section.object];
        if pieces.is_empty() {
            pieces.push(Piece { tool: own, style: None, region: section.region.clone() });
        }
        for Modified { object, modifier, region } in modified {
            let changes = styles.changes(*object);
            lay_over(&mut pieces, region, |tool, style| changes.of(*modifier, tool, style));
        }
        for (tool, region) in painted {
            lay_over(&mut pieces, region, |_, style| (*tool, style));
        }
        let is_own = |piece: &Piece| piece.tool == own && piece.style.is_none();
        if pieces.iter().all(is_own) {
            return Parts::new();
        }
        slivers::give_away(&section.region, &mut pieces, self.lines_mm[section.object]);
        pieces.sort_by_key(|piece| (piece.tool, piece.style));
        if pieces.iter().all(is_own) {
            return Parts::new();
        }
        let mut parts = parts(pieces, section.object, styles, settings);
        if parts.len() > 1 {
            press(&mut parts, &section.region, height_mm, self.beads_mm[section.object]);
        }
        parts
    }
}

/// Lets the walls of parts press into each other where these meet, as walls of one part do: beads are narrower above and below.
/// Tips in which the narrowest bead has no room, which would be laid over what is beside them, are rounded off.
fn press(parts: &mut Parts, section: &Region, height_mm: f64, bead_mm: f64) {
    let each_mm = bead::rounding_mm(height_mm) / 2.0 + ROUNDED_MM;
    let radius_mm = bead_mm / 2.0;
    let narrow = geometry::difference(section, &geometry::opening(section, radius_mm));
    for part in parts {
        let pressed = geometry::intersection(&geometry::offset(&part.region, each_mm), section);
        let core = geometry::offset(&pressed, -radius_mm);
        let roomy = geometry::union(&geometry::offset_with(&core, radius_mm, ROUND), &narrow);
        let mut tips = geometry::difference(&pressed, &roomy);
        if !tips.is_empty() {
            // Corners that are the section's own lie beside nothing.
            let beside = geometry::offset(&geometry::difference(section, &part.region), each_mm);
            tips.retain(|tip| !geometry::intersection(&Region::from(tip.clone()), &beside).is_empty());
        }
        part.region = geometry::difference(&pressed, &tips);
    }
}

/// Gives what lies in a region another tool, or other settings.
fn lay_over(
    pieces: &mut Vec<Piece>,
    region: &Region,
    change: impl Fn(ToolId, Option<usize>) -> (ToolId, Option<usize>),
) {
    let mut changed = Vec::new();
    for piece in pieces.iter_mut() {
        let (tool, style) = change(piece.tool, piece.style);
        if (tool, style) == (piece.tool, piece.style) {
            continue;
        }
        let here = geometry::intersection(&piece.region, region);
        if !here.is_empty() {
            piece.region = geometry::difference(&piece.region, region);
            changed.push(Piece { tool, style, region: here });
        }
    }
    changed.into_iter().for_each(|piece| add(pieces, piece));
    pieces.retain(|piece| !piece.region.is_empty());
}

/// Adds a piece, unless it is nothing.
fn add(pieces: &mut Vec<Piece>, more: Piece) {
    let alike = |piece: &&mut Piece| (piece.tool, piece.style) == (more.tool, more.style);
    match pieces.iter_mut().find(alike) {
        _ if more.region.is_empty() => {}
        Some(piece) => piece.region = geometry::union(&piece.region, &more.region),
        None => pieces.push(more),
    }
}

/// Pieces by the walls around them: those of one tool share walls where the settings of these are the same.
fn parts(pieces: Vec<Piece>, object: usize, styles: &Styles<'_>, settings: &Settings) -> Parts {
    let walls = |style| {
        let Settings { walls, fuzzy, first_layer, .. } = styles.inside(object, style, settings);
        (walls, fuzzy, first_layer.width)
    };
    let mut parts = Parts::new();
    for Piece { tool, style, region } in pieces {
        let shares = |part: &&mut Part| part.tool == tool && walls(part.style) == walls(style);
        match parts.iter_mut().find(shares) {
            None => parts.push(Part { tool, region, fills: Vec::new(), style }),
            Some(part) => {
                if part.fills.is_empty() {
                    part.fills.push((part.style, part.region.clone()));
                }
                part.region = geometry::union(&part.region, &region);
                part.fills.push((style, region));
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Point, Polygon};

    fn polygon(corners: &[[f64; 2]]) -> Region {
        let outer = corners.iter().map(|&[x, y]| Point::from_mm(x, y)).collect();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    #[test]
    fn tips_are_rounded_off_only_beside_other_parts() {
        // The corner on the left, of 44°, is the section's, those of 68° on the right lie beside the other part.
        let wedge = polygon(&[[0.0, 0.0], [10.0, -4.0], [10.0, 4.0]]);
        let other = polygon(&[[10.0, -5.0], [20.0, -5.0], [20.0, 5.0], [10.0, 5.0]]);
        let section = geometry::union(&wedge, &other);
        let part = |(tool, region)| Part { tool, region, fills: Vec::new(), style: None };
        let mut parts: Parts = [(0, wedge), (1, other)].into_iter().map(part).collect();
        press(&mut parts, &section, 0.2, 0.45);
        let [wedge] = parts[0].region.polygons() else { panic!("{:?}", parts[0].region) };
        let bounds = wedge.bounds();
        assert!(bounds.min.mm()[0] < 0.001, "{bounds:?}");
        assert!(bounds.max.mm()[1] < 3.95, "{bounds:?}");
    }
}
