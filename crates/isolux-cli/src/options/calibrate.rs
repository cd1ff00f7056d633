//! What `isolux calibrate` takes.

use std::path::PathBuf;

use clap::Args;
use isolux::calibration::REFERENCE_DISTANCE_M;

use super::values::positive;

/// Fit a camera's calibration from sweeps, targets and scenes
///
/// Give one recording or several. Each kind of recording determines its own terms, that is, corrections.
///
/// Exposure sweep: a still scene, best a bright wall, while the integration time grows step by step until the image is
/// over-saturated; several frames at each time. It determines the table over the integration time (`lut`), the
/// saturation of the pixels (`response`; the more channels, the better) and the noise of the amplitude (`noise`).
///
/// Distance sweep: a flat board that faces the camera, at eight or more distances and a few integration times, the
/// reference distance among them. It determines the polynomial (`cubic`) and the smooth law (`spline`) over distance.
///
/// Target: any recording with the channel `target` (equal labels above 0 are one material). Best is a matt board,
/// carried through the whole image from near to far and tilted by up to 60°. It determines `spline`, the illumination
/// profile (`profile`) and the angle of incidence (`angle`) together.
///
/// Scene: any recording of things that stand still; their surfaces need not be known. A still camera at several
/// integration times determines `lut` and `response`. A camera that moves nearer and farther and turns determines
/// everything else. The motion is that of `world_from_camera`, or it is estimated from the distances.
///
/// A term that no recording determines is left out, and the reason is said. What a sweep or a target determines is
/// not taken from a scene.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux calibrate --exposure-sweep wall --distance-sweep board -o CAMERA.json\n  \
    isolux calibrate --exposure-sweep wall --skip-frames 50 -o CAMERA.json\n  \
    isolux calibrate --distance-sweep board --exclude-time-us 200 -o CAMERA.json\n  \
    isolux calibrate --exposure-sweep wall --target tilted-board -o CAMERA.json\n  \
    isolux calibrate --scene walk-through-the-lab -o CAMERA.json")]
pub(crate) struct CalibrateArgs {
    /// Exposure sweep: a still scene at many integration times; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) exposure_sweep: Vec<PathBuf>,
    /// Distance sweep: a flat board at several distances; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) distance_sweep: Vec<PathBuf>,
    /// Target: labelled materials in any pose; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) target: Vec<PathBuf>,
    /// Scene: an ordinary recording of things that stand still, the camera moving or not; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) scene: Vec<PathBuf>,
    /// The calibration file to write
    #[arg(short, long, value_name = "CAMERA.json")]
    pub(crate) output: PathBuf,
    /// Reference integration time: there, amplitudes keep their value, µs [default: 8200, or the nearest to it that all
    /// exposure sweeps cover]
    #[arg(long, value_parser = positive)]
    pub(crate) reference_time_us: Option<f64>,
    /// Reference distance: there, amplitudes keep their value, m
    #[arg(long, default_value_t = REFERENCE_DISTANCE_M, value_parser = positive)]
    pub(crate) reference_distance_m: f64,
    /// Side of the square in the image's centre that distance sweeps are measured in, pixels; at least 6, to measure
    /// the noise
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u16).range(6..))]
    pub(crate) window: u16,
    /// Frames to drop after each change of the integration time, while the camera settles
    #[arg(long, default_value_t = 0)]
    pub(crate) skip_frames: usize,
    /// An integration time to leave out, µs; may be given several times
    #[arg(long, value_name = "T", value_parser = positive)]
    pub(crate) exclude_time_us: Vec<f64>,
    /// Name of the camera [default: that of the recordings]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// Write the calibration even if its recordings contradict each other, so that terms are wrong by 5 % or more
    #[arg(long)]
    pub(crate) accept_poor_fit: bool,
    /// Print the calibration as JSON instead of a table
    #[arg(long)]
    pub(crate) json: bool,
}
