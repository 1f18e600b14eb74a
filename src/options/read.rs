//! Sections out of tables.
//!
//! Derived code has a copy of all that reading takes for every key; here there is one for every type of value.

use serde::de::{DeserializeOwned, Error as _};
use toml::de::Error;
use toml::{Table, Value};

/// Takes values out of a table, and keeps what is wrong with the first that is.
pub(crate) struct Reader {
    table: Table,
    wrong: Option<Error>,
}

impl Reader {
    /// Nothing is taken yet.
    pub(crate) fn new(table: Table) -> Self {
        Self { table, wrong: None }
    }

    /// Takes the value of a key, if there is one.
    pub(crate) fn take<T: DeserializeOwned>(&mut self, key: &str, into: &mut T) {
        match self.table.remove(key).map(T::deserialize) {
            Some(Ok(value)) => *into = value,
            Some(Err(error)) => self.refuse(error),
            None => {}
        }
    }

    /// Takes the value of a key that has to be there.
    pub(crate) fn demand<T: DeserializeOwned>(&mut self, key: &'static str, into: &mut T) {
        if !self.table.contains_key(key) {
            self.refuse(Error::missing_field(key));
        }
        self.take(key, into);
    }

    /// Takes a section, which has to be there.
    pub(crate) fn section<T: TryFrom<Table, Error = Error>>(&mut self, name: &'static str, into: &mut T) {
        let read = match self.table.remove(name) {
            Some(Value::Table(section)) => T::try_from(section),
            Some(_) => Err(Error::custom(format_args!("`{name}` is no table"))),
            None => Err(Error::missing_field(name)),
        };
        match read {
            Ok(section) => *into = section,
            Err(error) => self.refuse(error),
        }
    }

    /// What was read, unless something is wrong or left.
    ///
    /// # Errors
    /// The first value that is wrong, or a key that nothing was taken for.
    pub(crate) fn end<T>(self, read: T) -> Result<T, Error> {
        let left = self.table.into_iter().next();
        let unknown = left.map(|(key, _)| Error::custom(format_args!("there is no key `{key}`")));
        self.wrong.or(unknown).map_or(Ok(read), Err)
    }

    fn refuse(&mut self, error: Error) {
        self.wrong.get_or_insert(error);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<u32, String> {
        let mut reader = Reader::new(text.parse().expect("a table"));
        let (mut count, mut name) = (7, String::new());
        reader.demand("count", &mut count);
        reader.take("name", &mut name);
        reader.end(count).map_err(|error| error.to_string())
    }

    #[test]
    fn a_value_is_read_and_what_is_missing_wrong_or_unknown_is_named() {
        assert_eq!(read("count = 3\nname = \"a\""), Ok(3));
        assert!(read("name = \"a\"").unwrap_err().contains("missing field `count`"));
        assert!(read("count = 3\nname = 1").unwrap_err().contains("expected a string"));
        assert!(read("count = 3\nsize = 1").unwrap_err().contains("no key `size`"));
    }
}
