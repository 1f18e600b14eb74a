//! A form with a file, as `multipart/form-data` (RFC 7578), whose length is known before it is sent.

use std::io::Read;

/// What comes before and after the file.
pub(super) struct Form {
    head: Vec<u8>,
    tail: Vec<u8>,
    boundary: String,
}

impl Form {
    /// Fields, then a file. The boundary holds the file's sum, so that it is not in the file.
    pub fn new(fields: &[(&str, &str)], file_name: &str, sum: &str) -> Self {
        let boundary = format!("pathwright-{sum}");
        let mut head = String::new();
        for (name, value) in fields {
            head += &format!(
                "--{boundary}\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n{value}\r\n"
            );
        }
        head += &format!(
            "--{boundary}\r\nContent-Disposition: form-data; name=\"file\"; filename=\"{file_name}\"\r\n\
             Content-Type: application/octet-stream\r\n\r\n"
        );
        let tail = format!("\r\n--{boundary}--\r\n").into_bytes();
        Self { head: head.into_bytes(), tail, boundary }
    }

    pub fn content_type(&self) -> String {
        format!("multipart/form-data; boundary={}", self.boundary)
    }

    pub fn length(&self, file_bytes: u64) -> u64 {
        file_bytes + (self.head.len() + self.tail.len()) as u64
    }

    /// All of it, around what the file is read from.
    pub fn around<'a>(&'a self, file: impl Read + 'a) -> impl Read + 'a {
        self.head.as_slice().chain(file).chain(self.tail.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_length_is_known_before() {
        let form = Form::new(&[("root", "gcodes")], "a b.gcode", "00ff");
        let mut all = String::new();
        form.around(&b"G28\n"[..]).read_to_string(&mut all).unwrap();
        assert_eq!(all.len() as u64, form.length(4));
        assert_eq!(all.matches("pathwright-00ff").count(), 3);
        assert!(
            all.contains("name=\"root\"\r\n\r\ngcodes\r\n")
                && all.ends_with("G28\n\r\n--pathwright-00ff--\r\n")
        );
    }
}
