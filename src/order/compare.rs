//! Strategies side by side on the same layers.

use std::fmt;

use serde::Serialize;
use serde_json::{Value, json};

use ordering::{Cost, Problem, Visit, links};

/// The result of one strategy for one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerRow {
    /// Index of the layer from the bed.
    pub layer: usize,
    /// Paths on it.
    pub paths: usize,
    /// Straight lines from where the layer before ended to the first path and between paths, mm.
    pub link_mm: f64,
    /// Links longer than nothing.
    pub travels: usize,
    /// Time of these links by the machine's trapezoid, with retractions, seconds.
    pub travel_s: f64,
    /// Lower bound of `link_mm`, if requested.
    pub bound_mm: Option<f64>,
    /// Lower bound of `travel_s`, if requested where ordering minimises times.
    pub bound_s: Option<f64>,
    /// By how much, as a share, the links are at most longer than the shortest between where the layer below ends and where the one
    /// above begins; if requested, and known.
    pub excess: Option<f64>,
}

/// How many layers are proved to be ordered as well as possible, or nearly, between those below and above them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Proved {
    /// Layers with paths.
    pub layers: usize,
    /// No order is shorter.
    pub optimal: usize,
    /// None saves more than 1 %, or 5 %.
    pub within_1: usize,
    /// See `within_1`.
    pub within_5: usize,
}

impl Proved {
    /// Counts the excesses of layers, of which some are not known.
    pub fn of(excesses: impl Iterator<Item = Option<f64>>) -> Self {
        excesses.fold(Self::default(), |sum, excess| {
            let within = |most: f64| usize::from(excess.is_some_and(|excess| excess <= most));
            Self {
                layers: sum.layers + 1,
                optimal: sum.optimal + within(0.0),
                within_1: sum.within_1 + within(0.01),
                within_5: sum.within_5 + within(0.05),
            }
        })
    }
}

impl fmt::Display for Proved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { layers, optimal, within_1, within_5 } = self;
        write!(f, "{optimal} of {layers} layers proved optimal, {within_1} within 1 %, {within_5} within 5 %")
    }
}

/// The result of one strategy for all layers.
#[derive(Clone, Debug, PartialEq)]
pub struct StrategyRow {
    /// The strategy's name.
    pub strategy: String,
    /// Processor time that it took, seconds, for the text table only: it differs from run to run.
    pub took_s: f64,
    /// Lower bound of the whole chain's links, if requested. Not the sum of the layers' bounds.
    pub bound_mm: Option<f64>,
    /// The same of their time in seconds, where ordering minimises times.
    pub bound_s: Option<f64>,
    /// Its layers.
    pub layers: Vec<LayerRow>,
}

impl LayerRow {
    /// Measures a solution of one layer. `time` is a [`Cost::Time`], whatever the solution minimised.
    pub fn new(layer: usize, problem: &Problem, sequence: &[Visit], time: &Cost) -> Self {
        let paths = sequence.len();
        let mut row = Self {
            layer,
            paths,
            link_mm: 0.0,
            travels: 0,
            travel_s: 0.0,
            bound_mm: None,
            bound_s: None,
            excess: None,
        };
        for (link_mm, kind) in links(problem, sequence) {
            row.link_mm += link_mm;
            row.travels += usize::from(link_mm > 0.0);
            row.travel_s += time.of(link_mm, kind);
        }
        row
    }
}

impl StrategyRow {
    /// Length of all links, mm.
    pub fn link_mm(&self) -> f64 {
        self.layers.iter().map(|row| row.link_mm).sum()
    }

    /// Number of links longer than nothing.
    pub fn travels(&self) -> usize {
        self.layers.iter().map(|row| row.travels).sum()
    }

    /// Time of all links, seconds.
    pub fn travel_s(&self) -> f64 {
        self.layers.iter().map(|row| row.travel_s).sum()
    }

    /// How many layers are proved to be ordered well, if that was requested.
    pub fn proved(&self) -> Option<Proved> {
        let layers = self.layers.iter().filter(|row| row.paths > 0);
        self.bound_mm.map(|_| Proved::of(layers.map(|row| row.excess)))
    }

    /// Number of paths.
    pub fn paths(&self) -> usize {
        self.layers.iter().map(|row| row.paths).sum()
    }
}

/// Excess of a length or time over its bound, as a share of the bound; `None` without a bound above 0.
pub fn gap(found: f64, bound: Option<f64>) -> Option<f64> {
    bound.filter(|&bound| bound > 0.0).map(|bound| found / bound - 1.0)
}

/// A table for people: one line per strategy, lengths relative to `nearest` where it is among them; bound and gap of times where
/// ordering minimised these, else of lengths.
pub fn text(rows: &[StrategyRow]) -> String {
    let nearest = rows.iter().find(|row| row.strategy == "nearest").map(StrategyRow::link_mm);
    let of_times = rows.iter().any(|row| row.bound_s.is_some());
    let bound = if of_times { "bound_s" } else { "bound_mm" };
    let mut out = format!(
        "{:<18}{:>12}{:>9}{:>12}{:>8}{:>9}{:>10}{:>14}\n",
        "strategy", "link_mm", "nearest", bound, "gap", "travels", "travel_s", "ms/100 paths"
    );
    let share = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.1}%", value * 100.0));
    for row in rows {
        let link_mm = row.link_mm();
        let of_nearest = nearest.filter(|&nearest| nearest > 0.0).map(|nearest| link_mm / nearest);
        let (found, bound) = if of_times { (row.travel_s(), row.bound_s) } else { (link_mm, row.bound_mm) };
        out += &format!(
            "{:<18}{:>12.1}{:>9}{:>12}{:>8}{:>9}{:>10.2}{:>14.3}\n",
            row.strategy,
            link_mm,
            share(of_nearest),
            bound.map_or("-".into(), |bound| format!("{bound:.1}")),
            share(gap(found, bound)),
            row.travels(),
            row.travel_s(),
            row.took_s * 1e5 / row.paths().max(1) as f64,
        );
    }
    for row in rows {
        if let Some(proved) = row.proved() {
            out += &format!("{:<18}{proved}\n", row.strategy);
        }
    }
    out
}

/// The same for programs, with every layer. The same on every run: no times taken.
pub fn to_json(rows: &[StrategyRow]) -> Value {
    let layer = |row: &LayerRow| {
        let mut value = figures((row.link_mm, row.bound_mm), row.travels, (row.travel_s, row.bound_s));
        value["layer"] = json!(row.layer);
        value["paths"] = json!(row.paths);
        value["excess"] = json!(row.excess);
        value
    };
    let strategy = |row: &StrategyRow| {
        let mut value = figures((row.link_mm(), row.bound_mm), row.travels(), (row.travel_s(), row.bound_s));
        value["strategy"] = json!(row.strategy);
        value["proved"] = json!(row.proved());
        value["paths"] = json!(row.paths());
        value["layers"] = row.layers.iter().map(layer).collect();
        value
    };
    Value::Array(rows.iter().map(strategy).collect())
}

/// Lengths and times have a bound each.
fn figures(
    (link_mm, bound_mm): (f64, Option<f64>),
    travels: usize,
    (travel_s, bound_s): (f64, Option<f64>),
) -> Value {
    json!({
        "link_mm": link_mm,
        "bound_mm": bound_mm,
        "gap": gap(link_mm, bound_mm),
        "travels": travels,
        "travel_s": travel_s,
        "bound_s": bound_s,
        "gap_s": gap(travel_s, bound_s),
    })
}

/// Adds the rows of another model to those of the models before, strategy by strategy. Bounds of prints add up.
pub fn pool(pooled: &mut Vec<StrategyRow>, rows: Vec<StrategyRow>) {
    for row in rows {
        match pooled.iter_mut().find(|sum| sum.strategy == row.strategy) {
            Some(sum) => {
                sum.took_s += row.took_s;
                sum.bound_mm = sum.bound_mm.zip(row.bound_mm).map(|(a, b)| a + b);
                sum.bound_s = sum.bound_s.zip(row.bound_s).map(|(a, b)| a + b);
                sum.layers.extend(row.layers);
            }
            None => pooled.push(row),
        }
    }
}

/// The same as comma-separated values, one line per strategy and layer, below a heading if that is wanted.
pub fn csv(model: &str, rows: &[StrategyRow], heading: bool) -> String {
    let mut out = String::new();
    if heading {
        out += "model,strategy,layer,paths,link_mm,bound_mm,gap,travels,travel_s,bound_s,gap_s\n";
    }
    let model = if model.contains([',', '"', '\n']) {
        format!("\"{}\"", model.replace('"', "\"\""))
    } else {
        model.to_owned()
    };
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.4}"));
    for strategy in rows {
        for row in &strategy.layers {
            out += &format!(
                "{model},{},{},{},{:.4},{},{},{},{:.4},{},{}\n",
                strategy.strategy,
                row.layer,
                row.paths,
                row.link_mm,
                cell(row.bound_mm),
                cell(gap(row.link_mm, row.bound_mm)),
                row.travels,
                row.travel_s,
                cell(row.bound_s),
                cell(gap(row.travel_s, row.bound_s))
            );
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<StrategyRow> {
        let row = |strategy: &str, link_mm| StrategyRow {
            strategy: strategy.into(),
            took_s: 0.001,
            bound_mm: Some(50.0),
            bound_s: None,
            layers: vec![LayerRow {
                layer: 0,
                paths: 4,
                link_mm,
                travels: 3,
                travel_s: 0.5,
                bound_mm: None,
                bound_s: None,
                excess: None,
            }],
        };
        vec![row("nearest", 100.0), row("optimized", 60.0)]
    }

    #[test]
    fn the_gap_is_relative_to_the_bound() {
        let value = to_json(&rows());
        assert!((value[1]["gap"].as_f64().unwrap() - 0.2).abs() < 1e-12);
        assert!(value[1]["layers"][0]["gap"].is_null());
    }

    #[test]
    fn the_gap_is_that_of_times_where_these_are_minimised() {
        let mut rows = rows();
        rows[1].bound_s = Some(0.4);
        assert!(text(&rows).lines().nth(2).unwrap().contains(" 0.4   25.0%"), "{}", text(&rows));
        assert!((to_json(&rows)[1]["gap_s"].as_f64().unwrap() - 0.25).abs() < 1e-12);
    }

    #[test]
    fn the_table_shows_the_share_of_nearest() {
        assert!(text(&rows()).lines().nth(2).unwrap().contains("60.0%"));
    }

    #[test]
    fn csv_has_a_line_per_strategy_and_layer() {
        assert_eq!(csv("a,b.stl", &rows(), true).lines().count(), 3);
    }

    #[test]
    fn a_layer_counts_as_proved_by_the_most_that_an_order_could_save() {
        let proved = Proved::of([Some(0.0), Some(0.02), None, Some(0.01)].into_iter());
        assert_eq!(proved, Proved { layers: 4, optimal: 1, within_1: 2, within_5: 3 });
    }
}
