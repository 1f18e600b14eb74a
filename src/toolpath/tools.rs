//! Which tool prints a path: by its object, its role and its height.

use super::options::ToolOfSettings;
use super::path::{LayerPaths, Role, ToolId};

/// Heights over the bed between which a tool prints everything of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolHeights {
    /// From here, millimetres.
    pub from_mm: f64,
    /// Up to here, millimetres.
    pub to_mm: f64,
    /// The tool.
    pub tool: ToolId,
}

/// Reads `tool_of.heights`: `5-10:2, 20.5-24:3`.
///
/// # Errors
/// The entry that is wrong, and what would be right.
pub fn tool_heights(text: &str) -> Result<Vec<ToolHeights>, String> {
    let entry = |text: &str| {
        let (range, tool) = text.split_once(':')?;
        let (from, to) = range.split_once('-')?;
        let number = |text: &str| text.trim().trim_end_matches("mm").trim_end().parse::<f64>().ok();
        let (from_mm, to_mm) = (number(from)?, number(to)?);
        let tool = tool.trim().parse::<ToolId>().ok().filter(|tool| (1..=16).contains(tool))?;
        (from_mm >= 0.0 && to_mm > from_mm).then_some(ToolHeights { from_mm, to_mm, tool: tool - 1 })
    };
    let entries = text.split(',').map(str::trim).filter(|text| !text.is_empty());
    let wrong = |text| format!("`{text}` is no height with a tool; write 5-10:2 for tool 2 from 5 to 10 mm");
    entries.map(|text| entry(text).ok_or_else(|| wrong(text))).collect()
}

impl ToolOfSettings {
    /// The tool of an object's paths, those of skirt, brim and support apart.
    pub fn base(&self) -> ToolId {
        to_id(self.object).unwrap_or(0)
    }

    /// The tool of a path of a part that a tool prints; `None`: any will do.
    pub fn of_role(&self, role: Role, part: ToolId) -> Option<ToolId> {
        let own = match role {
            Role::Skirt | Role::Brim => return None,
            Role::Support => return to_id(self.support),
            Role::SupportInterface => return to_id(self.support_interface).or(to_id(self.support)),
            Role::PrimeTower => return Some(part),
            Role::InternalInfill => self.infill,
            Role::SolidInfill | Role::BridgeInfill | Role::TopSolidInfill | Role::Ironing => {
                self.solid_infill
            }
            Role::Perimeter | Role::ExternalPerimeter | Role::OverhangPerimeter | Role::GapFill => self.walls,
        };
        Some(to_id(own).unwrap_or(part))
    }
}

/// From a number that counts from 1, 0 being none.
fn to_id(number: u32) -> Option<ToolId> {
    number.checked_sub(1).map(|id| id as ToolId)
}

/// Says of each path, whose tools are those of their parts, which tool prints it.
pub fn assign(layer: &mut LayerPaths, settings: &ToolOfSettings, heights: &[ToolHeights]) {
    let middle_mm = layer.top_mm - layer.height_mm / 2.0;
    let by_height = heights.iter().rev().find(|at| (at.from_mm..at.to_mm).contains(&middle_mm));
    for path in &mut layer.paths {
        path.tool = match by_height {
            Some(at) if path.island.is_some() => Some(at.tool),
            _ => settings.of_role(path.role, path.tool.unwrap_or_else(|| settings.base())),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_read_with_their_tools() {
        let read = tool_heights(" 5-10:2, 20.5 - 24mm:3,").unwrap();
        assert_eq!(
            read.iter().map(|at| (at.from_mm, at.to_mm, at.tool)).collect::<Vec<_>>(),
            [(5.0, 10.0, 1), (20.5, 24.0, 2)]
        );
        assert!(tool_heights("").unwrap().is_empty());
        for wrong in ["5:2", "5-4:1", "0-1:0", "0-1:17", "-1-4:1", "a-b:1"] {
            assert!(tool_heights(wrong).unwrap_err().starts_with(&format!("`{wrong}`")), "{wrong}");
        }
    }
}
