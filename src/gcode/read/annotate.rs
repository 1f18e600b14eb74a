//! Strokes and what they are for: role, layer, width and height, whichever slicer wrote the file.

use super::features::role;
use super::lexer::{Line, lines};
use super::marks::{Mark, mark};
use super::replay::{Action, State, Stroke};
use crate::toolpath::Role;

/// The state given by the comments so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Context {
    /// The role being printed; `None` without a comment or for an unknown name.
    pub role: Option<Role>,
    /// Layers begun before this one.
    ///
    /// They are those that the file marks. What comes before the first mark is counted by itself, and so is a file
    /// without marks: there a layer begins with the first level stroke that extrudes at another height than the last
    /// one. `None` before the first mark or extrusion.
    pub layer: Option<usize>,
    /// Height over the bed that the layer's mark states, mm.
    pub z_mm: Option<f64>,
    /// Width of beads, mm.
    pub width_mm: Option<f64>,
    /// Height of beads, mm.
    pub height_mm: Option<f64>,
}

/// A line, what it does, and in which context.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Annotated<'a> {
    pub line: Line<'a>,
    pub action: Action<'a>,
    pub context: Context,
}

/// Reads a file from the start, line by line. Number and place of a line are in [`Line`].
pub fn annotate(text: &[u8]) -> impl Iterator<Item = Annotated<'_>> {
    let mut reader = Reader::default();
    lines(text).map(move |line| reader.read(line))
}

/// The state of a reader between lines. It takes lines one by one, so that files need not be in memory as a whole.
#[derive(Clone, Debug, Default)]
pub struct Reader {
    /// What the machine keeps in mind.
    pub state: State,
    context: Context,
    /// Whether layers are marked.
    marked: bool,
    /// Whether something was extruded since the layer began.
    extruded: bool,
    /// Height of the last level stroke that extruded.
    bead_z_mm: Option<f64>,
}

impl Reader {
    /// Follows a line.
    pub fn read<'a>(&mut self, line: Line<'a>) -> Annotated<'a> {
        let action = self.state.follow(&line);
        let mut context = None;
        match action {
            Action::Stroke(stroke) => {
                if let Some(comment) = line.comment {
                    context = self.beside(comment, stroke.extrudes());
                }
                if stroke.extrudes() {
                    self.extrude(stroke.from[2], stroke.to[2]);
                    if let Some(context) = &mut context {
                        context.layer = self.context.layer;
                    }
                }
            }
            Action::Type(name) => self.context.role = role(name),
            _ if line.code.is_none() => self.alone(line.comment.and_then(mark)),
            _ => {}
        }
        Annotated { line, action, context: context.unwrap_or(self.context) }
    }

    /// Follows a move that is known without its line, from its place in [`Self::state`].
    pub(crate) fn take(&mut self, stroke: Stroke) -> Annotated<'static> {
        if stroke.extrudes() {
            self.extrude(stroke.from[2], stroke.to[2]);
        }
        Annotated { line: Line::EMPTY, action: Action::Stroke(stroke), context: self.context }
    }

    /// Takes what comments say of the beads that follow.
    pub(crate) fn begin_beads(&mut self, role: Role, width_mm: f64, height_mm: f64) {
        let context = &mut self.context;
        (context.role, context.width_mm, context.height_mm) = (Some(role), Some(width_mm), Some(height_mm));
    }

    /// The state given by the comments so far.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Adds a comment on a line of its own.
    fn alone(&mut self, mark: Option<Mark<'_>>) {
        match mark {
            Some(Mark::Layer) => self.layer_mark(),
            Some(Mark::Z(z_mm)) => self.context.z_mm = Some(z_mm),
            Some(Mark::Width(width_mm)) => self.context.width_mm = Some(width_mm),
            Some(Mark::Height(height_mm)) => self.context.height_mm = Some(height_mm),
            _ => {}
        }
    }

    /// A comment beside a move, as Slic3r writes them if it is asked to be verbose: the role of this one stroke.
    fn beside(&mut self, comment: &[u8], extrudes: bool) -> Option<Context> {
        let text = comment.trim_ascii();
        if text.starts_with(b"move to next layer") {
            self.layer_mark();
        }
        let role = extrudes.then(|| role(text)).flatten()?;
        Some(Context { role: Some(role), ..self.context })
    }

    fn layer_mark(&mut self) {
        self.context.layer = match self.context.layer {
            Some(layer) if self.marked => Some(layer + usize::from(self.extruded)),
            _ => Some(0),
        };
        (self.marked, self.extruded) = (true, false);
    }

    fn extrude(&mut self, from_z_mm: f64, to_z_mm: f64) {
        self.extruded = true;
        let level = from_z_mm == to_z_mm;
        if level && self.bead_z_mm.replace(to_z_mm) != Some(to_z_mm) && !self.marked {
            self.context.layer = Some(self.context.layer.map_or(0, |layer| layer + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beads(text: &str) -> Vec<Context> {
        let extruded = |a: &Annotated| matches!(a.action, Action::Stroke(stroke) if stroke.extrudes());
        annotate(text.as_bytes()).filter(extruded).map(|a| a.context).collect()
    }

    fn layers(text: &str) -> Vec<Option<usize>> {
        beads(text).iter().map(|context| context.layer).collect()
    }

    #[test]
    fn layers_are_the_marked_ones_and_several_marks_are_one() {
        let text = "M83\nG1 Z.3\nG1 X9 E1\n;LAYER_CHANGE\n;LAYER:0\nG1 X1 E1\n;LAYER_CHANGE\n;LAYER:1\nG1 Z.2 X2\nG1 X3 E1";
        assert_eq!(layers(text), [Some(0), Some(0), Some(1)]);
    }

    #[test]
    fn without_marks_a_new_height_of_extrusion_is_a_layer_and_a_hop_is_not() {
        let text = "M83\nG1 Z.2\nG1 X1 E1\nG1 Z.6\nG1 X2\nG1 Z.2\nG1 X3 E1\nG1 Z.4\nG1 X4 E1\nG1 X5 Z.5 E1";
        assert_eq!(layers(text), [Some(0), Some(0), Some(1), Some(1)]);
    }

    #[test]
    fn roles_come_from_comments_on_lines_of_their_own_or_beside_moves() {
        let text = "M83\nG1 X1 E1 ; perimeter\nG1 X2 E1 ; infill\nG1 X3 E1 ; who knows\n; FEATURE: Outer wall\nG1 X4 E1\n;TYPE:Custom\nG1 X5 E1";
        let roles: Vec<_> = beads(text).iter().map(|context| context.role).collect();
        let [wall, fill, outer] = [Role::Perimeter, Role::InternalInfill, Role::ExternalPerimeter].map(Some);
        assert_eq!(roles, [wall, fill, None, outer, None]);
    }

    #[test]
    fn widths_and_heights_hold_until_the_next() {
        let text = "M83\n;WIDTH:0.45\n;HEIGHT:0.2\nG1 X1 E1\n; LINE_WIDTH: 0.5\nG1 X2 E1";
        let widths: Vec<_> = beads(text).iter().map(|c| (c.width_mm, c.height_mm)).collect();
        assert_eq!(widths, [(Some(0.45), Some(0.2)), (Some(0.5), Some(0.2))]);
    }

    #[test]
    fn lines_know_where_they_are() {
        let text = b";LAYER:0\r\nG1 X1 E1\n";
        for line in annotate(text).map(|a| a.line) {
            assert_eq!(&text[line.offset..line.offset + line.raw.len()], line.raw);
        }
    }
}
