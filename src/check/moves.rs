//! A layer by its moves: what its text says, for half the work.

use memchr::memchr_iter;

use super::Checker;
use crate::gcode::{Center, lines};
use crate::motion::{LayerMoves, Move};
use crate::units::MmPerS;

/// Moves shorter than this are not written; the next one gets their filament.
const SHORTEST_MM: f64 = 5e-4;

/// Whether moves say all that a layer's text does.
fn is_plain(step: &Move) -> bool {
    use Move::{
        Acceleration, Arc, Bead, Bed, Climb, Extrude, Fan, Lift, Nozzle, Ramp, Retract, Travel, Unretract,
        Wipe,
    };
    matches!(
        step,
        Bead { .. }
            | Travel { .. }
            | Climb { .. }
            | Lift { .. }
            | Extrude { .. }
            | Ramp { .. }
            | Arc { .. }
            | Retract { .. }
            | Unretract { .. }
            | Wipe { .. }
            | Fan(_)
            | Acceleration(_)
            | Nozzle(_)
            | Bed(_)
    )
}

impl Checker {
    /// Takes a layer by its moves, which are those of its text, with retraction by E; of the text only the comments that it begins
    /// with are read. Nothing is done, and `false` returned, where there is more in the layer: objects that begin, changes, pauses.
    pub(crate) fn layer(&mut self, layer: &LayerMoves, text: &[u8], filament_area_mm2: f64) -> bool {
        if self.finder.in_script || !layer.moves.iter().all(is_plain) {
            return false;
        }
        let begin = self.bytes;
        for line in lines(text).take_while(|line| line.code.is_none()) {
            self.line(line.placed(self.lines + 1, self.bytes));
        }
        let rest = &text[self.bytes - begin..];
        if self.reader.state.e_absolute {
            // Every layer begins so.
            self.reader.state.e = 0.0;
        }
        let mut waiting_mm3 = 0.0;
        for step in &layer.moves {
            let [x, y, z] = self.reader.state.position;
            match *step {
                Move::Bead { role, width_mm, height_mm } => {
                    self.reader.begin_beads(role, width_mm, height_mm)
                }
                Move::Travel { to: [x, y], speed } => self.make([x, y, z], None, 0.0, speed),
                Move::Climb { to: [x, y], z_mm, speed } => self.make([x, y, z_mm], None, 0.0, speed),
                Move::Lift { z_mm, speed } => self.make([x, y, z_mm], None, 0.0, speed),
                Move::Wipe { to: [x, y], length_mm, speed } => self.make([x, y, z], None, -length_mm, speed),
                Move::Retract { length_mm, speed } => self.make([x, y, z], None, -length_mm, speed),
                Move::Unretract { length_mm, speed } => self.make([x, y, z], None, length_mm, speed),
                Move::Extrude { to, volume, speed }
                | Move::Ramp { to, volume, speed, .. }
                | Move::Arc { to, volume, speed, .. } => {
                    waiting_mm3 += volume.0;
                    let (z_mm, arc) = match *step {
                        Move::Ramp { z_mm, .. } => (z_mm, None),
                        Move::Arc { center: at, clockwise, .. } => (z, Some(Center { at, clockwise })),
                        _ => (z, None),
                    };
                    let is_short = (to[0] - x).abs().max((to[1] - y).abs()) < SHORTEST_MM && arc.is_none();
                    if !is_short {
                        let e_mm = std::mem::take(&mut waiting_mm3) / filament_area_mm2;
                        self.make([to[0], to[1], z_mm], arc, e_mm, speed);
                    }
                }
                _ => {}
            }
        }
        self.lines += memchr_iter(b'\n', rest).count();
        self.bytes += rest.len();
        true
    }

    fn make(&mut self, to: [f64; 3], arc: Option<Center>, e_mm: f64, speed: MmPerS) {
        let state = &mut self.reader.state;
        state.feed_mm_s = speed.0;
        state.e += e_mm;
        let offset_mm = self.finder.offset_mm;
        let to = [to[0] - offset_mm[0], to[1] - offset_mm[1], to[2]];
        let stroke = state.make(to, arc, e_mm);
        let mut read = self.reader.take(stroke);
        read.line = read.line.placed(self.lines, self.bytes);
        self.finder.judge(&mut read, &self.reader.state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{FaultFinder, Kind};
    use crate::gcode::{PrintFacts, Scripts, WriterSettings, format_layer};
    use crate::motion::Entry;
    use crate::profile::Settings;
    use crate::toolpath::Role;
    use crate::units::{Mm3, Mm3PerS};

    const SPEED: MmPerS = MmPerS(50.0);

    fn square(z_mm: f64, more: &[Move]) -> LayerMoves {
        let bead = |to| Move::Extrude { to, volume: Mm3(0.9), speed: SPEED };
        let opening = [
            Move::Lift { z_mm, speed: SPEED },
            Move::Travel { to: [100.0, 100.0], speed: SPEED },
            Move::Bead { role: Role::Perimeter, width_mm: 0.45, height_mm: 0.2 },
        ];
        let beads =
            [[110.0, 100.0], [110.0, 110.0], [110.0, 110.0001], [100.0, 110.0], [100.0, 100.0]].map(bead);
        let moves = opening.into_iter().chain(beads).chain(more.iter().cloned()).collect();
        let index = (z_mm / 0.2).round() as usize - 1;
        LayerMoves { index, z_mm, height_mm: 0.2, from: Entry::default(), moves }
    }

    /// The kinds of faults in some layers, where the nozzle is then, how far the filament is back, and how many lines there are.
    fn judged(
        layers: &[LayerMoves],
        relative_e: bool,
        by_moves: impl Fn(usize) -> bool,
    ) -> (Vec<Kind>, [i64; 3], i64, usize) {
        let mut settings = Settings::default();
        settings.filament.max_flow = Mm3PerS(12.0);
        settings.gcode.relative_e = relative_e;
        let scripts = Scripts::new(&settings, &PrintFacts::default()).expect("no mistakes");
        let writer = WriterSettings::new(&settings, &scripts, true);
        let mut checker = Checker::with(FaultFinder::of_paths(&settings, false));
        checker.text(if relative_e { b"G90\nM83\nG28\n" } else { b"G90\nM82\nG28\n" });
        for (index, layer) in layers.iter().enumerate() {
            let text = format_layer(layer, &writer).bytes;
            if by_moves(index) {
                assert!(checker.layer(layer, &text, settings.filament.area_mm2()));
            } else {
                checker.text(&text);
            }
        }
        let state = &checker.reader.state;
        let um = |mm: f64| (mm * 1e3).round() as i64;
        let (at, back, lines) = (state.position.map(um), um(state.retracted_mm), checker.lines);
        (checker.finish().into_faults().iter().map(|fault| fault.kind).collect(), at, back, lines)
    }

    #[test]
    fn moves_are_judged_as_their_text_is() {
        let back = Move::Retract { length_mm: 0.8, speed: SPEED };
        let far = Move::Travel { to: [300.0, 100.0], speed: SPEED };
        let bead = Move::Extrude { to: [105.0, 105.0], volume: Mm3(0.4), speed: SPEED };
        let through =
            [Move::Lift { z_mm: 0.2, speed: SPEED }, Move::Travel { to: [110.0, 110.0], speed: SPEED }];
        let more = Move::Unretract { length_mm: 2.0, speed: SPEED };
        let fast = Move::Extrude { to: [140.0, 105.0], volume: Mm3(40.0), speed: SPEED };
        let ramp = Move::Ramp { to: [110.0, 110.0], z_mm: 0.7, volume: Mm3(0.4), speed: SPEED };
        let arc = Move::Arc {
            to: [120.0, 100.0],
            center: [110.0, 100.0],
            clockwise: false,
            volume: Mm3(1.0),
            speed: SPEED,
        };
        let wipe = Move::Wipe { to: [105.0, 100.0], length_mm: 0.8, speed: SPEED };
        let cases: [(&[Move], &[Kind]); 8] = [
            (&[], &[]),
            (&[wipe, far.clone()], &[Kind::OutsideBed]),
            (&[back, bead.clone()], &[Kind::RetractedExtrusion]),
            (&through, &[Kind::ThroughPrint]),
            (&[more], &[Kind::ExtrusionInPlace]),
            (&[fast], &[Kind::Flow]),
            (&[ramp, arc], &[]),
            (&[Move::Lift { z_mm: 0.0, speed: SPEED }, bead], &[Kind::BelowBed]),
        ];
        for (moves, wanted) in cases {
            let layers = [square(0.2, &[]), square(0.4, moves), square(0.6, &[])];
            for relative_e in [true, false] {
                let by_text = judged(&layers, relative_e, |_| false);
                assert!(wanted.iter().all(|kind| by_text.0.contains(kind)), "{moves:?}: {by_text:?}");
                assert_eq!(judged(&layers, relative_e, |_| true), by_text, "{moves:?}");
                assert_eq!(
                    judged(&layers, relative_e, |index| index == 1),
                    by_text,
                    "{moves:?}, then text again"
                );
            }
        }
    }
}
