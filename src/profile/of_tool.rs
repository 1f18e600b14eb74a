//! The settings in force while a tool prints.

use std::borrow::Cow;

use toml::{Table, Value};

use super::flush;
use super::settings::Settings;
use super::tools::Tool;
use crate::gcode::ToolChangeKind;

impl Settings {
    /// What each tool has of its own, where there are several.
    pub(crate) fn tool_list(&self) -> &[Tool] {
        if self.tools.len() > 1 { &self.tools } else { &[] }
    }

    /// How many tools the printer has.
    pub fn tool_count(&self) -> usize {
        self.tools.len().max(1)
    }

    /// The settings in force while a tool prints, counted from 0.
    pub fn of_tool(&self, tool: usize) -> Cow<'_, Self> {
        let Some(own) = self.tools.get(tool) else { return Cow::Borrowed(self) };
        let mut table = Table::try_from(self).expect("settings are a table");
        for (key, value) in own.own() {
            if let Some((section, name)) = key.split_once('.')
                && let Some(Value::Table(section)) = table.get_mut(section)
            {
                section.insert(name.to_owned(), value.clone());
            }
        }
        Cow::Owned(Self::try_from(table).expect("every value was checked"))
    }

    /// Filament flushed when one tool follows another, both counted from 0, mm³: as is listed, the same for all, or by the colors.
    pub fn flush_mm3(&self, from: usize, to: usize) -> f64 {
        let change = &self.tool_change;
        let same = Some(change.flush_volume.0).filter(|own| *own > 0.0);
        let listed = change.flush_volumes.get(from * self.tools.len() + to).copied();
        if let Some(volume_mm3) = listed.or(same) {
            return change.flush_multiplier * volume_mm3;
        }
        let [least, most] = change.flush_limits.map(|mm3| mm3.0);
        let by_color = || {
            let color = |tool: usize| flush::color(&self.of_tool(tool).filament.color);
            let mm3 = flush::between_mm3(color(from)?, color(to)?);
            Some(mm3.min(most).max(least))
        };
        let usual = match change.kind {
            ToolChangeKind::SingleNozzle => by_color().unwrap_or(140.0),
            ToolChangeKind::ToolChanger | ToolChangeKind::Heads => 15.0,
        };
        change.flush_multiplier * usual
    }
}
