//! The figures of recordings of real cameras, where they are at hand.

use std::path::Path;

use isolux::{Channels, Frame};
use isolux_experiments::unseen::checkerboard::{Protocol, spreads};
use isolux_experiments::unseen::figure::{Aim, Figure, Unit};
use isolux_io::Recording;
use isolux_pipeline::diagnose;

use crate::failure::{Failure, Outcome};
use crate::terminal::Terminal;

/// Where the white squares of the checkerboard saturate, m.
const NEAREST_M: f64 = 0.68;
/// Their label.
const WHITE: u8 = 1;

/// The recordings that have figures, by their names.
const MEASURED: [(&str, Measure); 2] =
    [("kinect2-checkerboard", checkerboard), ("ifm-o3d303", vendor_scaling)];

/// Measures those recordings that are in `folder`.
pub(super) fn figures(folder: &Path, progress: &mut dyn FnMut(&str)) -> Outcome<Vec<Figure>> {
    let mut figures = Vec::new();
    for (name, measure) in MEASURED {
        let path = folder.join(name);
        if path.is_dir() {
            progress(name);
            figures.extend(measure(&mut isolux_io::open(&path)?)?);
        }
    }
    Ok(figures)
}

/// Refuses a folder without any of them, before anything takes time.
pub(super) fn expect_recordings(folder: &Path) -> Outcome {
    if MEASURED.iter().any(|(name, _)| folder.join(name).is_dir()) {
        return Ok(());
    }
    Err(Failure::data(format!(
        "`{}`: no recording found that has a figure, kinect2-checkerboard or ifm-o3d303 expected",
        folder.display()
    )))
}

type Measure = fn(&mut Box<dyn Recording>) -> Outcome<Vec<Figure>>;

/// White squares of a board at all distances, tilts and places, in frames that were not fitted on.
fn checkerboard(recording: &mut Box<dyn Recording>) -> Outcome<Vec<Figure>> {
    let metadata = recording.metadata().clone();
    let Some(intrinsics) = metadata.info.intrinsics.as_ref().map(|recorded| recorded.pinhole) else {
        return Err(Failure::data(format!(
            "`{}`: no intrinsics found in its recording.json, {{fx, fy, cx, cy}} expected",
            metadata.path.display()
        )));
    };
    let wanted = Channels::AMPLITUDE | Channels::DISTANCE | Channels::TARGET;
    let mut frames = Vec::new();
    for index in 0..metadata.require_frame_count()? {
        let mut frame = Frame::new(metadata.shape);
        recording.read_frame(index, wanted, &mut frame)?;
        frames.push(frame);
    }
    let protocol = Protocol { intrinsics, label: WHITE, nearest_m: NEAREST_M };
    let spreads = spreads(&frames, &protocol).map_err(Failure::data)?;
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
fn vendor_scaling(recording: &mut Box<dyn Recording>) -> Outcome<Vec<Figure>> {
    let diagnosis = diagnose(recording, &Terminal::default())?;
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
