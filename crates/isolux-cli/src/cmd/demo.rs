//! `isolux demo`: simulate, calibrate, standardize, evaluate; no input needed. It does what a user would do with
//! a camera, through the same code as the other commands.

use std::fs;
use std::path::{Path, PathBuf};

use isolux::calibrate::CalibrateSettings;
use isolux::evaluate::Comparison;
use isolux::standardize::Method;
use isolux::{Calibration, Channels, Choice, Frame, Plane, Standardizer};
use serde_json::{Value, json};

use crate::args::DemoArgs;
use crate::cmd::{calibrate, evaluate, simulate, standardize};
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::picture::{white_level, write_montage};

/// Marks a folder as a demo, which the next one may replace.
const FIGURES: &str = "demo.json";
/// The sweeps that the calibration is fitted on.
const EXPOSURE_SWEEP: &str = "wall-sweep-smoke";
const DISTANCE_SWEEP: &str = "board-distances-smoke";

/// One scene that is standardized and shown.
struct Exhibit {
    scene: &'static str,
    /// What it shows, for the heading and the name of its picture.
    shows: &'static str,
    /// Integration times of the pictures, µs.
    pictured_us: &'static [f64],
    /// Rows of the table that this scene is about, by the beginning of their names.
    figures: &'static [&'static str],
}

const EXHIBITS: [Exhibit; 3] = [
    Exhibit {
        scene: "office-desk",
        shows: "integration-times",
        pictured_us: &[2000.0, 6000.0, 16200.0],
        figures: &[
            "pixel CV over integration times, ",
            "image CV",
            "fixed-threshold",
            "W1",
            "noise amplification",
        ],
    },
    Exhibit {
        scene: "two-boards",
        shows: "distances",
        pictured_us: &[4200.0],
        figures: &["slope", "relative noise"],
    },
    Exhibit {
        scene: "highlights",
        shows: "highlights",
        pictured_us: &[8200.0],
        figures: &["image CV", "fixed-threshold", "W1"],
    },
];

pub(crate) fn run(args: &DemoArgs) -> Outcome {
    let io = |error: std::io::Error| Failure::data(format!("cannot write `{}`: {error}", args.dir.display()));
    let is_demo = args.dir.join(FIGURES).is_file();
    if args.dir.exists() && !is_demo {
        let message = "found something else than an earlier demo, a new folder expected: name another";
        return Err(Failure::usage(format!("`{}`: {message}", args.dir.display())));
    }
    let parent = args.dir.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let staging = staging_folder(parent).map_err(io)?;
    let demo = Demo { folder: staging.path().to_owned(), seed: args.seed };
    let figures = demo.make()?;
    fs::write(demo.folder.join(FIGURES), format!("{figures:#}\n")).map_err(io)?;
    if is_demo {
        fs::remove_dir_all(&args.dir).map_err(io)?;
    }
    fs::rename(staging.keep(), &args.dir).map_err(io)?;
    let dir = args.dir.display();
    console::print(format!(
        "\nIn {dir}: recordings/, CAMERA.json, standardized/, before-after-*.png (top: raw, bottom: standardized), \
         {FIGURES}\nThe same with your own recording: isolux info REC"
    ))
}

/// A temporary folder with the permissions that a folder usually has; those of temporary ones are narrower.
fn staging_folder(parent: &Path) -> std::io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isolux-demo");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.tempdir_in(parent)
}

struct Demo {
    folder: PathBuf,
    seed: u64,
}

impl Demo {
    fn make(&self) -> Outcome<Value> {
        let io = |error: std::io::Error| {
            Failure::data(format!("cannot write `{}`: {error}", self.folder.display()))
        };
        for folder in ["recordings", "standardized"] {
            fs::create_dir(self.folder.join(folder)).map_err(io)?;
        }
        for scene in [EXPOSURE_SWEEP, DISTANCE_SWEEP].into_iter().chain(EXHIBITS.iter().map(|e| e.scene)) {
            let simulation = simulate::simulation(scene, None, self.seed)?;
            simulate::record(&simulation, simulate::Extras::default(), &self.recording(scene), false)?;
        }
        let (calibration, report) = calibrate::fit(
            &CalibrateSettings::default(),
            None,
            &[self.recording(EXPOSURE_SWEEP)],
            &[self.recording(DISTANCE_SWEEP)],
        )?;
        isolux_io::write_calibration(&calibration, &self.folder.join("CAMERA.json"))?;
        console::print("Calibration, from a wall over integration times and a board over distances\n")?;
        console::print(calibrate::describe(&calibration, &report))?;
        let mut figures = serde_json::Map::new();
        for exhibit in &EXHIBITS {
            let comparison = self.show(exhibit, &calibration)?;
            figures.insert(exhibit.scene.to_owned(), json!(comparison));
        }
        Ok(json!({"seed": self.seed, "method": "paper", "scenes": figures}))
    }

    /// Standardizes and evaluates one scene with the paper's method, and pictures it.
    fn show(&self, exhibit: &Exhibit, calibration: &Calibration) -> Outcome<Comparison> {
        let mut input = isolux_io::open(&self.recording(exhibit.scene))?;
        let choice = Choice { method: Method::Paper, ..Choice::default() };
        let standardizer = Standardizer::plan(&choice, Some(calibration), input.metadata().available)?;
        let output = self.folder.join("standardized").join(exhibit.scene);
        let options = standardize::WriteOptions::default();
        standardize::standardize(&mut *input, &standardizer, Some(calibration), &output, options)?;
        let comparison =
            evaluate::compare(&mut *input, &standardizer, Some(calibration), evaluate::Pixels::Trusted)?;
        console::print(format!("\n{}: {}\n", exhibit.scene, exhibit.shows.replace('-', " ")))?;
        console::print(evaluate::describe_rows(&comparison, |metric| {
            exhibit.figures.iter().any(|wanted| metric.starts_with(wanted))
        }))?;
        self.picture(exhibit, &output)?;
        Ok(comparison)
    }

    /// Raw frames above, standardized ones below, each row on one grey scale.
    fn picture(&self, exhibit: &Exhibit, standardized: &Path) -> Outcome {
        let (mut input, mut output) =
            (isolux_io::open(&self.recording(exhibit.scene))?, isolux_io::open(standardized)?);
        let shape = input.metadata().shape;
        let (mut raw, mut corrected) = (Vec::new(), Vec::new());
        let mut frame = Frame::new(shape);
        for index in 0..input.metadata().frame_count {
            input.read_frame(index, Channels::AMPLITUDE | Channels::INTEGRATION_TIME, &mut frame)?;
            let isolux::IntegrationTime::PerFrame(time_us) = frame.integration_time_us else { continue };
            if exhibit.pictured_us.get(raw.len()) == Some(&time_us) {
                let mut plane = Plane::filled(shape, f32::NAN);
                output.read_plane("standardized_amplitude", index, &mut plane)?;
                corrected.push(plane);
                raw.push(frame.amplitude.clone());
            }
        }
        let rows = [raw, corrected].map(|planes| {
            let white = white_level(&planes, 0.995);
            (planes, white)
        });
        write_montage(&self.folder.join(format!("before-after-{}.png", exhibit.shows)), &rows)
    }

    fn recording(&self, scene: &str) -> PathBuf {
        self.folder.join("recordings").join(scene)
    }
}
