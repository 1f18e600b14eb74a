//! Lines of a file of any size, in memory that does not grow with it.

use std::io::{self, Read};

use memchr::memchr;

use super::lexer::Line;

/// Bytes read at a time. A line longer than this is no G-code and is cut.
const CHUNK: usize = 1 << 20;

/// Hands over every line, from the first to the last.
///
/// # Errors
/// Those of reading.
pub fn each_line(mut file: impl Read, mut take: impl FnMut(Line<'_>)) -> io::Result<()> {
    let mut buffer = vec![0; CHUNK];
    let (mut filled, mut number, mut offset) = (0, 0, 0);
    loop {
        let read = match file.read(&mut buffer[filled..]) {
            Ok(read) => read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        filled += read;
        let mut begun = 0;
        let mut hand_over = |raw: &[u8]| {
            number += 1;
            take(Line::new(number, offset, raw));
            offset += raw.len();
        };
        while let Some(end) = memchr(b'\n', &buffer[begun..filled]) {
            hand_over(&buffer[begun..=begun + end]);
            begun += end + 1;
        }
        if begun < filled && (read == 0 || filled - begun == CHUNK) {
            hand_over(&buffer[begun..filled]);
            begun = filled;
        }
        if read == 0 {
            return Ok(());
        }
        buffer.copy_within(begun..filled, 0);
        filled -= begun;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader that gives a few bytes at a time.
    struct ShortReads<'a>(&'a [u8]);

    impl Read for ShortReads<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.0.len().min(3).min(buffer.len());
            buffer[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    #[test]
    fn lines_come_whole_however_the_file_is_read() {
        let text = b"G28\r\nG1 X1 Y2\n\n;end";
        let mut seen = Vec::new();
        each_line(ShortReads(text), |line| seen.push((line.number, line.offset, line.raw.to_vec()))).unwrap();
        let whole = super::super::lexer::lines(text).map(|l| (l.number, l.offset, l.raw.to_vec()));
        assert_eq!(seen, whole.collect::<Vec<_>>());
    }
}
