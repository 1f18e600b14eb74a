//! G-code as text to binary G-code, or back: `convert INPUT OUTPUT`, by the first bytes of the input.

use std::error::Error;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek};

use pathwright_bgcode::{Contents, MAGIC, Options, Text, pack};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output] = arguments.as_slice() else { return Err("usage: convert INPUT OUTPUT".into()) };
    let mut input = BufReader::new(File::open(input)?);
    let mut magic = Vec::new();
    input.by_ref().take(4).read_to_end(&mut magic)?;
    input.rewind()?;
    let mut output = BufWriter::new(File::create(output)?);
    if magic == MAGIC {
        std::io::copy(&mut Text::open(input)?, &mut output)?;
    } else {
        let contents = Contents::of(&mut input)?;
        input.rewind()?;
        pack(&contents, input, Options::default(), output)?;
    }
    Ok(())
}
