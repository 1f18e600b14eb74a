//! A table of layer heights, as a setting writes it.

/// The lines of a layer table: a height over the bed, and the layer height from there on, millimetres: `0:0.2,
/// 10:0.1`.
///
/// # Errors
/// What is wrong and what is expected.
pub fn layer_heights(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let lines = text.split(',').map(str::trim).filter(|line| !line.is_empty());
    let table: Option<Vec<[f64; 2]>> = lines
        .map(|line| {
            let (from, height) = line.split_once(':')?;
            let [from, height] = [from, height].map(|text| text.trim().parse::<f64>().ok());
            Some([
                from.filter(|mm| mm.is_finite() && *mm >= 0.0)?,
                height.filter(|mm| (0.01..=2.0).contains(mm))?,
            ])
        })
        .collect();
    table.filter(|table| table.windows(2).all(|w| w[0][0] < w[1][0])).ok_or_else(|| {
        "heights over the bed, rising, each with a layer height from 0.01 to 2 mm, are expected, such as \"0:0.2, 10:0.1\""
            .into()
    })
}

/// The same from a file: on each line a height over the bed and a layer height, separated by blanks; `#` begins a
/// comment. Returned as the setting is written.
///
/// # Errors
/// Which line is wrong.
pub fn heights_from_lines(text: &str) -> Result<String, String> {
    let mut out = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            [from, height] if layer_heights(&format!("{from}:{height}")).is_ok() => {
                out.push(format!("{from}:{height}"))
            }
            _ => {
                let line = index + 1;
                return Err(format!(
                    "line {line}: a height over the bed and a layer height are expected, such as 10 0.1"
                ));
            }
        }
    }
    let text = out.join(", ");
    if out.is_empty() { Err("holds no heights".into()) } else { layer_heights(&text).map(|_| text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_rise() {
        assert_eq!(layer_heights("0:0.2, 10 : 0.1,"), Ok(vec![[0.0, 0.2], [10.0, 0.1]]));
        assert_eq!(layer_heights(" "), Ok(Vec::new()));
        for wrong in ["0.2", "5:0.2,5:0.1", "5:0.2,1:0.1", "0:0", "0:9", "-1:0.2", "a:b", "inf:0.2"] {
            assert!(layer_heights(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_file_has_a_line_for_each() {
        assert_eq!(
            heights_from_lines("# z\theight\n0\t0.2\n10\t0.1 # fine\n").as_deref(),
            Ok("0:0.2, 10:0.1")
        );
        assert!(heights_from_lines("0 0.2\n10\n").unwrap_err().contains("line 2"));
        assert!(heights_from_lines("").is_err() && heights_from_lines("5 0.1\n0 0.2\n").is_err());
    }
}
