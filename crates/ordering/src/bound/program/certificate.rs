//! A bound with all that it follows from, for others to check.

use super::super::model::Model;
use super::super::relaxation::{Multipliers, Neighbour, Relaxation};
use crate::Scope;
use pathwright_geometry::Point;

/// A bound of a layer without precedence, and the multipliers that it follows from; costs in sixteenths of a grid unit.
///
/// The bound is the cheapest tree of links between paths, with the cheapest link in and out, less what every walk pays:
/// `docs/ordering-bounds.md`. `examples/check_certificate.py` does the sum.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Certificate {
    /// What the links of no order can cost less than.
    pub bound: i64,
    /// Where walks come from and go to, in grid units, if that is known.
    pub ends: [Option<[i32; 2]>; 2],
    /// Whether each path is a loop, which is entered in one of its terminals.
    pub closed: Vec<bool>,
    /// Path of each terminal: an end of an open path, or a piece of a loop.
    pub path: Vec<u32>,
    /// Points of each terminal, in grid units.
    pub points: Vec<Vec<[i32; 2]>>,
    /// What a link pays at each terminal.
    pub nodes: Vec<i64>,
    /// Sets that a walk must leave.
    pub cuts: Vec<Cut>,
    /// Prices of links from a neighbour to a terminal.
    pub ties: Vec<Tie>,
}

/// A set of terminals that a walk leaves at least so many times; if there is a guard, only if this loop is entered in the set.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[expect(missing_docs, reason = "they are named above")]
pub struct Cut {
    pub members: Vec<u32>,
    pub least: i32,
    pub guard: Option<u32>,
    pub price: i64,
}

/// The price of links from one neighbour to a terminal of a loop that is not entered there.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[expect(missing_docs, reason = "they are named above")]
pub struct Tie {
    pub terminal: u32,
    /// A path; what comes before the layer: the number of paths; what comes after it: one more.
    pub neighbour: u32,
    pub price: i64,
}

impl Certificate {
    /// `None` where precedence orders paths.
    pub(super) fn new(
        relaxation: &Relaxation,
        multipliers: &Multipliers,
        bound: i64,
        ends: [Option<Point>; 2],
    ) -> Option<Self> {
        let model: &Model = relaxation.model;
        if model.scope != Scope::Layer || model.stages() > 1 {
            return None;
        }
        let (terminals, paths) = (model.terminals.len() as u32, model.bodies.len() as u32);
        let cuts = multipliers.cuts.iter().enumerate().filter(|(_, price)| **price > 0);
        let cuts = cuts.map(|(cut, &price)| Cut {
            members: relaxation.cuts.members[cut].clone(),
            least: relaxation.cuts.least[cut],
            guard: relaxation.cuts.guard[cut],
            price,
        });
        let ties =
            relaxation.neighbours().into_iter().zip(&multipliers.ties).filter(|(_, price)| **price > 0);
        let ties = ties.filter_map(|(tie, &price)| {
            let (terminal, neighbour) = tie?;
            let neighbour = match neighbour {
                Neighbour::Path(path) => path,
                Neighbour::Beyond(side) => paths + side as u32,
            };
            Some(Tie { terminal, neighbour, price })
        });
        let at = |p: &Point| [p.x, p.y];
        Some(Self {
            bound,
            ends: ends.map(|end| end.as_ref().map(at)),
            closed: model.bodies.iter().map(|body| body.closed).collect(),
            path: model.terminals.iter().map(|terminal| terminal.item).collect(),
            points: (0..terminals).map(|t| model.points_of(t).iter().map(at).collect()).collect(),
            nodes: multipliers.nodes.clone(),
            cuts: cuts.collect(),
            ties: ties.collect(),
        })
    }
}
