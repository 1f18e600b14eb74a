//! Which tool prints which part of a section, as it is painted on the surface.
//!
//! Each place of a section has what is painted where its outline is nearest (as in PrusaSlicer, by Voronoi cells), unless it is
//! under a top surface or over a bottom surface within the shell's thickness: then it has what is painted there.

use std::collections::BTreeMap;

use crate::parallel::Workers;
use crate::plate::{self, Plate};
use crate::profile::Settings;
use crate::slice::{self, Layer, PaintedArea, PaintedLine};
use crate::toolpath::{ToolId, shell_depth};
use geometry::{Point, Region, Ring, difference, intersection, offset, opening, union, unite_rings};
use ordering::matching::KdTree;

use super::parts::Painted as PaintedPart;
use super::piece::Piece;
use super::rounded::{self, Radii};

/// What is painted is looked at so often along outlines, mm.
const STEP_MM: f64 = 0.2;

/// An outline differs from the mesh by less than this, mm.
const TOLERANCE_MM: f64 = 0.1;

/// What is painted is at least twice this wide, in line widths: more than a half, so that lines have room.
const NARROW: f64 = 0.55;

/// Corners of painted regions are this round, in line widths: inner walls turn in them, too.
const ROUND: f64 = 1.0;

/// What is larger is a stroke and no corner, or a dot where it is apart, in line widths squared.
const STROKE: f64 = 4.0;
const DOT: f64 = 2.0;

/// Not painted.
const BARE: u8 = 0;

/// Regions by tool, counted from 1; [`BARE`] has the rest.
type Painted = BTreeMap<u8, Region>;

/// What the regions depend on.
#[derive(Clone, Copy, Debug)]
struct Spec {
    /// Lines are so wide.
    line_mm: f64,
    /// Walls together are so wide.
    walls_mm: f64,
    /// What is painted reaches so far inside of outlines; 0: to the middle.
    depth_mm: f64,
    /// Outlines may differ from the mesh by so much more.
    moved_mm: f64,
}

/// For each layer the painted parts of all objects, which do not overlap; empty if none is painted. Parts of tools that there are
/// not are left out.
pub(super) fn parts(
    layers: &[Layer],
    plate: &Plate,
    settings: &Settings,
    workers: Workers<'_>,
) -> Vec<Vec<PaintedPart>> {
    let count = settings.tools.len() as u8;
    let is_painted = |object: &usize| !plate.meshes[plate.objects[*object].mesh].paint().tools.is_empty();
    let objects: Vec<usize> = (0..plate.objects.len()).filter(is_painted).collect();
    if count < 2 || objects.is_empty() {
        return Vec::new();
    }
    let mut all = vec![Vec::new(); layers.len()];
    for object in objects {
        let of_object = Object::new(layers, plate, object, settings);
        let exposed = workers.map(layers.len(), |i| of_object.exposed(i));
        let painted = workers.map(layers.len(), |i| of_object.painted(i, &exposed));
        for (parts, painted) in all.iter_mut().zip(painted) {
            let printed =
                painted.into_iter().filter(|(tool, region)| (1..=count).contains(tool) && !region.is_empty());
            parts.extend(printed.map(|(tool, region)| ((tool - 1) as ToolId, region)));
        }
    }
    all
}

/// What the user should know of tools that are painted, but that the printer does not have.
pub(super) fn note(plate: &Plate, settings: &Settings) -> Option<String> {
    let count = settings.tools.len().max(1);
    let most = |object: &plate::Object| {
        let tools = plate.meshes[object.mesh].paint().tools.iter();
        tools.map(|facet| usize::from(facet.paint)).max()
    };
    let (most, object) =
        plate.objects.iter().filter_map(|o| Some((most(o)?, o))).max_by_key(|(most, _)| *most)?;
    let name = &object.name;
    (most > count).then(|| {
        let has = if count == 1 { "one tool".to_owned() } else { format!("{count} tools") };
        format!("{name} is painted with tool {most}, but the printer has {has}; there it is printed as if it were not painted")
    })
}

/// Surfaces of a layer that are seen from above and from below, by what is painted on them.
#[derive(Default)]
struct Exposed {
    tops: Painted,
    bottoms: Painted,
}

/// A painted object.
struct Object<'a> {
    sections: Vec<&'a Region>,
    /// Where tools are painted on the outline of each layer.
    lines: Vec<Vec<&'a PaintedLine<u8>>>,
    /// Level surfaces below each layer's cut, and one more above the last.
    level: Vec<Vec<PaintedArea<u8>>>,
    at: Point,
    heights_mm: Vec<f64>,
    settings: &'a Settings,
    spec: Spec,
}

impl<'a> Object<'a> {
    fn new(layers: &'a [Layer], plate: &'a Plate, object: usize, settings: &'a Settings) -> Self {
        let section = |layer: &'a Layer| {
            let section = layer.sections.iter().find(|section| section.object == object);
            section.map_or(Region::EMPTY, |section| &section.region)
        };
        let lines = |layer: &'a Layer| layer.tools.iter().filter(|line| line.object == object).collect();
        let cuts_mm: Vec<f64> = layers.iter().map(|layer| layer.span.cut_mm).collect();
        let line_mm = settings.walls.width.0;
        let spec = Spec {
            line_mm,
            walls_mm: line_mm * f64::from(settings.walls.count.max(1)),
            depth_mm: settings.tool_of.paint_depth.0,
            moved_mm: settings.layer.xy_compensation.0.abs(),
        };
        let placed = &plate.objects[object];
        Self {
            sections: layers.iter().map(section).collect(),
            lines: layers.iter().map(lines).collect(),
            level: slice::level_paint(&plate.meshes[placed.mesh].paint().tools, &cuts_mm),
            at: placed.offset,
            heights_mm: layers.iter().map(|layer| layer.span.height_mm).collect(),
            settings,
            spec,
        }
    }

    fn section(&self, layer: Option<usize>) -> &Region {
        layer.and_then(|layer| self.sections.get(layer).copied()).unwrap_or(Region::EMPTY)
    }

    /// The surfaces of a layer that are wide enough for a line.
    fn exposed(&self, i: usize) -> Exposed {
        let own = self.section(Some(i));
        let facing = |other: &Region, level: &[PaintedArea<u8>]| {
            // Most of what is left of other layers is narrower than a line.
            let bare = difference(own, other);
            let surface = intersection(&opening(&bare, self.spec.line_mm / 2.0), &bare);
            if surface.is_empty() {
                return Painted::new();
            }
            let mut rings: BTreeMap<u8, Vec<Ring>> = BTreeMap::new();
            for area in level {
                rings.entry(area.paint).or_default().push(area.ring.clone());
            }
            let mut left = surface;
            let mut found = Painted::new();
            for (tool, rings) in rings {
                let painted = unite_rings(&rings).translated(self.at);
                let here = intersection(&left, &painted);
                left = difference(&left, &painted);
                found.insert(tool, here);
            }
            found.insert(BARE, left);
            found
        };
        Exposed {
            tops: facing(self.section(Some(i + 1)), &self.level[i + 1]),
            bottoms: facing(self.section(i.checked_sub(1)), &self.level[i]),
        }
    }

    /// What each tool prints of a layer.
    fn painted(&self, i: usize, exposed: &[Exposed]) -> Painted {
        let section = self.section(Some(i));
        let shell = &self.settings.shell;
        let thickness_mm = shell.min_thickness.0;
        let above = self.heights_mm[i + 1..].iter().copied();
        let below = self.heights_mm[..i].iter().rev().copied();
        let last = i + shell_depth(above, shell.top_layers, thickness_mm).saturating_sub(1);
        let first = i.saturating_sub(shell_depth(below, shell.bottom_layers, thickness_mm).saturating_sub(1));
        let tops = (i..=last).filter_map(|k| Some((k - i, &exposed.get(k)?.tops)));
        let bottoms = (first..=i).map(|k| (i - k, &exposed[k].bottoms));
        let mut surfaces: Vec<(usize, &Painted)> =
            tops.chain(bottoms).filter(|(_, surface)| !surface.is_empty()).collect();
        if self.lines[i].is_empty()
            && surfaces.iter().all(|(_, surface)| surface.keys().all(|tool| *tool == BARE))
        {
            return Painted::new();
        }
        // The nearest surface says what is printed.
        surfaces.sort_by_key(|(distance, _)| *distance);
        let inside = offset(section, -self.spec.walls_mm);
        let mut left = section.clone();
        let mut found = Painted::new();
        for (distance, surface) in surfaces {
            for (&tool, region) in surface {
                let reach = if distance == 0 { &left } else { &intersection(&left, &inside) };
                let here = intersection(reach, region);
                if !here.is_empty() {
                    left = difference(&left, &here);
                    add(&mut found, tool, &here);
                }
            }
        }
        let by_outline = by_outline(section, &self.lines[i], self.spec);
        for (tool, region) in by_outline {
            let here = intersection(&left, &region);
            left = difference(&left, &here);
            add(&mut found, tool, &here);
        }
        found.remove(&BARE);
        rounded(section, found, self.spec.line_mm)
    }
}

/// Painted regions of a section, and what is not painted, with corners that a line can follow.
fn rounded(section: &Region, found: Painted, line_mm: f64) -> Painted {
    let bare = found.values().fold(section.clone(), |left, region| difference(&left, region));
    let all = found.into_iter().chain([(BARE, bare)]);
    let mut pieces: Vec<Piece> = all.map(|(tool, region)| Piece { tool, style: None, region }).collect();
    pieces.retain(|piece| !piece.region.is_empty());
    let radii = Radii {
        narrow_mm: NARROW * line_mm,
        corner_mm: ROUND * line_mm,
        stroke_mm2: STROKE * line_mm * line_mm,
        dot_mm2: DOT * line_mm * line_mm,
    };
    rounded::round(section, &mut pieces, radii);
    let painted = pieces.into_iter().filter(|piece| piece.tool != ToolId::from(BARE));
    painted.map(|piece| (piece.tool, piece.region)).collect()
}

fn add(painted: &mut Painted, tool: u8, region: &Region) {
    let known = painted.entry(tool).or_default();
    *known = union(known, region);
}

/// A section by what is painted on the nearest piece of its outline, as far inside as that reaches; the rest is not painted.
fn by_outline(section: &Region, lines: &[&PaintedLine<u8>], spec: Spec) -> Painted {
    if lines.is_empty() {
        return Painted::new();
    }
    let mut points = Vec::new();
    let mut tools = Vec::new();
    for line in lines {
        points.extend(along(line.ends[0], line.ends[1], STEP_MM / 2.0));
        tools.resize(points.len(), line.paint);
    }
    let tree = KdTree::new(&points);
    let tolerance_mm = TOLERANCE_MM + spec.moved_mm;
    let tool = |p: Point| {
        let (_, nearest) = tree.nearest(&points, p)?;
        (points[nearest as usize].distance_mm(p) <= tolerance_mm).then(|| tools[nearest as usize])
    };
    let mut sites = Vec::new();
    for ring in section.rings() {
        let edges = (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()]));
        // Corners are shared by two edges, which may be painted differently.
        let places: Vec<Point> = edges.flat_map(|(a, b)| along(a, b, STEP_MM)).collect();
        let mut found: Vec<u8> = places.iter().map(|&p| tool(p).unwrap_or(BARE)).collect();
        merge_short(&mut found, (spec.line_mm / STEP_MM).ceil() as usize);
        sites.extend(places.into_iter().zip(found));
    }
    let painted = geometry::nearest_kinds(&sites).into_iter().filter(|(tool, _)| *tool != BARE);
    if spec.depth_mm == 0.0 {
        return painted.collect();
    }
    let band = difference(section, &offset(section, -spec.depth_mm));
    painted.map(|(tool, region)| (tool, intersection(&region, &band))).collect()
}

/// Places between two points, at equal distances, each in the middle of its part.
fn along(a: Point, b: Point, step_mm: f64) -> impl Iterator<Item = Point> {
    let parts = (a.distance_mm(b) / step_mm).ceil().max(1.0);
    (0..parts as u32).map(move |part| a.towards(b, (f64::from(part) + 0.5) / parts))
}

/// Gives stretches of a ring that have fewer places than this what is before them.
fn merge_short(kinds: &mut [u8], least: usize) {
    let Some(first) = (1..kinds.len()).find(|&k| kinds[k] != kinds[k - 1]) else { return };
    kinds.rotate_left(first);
    let runs: Vec<usize> = kinds.chunk_by(|a, b| a == b).map(<[u8]>::len).collect();
    let (mut from, mut before) = (0, kinds[kinds.len() - 1]);
    for length in runs {
        if length < least {
            kinds[from..from + length].fill(before);
        }
        before = kinds[from];
        from += length;
    }
    kinds.rotate_right(first);
}

#[cfg(test)]
mod tests {
    use super::super::slivers;
    use super::*;
    use proptest::prelude::*;

    const LINE_MM: f64 = 0.45;

    fn ring(corners: &[(f64, f64)]) -> Ring {
        corners.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
    }

    /// A ring of so many corners about the origin, at these distances from it, with the tool painted on each side.
    fn star(radii: &[f64]) -> Ring {
        let corner = |(k, radius): (usize, &f64)| {
            let (sine, cosine) =
                geometry::real::sin_cos(k as f64 / radii.len() as f64 * std::f64::consts::TAU);
            (radius * cosine, radius * sine)
        };
        ring(&radii.iter().enumerate().map(corner).collect::<Vec<_>>())
    }

    fn painted(ring: &Ring, tools: &[u8], depth_mm: f64) -> (Region, Vec<Piece>) {
        let section = unite_rings(std::slice::from_ref(ring));
        let lines: Vec<PaintedLine<u8>> = (0..ring.len())
            .filter(|&k| tools[k % tools.len()] != BARE)
            .map(|k| PaintedLine {
                object: 0,
                ends: [ring[k], ring[(k + 1) % ring.len()]],
                paint: tools[k % tools.len()],
            })
            .collect();
        let spec = Spec { line_mm: LINE_MM, walls_mm: 0.9, depth_mm, moved_mm: 0.0 };
        let found = by_outline(&section, &lines.iter().collect::<Vec<_>>(), spec);
        let mut left = section.clone();
        let mut apart = Painted::new();
        for (tool, region) in found {
            apart.insert(tool, intersection(&left, &region));
            left = difference(&left, &region);
        }
        let found = rounded(&section, apart, LINE_MM);
        let bare = found.values().fold(section.clone(), |left, region| difference(&left, region));
        let mut pieces: Vec<Piece> = found
            .into_iter()
            .chain([(BARE, bare)])
            .map(|(tool, region)| Piece { tool, style: None, region })
            .collect();
        slivers::give_away(&section, &mut pieces, LINE_MM);
        (section, pieces)
    }

    fn of_tool(pieces: &[Piece], tool: ToolId) -> Region {
        pieces.iter().find(|piece| piece.tool == tool).map(|piece| piece.region.clone()).unwrap_or_default()
    }

    #[test]
    fn sides_of_a_square_reach_to_its_middle_or_as_deep_as_is_wanted() {
        let square = ring(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        let (_, found) = painted(&square, &[1, 2, 0, 0], 0.0);
        for tool in [1, 2] {
            let area_mm2 = of_tool(&found, tool).area_mm2();
            assert!((area_mm2 - 100.0).abs() < 2.0, "{area_mm2}");
        }
        let (one, two) = (of_tool(&found, 1), of_tool(&found, 2));
        assert!(one.contains(Point::from_mm(10.0, 9.0)) && two.contains(Point::from_mm(11.0, 10.0)));
        let (_, found) = painted(&square, &[1, 2, 0, 0], 1.0);
        let one = of_tool(&found, 1);
        assert!((one.area_mm2() - 19.0).abs() < 0.5, "{}", one.area_mm2());
        assert!(!one.contains(Point::from_mm(10.0, 1.1)));
    }

    #[test]
    fn stretches_shorter_than_a_line_go_to_what_is_before_them() {
        let mut kinds = [1, 1, 1, 2, 1, 1, 3, 3, 3, 1];
        merge_short(&mut kinds, 2);
        assert_eq!(kinds, [1, 1, 1, 1, 1, 1, 3, 3, 3, 1]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn painted_pieces_make_up_the_section_do_not_overlap_and_have_no_slivers(
            radii in proptest::collection::vec(4.0..12.0f64, 3..24),
            tools in proptest::collection::vec(0..4u8, 1..24),
            depth_mm in prop_oneof![Just(0.0), 0.9..3.0f64],
        ) {
            let (section, pieces) = painted(&star(&radii), &tools, depth_mm);
            slivers::tests::is_sound(&section, &pieces, LINE_MM)?;
            prop_assert_eq!(pieces, painted(&star(&radii), &tools, depth_mm).1);
        }
    }
}
