//! What `isolux calibrate` takes.

use std::path::PathBuf;

use clap::Args;
use isolux::calibration::{REFERENCE_DISTANCE_M, REFERENCE_TIME_US};

use super::values::positive;

/// Fit a camera's calibration from sweeps, targets and scenes
///
/// Every given recording determines a term: an exposure sweep the lookup table over integration time (`lut`), the
/// compression of each pixel (`response`: the more channels, the better) and the noise of the amplitude (`noise`), a
/// distance sweep the polynomial (`cubic`) and the smooth law (`spline`) over distance, a target the smooth law, the
/// illumination profile (`profile`) and the angle of incidence (`angle`) together, a scene `lut`, `spline`,
/// `profile` and `angle` as far as it goes, without knowing any surface. What no recording determines is left out,
/// and why is said; what a sweep or a target determines is not taken from a scene.
///
/// Exposure sweep: a still scene, best a bright wall, while the integration time grows step by step into
/// over-saturation; several frames each. Distance sweep: a flat target facing the camera, at eight or more
/// distances and a few integration times; the reference distance among them. Target: any recording with the `target`
/// channel (equal labels above 0 are one material); best a matt board, carried through the whole image from near to
/// far and tilted by up to 60°. Scene: any recording of things that stand still. With the camera still and several
/// integration times it gives the table and the response; with the camera moving, nearer and farther and turning,
/// everything else. The motion is that of `world_from_camera`, or is estimated from the distances.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux calibrate --exposure-sweep wall --distance-sweep board -o CAMERA.json\n  \
    isolux calibrate --exposure-sweep wall --skip-frames 50 -o CAMERA.json\n  \
    isolux calibrate --distance-sweep board --exclude-time-us 200 -o CAMERA.json\n  \
    isolux calibrate --exposure-sweep wall --target tilted-board -o CAMERA.json\n  \
    isolux calibrate --scene walk-through-the-lab -o CAMERA.json")]
pub(crate) struct CalibrateArgs {
    /// A still scene, integration time varied; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) exposure_sweep: Vec<PathBuf>,
    /// A flat target at several distances; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) distance_sweep: Vec<PathBuf>,
    /// A recording with labelled materials in any pose; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) target: Vec<PathBuf>,
    /// An ordinary recording of unknown things, the camera in the hand or still; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) scene: Vec<PathBuf>,
    /// The calibration file to write
    #[arg(short, long, value_name = "CAMERA.json")]
    pub(crate) output: PathBuf,
    /// Integration time at which amplitudes stay as they are, µs
    #[arg(long, default_value_t = REFERENCE_TIME_US, value_parser = positive)]
    pub(crate) reference_time_us: f64,
    /// Distance at which amplitudes stay as they are, m
    #[arg(long, default_value_t = REFERENCE_DISTANCE_M, value_parser = positive)]
    pub(crate) reference_distance_m: f64,
    /// Side of the central measurement window of distance sweeps, pixels; less than 6 do not tell the noise
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u16).range(6..))]
    pub(crate) window: u16,
    /// Frames to drop after each change of the integration time
    #[arg(long, default_value_t = 0)]
    pub(crate) skip_frames: usize,
    /// An integration time to leave out, µs; may be given several times
    #[arg(long, value_name = "T", value_parser = positive)]
    pub(crate) exclude_time_us: Vec<f64>,
    /// Name of the camera [default: that of the recordings]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// Print the calibration as JSON instead of a table
    #[arg(long)]
    pub(crate) json: bool,
}
