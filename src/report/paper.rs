//! The table of Fok, Ganganath, Cheng and Tse (2016), on files at hand.

use std::fmt::Write;

/// One order of one file.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct PaperRow {
    pub order: String,
    pub scope: String,
    pub print_mm: f64,
    pub travel_mm: f64,
    /// Straight lines in place of the travels.
    pub link_mm: f64,
    pub retractions: usize,
    pub total_s: f64,
    /// Reading, ordering and writing.
    pub took_s: f64,
    pub gap: Option<f64>,
}

/// The change of the total path that the paper's Table I gives for a model, by a part of its name.
const PAPER: [(&str, f64); 5] = [
    ("3DHackerTest", -8.01),
    ("ctrlV", -6.14),
    ("TortureTestV2", -9.23),
    ("testModel", -6.73),
    ("Robot", -9.86),
];
/// The mean over the paper's seven models.
const PAPER_MEAN: f64 = -8.58;

impl PaperRow {
    /// Length of the whole path: printing and travel.
    pub fn path_mm(&self) -> f64 {
        self.print_mm + self.travel_mm
    }

    /// Length of the whole path with straight travels.
    pub fn straight_mm(&self) -> f64 {
        self.print_mm + self.link_mm
    }
}

/// The table of one file, whose first row is the baseline. `own`: the segments are our own.
pub fn table(file: &str, own: bool, rows: &[PaperRow]) -> String {
    let mut out = format!("{file}{}\n", if own { " (own segments)" } else { "" });
    out += &format!(
        "{:<18} {:<8} {:>9} {:>9} {:>9} {:>9} {:>7} {:>9} {:>8} {:>7}\n",
        "order", "scope", "path m", "change", "straight", "paper", "retr.", "time s", "took s", "gap"
    );
    let Some(first) = rows.first() else { return out };
    let percent =
        |a: f64, b: f64| if a > 0.0 { format!("{:+.2}%", 100.0 * (b / a - 1.0)) } else { "-".into() };
    for row in rows {
        let paper = PAPER.iter().find(|(name, _)| file.contains(name) && row.order == "christofides");
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{:<18} {:<8} {:>9.2} {:>9} {:>9} {:>9} {:>7} {:>9.0} {:>8.2} {:>7}",
            row.order,
            row.scope,
            row.path_mm() / 1000.0,
            percent(first.path_mm(), row.path_mm()),
            percent(first.straight_mm(), row.straight_mm()),
            paper.map_or("-".into(), |(_, change)| format!("{change:+.2}%")),
            row.retractions,
            row.total_s,
            row.took_s,
            row.gap.map_or("-".into(), |gap| format!("{:.2}%", 100.0 * gap)),
        );
    }
    out
}

/// The mean change of each order over several files, beside the paper's.
pub fn means(tables: &[Vec<PaperRow>]) -> String {
    let mut out = format!(
        "mean of {} files; the paper's mean of its seven models is {PAPER_MEAN:+.2}%\n",
        tables.len()
    );
    let orders = tables.iter().map(Vec::len).min().unwrap_or(0);
    for order in 1..orders {
        let mean = |of: fn(&PaperRow) -> f64| {
            let sum: f64 =
                tables.iter().map(|rows| of(&rows[order]) / of(&rows[0]).max(f64::MIN_POSITIVE) - 1.0).sum();
            100.0 * sum / tables.len() as f64
        };
        let (row, path, straight) = (&tables[0][order], mean(PaperRow::path_mm), mean(PaperRow::straight_mm));
        let _ = writeln!(out, "{:<18} {:<8} {path:>+18.2}% {straight:>+8.2}%", row.order, row.scope);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_those_of_print_and_travel_against_as_sliced() {
        let row = |order: &str, travel_mm| PaperRow {
            order: order.into(),
            print_mm: 900.0,
            travel_mm,
            link_mm: travel_mm,
            ..PaperRow::default()
        };
        let rows = vec![row("as sliced", 100.0), row("christofides", 50.0)];
        let table = table("a/ctrlV.gcode", false, &rows);
        assert!(table.lines().nth(3).unwrap().contains("-5.00%") && table.contains("-6.14%"), "{table}");
        assert!(means(&[rows.clone(), rows]).contains("-5.00%"));
    }
}
