//! Widths of lines by the nozzle of the tool that prints them.

use std::borrow::Cow;

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
            for width in widths {
                *width.1(&mut own) = self.width_of(tool, *width);
            }
        }
        (own != *self).then_some(own)
    }

    /// The settings of what the usual tool of objects prints.
    pub(crate) fn with_widths_of_objects(&self) -> Cow<'_, Self> {
        self.with_widths_of(self.tool_of.base().into()).map_or(Cow::Borrowed(self), Cow::Owned)
    }

    /// Widths of what each tool prints beside the objects, on the first layer and on others, millimetres.
    pub(crate) fn widths_beside_mm(&self) -> [Vec<f64>; 2] {
        let [walls, _, first] = OF_WALLS;
        let tools = 0..self.tool_count();
        let first = |tool: usize| Some(self.width_of(tool, first).0).filter(|mm| *mm > 0.0);
        let walls = |tool: usize| self.width_of(tool, walls).0;
        [
            tools.clone().map(|tool| first(tool).unwrap_or_else(|| walls(tool))).collect(),
            tools.map(walls).collect(),
        ]
    }

    /// A width as a tool has it.
    fn width_of(&self, tool: usize, (key, width): Width) -> Mm {
        let mut of_tool = self.of_tool(tool).into_owned();
        let is_listed = self.tools.get(tool).is_some_and(|own| own.own().any(|(listed, _)| listed == key));
        let share = of_tool.printer.nozzle_diameter / self.printer.nozzle_diameter;
        *width(&mut of_tool) * if is_listed { 1.0 } else { share }
    }
}
