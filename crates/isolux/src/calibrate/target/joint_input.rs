//! Windows of all recordings as observations of the joint model.

use super::noise::WindowNoise;
use super::{TargetError, TargetWarning, TargetWindows};
use crate::calibrate::CalibrateSettings;
use crate::calibrate::joint::{AngleModel, DistanceModel, JointError, JointModel, Observation};
use crate::calibrate::levels::Levels;
use crate::calibrate::measure_error::common_shape;
use crate::calibration::{Calibration, REFERENCE_TIME_US};
use crate::terms::lut::LutAnswer;
use crate::terms::profile::Places;
use crate::terms::{Lut, Spline, linear};

/// Windows as observations.
pub(super) struct JointInput {
    pub(super) observations: Vec<Observation>,
    /// The window of each: its recording and number there, and what was added to its ln A.
    windows: Vec<(usize, usize, f64)>,
    noise: WindowNoise,
    pub(super) model: JointModel,
    /// Recording (by number) and label of each surface.
    pub(super) surfaces: Vec<(usize, u8)>,
    /// Their exposures.
    pub(super) levels: Levels,
}

impl JointInput {
    pub(super) fn new(
        settings: &CalibrateSettings,
        targets: &[TargetWindows],
        calibration: &Calibration,
        warnings: &mut Vec<TargetWarning>,
    ) -> Result<Self, TargetError> {
        let places = places(targets)?;
        warn(targets, warnings);
        let known = Known {
            lut: calibration.terms.lut.as_ref(),
            reference_us: calibration.reference.integration_time_us.unwrap_or(REFERENCE_TIME_US),
            spline: calibration.terms.spline.as_ref(),
        };
        let levels = levels(targets);
        let levels = if known.lut.is_some() { levels.of_one_time() } else { levels };
        let mut input = Self {
            observations: Vec::new(),
            windows: Vec::new(),
            noise: WindowNoise::fit(targets.iter().flat_map(|target| &target.windows)),
            model: model(settings, targets, &known, &levels, places),
            surfaces: Vec::new(),
            levels,
        };
        let mut first_frame = 0;
        for (number, target) in targets.iter().enumerate() {
            for (index, window) in target.windows.iter().enumerate() {
                let Some(correction) = known.correction(target.linear, window.time_us, window.distance_m)
                else {
                    continue;
                };
                let frame = first_frame + window.frame;
                // Frames that have no level are those that too long a recording has beyond those taken.
                let Some(time) = input.levels.of(f64::from(window.time_us), frame) else { continue };
                let surface = input.surface(number, window.label);
                let [row, column] = window.pixel.map(f64::from);
                input.observations.push(Observation {
                    surface,
                    frame,
                    time,
                    ln_amplitude: (f64::from(window.ln_amplitude) + correction) as f32,
                    distance_m: window.distance_m,
                    place: places.at(row, column).map(|value| value as f32),
                    cosine: window.cosine,
                    weight: input.noise.effect(window, f64::from(window.ln_amplitude)).weight as f32,
                });
                input.windows.push((number, index, correction));
            }
            first_frame += frames(target);
        }
        Ok(input)
    }

    fn surface(&mut self, recording: usize, label: u8) -> u32 {
        let known = self.surfaces.iter().position(|surface| *surface == (recording, label));
        let number = known.unwrap_or_else(|| {
            self.surfaces.push((recording, label));
            self.surfaces.len() - 1
        });
        u32::try_from(number).unwrap_or(u32::MAX)
    }

    /// Weighs the windows anew and takes the bias of their noise out, by the amplitudes that a first fit, with these
    /// residuals, expects of them. Windows that it says nothing of stay as they are.
    pub(super) fn expect(&mut self, targets: &[TargetWindows], residuals: &[f64]) {
        for ((observation, &(target, index, correction)), residual) in
            self.observations.iter_mut().zip(&self.windows).zip(residuals)
        {
            let window = &targets[target].windows[index];
            let measured = f64::from(window.ln_amplitude);
            if residual.is_finite() {
                let effect = self.noise.effect(window, measured - residual);
                observation.weight = effect.weight as f32;
                observation.ln_amplitude = (measured + correction - effect.bias) as f32;
            }
        }
    }

    /// Takes the weight from the surfaces that are marked.
    pub(super) fn leave_out(&mut self, marked: &[bool]) {
        for observation in &mut self.observations {
            if marked.get(observation.surface as usize).copied().unwrap_or(false) {
                observation.weight = 0.0;
            }
        }
    }
}

/// Terms that sweeps have fitted already.
struct Known<'a> {
    lut: Option<&'a Lut>,
    reference_us: f64,
    spline: Option<&'a Spline>,
}

impl Known<'_> {
    /// What takes the known terms out of ln A; `None` where a term does not reach.
    fn correction(&self, is_linear: bool, time_us: f32, distance_m: f32) -> Option<f64> {
        let lut = self.lut.filter(|_| !time_us.is_nan());
        let time = match lut.map(|lut| lut.at(f64::from(time_us))) {
            Some(_) if is_linear => linear::multiplier(f64::from(time_us), self.reference_us).ln(),
            None => 0.0,
            Some(LutAnswer::Inside(multiplier) | LutAnswer::Below(multiplier)) => multiplier.ln(),
            Some(LutAnswer::Refused) => return None,
        };
        let law = self.spline.map_or(0.0, |spline| spline.ln_response(f64::from(distance_m)));
        Some(time - law)
    }
}

fn model(
    settings: &CalibrateSettings,
    targets: &[TargetWindows],
    known: &Known<'_>,
    levels: &Levels,
    places: Places,
) -> JointModel {
    let windows = || targets.iter().flat_map(|target| &target.windows);
    let has_distance = windows().any(|window| window.distance_m > 0.0);
    let has_angle = windows().any(|window| window.cosine > 0.0);
    let reference_us = settings.reference.integration_time_us.unwrap_or(f64::NAN);
    JointModel {
        time: levels.model(reference_us),
        distance: (has_distance && known.spline.is_none()).then_some(DistanceModel {
            reference_m: settings.reference.distance_m,
            modulation_frequency_hz: settings.modulation_frequency_hz,
        }),
        profile: Some(places),
        angle: if has_angle { AngleModel::Free } else { AngleModel::Absent },
        smoothness: 1.0,
    }
}

/// The exposures of all windows, frames counted through all recordings.
fn levels(targets: &[TargetWindows]) -> Levels {
    let mut first_frame = 0;
    let of = |target: &TargetWindows| {
        let first = first_frame;
        first_frame += frames(target);
        target
            .windows
            .iter()
            .map(move |window| (f64::from(window.time_us), first + window.frame))
            .collect::<Vec<_>>()
    };
    Levels::new(targets.iter().flat_map(of))
}

/// All frames of a recording.
fn frames(target: &TargetWindows) -> u32 {
    u32::try_from(target.source.frames_used + target.source.frames_left_out).unwrap_or(u32::MAX)
}

/// Image coordinates that all recordings share.
fn places(targets: &[TargetWindows]) -> Result<Places, TargetError> {
    let used = || targets.iter().filter(|target| !target.is_empty());
    let shapes = used().filter_map(|target| target.shape.map(|shape| (&*target.source.recording, shape)));
    let shape = common_shape(shapes)?.ok_or(JointError::TooFew { found: 0, expected: 2 })?;
    let lens = used().find_map(|target| target.lens.as_ref());
    Ok(Places::new(shape, lens))
}

fn warn(targets: &[TargetWindows], warnings: &mut Vec<TargetWarning>) {
    for target in targets {
        let recording = || target.source.recording.clone();
        if target.is_empty() {
            warnings.push(TargetWarning::NoWindows { recording: recording() });
        } else if target.lens.is_none() {
            warnings.push(TargetWarning::NoIntrinsics { recording: recording() });
        } else if target.without_normal * 2 > target.len() {
            let (windows, of) = (target.without_normal, target.len());
            warnings.push(TargetWarning::FewNormals { recording: recording(), windows, of });
        }
    }
}
