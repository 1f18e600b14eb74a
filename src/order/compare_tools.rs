//! Orders of tools side by side on the same layers.

use serde::Serialize;

/// The result of one order of tools.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToolOrderRow {
    /// Its name.
    pub order: String,
    /// How often another tool is taken.
    pub changes: u64,
    /// How long that takes, without heating and flushing, seconds.
    pub change_s: f64,
    /// How long is waited for tools to be hot again, about, seconds.
    pub heat_s: f64,
    /// Filament that is flushed.
    pub flushed_mm3: f64,
    /// The time, and that which the waste is worth, which are minimised together, seconds.
    pub cost_s: f64,
    /// No order costs less; of the best one only.
    pub bound_s: Option<f64>,
}

/// A table for people: one line per order.
pub fn text(rows: &[ToolOrderRow]) -> String {
    let mut out = format!(
        "{:<18}{:>9}{:>12}{:>12}{:>14}{:>12}{:>12}\n",
        "tools", "changes", "change_s", "heat_s", "flushed_mm3", "cost_s", "bound_s"
    );
    for row in rows {
        out += &format!(
            "{:<18}{:>9}{:>12.1}{:>12.1}{:>14.1}{:>12.1}{:>12}\n",
            row.order,
            row.changes,
            row.change_s,
            row.heat_s,
            row.flushed_mm3,
            row.cost_s,
            row.bound_s.map_or("-".into(), |bound| format!("{bound:.1}")),
        );
    }
    out
}
