//! Records of jobs, works and results on the disk: what is committed survives whatever happens to the process.
//!
//! redb, as it is Rust alone, commits with one flush, and all that is asked for is found by its key.

use std::path::Path;

use redb::{Database, ReadableDatabase, ReadableTable, TableDefinition};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::record::{Job, Kept, Work};

/// A record of each kind by its key, as JSON.
type Table = TableDefinition<'static, &'static str, &'static [u8]>;

const JOBS: Table = TableDefinition::new("jobs");
const WORKS: Table = TableDefinition::new("works");
const RESULTS: Table = TableDefinition::new("results");

/// Memory for parts of the database, bytes.
const CACHE_BYTES: usize = 16 << 20;

/// Why the store cannot do something.
#[derive(Debug, thiserror::Error)]
#[error("the store of jobs: {0}")]
pub struct StoreError(String);

impl<E: Into<redb::Error>> From<E> for StoreError {
    fn from(error: E) -> Self {
        Self(error.into().to_string())
    }
}

/// Records on the disk.
#[derive(Debug)]
pub struct Store(Database);

/// Changes that are made together or not at all.
#[derive(Default)]
pub struct Changes(Vec<(Table, String, Option<Vec<u8>>)>);

impl Changes {
    /// A job is new or another.
    pub fn job(&mut self, id: &str, job: &Job) {
        self.put(JOBS, id, job);
    }

    /// A work is new or another.
    pub fn work(&mut self, key: &str, work: &Work) {
        self.put(WORKS, key, work);
    }

    /// A result is new or another.
    pub fn result(&mut self, key: &str, kept: &Kept) {
        self.put(RESULTS, key, kept);
    }

    /// A job is gone.
    pub fn no_job(&mut self, id: &str) {
        self.0.push((JOBS, id.to_owned(), None));
    }

    /// A work is gone.
    pub fn no_work(&mut self, key: &str) {
        self.0.push((WORKS, key.to_owned(), None));
    }

    /// A result is gone.
    pub fn no_result(&mut self, key: &str) {
        self.0.push((RESULTS, key.to_owned(), None));
    }

    fn put(&mut self, table: Table, key: &str, value: &impl Serialize) {
        let value = serde_json::to_vec(value).expect("records are plain values");
        self.0.push((table, key.to_owned(), Some(value)));
    }
}

/// All records of a store.
#[derive(Debug, Default)]
pub struct Records {
    /// Jobs by their ids.
    pub jobs: Vec<(String, Job)>,
    /// Works by their keys.
    pub works: Vec<(String, Work)>,
    /// Results by their keys.
    pub results: Vec<(String, Kept)>,
}

impl Store {
    /// Opens or makes the store, and reads what is in it.
    ///
    /// # Errors
    /// It is in use by another process, is no store, or cannot be written.
    pub fn open(path: &Path) -> Result<(Self, Records), StoreError> {
        let mut builder = Database::builder();
        builder.set_cache_size(CACHE_BYTES);
        let store = Self(builder.create(path)?);
        let writing = store.0.begin_write()?;
        for table in [JOBS, WORKS, RESULTS] {
            writing.open_table(table)?;
        }
        writing.commit()?;
        let records =
            Records { jobs: store.all(JOBS)?, works: store.all(WORKS)?, results: store.all(RESULTS)? };
        Ok((store, records))
    }

    /// Makes changes; when this returns they are on the disk.
    ///
    /// # Errors
    /// The disk is full or broken; then nothing has changed.
    pub fn commit(&self, changes: &Changes) -> Result<(), StoreError> {
        if changes.0.is_empty() {
            return Ok(());
        }
        let writing = self.0.begin_write()?;
        for (table, key, value) in &changes.0 {
            let mut table = writing.open_table(*table)?;
            match value {
                Some(value) => table.insert(key.as_str(), value.as_slice())?,
                None => table.remove(key.as_str())?,
            };
        }
        writing.commit()?;
        Ok(())
    }

    fn all<T: DeserializeOwned>(&self, table: Table) -> Result<Vec<(String, T)>, StoreError> {
        let reading = self.0.begin_read()?;
        let table = reading.open_table(table)?;
        let mut all = Vec::new();
        for entry in table.iter()? {
            let (key, value) = entry?;
            // What another version wrote and this one does not know is passed over.
            if let Ok(value) = serde_json::from_slice(value.value()) {
                all.push((key.value().to_owned(), value));
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_committed_is_there_when_the_store_is_opened_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("jobs.redb");
        let kept = |used| Kept { file_name: None, binary: false, gcode_bytes: 3, bytes: 5, runs: 1, used };
        let (store, _) = Store::open(&path).unwrap();
        let mut changes = Changes::default();
        changes.result("a", &kept(1));
        changes.result("b", &kept(2));
        store.commit(&changes).unwrap();
        let mut changes = Changes::default();
        changes.no_result("a");
        store.commit(&changes).unwrap();
        assert!(Store::open(&path).is_err(), "one process at a time");
        drop(store);
        let (_, records) = Store::open(&path).unwrap();
        assert_eq!(records.results, [("b".to_owned(), kept(2))]);
        assert!(records.jobs.is_empty() && records.works.is_empty());
    }
}
