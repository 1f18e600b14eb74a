//! Names: those of files as headers say them, and those that nobody can guess.

use super::error::ApiError;
use crate::job::hexadecimal;

/// The value of `Content-Disposition` by which a file is saved under a name of any letters.
pub fn disposition(name: &str) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "._- ".contains(c) { c } else { '_' }).collect();
    let mut any = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b'_' | b'-' => any.push(byte as char),
            _ => any.push_str(&format!("%{byte:02X}")),
        }
    }
    format!("attachment; filename=\"{plain}\"; filename*=UTF-8''{any}")
}

/// A name that nobody can guess.
///
/// # Errors
/// The machine has no random numbers.
pub fn unguessable() -> Result<String, ApiError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(ApiError::internal)?;
    Ok(hexadecimal(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_end_the_header() {
        let text = disposition("a\"b\r\nX: y/é.gcode");
        assert_eq!(
            text,
            "attachment; filename=\"a_b__X_ y__.gcode\"; filename*=UTF-8''a%22b%0D%0AX%3A%20y%2F%C3%A9.gcode"
        );
    }
}
