//! The commands and what each takes.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::calibrate::CalibrateArgs;
use super::steps::StepArgs;
use super::values::not_negative;

/// isolux makes the amplitude images of time-of-flight cameras comparable: one material has one value, whatever the
/// integration time and the distance, without specular outliers.
///
/// A recording (REC) is a folder of .npy files with recording.json, or the same in one .npz with a .json beside
/// it. `isolux info REC` says what a recording holds and what can be done with it. `isolux demo` shows
/// everything and needs no input.
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
    Figures(FiguresArgs),
    Completions(CompletionsArgs),
}

/// Simulate a camera, calibrate it, standardize its recordings, and show the result
///
/// The demo needs no input. It writes recordings, a calibration, images before and after, and a page into DIR.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  isolux demo\n  isolux demo /tmp/demo --seed 2")]
pub(crate) struct DemoArgs {
    /// Folder to create; a demo that is already in it is replaced
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

/// Standardize a recording
///
/// The output is a recording with `standardized_amplitude` (f32, NaN where invalid), `flags` (u16; their
/// meaning is in its recording.json) and, where the noise is known, `sigma`, the predicted standard deviation.
/// Without -c, textbook physics is used (t_ref/t, d²), as far as the recording has the channels.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux standardize desk -o desk-standardized\n  \
    isolux standardize desk -c CAMERA.json -o desk-standardized.npz --keep-input\n  \
    isolux standardize desk -c CAMERA.json -o out --method paper --specular none\n  \
    isolux standardize desk -o out --time linear --distance none\n  \
    isolux standardize desk -c CAMERA.json -o out --denoise wiener\n  \
    isolux standardize desk -c CAMERA.json -o out --time response\n  \
    isolux standardize desk -o out --read-noise-dn 4 --merge-bracket")]
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
    /// Merge frames of a still scene at several integration times (a bracket) into one. The frames are weighted by the
    /// predicted sigma; saturated pixels are left out. A bracket ends where an integration time recurs, or after N
    /// frames
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, conflicts_with = "keep_input",
          value_parser = clap::value_parser!(u16).range(2..))]
    pub(crate) merge_bracket: Option<Option<u16>>,
    /// Copy the channels of the input into the output
    #[arg(long)]
    pub(crate) keep_input: bool,
    /// Replace OUT if it exists
    #[arg(long)]
    pub(crate) force: bool,
    /// Threads to use [default: all cores]; the output does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: Option<u16>,
    /// Print the summary as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Measure how much better a recording is after standardizing
///
/// For a still scene at several integration times, the figures say how much each pixel and the image vary, whether
/// one threshold finds the same pixels at all times, and how far apart the histograms are. For any scene, they say
/// how the amplitude depends on the distance, and how large the noise is. Beside each figure stands the share of
/// valid pixels.
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
    /// Do not compare with textbook physics and the steps of the paper: faster
    #[arg(long)]
    pub(crate) alone: bool,
    /// Also write an HTML page with figures, curves and pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Say whether the amplitude of a recording is raw, or already corrected, gamma-encoded or clipped
///
/// The logarithm of the amplitude is fitted by a sum of three effects: the logarithm of the integration time, the
/// logarithm of the distance, and r² (r: distance from the principal point in units of the half diagonal). Each
/// effect needs its recording: a still scene for the time; one labelled target (channel `target`) or one vendor
/// reflectivity for the distance. If the recording has `vendor_amplitude`, the scaling of the vendor is fitted in the
/// same way. If it has `phase_samples`, the amplitude is compared with eq. 1 of the paper.
///
/// The command says what the recording does not determine, and what to record instead. All intervals are 95 %, from
/// errors clustered by image block and by frame. A residual is the scatter of the logarithm around the fit: 10 % is
/// 0.1.
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
/// cameras. `--print NAME` prints a built-in scene, to copy and change.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    isolux simulate --list\n  \
    isolux simulate patches -o patches --seed 7\n  \
    isolux simulate --print patches > mine.toml\n  \
    isolux simulate office-desk -o bright-desk --ambient 2 --phase-samples\n  \
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
    /// Ambient light on a white surface, relative to the camera's own light at 1 m [default: the scene's]
    #[arg(long, value_name = "F", value_parser = not_negative)]
    pub(crate) ambient: Option<f64>,
    /// Name of a built-in camera, or a TOML file [default: the scene's]
    #[arg(long, value_name = "CAMERA")]
    pub(crate) camera: Option<String>,
    /// Write the four raw phase samples too
    #[arg(long)]
    pub(crate) phase_samples: bool,
    /// Write the true values too: `true_distance_m` and `reflectivity`
    #[arg(long)]
    pub(crate) truth: bool,
    /// Replace the output if it exists
    #[arg(long)]
    pub(crate) force: bool,
    /// List the built-in scenes and cameras
    #[arg(long)]
    pub(crate) list: bool,
    /// Print a built-in scene or camera
    #[arg(long, value_name = "NAME", conflicts_with = "list")]
    pub(crate) print: Option<String>,
}

/// Repeat every experiment of the paper on the simulated SR-3100
///
/// The command writes one page. It shows each figure, what the paper states about it, what is measured here and whether
/// it holds. The numbers of every figure lie beside the page as CSV.
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

/// Measure isolux, the paper and textbook physics on cameras and frames that nothing was fitted on
///
/// The command prints a table in Markdown. The simulated cameras need no input. Recordings of real cameras are measured
/// too if they are given.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  isolux figures\n  isolux figures --json")]
pub(crate) struct FiguresArgs {
    /// Folder with recordings of real cameras, by name: kinect2-checkerboard, ifm-o3d303
    #[arg(long, value_name = "DIR")]
    pub(crate) recordings: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
