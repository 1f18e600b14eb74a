//! Presets of other slicers, from a folder that the user has opened.

use std::path::PathBuf;
use std::sync::Arc;

use pathwright::presets::{Files, Kind, Library, PrinterPresets, Printers, Source, is_preset_file};
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::error::{Fault, Result};

/// The printers that are listed at most.
const LISTED: usize = 200;

/// Which of these paths may be of presets, and are to be read: one byte each.
#[wasm_bindgen]
pub fn preset_files(paths: Vec<String>) -> Vec<u8> {
    paths.iter().map(|path| u8::from(is_preset_file(path))).collect()
}

/// Presets of other slicers.
#[wasm_bindgen]
pub struct Presets {
    library: Arc<Library>,
    printers: Printers,
}

#[wasm_bindgen]
impl Presets {
    /// Those in files, whose bytes come one after the other; paths begin with the folder that was opened.
    #[wasm_bindgen(constructor)]
    pub fn new(paths: Vec<String>, lengths: &[u32], bytes: &[u8]) -> Self {
        let mut rest = bytes;
        let contents = lengths.iter().map(|&length| rest.split_off(..length as usize).unwrap_or_default());
        let contents: Vec<&[u8]> = contents.collect();
        let mut sources: Vec<Source> = Vec::new();
        for path in &paths {
            let path = PathBuf::from(path.split('/').next().unwrap_or_default());
            if sources.last().is_none_or(|last| last.path != path) {
                sources.push(Source { path, dialect: None });
            }
        }
        let contents = contents.into_iter().map(<[u8]>::to_vec);
        let files = Files::given(paths.into_iter().map(PathBuf::from).zip(contents));
        Self { library: Arc::new(Library::open_in(&files, &sources)), printers: Printers::default() }
    }

    /// The printers whose names have all words, as JSON.
    pub fn find(&self, words: &str) -> String {
        json!(self.printers.find(&self.library, words, LISTED)).to_string()
    }

    /// A printer with the presets that fit it, as JSON.
    pub fn printer(&self, name: &str) -> Result<String> {
        let found = PrinterPresets::of(&self.library, name, None).map_err(Fault::settings)?;
        Ok(json!(found).to_string())
    }

    /// How many printers are from a folder.
    pub fn count(&self, folder: &str) -> usize {
        let listed = self.library.listed(Kind::Printer);
        listed.iter().filter(|printer| printer.place.file.starts_with(&format!("{folder}/"))).count()
    }

    /// What could not be read.
    pub fn problems(&self) -> Vec<String> {
        self.library.problems().iter().map(ToString::to_string).collect()
    }
}

impl Presets {
    /// For a plate that uses them.
    pub fn library(&self) -> Arc<Library> {
        self.library.clone()
    }
}
