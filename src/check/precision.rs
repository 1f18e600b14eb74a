//! Whether numbers are written finely enough.

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};

/// Fewer beads say nothing about how numbers are written.
const ENOUGH_BEADS: usize = 100;
/// Decimals of X and Y, and of E, that a file should have somewhere: zeros at the end may be left out.
const DECIMALS: [usize; 2] = [2, 3];
/// Firmwares keep E in 32 bits: from here on its steps are larger than 0.005 mm.
const COARSE_E: f64 = 65_536.0;

/// Checks the precision and magnitude of numbers.
#[derive(Default)]
pub(super) struct Precision {
    beads: usize,
    /// Most decimals so far, of X and Y, and of E.
    decimals: [usize; 2],
    first: Option<(usize, Option<usize>)>,
    coarse: bool,
}

impl Rule for Precision {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        if seen.bead().is_none() {
            return;
        }
        self.beads += 1;
        self.first.get_or_insert((seen.line.number, seen.context.layer));
        if seen.state.e_absolute
            && seen.state.e.abs() > COARSE_E
            && !std::mem::replace(&mut self.coarse, true)
        {
            seen.fault(found, Kind::CoarseAmounts, || format!("E{:.3}; reset it with G92 E0", seen.state.e));
        }
        if self.decimals.iter().zip(DECIMALS).any(|(most, enough)| *most < enough) {
            self.count(seen.line.parameters());
        }
    }

    fn end(&mut self, found: &mut Found) {
        let Some((line, layer)) = self.first.filter(|_| self.beads >= ENOUGH_BEADS) else { return };
        for (what, (most, enough)) in
            ["X and Y", "E"].into_iter().zip(self.decimals.into_iter().zip(DECIMALS))
        {
            if most < enough {
                found.add(Kind::FewDecimals, line, layer, || format!("{what} have no more than {most}"));
            }
        }
    }
}

impl Precision {
    fn count(&mut self, text: &[u8]) {
        let mut kind = None;
        let mut point = None;
        for (at, &byte) in text.iter().enumerate() {
            match byte.to_ascii_uppercase() {
                b'X' | b'Y' => (kind, point) = (Some(0), None),
                b'E' => (kind, point) = (Some(1), None),
                b'.' => point = Some(at),
                b'0'..=b'9' => {
                    if let (Some(kind), Some(point)) = (kind, point) {
                        self.decimals[kind] = self.decimals[kind].max(at - point);
                    }
                }
                _ => (kind, point) = (None, None),
            }
        }
    }
}
