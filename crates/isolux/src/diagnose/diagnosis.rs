//! What all the fits together say of a recording.

use serde::Serialize;

use super::Diagnoser;
use super::effect::{Effect, Estimate, Evidence, State};
use super::finding::{self, Finding};
use super::material::{Material, MaterialFit};
use super::rules;
use super::sample::Observed;
use super::scaling::{Pair, Scaling};
use super::still::StillPixels;
use super::untold::{Outcome, Untold};
use super::values::{Values, pile_up_value};

/// The diagnosis of a recording: what is in its amplitude, what is gone, and what cannot be told.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// Frames that were looked at.
    pub frames: u32,
    /// What follows, most important first. Empty when nothing can be told.
    pub findings: Vec<Finding>,
    /// Integration time.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub time: Outcome<Effect>,
    /// Distance.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub distance: Outcome<Effect>,
    /// Place in the image: the coefficient of r².
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub radius: Outcome<Effect>,
    /// The vendor amplitude against the amplitude.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub vendor_scaling: Outcome<Scaling>,
    /// The amplitude against eq. 1 of the phase samples.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub phase_samples: Outcome<Scaling>,
    /// The same pixels at several times.
    #[serde(serialize_with = "crate::outcome_json::serialize")]
    pub still_pixels: Outcome<StillPixels>,
    /// Pixels of one material.
    pub material: Material,
    /// The values that the amplitude takes; `None` where no pixel is valid.
    pub values: Option<Values>,
}

impl Diagnosis {
    /// The findings in a few words: `raw in time and distance; clipped`.
    #[must_use]
    pub fn headline(&self) -> String {
        finding::headline(&self.findings)
    }

    /// What is not told, with its reason: name and reason.
    #[must_use]
    pub fn untold(&self) -> Vec<(&'static str, &Untold)> {
        let effects = [
            ("integration time", &self.time),
            ("distance", &self.distance),
            ("place in the image", &self.radius),
        ];
        let mut untold: Vec<_> = effects
            .into_iter()
            .filter_map(|(name, effect)| effect.as_ref().err().map(|why| (name, why)))
            .collect();
        let vendor = self.vendor_scaling.as_ref();
        match vendor {
            Err(why) => untold.push(("the vendor's scaling", why)),
            Ok(scaling) => {
                let parts = [
                    ("the vendor's scaling with time", scaling.time.as_ref().err()),
                    ("the vendor's scaling with distance", scaling.distance.as_ref().err()),
                    ("the vendor's scaling with the place in the image", scaling.radial.as_ref().err()),
                ];
                untold.extend(parts.into_iter().filter_map(|(name, why)| why.map(|why| (name, why))));
            }
        }
        untold.extend(
            self.phase_samples.as_ref().err().map(|why| ("a gamma curve against the phase samples", why)),
        );
        untold
    }
}

pub(super) fn conclude(diagnoser: &Diagnoser) -> Diagnosis {
    let all = diagnoser.all.observed();
    let values = diagnoser.values.finish(&all);
    let clip_dn =
        values.and_then(|values| values.pile_up).map_or(f32::INFINITY, |pile_up| pile_up.value_dn as f32);
    let unclipped = |rows: Vec<Observed>| -> Vec<Observed> {
        rows.into_iter().filter(|row| row.amplitude < clip_dn).collect()
    };
    let (all, labelled) = (unclipped(all), unclipped(diagnoser.labelled.observed()));
    let vendor_scaling = vendor_scaling(diagnoser, &all);
    let phase_samples = phase_samples(diagnoser, &all);
    let still_pixels = match values {
        None => Err(Untold::NoValidPixels),
        Some(_) => diagnoser.panel.finish(clip_dn, diagnoser.seen.time_per_pixel),
    };
    let material = Material::fit(&all, &labelled, &vendor_scaling);
    let mut diagnosis = Diagnosis {
        frames: diagnoser.frames,
        findings: Vec::new(),
        time: time(&still_pixels, &material, &all),
        distance: distance(diagnoser, &material, &all),
        radius: radius(&material, &all),
        vendor_scaling,
        phase_samples,
        still_pixels,
        material,
        values,
    };
    diagnosis.findings = rules::findings(&diagnosis);
    diagnosis
}

fn vendor_scaling(diagnoser: &Diagnoser, all: &[Observed]) -> Outcome<Scaling> {
    if !diagnoser.seen.vendor {
        return Err(Untold::NoChannel { channel: "vendor_amplitude" });
    }
    let full = pile_up_value(all.iter().map(|row| row.vendor)).unwrap_or(f32::INFINITY);
    let below = |row: &Observed| if row.vendor < full { row.vendor } else { f32::NAN };
    Scaling::fit(all, &Pair { raw: &|row| row.amplitude, scaled: &below, gamma: false })
}

fn phase_samples(diagnoser: &Diagnoser, all: &[Observed]) -> Outcome<Scaling> {
    if diagnoser.settings.amplitude_from_phase_samples {
        return Err(Untold::AmplitudeFromPhaseSamples);
    }
    if !diagnoser.seen.phase_samples {
        return Err(Untold::NoChannel { channel: "phase_samples" });
    }
    Scaling::fit(all, &Pair { raw: &|row| row.demodulated, scaled: &|row| row.amplitude, gamma: true })
}

/// The same pixels at several times decide; without them a target label does.
fn time(still: &Outcome<StillPixels>, material: &Material, all: &[Observed]) -> Outcome<Effect> {
    let untold = match still {
        Ok(still) => return Ok(still.effect),
        Err(untold) => untold.clone(),
    };
    let target = material.best_target().and_then(|fit| Some((fit, *fit.time.as_ref().ok()?)));
    match target {
        Some((fit, exponent)) => Ok(of_target(fit, exponent, State::of_time(exponent))),
        None if all.is_empty() => Err(Untold::NoValidPixels),
        None => Err(untold),
    }
}

fn distance(diagnoser: &Diagnoser, material: &Material, all: &[Observed]) -> Outcome<Effect> {
    if all.is_empty() {
        return Err(Untold::NoValidPixels);
    }
    if !diagnoser.seen.distance {
        return Err(Untold::NoDistance);
    }
    if let Some(target) = material.best_target() {
        let exponent = *target.distance.as_ref().map_err(Clone::clone)?;
        return Ok(of_target(target, exponent, State::of_distance(exponent)));
    }
    let fit = match &material.vendor_reflectivity {
        Ok(fit) => fit,
        Err(Untold::VendorIsNoMaterial) => return Err(Untold::VendorIsNoMaterial),
        Err(_) => return Err(Untold::MaterialUnknown),
    };
    let exponent = *fit.distance.as_ref().map_err(Clone::clone)?;
    let (state, evidence) = (State::of_distance(exponent), Evidence::VendorReflectivity);
    Ok(Effect { exponent, state, evidence, residual: fit.residual_rms, observations: fit.observations })
}

fn radius(material: &Material, all: &[Observed]) -> Outcome<Effect> {
    if all.is_empty() {
        return Err(Untold::NoValidPixels);
    }
    let target = material.best_target().ok_or(Untold::MaterialUnknown)?;
    // With an unknown distance, what lies farther off at the edge looks like an illumination profile.
    if let Err(Untold::NoDistance) = &target.distance {
        return Err(Untold::NoDistance);
    }
    let exponent = *target.radius.as_ref().map_err(Clone::clone)?;
    Ok(of_target(target, exponent, State::of_radius(exponent)))
}

fn of_target(fit: &MaterialFit, exponent: Estimate, state: State) -> Effect {
    let evidence = Evidence::Target { label: fit.label.unwrap_or(0) };
    Effect { exponent, state, evidence, residual: fit.residual, observations: fit.observations }
}
