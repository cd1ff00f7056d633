//! `isolux demo`: simulate, calibrate, standardize, evaluate; no input needed. It does what a user would do with
//! a camera, through the same code as the other commands.

use std::fs;
use std::path::{Path, PathBuf};

use isolux::calibrate::CalibrateSettings;
use isolux::evaluate::Comparison;
use isolux::{Calibration, Choice};
use isolux_pipeline::assess::{Pixels, first_frames_at};
use isolux_pipeline::{
    AssessOptions, CalibrationPaths, NativeSink, StandardizeOptions, assess, page, plan, standardize,
};
use isolux_report::page::{Page, Picture, Section};
use serde_json::{Value, json};

use crate::cmd::{calibrate, simulate};
use crate::evaluation::figures_table;
use crate::failure::{Failure, Outcome};
use crate::options::DemoArgs;
use crate::terminal::{self, Terminal, interrupt};

/// Marks a folder as a demo, which the next one may replace.
const FIGURES: &str = "demo.json";
/// What [`FIGURES`] names as its author.
const PROGRAM: &str = "isolux demo";
/// Everything in a demo's folder, besides the pictures.
const WRITTEN: [&str; 7] =
    ["report.html", "data", "pictures", "recordings", "standardized", "CAMERA.json", FIGURES];
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
    if args.dir.exists() && !is_demo(&args.dir) {
        let message = "found something else than an earlier demo, a new folder expected: name another";
        return Err(Failure::usage(format!("`{}`: {message}", args.dir.display())));
    }
    let parent = args.dir.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let staging = staging_folder(parent).map_err(io)?;
    let demo = Demo { folder: staging.path().to_owned(), seed: args.seed, observer: Terminal::default() };
    interrupt::watch();
    let figures = demo.make()?;
    fs::write(demo.folder.join(FIGURES), format!("{figures:#}\n")).map_err(io)?;
    replace(&args.dir, staging).map_err(io)?;
    let dir = args.dir.display();
    terminal::print(format!(
        "\nIn {dir}: report.html, recordings/, CAMERA.json, standardized/, before-after-*.png (top: raw, bottom: \
         standardized), {FIGURES}\nThe same with your own recording: isolux info REC"
    ))
}

/// True for a folder that a demo wrote, with nothing in it but what a demo writes: only that may be replaced.
fn is_demo(folder: &Path) -> bool {
    let text = fs::read_to_string(folder.join(FIGURES)).unwrap_or_default();
    let written: Value = serde_json::from_str(&text).unwrap_or_default();
    let holds_only = |folder: &Path, known: &dyn Fn(&str) -> bool| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.file_name()).all(|name| name.to_str().is_some_and(known))
    };
    let scenes = |name: &str| {
        [EXPOSURE_SWEEP, DISTANCE_SWEEP].contains(&name)
            || EXHIBITS.iter().any(|exhibit| exhibit.scene == name)
    };
    written["program"] == PROGRAM
        && holds_only(folder, &|name| WRITTEN.contains(&name) || name.starts_with("before-after-"))
        && ["recordings", "standardized"].iter().all(|inside| holds_only(&folder.join(inside), &scenes))
}

/// Puts the finished demo in its place. An earlier one goes only when the new one is there.
fn replace(folder: &Path, finished: tempfile::TempDir) -> std::io::Result<()> {
    if !folder.exists() {
        return fs::rename(finished.keep(), folder);
    }
    let parent = finished.path().parent().unwrap_or(Path::new("."));
    let aside = staging_folder(parent)?;
    let earlier = aside.path().join("earlier");
    fs::rename(folder, &earlier)?;
    fs::rename(finished.path(), folder).inspect_err(|_| {
        // The first error is the one to tell.
        let _ = fs::rename(&earlier, folder);
    })?;
    // The folder is no temporary one any more: nothing is left to remove.
    let _ = finished.keep();
    Ok(())
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
    observer: Terminal,
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
            let simulation = simulate::simulation(scene, None, None, self.seed)?;
            let extras = isolux_pipeline::simulate::Extras::default();
            let recording = self.recording(scene);
            isolux_pipeline::simulate::record(&simulation, extras, &recording, false, &self.observer)?;
        }
        let sweeps = CalibrationPaths {
            exposure_sweeps: &[self.recording(EXPOSURE_SWEEP)],
            distance_sweeps: &[self.recording(DISTANCE_SWEEP)],
            ..CalibrationPaths::default()
        };
        let settings = CalibrateSettings::default();
        let fitted = isolux_pipeline::calibrate(&settings, None, sweeps.open()?, &self.observer);
        let (calibration, report) =
            fitted.inspect_err(|error| error.warnings().iter().for_each(calibrate::warn))?;
        isolux_io::write_calibration(&calibration, &self.folder.join("CAMERA.json"))?;
        terminal::print("Calibration, from a wall over integration times and a board over distances\n")?;
        terminal::print(calibrate::describe(&calibration, &report))?;
        let (mut figures, mut sections) = (serde_json::Map::new(), Vec::new());
        for exhibit in &EXHIBITS {
            let (comparison, section) = self.show(exhibit, &calibration)?;
            figures.insert(exhibit.scene.to_owned(), json!(comparison));
            sections.push(section);
        }
        isolux_report::write_report(&self.page(sections), &self.folder, "report.html")
            .map_err(Failure::data)?;
        Ok(json!({"program": PROGRAM, "seed": self.seed, "method": "paper", "scenes": figures}))
    }

    /// Standardizes and evaluates one scene with the paper's method, and pictures it.
    fn show(&self, exhibit: &Exhibit, calibration: &Calibration) -> Outcome<(Comparison, Section)> {
        let mut input = isolux_io::open(&self.recording(exhibit.scene))?;
        let standardizer = plan(&Choice::paper(), Some(calibration), &mut input, &self.observer)?;
        let mut sink = NativeSink::new(&self.folder.join("standardized").join(exhibit.scene), false);
        let options = StandardizeOptions { calibration: Some(calibration), ..StandardizeOptions::default() };
        standardize(&mut input, &standardizer, &options, &mut sink, &self.observer)?;
        let options =
            AssessOptions { calibration: Some(calibration), pixels: Pixels::Trusted, rivals: false };
        let assessment = assess(&mut input, &standardizer, &options, &self.observer)?;
        terminal::print(format!("\n{}: {}\n", exhibit.scene, exhibit.shows.replace('-', " ")))?;
        terminal::print(figures_table(&assessment.comparison, |metric| {
            exhibit.figures.iter().any(|wanted| metric.starts_with(wanted))
        }))?;
        let frames = first_frames_at(&mut input, exhibit.pictured_us, &self.observer)?;
        let pictures = page::pictures(&mut input, &standardizer, &frames, exhibit.scene)?;
        self.montage(exhibit, &pictures)?;
        let title = format!("{}: {}", exhibit.scene, exhibit.shows.replace('-', " "));
        let section = page::section(exhibit.scene, &title, &standardizer, &assessment, pictures);
        Ok((assessment.comparison, section))
    }

    /// Raw frames above, standardized ones below, each row on one grey scale.
    fn montage(&self, exhibit: &Exhibit, pictures: &[Picture]) -> Outcome {
        let (raw, standardized) = pictures.split_at(pictures.len() / 2);
        let rows = [raw, standardized].map(|row| {
            let range = row.first().map_or((0.0, 1.0), |picture| picture.range);
            (row.iter().map(|picture| picture.values.clone()).collect(), range)
        });
        let path = self.folder.join(format!("before-after-{}.png", exhibit.shows));
        let bytes = isolux_report::png::montage(&rows).map_err(Failure::data)?;
        isolux_io::write_whole(&path, &bytes)
            .map_err(|error| Failure::data(format!("cannot write `{}`: {error}", path.display())))
    }

    fn page(&self, sections: Vec<Section>) -> Page {
        Page {
            title: "isolux demo".to_owned(),
            lead: "A simulated SR-3100, calibrated on a wall over integration times and a board over distances, then \
                   standardized with the paper's method. Pixels flagged as too dark are left out of the \
                   figures, before and after."
                .to_owned(),
            sections,
            colophon: format!(
                "Made by isolux {} with `isolux demo --seed {}`. All data are simulated.",
                env!("CARGO_PKG_VERSION"),
                self.seed
            ),
        }
    }

    fn recording(&self, scene: &str) -> PathBuf {
        self.folder.join("recordings").join(scene)
    }
}
