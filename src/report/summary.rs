//! What a run made: as text, and as JSON with the keys that every command shares.

use std::fmt;
use std::ops::AddAssign;

use serde::Serialize;

use super::repairs::Repaired;
use crate::gcode::Measure;
use crate::order::compare::{Proved, gap};
use crate::units::Seconds;

/// Lengths, counts and times of a layer or a whole print. Lengths are in X and Y and count what comes after the first
/// extruding move; `travel_mm` is the real distance with detours.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// Distance while extruding.
    pub print_mm: f64,
    /// Distance while not extruding.
    pub travel_mm: f64,
    /// Both.
    pub total_mm: f64,
    /// Length of the straight lines from the end of each path to the start of the next, which ordering minimises.
    pub link_mm: f64,
    /// No order can have shorter links than this, where it was computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound_mm: Option<f64>,
    /// `link_mm / bound_mm − 1`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Runs of moves without extrusion.
    pub travels: usize,
    /// Number of retractions.
    pub retractions: usize,
    /// Estimated duration.
    pub total_s: f64,
    /// Plastic deposited.
    pub volume_mm3: f64,
    /// Filament used.
    pub filament_mm: f64,
}

impl Measures {
    /// What was read from G-code. `time` is its duration, `filament_area_mm2` the cross-section of the filament.
    pub fn of(measure: &Measure, time: Seconds, filament_area_mm2: f64) -> Self {
        Self {
            print_mm: measure.print_mm,
            travel_mm: measure.travel_mm,
            total_mm: measure.total_mm(),
            link_mm: measure.link_mm,
            travels: measure.travels,
            retractions: measure.retractions,
            total_s: time.0,
            volume_mm3: measure.volume_mm3,
            filament_mm: measure.volume_mm3 / filament_area_mm2,
            ..Self::default()
        }
    }

    /// Adds a lower bound for `link_mm`, and with it the gap. Where nothing can be saved the gap is 0.
    #[must_use]
    pub fn with_bound(mut self, bound_mm: f64) -> Self {
        self.bound_mm = Some(bound_mm);
        self.gap = match (self.link_mm > bound_mm, bound_mm > 0.0) {
            (false, _) => Some(0.0),
            (true, true) => Some(self.link_mm / bound_mm - 1.0),
            (true, false) => None,
        };
        self
    }
}

/// Sums everything but the bound: the sum of layers' bounds is no bound for the print.
impl AddAssign<&Measures> for Measures {
    fn add_assign(&mut self, other: &Measures) {
        self.print_mm += other.print_mm;
        self.travel_mm += other.travel_mm;
        self.total_mm += other.total_mm;
        self.link_mm += other.link_mm;
        self.travels += other.travels;
        self.retractions += other.retractions;
        self.total_s += other.total_s;
        self.volume_mm3 += other.volume_mm3;
        self.filament_mm += other.filament_mm;
    }
}

/// How near the time of links is to the least, where ordering minimises times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TimeBound {
    /// Time of the straight lines from the end of each path to the start of the next, from rest to rest, with retractions.
    pub link_s: f64,
    /// No order takes less.
    pub bound_s: f64,
    /// `link_s / bound_s − 1`; `None` without a bound above 0.
    pub gap_s: Option<f64>,
}

impl TimeBound {
    /// Of a time and its bound.
    pub fn new(link_s: f64, bound_s: f64) -> Self {
        Self { link_s, bound_s, gap_s: gap(link_s, Some(bound_s)) }
    }
}

/// One layer's share.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LayerSummary {
    /// Height of its top over the bed.
    pub z_mm: f64,
    /// Its measures.
    #[serde(flatten)]
    pub measures: Measures,
}

/// Overhangs beyond `support.angle`, and islands that rest on nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Overhangs {
    /// Positions where one begins.
    pub count: usize,
    /// Area seen from below.
    pub area_mm2: f64,
    /// Height at which the lowest begins; `None` if there are none.
    pub lowest_mm: Option<f64>,
}

impl Overhangs {
    /// The warning for the user; `None` if there are none.
    pub fn warning(&self) -> Option<String> {
        let Self { count, area_mm2, lowest_mm } = self;
        let overhangs = if *count == 1 { "1 overhang needs" } else { &format!("{count} overhangs need") };
        lowest_mm.map(|lowest_mm| {
            format!(
                "{overhangs} support ({area_mm2:.1} mm²), the lowest at Z {lowest_mm:.2}; \
                 --set support.enabled=true lays it"
            )
        })
    }
}

/// What one of several tools printed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ToolSummary {
    /// Its number, from 1.
    pub tool: usize,
    /// Its name.
    pub name: String,
    /// Material of its filament.
    pub material: String,
    /// Color of its filament.
    pub color: String,
    /// Plastic deposited, flushing included.
    pub volume_mm3: f64,
    /// Of that, what went into the prime tower.
    pub flushed_mm3: f64,
    /// Filament used.
    pub filament_mm: f64,
    /// Its weight.
    pub filament_g: f64,
    /// Its price.
    pub filament_cost: f64,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// The summary of a run. `Display` gives the text for people, `Serialize` the JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The models, as named on the command line.
    pub models: Vec<String>,
    /// Where the G-code went.
    pub output: String,
    /// What `gcode.file_name` says that its file is called.
    #[serde(skip)]
    pub file_name: Option<String>,
    /// Extents of the print, without skirt and brim.
    pub size_mm: [f64; 3],
    /// Number of layers.
    pub layer_count: usize,
    /// Measures of the whole print.
    #[serde(flatten)]
    pub total: Measures,
    /// How near links are to the quickest, where that was asked for and ordering minimises times.
    #[serde(flatten)]
    pub time_bound: Option<TimeBound>,
    /// How many layers are proved to be ordered well, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proved: Option<Proved>,
    /// Weight of the filament.
    pub filament_g: f64,
    /// Its price, in the currency of `filament.cost`.
    pub filament_cost: f64,
    /// What each tool printed, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tools: Vec<ToolSummary>,
    /// How often another tool was taken.
    #[serde(skip_serializing_if = "is_zero")]
    pub tool_changes: usize,
    /// What was repaired of the models.
    pub repairs: Vec<Repaired>,
    /// What would need support, where none is printed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overhangs: Option<Overhangs>,
    /// Repairs and warnings.
    pub warnings: Vec<String>,
    /// Each layer, from the bed up.
    pub layers: Vec<LayerSummary>,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { total, size_mm: [x, y, z], .. } = self;
        writeln!(f, "{} → {}", self.models.join(" + "), self.output)?;
        writeln!(f, "  size      {x:.2} × {y:.2} × {z:.2} mm, {} layers", self.layer_count)?;
        for repaired in &self.repairs {
            writeln!(f, "  repaired  {repaired}")?;
        }
        writeln!(f, "  time      {}", duration(total.total_s))?;
        let (metres, grams, cost) = (total.filament_mm / 1000.0, self.filament_g, self.filament_cost);
        writeln!(f, "  filament  {metres:.2} m, {grams:.2} g, cost {cost:.2}")?;
        for tool in &self.tools {
            let called = [tool.name.as_str(), tool.material.as_str()].map(str::trim);
            let called: Vec<&str> = called.into_iter().filter(|text| !text.is_empty()).collect();
            writeln!(
                f,
                "  tool {}    {:.2} m, {:.2} g, {:.0} mm³ of it in the prime tower ({})",
                tool.tool,
                tool.filament_mm / 1000.0,
                tool.filament_g,
                tool.flushed_mm3,
                called.join(", ")
            )?;
        }
        if !self.tools.is_empty() {
            writeln!(f, "  changes   {}", self.tool_changes)?;
        }
        let share = if total.total_mm > 0.0 { 100.0 * total.travel_mm / total.total_mm } else { 0.0 };
        writeln!(f, "  path      {:.2} m printed", total.print_mm / 1000.0)?;
        write!(f, "  travel    {:.2} m ({share:.1} % of the path), ", total.travel_mm / 1000.0)?;
        writeln!(f, "{} travels, {} retractions", total.travels, total.retractions)?;
        if let Some(bound_mm) = total.bound_mm {
            let (links, bound) = (total.link_mm / 1000.0, bound_mm / 1000.0);
            let saves = to_save(total.gap);
            writeln!(f, "  order     links {links:.2} m, no order has less than {bound:.2} m{saves}")?;
        }
        if let Some(TimeBound { link_s, bound_s, gap_s }) = self.time_bound {
            let saves = to_save(gap_s);
            writeln!(f, "  order     links {link_s:.1} s, no order takes less than {bound_s:.1} s{saves}")?;
        }
        if let Some(proved) = self.proved {
            writeln!(f, "  proof     {proved}")?;
        }
        Ok(())
    }
}

/// What a gap says of the links; nothing where it is not known.
fn to_save(gap: Option<f64>) -> String {
    gap.map_or(String::new(), |gap| format!(" (at most {:.1} % to save)", 100.0 * gap / (1.0 + gap)))
}

/// `1 h 02 min 03 s`, rounded to the second.
pub(super) fn duration(seconds: f64) -> String {
    let seconds = seconds.round().max(0.0) as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s:02} s"),
        (h, m, s) => format!("{h} h {m:02} min {s:02} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_well() {
        assert_eq!(duration(59.6), "1 min 00 s");
        assert_eq!(duration(9.0), "9 s");
        assert_eq!(duration(3723.0), "1 h 02 min 03 s");
    }

    #[test]
    fn json_has_the_shared_keys() {
        let total = Measures { link_mm: 110.0, ..Measures::default() }.with_bound(100.0);
        let layers = vec![LayerSummary { z_mm: 0.2, measures: Measures::default() }];
        let json = serde_json::to_value(Summary { total, layers, ..Summary::default() }).unwrap();
        let shared = [
            "print_mm",
            "travel_mm",
            "total_mm",
            "link_mm",
            "travels",
            "retractions",
            "total_s",
            "volume_mm3",
            "filament_mm",
        ];
        for key in shared {
            assert!(json[key].is_number() && json["layers"][0][key].is_number(), "{key}");
        }
        assert_eq!(json["bound_mm"], 100.0);
        assert!((json["gap"].as_f64().unwrap() - 0.1).abs() < 1e-12);
        assert!(json["layers"][0].get("bound_mm").is_none());
    }

    #[test]
    fn a_gap_of_nothing_is_zero_and_one_over_nothing_is_unknown() {
        assert_eq!(Measures::default().with_bound(0.0).gap, Some(0.0));
        assert_eq!(Measures { link_mm: 1.0, ..Measures::default() }.with_bound(0.0).gap, None);
    }
}
