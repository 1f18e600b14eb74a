//! What can be wrong with a file, and how bad it is.

use serde::Serialize;

/// The severity of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The print may suffer, or the firmware will do something else than the file says.
    Warning,
    /// The print fails, or the machine is harmed.
    Error,
}

impl Severity {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

macro_rules! kinds {
    ($($kind:ident, $severity:ident, $name:literal, $text:literal;)*) => {
        /// A kind of fault.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Kind { $(#[doc = $text] $kind,)* }

        impl Kind {
            /// Every kind, in the order of reports.
            pub const ALL: &'static [Kind] = &[$(Kind::$kind,)*];

            /// Its name in reports; it does not change.
            pub fn name(self) -> &'static str {
                match self { $(Kind::$kind => $name,)* }
            }

            /// How bad it is.
            pub fn severity(self) -> Severity {
                match self { $(Kind::$kind => Severity::$severity,)* }
            }

            /// What it means, in words.
            pub fn text(self) -> &'static str {
                match self { $(Kind::$kind => $text,)* }
            }
        }
    };
}

kinds! {
    NotANumber, Error, "not-a-number", "a value is not a number";
    Malformed, Error, "malformed", "a command cannot be read";
    Exponent, Error, "exponent", "a number with an exponent, which firmware reads as E";
    BadFeedRate, Error, "bad-feed-rate", "a feed rate that is not positive";
    OutsideBed, Error, "outside-bed", "a move outside of the printable volume";
    BelowBed, Error, "below-bed", "the nozzle at or below the bed";
    ThroughPrint, Error, "through-print", "a move through what has been printed";
    UnknownTool, Error, "unknown-tool", "a tool that the printer does not have";
    HeightOrder, Error, "height-order", "printing below a finished layer";
    ColdExtrusion, Error, "cold-extrusion", "extrusion while the nozzle is cold";
    RetractedExtrusion, Error, "retracted-extrusion", "a bead starts while the filament is retracted";
    ExtrusionInPlace, Error, "extrusion-in-place", "filament is extruded without moving";
    Flow, Error, "flow", "more flow than the hot end melts";
    StartsInAir, Error, "starts-in-air", "the print begins, or goes on, where nothing is beneath";
    MissingIsland, Error, "missing-island", "an island of the model is not printed";
    ExtraMaterial, Error, "extra-material", "material outside of the model";
    NotPlaced, Error, "not-placed", "a model is not found in the print";
    OverVolume, Error, "over-volume", "more material than the model has volume";
    UnbalancedRetraction, Warning, "unbalanced-retraction", "unretraction and retraction differ in length";
    UnretractedChange, Warning, "unretracted-change", "a change of tool without a retraction";
    MissingFlush, Warning, "missing-flush", "the part goes on after a change of tool before the flush that the file speaks of";
    UnprimedTool, Warning, "unprimed-tool", "a tool was not primed before the part began, though the file says that all are";
    OutsideAtStart, Warning, "outside-at-start", "a move outside of the printable volume before the print";
    OutsideInScript, Warning, "outside-in-script", "a script moves outside of the printable volume";
    HeaterLeftOn, Warning, "heater-left-on", "a heater is left on at the end";
    NotAwaited, Warning, "not-awaited", "nothing waits for the nozzle to be hot";
    UnknownCommand, Warning, "unknown-command", "a command that no common firmware knows";
    Speed, Warning, "speed", "faster than the machine; the firmware slows it down";
    Acceleration, Warning, "acceleration", "more acceleration than the machine has";
    FewDecimals, Warning, "few-decimals", "numbers have too few decimals";
    CoarseAmounts, Warning, "coarse-amounts", "E has grown so large that firmware rounds it";
    FloatingIsland, Warning, "floating-island", "an island begins in mid-air";
    OverAir, Warning, "over-air", "a bead over air that is held at one end or at none";
    NoTemperature, Note, "no-temperature", "the file itself does not heat the nozzle";
}

impl Kind {
    /// Whether it can lie in how beads and travels are laid. Other faults come from scripts and settings, which are
    /// the user's.
    pub fn is_of_paths(self) -> bool {
        self.severity() == Severity::Error
            && !matches!(self, Kind::ColdExtrusion | Kind::StartsInAir | Kind::UnknownTool)
    }
}
