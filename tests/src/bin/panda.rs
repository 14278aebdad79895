//! Writes the Panda of `tests/track.py`: its description, and a model file of the true arm: `panda FILE.urdf FILE.postcard`.

use leastaction_tests::panda;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args().skip(1);
    let mut path = || paths.next().ok_or("usage: panda FILE.urdf FILE.postcard");
    std::fs::write(path()?, panda::description())?;
    Ok(std::fs::write(path()?, panda::model_file()?)?)
}
