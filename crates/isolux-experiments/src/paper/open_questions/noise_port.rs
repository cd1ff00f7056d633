//! Noise that the distance brings into the amplitude.

use isolux::Window;
use isolux::standardize::{DistanceStep, SpecularStep, TimeStep};
use isolux_camera::{CameraModel, Scene, Simulation};
use isolux_report::page::{Block, Chart, Claim, Scale, Series, Stroke, Table};

use crate::error::ExperimentError;
use crate::measure::{WINDOW_PX, for_each};
use crate::paper::lab::Lab;
use crate::paper::parts::{axis, number, quote, text, verdict};

/// Low, short and reference integration time, µs.
const TIMES_US: [f64; 3] = [200.0, 1000.0, 8200.0];
/// From where 8.2 ms is nearly free of saturation, m.
const DISTANCES_M: [f64; 10] = [0.7, 0.8, 0.9, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0];
/// 400 pixels and 60 differences, each sharing a frame with the next: the standard error of a deviation is
/// √(3/2) / √(2·24000) = 0.6 %.
const FRAMES: u32 = 61;
/// First order holds where the amplitude is this many times its noise.
const SIGNAL_TO_NOISE: f64 = 10.0;
/// Three standard errors of a quotient of two such deviations are 2.4 %; second order adds about as much, as d² is
/// curved: half of (σ_d/d)², up to 5 % where φ is small.
const FORMULA_WITHIN: f64 = 0.05;

/// Noise at one integration time and distance.
struct Noise {
    integration_time_us: f64,
    distance_m: f64,
    /// Phase, rad.
    phase: f64,
    /// σ of A over its mean: raw, after d², after the fitted cubic.
    raw: f64,
    square: f64,
    cubic: f64,
}

impl Noise {
    /// `√(1 + (2/φ)²)`: A · d², first order (methods, section 5).
    fn formula(&self) -> f64 {
        (1.0 + (2.0 / self.phase).powi(2)).sqrt()
    }
}

pub(super) fn blocks(lab: &Lab) -> Result<Vec<Block>, ExperimentError> {
    let noise = measure(lab)?;
    Ok(vec![
        quote(
            "Only the measured distance is available for the scaling, so its noise is carried into the amplitudes: \
             a better contrast of the background, but worse noise at low integration times. Denoising is future \
             work.",
            "section 3",
        ),
        Block::Text(format!(
            "The board again, {FRAMES} frames at each distance. Relative noise is the deviation of the difference of \
             consecutive frames over √2 and over the mean, in the window of 20×20. To first order A·d² has \
             √(1 + (2/φ)²) times the relative noise of A, φ = 4πfd/c: the factor is the same at every integration \
             time and largest near the camera; what the integration time sets is the noise that it multiplies."
        )),
        Block::Chart(factor_chart(&noise)),
        Block::Chart(level_chart(&noise)),
        Block::Table(table(&noise)),
        Block::Claims(vec![formula_claim(&noise), low_time_claim(&noise)]),
    ])
}

/// A camera of the central window alone sees what the whole one sees there, for a fraction of the work.
fn window_camera(camera: &CameraModel) -> CameraModel {
    let window = Window::centred(camera.shape(), WINDOW_PX);
    let mut camera = camera.clone();
    (camera.height, camera.width) = (window.height, window.width);
    camera.intrinsics.cx -= window.left as f64;
    camera.intrinsics.cy -= window.top as f64;
    camera
}

fn measure(lab: &Lab) -> Result<Vec<Noise>, ExperimentError> {
    let mut scene = Scene::builtin("board-distances")?;
    for run in &mut scene.runs {
        run.integration_times_us = TIMES_US.to_vec();
        run.frames_per_time = FRAMES;
        if let Some(approach) = &mut run.approach {
            approach.distances_m = DISTANCES_M.to_vec();
        }
    }
    let camera = window_camera(&lab.camera);
    let simulation = Simulation::new(camera, scene, lab.seed)?;
    let plan = |distance| lab.plan(TimeStep::None, distance, SpecularStep::None);
    let (mut square, mut cubic) = (plan(DistanceStep::Square)?.stream(), plan(DistanceStep::Cubic)?.stream());
    let mut found: Vec<Noise> = Vec::new();
    let mut sums = [Differences::default(), Differences::default(), Differences::default()];
    for_each(&simulation, |index, simulated| {
        let frame = &simulated.frame;
        let planned = simulation.frames()[index];
        sums[0].push(frame.amplitude.values());
        sums[1].push(square.push(frame)?.amplitude.values());
        sums[2].push(cubic.push(frame)?.amplitude.values());
        let next = simulation.frames().get(index + 1);
        let same = |next: &isolux_camera::PlannedFrame| {
            (next.pose, next.integration_time_us) == (planned.pose, planned.integration_time_us)
        };
        if !next.is_some_and(same) {
            let [raw, square, cubic] = std::mem::take(&mut sums).map(|sums| sums.relative_noise());
            let distance_m = DISTANCES_M[planned.pose];
            let phase = lab.camera.phase(distance_m);
            let integration_time_us = planned.integration_time_us;
            found.push(Noise { integration_time_us, distance_m, phase, raw, square, cubic });
        }
        Ok(())
    })?;
    Ok(found)
}

/// Sums over the frames of one still scene.
#[derive(Default)]
struct Differences {
    previous: Vec<f32>,
    sum: f64,
    values: f64,
    squares: f64,
    pairs: f64,
}

impl Differences {
    fn push(&mut self, values: &[f32]) {
        for &value in values.iter().filter(|value| value.is_finite()) {
            self.sum += f64::from(value);
            self.values += 1.0;
        }
        for (now, before) in values.iter().zip(&self.previous) {
            let difference = f64::from(now - before);
            if difference.is_finite() {
                self.squares += difference * difference;
                self.pairs += 1.0;
            }
        }
        self.previous.clear();
        self.previous.extend_from_slice(values);
    }

    /// σ over mean.
    fn relative_noise(&self) -> f64 {
        (0.5 * self.squares / self.pairs).sqrt() / (self.sum / self.values)
    }
}

fn of_time(noise: &[Noise], time_us: f64) -> impl Iterator<Item = &Noise> {
    noise.iter().filter(move |noise| noise.integration_time_us == time_us)
}

fn name(time_us: f64) -> String {
    format!("{} ms", time_us / 1000.0)
}

fn factor_chart(noise: &[Noise]) -> Chart {
    let formula = of_time(noise, TIMES_US[0]).map(|noise| (noise.distance_m, noise.formula())).collect();
    let mut series =
        vec![Series { name: "√(1 + (2/φ)²)".to_owned(), points: formula, stroke: Stroke::Dashed }];
    for time_us in TIMES_US {
        let points =
            of_time(noise, time_us).map(|noise| (noise.distance_m, noise.square / noise.raw)).collect();
        series.push(Series { name: format!("A·d², {}", name(time_us)), points, stroke: Stroke::Points });
    }
    let points =
        of_time(noise, TIMES_US[2]).map(|noise| (noise.distance_m, noise.cubic / noise.raw)).collect();
    series.push(Series { name: "cubic, 8.2 ms".to_owned(), points, stroke: Stroke::Solid });
    Chart {
        id: "noise-factor".to_owned(),
        caption: "Relative noise after the distance scaling, as a multiple of that before.".to_owned(),
        alt: "At 1 and 8.2 ms the points lie on the formula, falling from 3.5 at 0.7 m to 1.3 at 3 m; those of \
              0.2 ms leave it upwards beyond about 1.3 m."
            .to_owned(),
        x: axis("distance in m", Scale::Linear),
        y: axis("noise after / noise before", Scale::Log),
        series,
        marks: Vec::new(),
    }
}

fn level_chart(noise: &[Noise]) -> Chart {
    let mut series = Vec::new();
    for time_us in TIMES_US {
        let points = of_time(noise, time_us).map(|noise| (noise.distance_m, 100.0 * noise.raw)).collect();
        series.push(Series { name: format!("{}, before", name(time_us)), points, stroke: Stroke::Dashed });
        let points = of_time(noise, time_us).map(|noise| (noise.distance_m, 100.0 * noise.cubic)).collect();
        series.push(Series { name: format!("{}, cubic", name(time_us)), points, stroke: Stroke::Solid });
    }
    Chart {
        id: "noise-level".to_owned(),
        caption: "Relative noise of the amplitude before (dashed) and after (solid) the cubic.".to_owned(),
        alt: "Noise rises with the distance and falls with the integration time; scaling raises every curve, most \
              near the camera, and that of 0.2 ms at all distances."
            .to_owned(),
        x: axis("distance in m", Scale::Linear),
        y: axis("relative noise in %", Scale::Log),
        series,
        marks: Vec::new(),
    }
}

fn table(noise: &[Noise]) -> Table {
    let columns = [
        "integration time and distance",
        "signal to noise",
        "√(1 + (2/φ)²)",
        "A·d², measured",
        "cubic, measured",
        "noise after the cubic, %",
    ];
    let row = |noise: &Noise| {
        vec![
            text(&format!("{}, {} m", name(noise.integration_time_us), noise.distance_m)),
            number(1.0 / noise.raw, 1),
            number(noise.formula(), 2),
            number(noise.square / noise.raw, 2),
            number(noise.cubic / noise.raw, 2),
            number(100.0 * noise.cubic, 1),
        ]
    };
    Table {
        id: "noise-port".to_owned(),
        caption: "Noise before and after the distance scaling.".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: TIMES_US.iter().flat_map(|time_us| of_time(noise, *time_us)).map(row).collect(),
    }
}

fn formula_claim(noise: &[Noise]) -> Claim {
    let error = |noise: &Noise| noise.square / noise.raw / noise.formula() - 1.0;
    let strong = || noise.iter().filter(|noise| noise.raw * SIGNAL_TO_NOISE < 1.0);
    let value = strong().map(|noise| error(noise).abs()).fold(0.0, f64::max);
    let weak = noise.iter().filter(|noise| noise.raw * SIGNAL_TO_NOISE >= 1.0).map(error).fold(0.0, f64::max);
    Claim {
        id: "noise-port-follows-the-formula".to_owned(),
        statement: "Beyond the paper: A·d² has √(1 + (2/φ)²) times the relative noise of A.".to_owned(),
        measured: format!(
            "Within {:.1} % at all {} places with a signal-to-noise ratio above {SIGNAL_TO_NOISE}, whatever the \
             integration time; below it, where the phase noise is no longer small, the \
             factor is up to {:.0} % higher.",
            100.0 * value,
            strong().count(),
            100.0 * weak
        ),
        value,
        verdict: verdict(value < FORMULA_WITHIN, "the measured factor differs"),
    }
}

fn low_time_claim(noise: &[Noise]) -> Claim {
    let at = |time_us: f64| of_time(noise, time_us).find(|noise| noise.distance_m == 1.5);
    let (before, after) = at(TIMES_US[0]).map_or((f64::NAN, f64::NAN), |noise| (noise.raw, noise.cubic));
    let long = at(TIMES_US[2]).map_or(f64::NAN, |noise| noise.cubic);
    Claim {
        id: "noise-is-worse-at-low-times".to_owned(),
        statement: "Scaling by the measured distance makes the noise worse if the integration time is low."
            .to_owned(),
        measured: format!(
            "At 1.5 m and 0.2 ms the relative noise rises from {:.0} % to {:.0} %; at 8.2 ms it is {:.1} % after the \
             scaling.",
            100.0 * before,
            100.0 * after,
            100.0 * long
        ),
        value: after,
        verdict: verdict(after > before && after > long, "it does not"),
    }
}
