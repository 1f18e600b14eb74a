//! Beam lattices: struts and balls on the vertices of a mesh (3MF beam lattice extension 1.2).

use quick_xml::events::BytesStart;

use super::xml::value;

pub(super) const BEAMS: &str = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02";
pub(super) const BALLS: &str = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07";

/// A lattice, in the units of its vertices.
#[derive(Debug)]
pub(super) struct Lattice {
    radius: f64,
    cap: Cap,
    mode: BallMode,
    ball_radius: Option<f64>,
    pub beams: Vec<Beam>,
    /// Vertex and radius.
    pub balls: Vec<(u32, f64)>,
}

/// A frustum between two vertices.
#[derive(Debug)]
pub(super) struct Beam {
    pub ends: [u32; 2],
    pub radii: [f64; 2],
    pub caps: [Cap; 2],
}

/// How a beam ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cap {
    Sphere,
    Hemisphere,
    Butt,
}

/// Which ends of beams have balls.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BallMode {
    None,
    /// Those that are listed.
    Mixed,
    All,
}

impl Lattice {
    /// The lattice that a tag begins.
    ///
    /// # Errors
    /// A radius that is none, a mode that does not exist.
    pub fn new(tag: &BytesStart<'_>) -> Result<Self, String> {
        let mode = match foreign(tag, "ballmode").as_deref() {
            None | Some("none") => BallMode::None,
            Some("mixed") => BallMode::Mixed,
            Some("all") => BallMode::All,
            Some(other) => return Err(format!("`{other}` is no ballmode")),
        };
        let ball_radius = foreign(tag, "ballradius").map(|text| radius("ballradius", &text)).transpose()?;
        if mode == BallMode::All && ball_radius.is_none() {
            return Err("a beam lattice with balls at all vertices gives no ballradius".into());
        }
        let Some(radius) = length(tag, "radius")? else {
            return Err("a beam lattice gives no radius".into());
        };
        let cap = cap(tag, "cap")?.unwrap_or(Cap::Sphere);
        Ok(Self { radius, cap, mode, ball_radius, beams: Vec::new(), balls: Vec::new() })
    }

    /// Adds the beam of a tag, between two of this many vertices.
    ///
    /// # Errors
    /// A vertex that is not there, a radius that is none, a cap that does not exist.
    pub fn add_beam(&mut self, tag: &BytesStart<'_>, vertices: usize) -> Result<(), String> {
        let first = length(tag, "r1")?;
        let second = length(tag, "r2")?.or(first).unwrap_or(self.radius);
        let number = self.beams.len() + 1;
        self.beams.push(Beam {
            ends: [
                vertex(tag, "v1", "beam", number, vertices)?,
                vertex(tag, "v2", "beam", number, vertices)?,
            ],
            radii: [first.unwrap_or(self.radius), second],
            caps: [cap(tag, "cap1")?.unwrap_or(self.cap), cap(tag, "cap2")?.unwrap_or(self.cap)],
        });
        Ok(())
    }

    /// Adds the ball of a tag, on one of this many vertices.
    ///
    /// # Errors
    /// A vertex that is not there, no radius.
    pub fn add_ball(&mut self, tag: &BytesStart<'_>, vertices: usize) -> Result<(), String> {
        let number = self.balls.len() + 1;
        let at = vertex(tag, "vindex", "ball", number, vertices)?;
        let Some(radius) = length(tag, "r")?.or(self.ball_radius) else {
            return Err(format!("ball {number} has no radius"));
        };
        if self.mode != BallMode::None {
            self.balls.push((at, radius));
        }
        Ok(())
    }

    /// The balls that its mode puts on all ends of beams that have none, after the last tag.
    pub fn complete(&mut self) {
        let (BallMode::All, Some(radius)) = (self.mode, self.ball_radius) else { return };
        let mut bare: Vec<u32> = self.beams.iter().flat_map(|beam| beam.ends).collect();
        let mut given: Vec<u32> = self.balls.iter().map(|ball| ball.0).collect();
        given.sort_unstable();
        bare.sort_unstable();
        bare.dedup();
        bare.retain(|vertex| given.binary_search(vertex).is_err());
        self.balls.extend(bare.into_iter().map(|vertex| (vertex, radius)));
    }
}

/// How the lattice is cut off by another mesh, unless it is not.
pub(super) fn clipping(tag: &BytesStart<'_>) -> Option<String> {
    // Drafts of the extension called it `clipping`.
    value(tag, "clippingmode").or_else(|| value(tag, "clipping")).filter(|mode| mode != "none")
}

/// An attribute of the balls' own namespace, whatever its prefix.
fn foreign(tag: &BytesStart<'_>, key: &str) -> Option<String> {
    let mut keys = tag.attributes().flatten().map(|a| a.key.0.to_owned());
    let found = keys.find(|found| found.rsplit(':').next() == Some(key))?;
    value(tag, &found)
}

fn vertex(
    tag: &BytesStart<'_>,
    key: &str,
    what: &str,
    number: usize,
    vertices: usize,
) -> Result<u32, String> {
    let text = value(tag, key).unwrap_or_default();
    let index: u32 =
        text.trim().parse().map_err(|_| format!("{what} {number}: `{text}` is no valid {key}"))?;
    match (index as usize) < vertices {
        true => Ok(index),
        false => Err(format!(
            "{what} {number} names vertex {index}, but there are only {vertices} (counted from 0)"
        )),
    }
}

fn length(tag: &BytesStart<'_>, key: &str) -> Result<Option<f64>, String> {
    value(tag, key).map(|text| radius(key, &text)).transpose()
}

fn radius(key: &str, text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.trim().parse().ok();
    number.filter(|r| r.is_finite() && *r > 0.0).ok_or_else(|| format!("`{text}` is no valid {key}"))
}

fn cap(tag: &BytesStart<'_>, key: &str) -> Result<Option<Cap>, String> {
    match value(tag, key).as_deref() {
        None => Ok(None),
        Some("sphere") => Ok(Some(Cap::Sphere)),
        Some("hemisphere") => Ok(Some(Cap::Hemisphere)),
        Some("butt") => Ok(Some(Cap::Butt)),
        Some(other) => Err(format!("`{other}` is no valid {key}")),
    }
}
