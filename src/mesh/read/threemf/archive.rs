//! The ZIP archive around a 3MF model, read no further than is sane.

use std::io::{self, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use quick_xml::events::Event;
use quick_xml::reader::NsReader;
use zip::ZipArchive;

use super::xml::value;
use crate::mesh::error::MeshError;

/// No part may be larger than this unpacked: some thirty million facets.
const LARGEST: u64 = 2 << 30;

/// Beyond this size no part may be more than [`HIGHEST_RATIO`] times as large as it is packed.
const UNSUSPECTED: u64 = 32 << 20;

/// Models pack to a fourth up to a fortieth; archives made to exhaust memory to a thousandth.
const HIGHEST_RATIO: u64 = 200;

/// Where the model is if the package does not say.
const USUAL_MODEL: &str = "3D/3dmodel.model";

/// An open package.
pub(super) struct Archive<'a> {
    path: PathBuf,
    zip: ZipArchive<Cursor<&'a [u8]>>,
}

impl<'a> Archive<'a> {
    pub fn open(path: &Path, data: &'a [u8]) -> Result<Self, MeshError> {
        let zip = ZipArchive::new(Cursor::new(data)).map_err(|problem| MeshError::Package {
            path: path.to_path_buf(),
            part: "archive".into(),
            problem: format!("it is damaged or ends early ({problem})"),
            mend: "copy or export it again",
        })?;
        Ok(Self { path: path.to_path_buf(), zip })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// An error in a part of the package.
    pub fn error(&self, part: &str, problem: impl Into<String>, mend: &'static str) -> MeshError {
        MeshError::Package { path: self.path.clone(), part: part.into(), problem: problem.into(), mend }
    }

    /// Opens a part as XML, whose name begins with a slash or not, in any case.
    pub fn part(&mut self, name: &str) -> Result<NsReader<BufReader<Limited<impl Read>>>, MeshError> {
        Ok(NsReader::from_reader(BufReader::with_capacity(1 << 16, self.open_part(name)?)))
    }

    /// The contents of a part of so many bytes at most; `None`: there is no such part.
    pub fn bytes(&mut self, name: &str, most: u64) -> Result<Option<Vec<u8>>, MeshError> {
        if self.index(name).is_none() {
            return Ok(None);
        }
        let mut bytes = Vec::new();
        let read = self.open_part(name)?.take(most.saturating_add(1)).read_to_end(&mut bytes);
        match read {
            Ok(_) if bytes.len() as u64 <= most => Ok(Some(bytes)),
            Ok(_) => Err(self.error(name, "it is larger than any such part", "save the project again")),
            Err(problem) => Err(self.error(name, problem.to_string(), "save the project again")),
        }
    }

    fn index(&self, name: &str) -> Option<usize> {
        let wanted = name.trim_start_matches('/');
        self.zip.index_for_name(wanted).or_else(|| {
            let same = |i: &usize| {
                self.zip.name_for_index(*i).is_some_and(|n| n.is_ok_and(|n| n.eq_ignore_ascii_case(wanted)))
            };
            (0..self.zip.len()).find(same)
        })
    }

    fn open_part(&mut self, name: &str) -> Result<Limited<impl Read>, MeshError> {
        let Some(index) = self.index(name) else {
            return Err(self.error(name, "the package has no such part", "export it again"));
        };
        let path = self.path.clone();
        let file = self.zip.by_index(index).map_err(|problem| MeshError::Package {
            path,
            part: name.into(),
            problem: format!("it cannot be unpacked ({problem})"),
            mend: "export it again, without a password",
        })?;
        let highest = LARGEST.min(UNSUSPECTED.max(file.compressed_size().saturating_mul(HIGHEST_RATIO)));
        Ok(Limited { file, left: highest })
    }

    /// The part that the package names as its model.
    pub fn root(&mut self) -> Result<String, MeshError> {
        const RELATIONS: &str = "_rels/.rels";
        let Ok(mut reader) = self.part(RELATIONS) else { return Ok(USUAL_MODEL.into()) };
        let (mut buffer, mut root) = (Vec::new(), None);
        let problem = loop {
            buffer.clear();
            match reader.read_event_into(&mut buffer) {
                Ok(Event::Start(tag) | Event::Empty(tag))
                    if tag.local_name().into_inner() == "Relationship" =>
                {
                    if value(&tag, "Type").is_some_and(|kind| kind.ends_with("/3dmodel")) {
                        root = root.or(value(&tag, "Target"));
                    }
                }
                Ok(Event::Eof) => break None,
                Ok(_) => {}
                Err(problem) => break Some(problem.to_string()),
            }
        };
        drop(reader);
        match problem {
            Some(problem) => Err(self.error(RELATIONS, problem, "export it again")),
            None => Ok(root.unwrap_or_else(|| USUAL_MODEL.into())),
        }
    }
}

/// A reader that fails where there is more than it may give.
pub(super) struct Limited<R> {
    file: R,
    left: u64,
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(into)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            io::Error::other("it unpacks to far more than a model of its packed size could be")
        })?;
        Ok(count)
    }
}
