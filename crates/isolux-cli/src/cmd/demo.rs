//! `isolux demo`: simulate, calibrate, standardize, evaluate; no input needed.

use crate::args::DemoArgs;
use crate::failure::Outcome;

pub fn run(_args: &DemoArgs) -> Outcome {
    Ok(())
}
