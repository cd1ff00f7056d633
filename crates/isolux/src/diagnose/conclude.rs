//! From the samples to the diagnosis: every fit, and what follows from them.

use super::diagnoser::Diagnoser;
use super::diagnosis::Diagnosis;
use super::effect::{Effect, Estimate, Evidence, State};
use super::material::{Material, MaterialFit};
use super::rules;
use super::sample::Observed;
use super::scaling::{Pair, Scaling};
use super::still::StillPixels;
use super::unavailable::{Outcome, Unavailable};
use super::values::pile_up_value;

impl Diagnoser {
    /// What the frames tell.
    #[must_use]
    pub fn finish(&self) -> Diagnosis {
        let all = self.all.observed();
        let values = self.values.finish(&all);
        let clip_dn =
            values.and_then(|values| values.pile_up).map_or(f32::INFINITY, |pile_up| pile_up.value_dn as f32);
        let unclipped = |rows: Vec<Observed>| -> Vec<Observed> {
            rows.into_iter().filter(|row| row.amplitude < clip_dn).collect()
        };
        let (all, labelled) = (unclipped(all), unclipped(self.labelled.observed()));
        let vendor_scaling = vendor_scaling(self, &all);
        let phase_samples = phase_samples(self, &all);
        let still_pixels = match values {
            None => Err(Unavailable::NoValidPixels),
            Some(_) => self.panel.finish(clip_dn, self.seen.time_per_pixel),
        };
        let material = Material::fit(&all, &labelled, &vendor_scaling);
        let exposure_changed = self.course.unexplained();
        let mut diagnosis = Diagnosis {
            frames: self.frames,
            findings: Vec::new(),
            time: time(&still_pixels, &material, &all),
            distance: distance(self, &material, &all),
            radius: radius(&material, &all),
            vendor_scaling,
            phase_samples,
            still_pixels,
            material,
            exposure_changed,
            scaled_by_frame: self.spans.stretched(exposure_changed.is_some()),
            values,
        };
        diagnosis.findings = rules::findings(&diagnosis);
        diagnosis
    }
}

fn vendor_scaling(diagnoser: &Diagnoser, all: &[Observed]) -> Outcome<Scaling> {
    if !diagnoser.seen.vendor {
        return Err(Unavailable::NoChannel { channel: "vendor_amplitude" });
    }
    let full = pile_up_value(all.iter().map(|row| row.vendor)).unwrap_or(f32::INFINITY);
    let below = |row: &Observed| if row.vendor < full { row.vendor } else { f32::NAN };
    Scaling::fit(all, &Pair { raw: &|row| row.amplitude, scaled: &below, gamma: false })
}

fn phase_samples(diagnoser: &Diagnoser, all: &[Observed]) -> Outcome<Scaling> {
    if diagnoser.settings.amplitude_from_phase_samples {
        return Err(Unavailable::AmplitudeFromPhaseSamples);
    }
    if !diagnoser.seen.phase_samples {
        return Err(Unavailable::NoChannel { channel: "phase_samples" });
    }
    Scaling::fit(all, &Pair { raw: &|row| row.demodulated, scaled: &|row| row.amplitude, gamma: true })
}

/// The same pixels at several times decide; without them a target label does.
fn time(still: &Outcome<StillPixels>, material: &Material, all: &[Observed]) -> Outcome<Effect> {
    let unavailable = match still {
        Ok(still) => return Ok(still.effect),
        Err(unavailable) => unavailable.clone(),
    };
    let target = material.best_target().and_then(|fit| Some((fit, *fit.time.as_ref().ok()?)));
    match target {
        Some((fit, exponent)) => Ok(of_target(fit, exponent, State::of_time(exponent))),
        None if all.is_empty() => Err(Unavailable::NoValidPixels),
        None => Err(unavailable),
    }
}

fn distance(diagnoser: &Diagnoser, material: &Material, all: &[Observed]) -> Outcome<Effect> {
    if all.is_empty() {
        return Err(Unavailable::NoValidPixels);
    }
    if !diagnoser.seen.distance {
        return Err(Unavailable::NoDistance);
    }
    if let Some(target) = material.best_target() {
        let exponent = *target.distance.as_ref().map_err(Clone::clone)?;
        return Ok(of_target(target, exponent, State::of_distance(exponent)));
    }
    let fit = match &material.vendor_reflectivity {
        Ok(fit) => fit,
        Err(Unavailable::VendorIsNoMaterial) => return Err(Unavailable::VendorIsNoMaterial),
        Err(_) => return Err(Unavailable::MaterialUnknown),
    };
    let exponent = *fit.distance.as_ref().map_err(Clone::clone)?;
    let (state, evidence) = (State::of_distance(exponent), Evidence::VendorReflectivity);
    Ok(Effect { exponent, state, evidence, residual: fit.residual_rms, observations: fit.observations })
}

fn radius(material: &Material, all: &[Observed]) -> Outcome<Effect> {
    if all.is_empty() {
        return Err(Unavailable::NoValidPixels);
    }
    let target = material.best_target().ok_or(Unavailable::MaterialUnknown)?;
    // With an unknown distance, what lies farther off at the edge looks like an illumination profile.
    if let Err(Unavailable::NoDistance) = &target.distance {
        return Err(Unavailable::NoDistance);
    }
    let exponent = *target.radius.as_ref().map_err(Clone::clone)?;
    Ok(of_target(target, exponent, State::of_radius(exponent)))
}

fn of_target(fit: &MaterialFit, exponent: Estimate, state: State) -> Effect {
    let evidence = Evidence::Target { label: fit.label.unwrap_or(0) };
    Effect { exponent, state, evidence, residual: fit.residual, observations: fit.observations }
}
