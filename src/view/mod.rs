//! Views of a print: pictures of layers, thumbnails, and a page for a browser.
//!
//! [`Scene`] is what all of them draw: the strokes of a G-code file, layer by layer, with what each is for.

mod colors;
mod colpic;
mod layer_png;
mod layer_svg;
mod pack;
mod page;
mod picture;
mod planned;
mod scene;
mod thumbnail;
mod thumbnail_format;

pub use layer_png::layer_png;
pub use layer_svg::layer_svg;
pub use page::{Print, page, preview};
#[cfg(feature = "serve")]
pub(crate) use page::{parts_module, parts_style};
pub use planned::PlannedLayer;
pub use scene::{Layer, Mark, MarkKind, Scene, Stroke};
pub use thumbnail::{Solid, Surface, thumbnail};
pub use thumbnail_format::{BTT_TFT_END, thumbnail_comment};
