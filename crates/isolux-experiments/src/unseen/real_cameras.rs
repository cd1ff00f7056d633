//! The figures of recordings of real cameras, where they are at hand.

use std::path::Path;

use isolux::{Channels, Frame};
use isolux_pipeline::{FrameSource, Observer, PipelineError, diagnose};

use super::checkerboard::{Protocol, spreads};
use super::figure::{Aim, Figure, Unit};
use crate::error::ExperimentError;

/// Where the white squares of the checkerboard saturate, m.
const NEAREST_M: f64 = 0.68;
/// Their label.
const WHITE: u8 = 1;

/// What is measured on the frames of one recording.
type Measure = fn(&mut dyn FrameSource, &dyn Observer) -> Result<Vec<Figure>, ExperimentError>;

/// The recordings that have figures, by their names.
const MEASURED: [(&str, Measure); 2] =
    [("kinect2-checkerboard", checkerboard), ("ifm-o3d303", vendor_scaling)];

/// Refuses a folder without any of the recordings that have figures, before anything takes time.
///
/// # Errors
/// [`ExperimentError::NoRecording`] for such a folder.
pub fn expect_recordings(folder: &Path) -> Result<(), ExperimentError> {
    if MEASURED.iter().any(|(name, _)| folder.join(name).is_dir()) {
        return Ok(());
    }
    let expected = MEASURED.map(|(name, _)| name).join(" or ");
    Err(ExperimentError::NoRecording { folder: folder.to_owned(), expected })
}

/// Measures those recordings that are in `folder`. `progress` is told the name of each.
///
/// # Errors
/// [`ExperimentError`] for a recording that cannot be read or lacks what its figures need.
pub fn figures(
    folder: &Path,
    observer: &dyn Observer,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<Figure>, ExperimentError> {
    let mut figures = Vec::new();
    for (name, measure) in MEASURED {
        let path = folder.join(name);
        if path.is_dir() {
            progress(name);
            let mut recording = isolux_io::open(&path).map_err(PipelineError::from)?;
            figures.extend(measure(&mut recording, observer)?);
        }
    }
    Ok(figures)
}

/// White squares of a board at all distances, tilts and places, in frames that were not fitted on.
fn checkerboard(recording: &mut dyn FrameSource, _: &dyn Observer) -> Result<Vec<Figure>, ExperimentError> {
    let facts = recording.facts();
    let Some(intrinsics) = facts.info.intrinsics.as_ref().map(|recorded| recorded.pinhole) else {
        return Err(ExperimentError::NoIntrinsics { recording: facts.name });
    };
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::TARGET;
    let (mut frames, mut frame) = (Vec::new(), Frame::new(facts.shape));
    while recording.read(frames.len(), wanted, &mut frame)? {
        frames.push(std::mem::replace(&mut frame, Frame::new(facts.shape)));
    }
    let spreads = spreads(&frames, &Protocol { intrinsics, label: WHITE, nearest_m: NEAREST_M })?;
    let last = spreads.len().saturating_sub(1);
    let mut figures = Vec::new();
    for (index, spread) in spreads.iter().enumerate() {
        let aim = |bound| if index == last { Aim::AtMost(bound) } else { Aim::None };
        let what =
            format!("Kinect v2, spread of ln A over white squares, frames not fitted on: {}", spread.name);
        let robust = format!("{what}, 1.4826 MAD");
        figures.push(Figure::new("profile, angle", what, spread.deviation, Unit::Ratio, aim(0.085)));
        figures.push(Figure::new("profile, angle", robust, spread.robust, Unit::Ratio, aim(0.055)));
    }
    Ok(figures)
}

/// What time and place leave of a vendor's own scaling.
fn vendor_scaling(
    recording: &mut dyn FrameSource,
    observer: &dyn Observer,
) -> Result<Vec<Figure>, ExperimentError> {
    let diagnosis = diagnose(recording, observer)?;
    let scaling = diagnosis.vendor_scaling.as_ref().ok();
    let residual = scaling.map_or(f64::NAN, |scaling| scaling.residual);
    let exponent = scaling.and_then(|scaling| scaling.distance.as_ref().ok());
    let exponent = exponent.map_or(f64::NAN, |distance| distance.value);
    let what =
        "ifm O3D303, what integration time and a radial term leave of the vendor's image, sd of the log";
    Ok(vec![
        Figure::new("diagnose", what, residual, Unit::Percent, Aim::AtMost(0.032)),
        Figure::new("diagnose", "the same, exponent of the distance", exponent, Unit::Ratio, Aim::None),
    ])
}
