//! The images of one experiment: a still scene over integration times, or a chart over distances, each before and
//! after standardization.

use isolux::standardize::{Choice, DistanceStep, SpecularStep, TimeStep};
use isolux::{Calibration, Channels, IntegrationTime, Plane, Standardizer, Stream};
use isolux_camera::scene::object::{Form, Object};
use isolux_camera::scene::run::Run;
use isolux_camera::scene::texture::Texture;
use isolux_camera::{CameraModel, Scene, Simulation, Truth};

use crate::error::ExperimentError;
use crate::measure::{for_each, simulation};
use crate::paper::lab::Lab;

/// Distances of the chart, m. Nearer than the first it would be over-saturated at 8.2 ms.
const CHART_DISTANCES_M: [f64; 13] = [0.6, 0.65, 0.7, 0.75, 0.8, 0.9, 1.0, 1.2, 1.5, 1.8, 2.2, 2.6, 3.0];
/// Integration times of the chart, µs: the reference, and a quarter of it.
pub(super) const CHART_TIMES_US: [f64; 2] = [2000.0, 8200.0];
/// The chart's scene, of which one board is taken, and its cell at the reference distance, m.
const CHART: (&str, &str, f64) = ("two-boards", "near-board", 0.027);

/// What is done to the amplitude before the detectors see it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variant {
    /// Nothing.
    Raw,
    /// The paper's table over integration time alone.
    TimeOnly,
    /// The paper's chain.
    Standardized,
}

impl Variant {
    /// Every variant; images come in this order.
    pub(super) const ALL: [Self; 3] = [Self::Raw, Self::TimeOnly, Self::Standardized];

    /// As the page names it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::TimeOnly => "time only",
            Self::Standardized => "standardized",
        }
    }

    fn standardizer(self, calibration: &Calibration) -> Result<Standardizer, ExperimentError> {
        let paper = Choice::paper();
        let choice = match self {
            Self::Raw => Choice {
                time: Some(TimeStep::None),
                distance: Some(DistanceStep::None),
                specular: Some(SpecularStep::None),
                ..paper
            },
            Self::TimeOnly => {
                Choice { distance: Some(DistanceStep::None), specular: Some(SpecularStep::None), ..paper }
            }
            Self::Standardized => paper,
        };
        let channels = Channels::AMPLITUDE | Channels::DISTANCE | Channels::INTEGRATION_TIME;
        Ok(Standardizer::plan(&choice, Some(calibration), channels)?)
    }
}

/// Conditions of one point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Conditions {
    /// Integration time, µs.
    pub(super) integration_time_us: f64,
    /// Distance of the chart, m; none for a scene with depth.
    pub(super) distance_m: Option<f64>,
}

/// One frame.
#[derive(Clone, Debug)]
pub(super) struct Shot {
    /// How it was taken.
    pub(super) conditions: Conditions,
    /// The amplitude in each [`Variant`]; NaN = invalid.
    pub(super) images: [Plane<f32>; 3],
}

/// Frames of one experiment.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    /// In the order of recording; those of equal conditions follow each other.
    pub(super) shots: Vec<Shot>,
    /// Index of the shot at which everything is tuned: the first one under the reference conditions. Another one
    /// under the same conditions follows it.
    pub(super) reference: usize,
    /// What the camera truly saw in that shot.
    pub(super) truth: Truth,
}

impl Sweep {
    /// A still scene over its integration times.
    ///
    /// # Errors
    /// [`ExperimentError::Scene`] when the reference time is not among them.
    pub(super) fn over_time(lab: &Lab, scene: &'static str) -> Result<Self, ExperimentError> {
        let mut collector = Collector::new(lab)?;
        collector.record(&simulation(scene, lab.seed)?, None)?;
        collector.finish(scene)
    }

    /// A lettered chart over distances and two integration times. It grows with its distance, so that every image
    /// shows the same: what differs is the distance alone, not the resolution.
    ///
    /// # Errors
    /// [`ExperimentError::Scene`] when the chart is not in its scene.
    pub(super) fn over_distance(lab: &Lab) -> Result<Self, ExperimentError> {
        let mut collector = Collector::new(lab)?;
        for (seed, distance_m) in (lab.seed..).zip(CHART_DISTANCES_M) {
            let scene = chart(distance_m, lab.calibration.reference.distance_m)?;
            let model = CameraModel::preset(&scene.camera)?;
            collector.record(&Simulation::new(model, scene, seed)?, Some(distance_m))?;
        }
        collector.finish(CHART.0)
    }
}

/// The chart at a distance, and nothing else: it fills the image.
fn chart(distance_m: f64, reference_m: f64) -> Result<Scene, ExperimentError> {
    let (scene, name, cell_m) = CHART;
    let mut scene_at = Scene::builtin(scene)?;
    let scale = distance_m / reference_m;
    let board = scene_at.objects.iter().find(|object| object.name == name);
    let Some(Texture::Bitmap { rows, reflectivities, .. }) = board.map(|board| &board.texture) else {
        return Err(ExperimentError::Scene { scene, missing: "a lettered board" });
    };
    let texture =
        Texture::Bitmap { cell_m: cell_m * scale, rows: rows.clone(), reflectivities: *reflectivities };
    let size_m = [2.0 * distance_m, 2.0 * distance_m];
    let board = Object::new(name, Form::Rectangle { size_m }, [0.0, 0.0, distance_m], texture);
    scene_at.objects = vec![board];
    scene_at.runs = vec![Run {
        integration_times_us: CHART_TIMES_US.to_vec(),
        frames_per_time: 3,
        skip_frames: 50,
        ..Run::default()
    }];
    Ok(scene_at)
}

struct Collector<'a> {
    lab: &'a Lab,
    standardizers: [Standardizer; 3],
    shots: Vec<Shot>,
    reference: Option<(usize, Truth)>,
}

impl<'a> Collector<'a> {
    fn new(lab: &'a Lab) -> Result<Self, ExperimentError> {
        let [raw, time_only, standardized] =
            Variant::ALL.map(|variant| variant.standardizer(&lab.calibration));
        let standardizers = [raw?, time_only?, standardized?];
        Ok(Self { lab, standardizers, shots: Vec::new(), reference: None })
    }

    fn record(&mut self, simulated: &Simulation, distance_m: Option<f64>) -> Result<(), ExperimentError> {
        let mut streams = self.standardizers.each_ref().map(Standardizer::stream);
        for_each(simulated, |_, simulated| {
            let frame = &simulated.frame;
            let IntegrationTime::PerFrame(integration_time_us) = frame.integration_time_us else {
                return Ok(());
            };
            let image = |stream: &mut Stream| stream.push(frame).map(|out| out.amplitude.clone());
            let [raw, time_only, standardized] = streams.each_mut().map(image);
            let conditions = Conditions { integration_time_us, distance_m };
            if self.reference.is_none() && self.is_reference(conditions) {
                self.reference = Some((self.shots.len(), simulated.truth.clone()));
            }
            self.shots.push(Shot { conditions, images: [raw?, time_only?, standardized?] });
            Ok(())
        })
    }

    fn is_reference(&self, conditions: Conditions) -> bool {
        let reference = self.lab.calibration.reference;
        reference.integration_time_us == Some(conditions.integration_time_us)
            && conditions.distance_m.is_none_or(|distance_m| distance_m == reference.distance_m)
    }

    fn finish(self, scene: &'static str) -> Result<Sweep, ExperimentError> {
        let missing = ExperimentError::Scene { scene, missing: "a frame under the reference conditions" };
        let (reference, truth) = self.reference.ok_or(missing)?;
        let again = self.shots.get(reference + 1).map(|shot| shot.conditions);
        if again != Some(self.shots[reference].conditions) {
            return Err(ExperimentError::Scene {
                scene,
                missing: "a second frame under the reference conditions",
            });
        }
        Ok(Sweep { shots: self.shots, reference, truth })
    }
}
