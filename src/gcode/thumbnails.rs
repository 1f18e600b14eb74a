//! Sizes and formats of thumbnails, as a setting writes them.

/// A picture in the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThumbnailSpec {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// How it is written.
    pub format: ThumbnailFormat,
}

/// How a picture is written in the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThumbnailFormat {
    /// PNG in base64: Moonraker, OctoPrint, Prusa and most others.
    Png,
    /// JPEG in base64.
    Jpg,
    /// QOI in base64: Prusa.
    Qoi,
    /// Runs of up to 1024 colours, in characters: Elegoo Neptune, some of Anycubic and Artillery.
    ColPic,
    /// RGB565 in hexadecimal digits: the TFT screens of BIGTREETECH.
    BttTft,
}

impl ThumbnailFormat {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Png, Self::Jpg, Self::Qoi, Self::ColPic, Self::BttTft];

    /// Its name in settings, as in other slicers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpg => "JPG",
            Self::Qoi => "QOI",
            Self::ColPic => "COLPIC",
            Self::BttTft => "BTT_TFT",
        }
    }
}

/// The thumbnails of a list such as `32x32, 300x300/QOI`; without a format they are PNG.
///
/// # Errors
/// What is wrong and what is expected.
pub fn thumbnail_list(text: &str) -> Result<Vec<ThumbnailSpec>, String> {
    text.split(',').map(str::trim).filter(|one| !one.is_empty()).map(spec).collect()
}

fn spec(text: &str) -> Result<ThumbnailSpec, String> {
    let (size, format) = text.split_once('/').unwrap_or((text, ThumbnailFormat::Png.name()));
    let format = format.trim();
    let known = ThumbnailFormat::ALL.into_iter().find(|known| known.name().eq_ignore_ascii_case(format));
    let format = known.ok_or_else(|| {
        let names = ThumbnailFormat::ALL.map(ThumbnailFormat::name);
        format!("`{format}` is no format of thumbnails; there are {}", names.join(", "))
    })?;
    let side = |text: &str| text.trim().parse::<u32>().ok().filter(|side| (1..=2000).contains(side));
    let size = size.split_once(['x', 'X']).and_then(|(width, height)| Some([side(width)?, side(height)?]));
    match size {
        Some(size) => Ok(ThumbnailSpec { size, format }),
        None => Err("sizes such as \"32x32,300x300/QOI\" are expected, up to 2000x2000".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_width_times_height_with_a_format() {
        let all = thumbnail_list("32x32, 400X300/QOI,16x16/jpg , 8x9 / COLPIC, 7x7/BTT_TFT").unwrap();
        let all: Vec<_> = all.iter().map(|one| (one.size, one.format.name())).collect();
        assert_eq!(
            all,
            [
                ([32, 32], "PNG"),
                ([400, 300], "QOI"),
                ([16, 16], "JPG"),
                ([8, 9], "COLPIC"),
                ([7, 7], "BTT_TFT")
            ]
        );
        assert_eq!(thumbnail_list(""), Ok(Vec::new()));
        for wrong in ["32", "0x32", "32x9999", "32x", "axb", "32x32,9/PNG"] {
            assert!(thumbnail_list(wrong).unwrap_err().contains("are expected"), "{wrong}");
        }
    }

    #[test]
    fn an_unknown_format_names_those_that_exist() {
        let error = thumbnail_list("32x32/GIF").unwrap_err();
        assert_eq!(error, "`GIF` is no format of thumbnails; there are PNG, JPG, QOI, COLPIC, BTT_TFT");
    }
}
