//! The command line, as clap reads it.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use isolux::calibration::{REFERENCE_DISTANCE_M, REFERENCE_TIME_US};
use isolux::specular::{HistogramRule, PercentRule, SigmaRule};
use isolux::standardize::{DenoiseStep, DistanceStep, Method, SpecularStep, TimeStep};
use isolux::{Choice, DenoiseRule, SpecularRule};

/// Makes the amplitude images of time-of-flight cameras comparable: one material has one value, whatever the
/// integration time and the distance, without specular outliers.
///
/// A recording (REC) is a folder of .npy files with recording.json, or the same in one .npz with a .json beside
/// it. `isolux info REC` says what a recording holds and what can be done with it; `isolux demo` shows
/// everything without any input.
#[derive(Debug, Parser)]
#[command(name = "isolux", version, max_term_width = 100)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Info(InfoArgs),
    Calibrate(CalibrateArgs),
    Standardize(StandardizeArgs),
    Evaluate(EvaluateArgs),
    Diagnose(DiagnoseArgs),
    Simulate(SimulateArgs),
    Paper(PaperArgs),
    Completions(CompletionsArgs),
}

/// Simulate a camera, calibrate it, standardize its recordings, and show what that is good for
///
/// Needs no input. Writes recordings, a calibration and before/after images into DIR.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  isolux demo\n  isolux demo /tmp/demo --seed 2")]
pub(crate) struct DemoArgs {
    /// Folder to create; an earlier demo in it is replaced
    #[arg(default_value = "isolux-demo")]
    pub(crate) dir: PathBuf,
    /// Seed of the simulated noise
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
}

/// Say what a recording holds, and what can be done with it
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  isolux info recordings/desk\n  isolux info desk.npz --json")]
pub(crate) struct InfoArgs {
    /// The recording
    #[arg(value_name = "REC")]
    pub(crate) recording: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Fit a camera's calibration from sweeps
///
/// Every given recording determines a term: an exposure sweep the lookup table over integration time (`lut`), a
/// distance sweep the polynomial (`cubic`) and the smooth law (`spline`) over distance. What no recording determines
/// is left out.
///
/// Exposure sweep: a still scene, best a bright wall, while the integration time grows step by step into
/// over-saturation; several frames each. Distance sweep: a flat target facing the camera, at eight or more
/// distances and a few integration times; the reference distance among them.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux calibrate --exposure-sweep wall --distance-sweep board -o CAMERA.json\n  \
    isolux calibrate --exposure-sweep wall --skip-frames 50 -o CAMERA.json\n  \
    isolux calibrate --distance-sweep board --exclude-time-us 200 -o CAMERA.json")]
pub(crate) struct CalibrateArgs {
    /// A still scene, integration time varied; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) exposure_sweep: Vec<PathBuf>,
    /// A flat target at several distances; may be given several times
    #[arg(long, value_name = "REC")]
    pub(crate) distance_sweep: Vec<PathBuf>,
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

/// Standardize a recording
///
/// The output is a recording with `standardized_amplitude` (f32, NaN where invalid) and `flags` (u16; their
/// meaning is in its recording.json). Without -c, textbook physics is used (t_ref/t, d²), as far as the channels
/// are there.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux standardize desk -o desk-standardized\n  \
    isolux standardize desk -c CAMERA.json -o desk-standardized.npz --keep-input\n  \
    isolux standardize desk -c CAMERA.json -o out --method paper --specular none\n  \
    isolux standardize desk -o out --time linear --distance none\n  \
    isolux standardize desk -c CAMERA.json -o out --denoise wiener")]
pub(crate) struct StandardizeArgs {
    /// The recording
    #[arg(value_name = "REC")]
    pub(crate) recording: PathBuf,
    /// The camera's calibration
    #[arg(short, long, value_name = "CAMERA.json")]
    pub(crate) calibration: Option<PathBuf>,
    /// Recording to write: a folder, or an archive when the name ends in .npz
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) steps: StepArgs,
    /// Copy the input's channels into the output
    #[arg(long)]
    pub(crate) keep_input: bool,
    /// Replace OUT if it is there
    #[arg(long)]
    pub(crate) force: bool,
    /// Threads to use [default: all cores]; the output does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: Option<u16>,
    /// Print the summary as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which steps to apply.
#[derive(Debug, Default, Args)]
pub(crate) struct StepArgs {
    /// Terms to use where no single step is given
    #[arg(long, value_enum, default_value_t)]
    pub(crate) method: MethodArg,
    /// Step for the integration time [default: by method]
    #[arg(long, value_enum)]
    pub(crate) time: Option<TimeArg>,
    /// Step for the distance [default: by method]
    #[arg(long, value_enum)]
    pub(crate) distance: Option<DistanceArg>,
    /// Denoise the distance before it scales, where a distance step is applied [default: none]
    #[arg(long, value_enum)]
    pub(crate) denoise: Option<DenoiseArg>,
    /// Step for highlights [default: histogram]
    #[arg(long, value_enum)]
    pub(crate) specular: Option<SpecularArg>,
    /// Pixels that a value needs, for --specular histogram [default: max(2, 0.0005 of the valid pixels)]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) specular_occurrences: Option<u32>,
    /// Standard deviations above the mean, for --specular sigma [default: 4]
    #[arg(long, value_name = "K", value_parser = positive)]
    pub(crate) specular_deviations: Option<f64>,
    /// Fraction of the maximum, for --specular percent [default: 0.9]
    #[arg(long, value_name = "F", value_parser = fraction, conflicts_with = "specular_quantile")]
    pub(crate) specular_fraction: Option<f64>,
    /// Quantile instead of a fraction of the maximum, for --specular percent
    #[arg(long, value_name = "Q", value_parser = fraction)]
    pub(crate) specular_quantile: Option<f64>,
    /// Flag amplitudes below this as LOW_SIGNAL, DN [default: from the calibration]
    #[arg(long, value_name = "DN", value_parser = positive)]
    pub(crate) low_signal_dn: Option<f64>,
}

/// Print before/after figures of a recording
///
/// For a still scene at several integration times: how much each pixel and the image still vary, whether one
/// threshold keeps finding the same pixels, how far the histograms lie apart. For any scene: how the amplitude
/// goes with distance, and the noise. The valid fraction stands beside each figure.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  isolux evaluate desk -c CAMERA.json\n  isolux evaluate desk -c CAMERA.json --trusted --report desk.html\n  isolux evaluate desk --json"
)]
pub(crate) struct EvaluateArgs {
    /// The recording
    #[arg(value_name = "REC")]
    pub(crate) recording: PathBuf,
    /// The camera's calibration
    #[arg(short, long, value_name = "CAMERA.json")]
    pub(crate) calibration: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) steps: StepArgs,
    /// Leave out pixels flagged LOW_SIGNAL or SATURATED, before and after
    #[arg(long)]
    pub(crate) trusted: bool,
    /// Also write a page with the figures, curves and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Say whether a stream is raw, already corrected, gamma'd or clipped
///
/// Regresses the logarithm of the amplitude on those of integration time and distance and on r² (r: distance from
/// the principal point in units of the half diagonal), each where the recording determines it: times from a still
/// scene, distances from one labelled target (`target` channel) or one vendor reflectivity. With
/// `vendor_amplitude`, the same for the vendor's scaling; with `phase_samples`, for the amplitude against eq. 1.
/// Says what the recording cannot tell, and what to record instead. All intervals are 95 %, from errors clustered
/// by image block and by frame; a residual is the scatter of the logarithm around the fit, 10 % = 0.1.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux diagnose desk\n  \
    isolux diagnose desk.npz --json | jq .findings\n  \
    isolux simulate board-distances -o board && isolux diagnose board")]
pub(crate) struct DiagnoseArgs {
    /// The recording
    #[arg(value_name = "REC")]
    pub(crate) recording: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Record a scene with the simulated camera
///
/// SCENE is the name of a built-in scene or a TOML file of your own. `isolux simulate --list` names the scenes and
/// cameras, `--print NAME` prints a built-in scene as a pattern for your own.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux simulate --list\n  \
    isolux simulate patches -o patches --seed 7\n  \
    isolux simulate --print patches > mine.toml\n  \
    isolux simulate mine.toml -o mine --camera o3d-like")]
pub(crate) struct SimulateArgs {
    /// Name of a built-in scene, or a TOML file
    #[arg(required_unless_present_any = ["list", "print"])]
    pub(crate) scene: Option<String>,
    /// Recording to write
    #[arg(short, long, value_name = "REC", required_unless_present_any = ["list", "print"])]
    pub(crate) output: Option<PathBuf>,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Name of a built-in camera, or a TOML file [default: the scene's]
    #[arg(long, value_name = "CAMERA")]
    pub(crate) camera: Option<String>,
    /// Write the four raw bins too
    #[arg(long)]
    pub(crate) phase_samples: bool,
    /// Write the truth too: `true_distance_m` and `reflectivity`
    #[arg(long)]
    pub(crate) truth: bool,
    /// Replace the output if it is there
    #[arg(long)]
    pub(crate) force: bool,
    /// Name the built-in scenes and cameras
    #[arg(long)]
    pub(crate) list: bool,
    /// Print a built-in scene or camera
    #[arg(long, value_name = "NAME", conflicts_with = "list")]
    pub(crate) print: Option<String>,
}

/// Repeat every experiment of the paper on the simulated SR-3100
///
/// Writes one page with each figure, what the paper states about it, what is measured here and whether it holds, and
/// the numbers of every figure as CSV beside it.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  isolux paper\n  isolux paper -o /tmp/paper --seed 2")]
pub(crate) struct PaperArgs {
    /// Folder for index.html, data/ and pictures/
    #[arg(short, long, value_name = "DIR", default_value = "isolux-paper")]
    pub(crate) output: PathBuf,
    /// Seed of the simulated noise
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
}

/// Print completions for a shell
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  isolux completions bash > ~/.local/share/bash-completion/completions/isolux"
)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum MethodArg {
    /// lut, cubic and histogram; the calibration must hold them
    Paper,
    /// The best terms that the calibration holds
    #[default]
    Best,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum TimeArg {
    /// The calibration's lookup table
    Lut,
    /// t_ref / t
    Linear,
    /// Leave it in
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum DistanceArg {
    /// The calibration's polynomial
    Cubic,
    /// The calibration's smooth law
    Spline,
    /// (d / d_ref)²
    Square,
    /// Eq. 5 of the paper: ((2d)² + 1) / ((2 d_ref)² + 1)
    Eq5,
    /// Leave it in
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum DenoiseArg {
    /// Scale by the distance as it was delivered
    None,
    /// Median of 3×3 pixels
    Median,
    /// Local Wiener filter of 5×5 pixels: the fast one
    Wiener,
    /// Plane fits in 7×7 pixels: the one for slanted surfaces and quality
    Plane,
    /// Mean over the last 8 frames, for still scenes
    Temporal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpecularArg {
    /// Limit at the highest value with enough pixels
    Histogram,
    /// Limit at mean + k standard deviations
    Sigma,
    /// Limit at a fraction of the maximum, or a quantile
    Percent,
    /// Leave them
    None,
}

impl StepArgs {
    /// The steps as the core takes them; a parameter of another rule than the chosen one is a usage error.
    pub(crate) fn choice(&self) -> Result<Choice, crate::failure::Failure> {
        let method = match self.method {
            MethodArg::Paper => Method::Paper,
            MethodArg::Best => Method::Best,
        };
        let time = self.time.map(|time| match time {
            TimeArg::Lut => TimeStep::Lut,
            TimeArg::Linear => TimeStep::Linear,
            TimeArg::None => TimeStep::None,
        });
        let distance = self.distance.map(|distance| match distance {
            DistanceArg::Cubic => DistanceStep::Cubic,
            DistanceArg::Spline => DistanceStep::Spline,
            DistanceArg::Square => DistanceStep::Square,
            DistanceArg::Eq5 => DistanceStep::Eq5,
            DistanceArg::None => DistanceStep::None,
        });
        let denoise = self.denoise.map(|denoise| match denoise {
            DenoiseArg::None => DenoiseStep::None,
            DenoiseArg::Median => DenoiseStep::Smooth(DenoiseRule::Median),
            DenoiseArg::Wiener => DenoiseStep::Smooth(DenoiseRule::Wiener),
            DenoiseArg::Plane => DenoiseStep::Smooth(DenoiseRule::Plane),
            DenoiseArg::Temporal => DenoiseStep::Smooth(DenoiseRule::Temporal),
        });
        let low_signal_below_dn = self.low_signal_dn.map(|dn| dn as f32);
        Ok(Choice { method, time, denoise, distance, specular: Some(self.specular()?), low_signal_below_dn })
    }

    fn specular(&self) -> Result<SpecularStep, crate::failure::Failure> {
        let chosen = self.specular.unwrap_or(SpecularArg::Histogram);
        let given = [
            (self.specular_occurrences.is_some(), "--specular-occurrences", SpecularArg::Histogram),
            (self.specular_deviations.is_some(), "--specular-deviations", SpecularArg::Sigma),
            (self.specular_fraction.is_some(), "--specular-fraction", SpecularArg::Percent),
            (self.specular_quantile.is_some(), "--specular-quantile", SpecularArg::Percent),
        ];
        if let Some((_, option, rule)) = given.iter().find(|(given, _, rule)| *given && *rule != chosen) {
            let (rule, chosen) = (format!("{rule:?}").to_lowercase(), format!("{chosen:?}").to_lowercase());
            let message = format!("{option} belongs to --specular {rule}, but --specular {chosen} is chosen");
            return Err(crate::failure::Failure::usage(message));
        }
        Ok(match chosen {
            SpecularArg::Histogram => SpecularStep::Limit(SpecularRule::Histogram(HistogramRule {
                occurrences: self.specular_occurrences,
            })),
            SpecularArg::Sigma => SpecularStep::Limit(SpecularRule::Sigma(SigmaRule {
                deviations: self.specular_deviations.unwrap_or(SigmaRule::default().deviations),
            })),
            SpecularArg::Percent => {
                SpecularStep::Limit(SpecularRule::Percent(match self.specular_quantile {
                    Some(quantile) => PercentRule::Quantile(quantile),
                    None => self.specular_fraction.map_or_else(PercentRule::default, PercentRule::OfMaximum),
                }))
            }
            SpecularArg::None => SpecularStep::None,
        })
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("{text} is no number"))?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("a positive number expected".to_owned()) }
}

fn fraction(text: &str) -> Result<f64, String> {
    let value = positive(text)?;
    if value <= 1.0 { Ok(value) } else { Err("a fraction above 0 and up to 1 expected".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn parameters_of_another_rule_are_refused() {
        let steps = StepArgs { specular_deviations: Some(3.0), ..StepArgs::default() };
        assert!(steps.choice().unwrap_err().to_string().contains("belongs to --specular sigma"));
    }
}
