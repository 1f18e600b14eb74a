//! Pictures and pages of results: made when they are asked for, or with the job where that wants them.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Read};
use std::sync::{Arc, Mutex, PoisonError};

use super::budget::Share;
use super::files::{Files, GCODE, SETTINGS};
use super::record::Output;
use crate::gcode;
use crate::job::JobError;
use crate::observer::Observer;
use crate::output::OutputError;
use crate::profile::Settings;
use crate::serve::error::ApiError;
use crate::view::{self, Print, Scene};

/// Memory for each byte of G-code while it is drawn (4 were measured for a page).
const PER_BYTE: u64 = 6;
/// G-code up to this size stays in memory for the next picture, bytes.
const REMEMBERED_BYTES: u64 = 32 << 20;
/// Longer sides of pictures, in pixels, where nothing else is asked for.
pub const LAYER_SIDE: u32 = 1200;
/// That of the whole print.
pub const THUMBNAIL_SIDE: u32 = 300;

/// What can be made of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    /// The whole print, with this many pixels a side.
    Thumbnail(u32),
    /// A page.
    Preview,
    /// A layer, counted from 1, with this many pixels on its longer side.
    LayerPng(usize, u32),
    /// A layer, to scale.
    LayerSvg(usize),
}

impl Picture {
    /// The file of the result that it would be, had the job wanted it.
    fn file(self) -> Option<String> {
        match self {
            Self::Thumbnail(THUMBNAIL_SIDE) => Some("thumbnail.png".into()),
            Self::Preview => Some("preview.html".into()),
            Self::LayerPng(number, LAYER_SIDE) => Some(format!("layer-{number}.png")),
            Self::Thumbnail(_) | Self::LayerPng(..) | Self::LayerSvg(_) => None,
        }
    }
}

/// Makes pictures, one at a time.
#[derive(Debug, Default)]
pub struct Renderer {
    /// What the last ones were of.
    last: Mutex<Option<(String, Arc<Drawn>)>>,
    turn: Mutex<()>,
}

/// What is drawn.
#[derive(Debug)]
struct Drawn {
    scene: Scene,
    settings: Settings,
}

impl Drawn {
    fn read(files: &Files, key: &str) -> io::Result<Self> {
        let folder = files.result(key);
        let settings = serde_json::from_slice(&fs::read(folder.join(SETTINGS))?)?;
        let mut text = Vec::new();
        gcode::open(&folder.join(GCODE))?.read_to_end(&mut text)?;
        Ok(Self { scene: Scene::read(&text, &settings), settings })
    }

    /// The picture; `None`: there is no such layer.
    fn picture(&self, name: &str, picture: Picture) -> Option<Vec<u8>> {
        let layer = |number: usize| self.scene.layers.get(number.checked_sub(1)?);
        Some(match picture {
            Picture::Thumbnail(side) => view::thumbnail(&self.scene, [side; 2]),
            Picture::Preview => {
                let print = Print::new(name.to_owned(), self.scene.clone(), &self.settings);
                view::page(name, &[print]).into_bytes()
            }
            Picture::LayerPng(number, side) => view::layer_png(&self.scene, layer(number)?, side),
            Picture::LayerSvg(number) => view::layer_svg(&self.scene, layer(number)?).into_bytes(),
        })
    }
}

impl Renderer {
    /// A picture of a result of so many bytes of G-code, as `name`; `room` waits until there is memory for it. It blocks.
    ///
    /// # Errors
    /// There is no such layer; the result went away meanwhile.
    pub fn picture(
        &self,
        files: &Files,
        (key, gcode_bytes): (&str, u64),
        name: &str,
        picture: Picture,
        room: impl FnOnce(u64) -> Option<Share>,
    ) -> Result<Vec<u8>, ApiError> {
        if let Some(contents) = picture.file().and_then(|file| fs::read(files.result(key).join(file)).ok()) {
            return Ok(contents);
        }
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let last = || self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last().as_ref().filter(|(known, _)| known == key).map(|(_, drawn)| drawn.clone());
        let _share;
        let drawn = match known {
            Some(drawn) => drawn,
            None => {
                last().take();
                _share = room(gcode_bytes * PER_BYTE);
                let drawn = Arc::new(Drawn::read(files, key)?);
                if gcode_bytes <= REMEMBERED_BYTES {
                    *last() = Some((key.to_owned(), drawn.clone()));
                }
                drawn
            }
        };
        drawn.picture(name, picture).ok_or_else(|| {
            ApiError::not_found(format!("the print has the layers 1 to {}", drawn.scene.layers.len()))
        })
    }
}

/// Makes what a job wants beside its G-code.
///
/// # Errors
/// The disk is full, or the run is cancelled.
pub fn all(
    files: &Files,
    key: &str,
    name: &str,
    wanted: &BTreeSet<Output>,
    observer: &Observer<'_>,
) -> Result<(), JobError> {
    let failed = |source| JobError::from(OutputError { path: "the result".into(), source });
    let drawn = Drawn::read(files, key).map_err(failed)?;
    let mut pictures = Vec::new();
    for output in wanted {
        match output {
            Output::Thumbnail => pictures.push(Picture::Thumbnail(THUMBNAIL_SIDE)),
            Output::Preview => pictures.push(Picture::Preview),
            Output::Layers => {
                pictures.extend(
                    (1..=drawn.scene.layers.len()).map(|number| Picture::LayerPng(number, LAYER_SIDE)),
                );
            }
            Output::Gcode | Output::Summary => {}
        }
    }
    for picture in pictures {
        if observer.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        if let (Some(contents), Some(file)) = (drawn.picture(name, picture), picture.file()) {
            files.write_result(key, &file, &contents).map_err(failed)?;
        }
    }
    Ok(())
}
