//! Sizes of thumbnails, as a setting writes them.

/// Width and height in pixels of each thumbnail: `32x32,300x300`.
///
/// # Errors
/// What is wrong and what is expected.
pub fn thumbnail_sizes(text: &str) -> Result<Vec<[u32; 2]>, String> {
    let sizes = text.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| {
        let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=2000).contains(side));
        let (width, height) = size.split_once(['x', 'X'])?;
        Some([side(width.trim())?, side(height.trim())?])
    });
    sizes
        .collect::<Option<_>>()
        .ok_or_else(|| "sizes such as \"32x32,300x300\" are expected, up to 2000x2000".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_width_times_height() {
        assert_eq!(thumbnail_sizes("32x32, 400X300"), Ok(vec![[32, 32], [400, 300]]));
        assert_eq!(thumbnail_sizes(""), Ok(Vec::new()));
        for wrong in ["32", "0x32", "32x9999", "32x", "axb"] {
            assert!(thumbnail_sizes(wrong).is_err(), "{wrong}");
        }
    }
}
