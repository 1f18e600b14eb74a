//! Widths of lines by the nozzle of the tool that prints them.

use super::settings::Settings;
use crate::units::Mm;

/// The key of a width, and where it is.
type Width = (&'static str, fn(&mut Settings) -> &mut Mm);

const OF_WALLS: [Width; 3] = [
    ("walls.width", |s| &mut s.walls.width),
    ("walls.external_width", |s| &mut s.walls.external_width),
    ("first_layer.width", |s| &mut s.first_layer.width),
];
const OF_SOLID: [Width; 2] =
    [("shell.width", |s| &mut s.shell.width), ("shell.top_width", |s| &mut s.shell.top_width)];
const OF_INFILL: [Width; 1] = [("infill.width", |s| &mut s.infill.width)];
const OF_SUPPORT: [Width; 1] = [("support.width", |s| &mut s.support.width)];

impl Settings {
    /// The settings of what a tool prints, counted from 0, but for the roles that have another: with that tool's own widths, or else
    /// in proportion to its nozzle. `None`: they are as they are.
    pub(crate) fn with_widths_of(&self, tool: usize) -> Option<Self> {
        let of = &self.tool_of;
        let or = |number: u32| (number as usize).checked_sub(1).unwrap_or(tool);
        let mut own = self.clone();
        for (tool, widths) in [
            (or(of.walls), &OF_WALLS[..]),
            (or(of.solid_infill), &OF_SOLID),
            (or(of.infill), &OF_INFILL),
            (or(of.support), &OF_SUPPORT),
        ] {
            let Some(listed) = self.tools.get(tool) else { continue };
            let mut of_tool = self.of_tool(tool).into_owned();
            let share = of_tool.printer.nozzle_diameter / self.printer.nozzle_diameter;
            for (key, width) in widths {
                let is_listed = listed.own().any(|(listed, _)| listed == *key);
                let wanted = if is_listed { *width(&mut of_tool) } else { *width(&mut own) * share };
                *width(&mut own) = wanted;
            }
        }
        (own != *self).then_some(own)
    }
}
