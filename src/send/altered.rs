//! A file that a host has written into: plug-ins of OctoPrint mark objects and times, for example.

use std::io::{self, BufRead};

/// Whether all commands of a file are in another one, in their order; comments and blanks do not count.
pub(super) fn has_commands(of: impl BufRead, in_other: impl BufRead) -> io::Result<bool> {
    let mut wanted = Commands(of);
    let mut others = Commands(in_other);
    while let Some(command) = wanted.next()? {
        loop {
            match others.next()? {
                Some(other) if other == command => break,
                Some(_) => {}
                None => return Ok(false),
            }
        }
    }
    Ok(true)
}

/// The lines of a file that are more than comments.
struct Commands<R>(R);

impl<R: BufRead> Commands<R> {
    fn next(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut line = Vec::new();
        while self.0.read_until(b'\n', &mut line)? > 0 {
            let end = line.iter().position(|byte| *byte == b';').unwrap_or(line.len());
            let command = line[..end].trim_ascii();
            if !command.is_empty() {
                return Ok(Some(command.to_vec()));
            }
            line.clear();
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn added_lines_and_comments_are_no_loss_and_a_lost_or_moved_command_is_one() {
        let ours = "G28\n; printing object a\nG1 X1 E1 ; here\n\nG1 X1 E1\nM84";
        for (theirs, wanted) in [
            ("@left 5\nG28\n@object a\nG1 X1 E1\nG1 X1 E1\nM84\n@end\n", true),
            (ours, true),
            ("G28\nG1 X1 E1\nM84\n", false),
            ("G28\nM84\nG1 X1 E1\nG1 X1 E1\n", false),
            ("G28\nG1 X1 E1\nG1 X1 E12\nM84\n", false),
            ("", false),
        ] {
            assert_eq!(has_commands(ours.as_bytes(), theirs.as_bytes()).unwrap(), wanted, "{theirs}");
        }
    }
}
