//! The three experiments of the purpose.

use isolux_report::page::{Colours, Picture};

use super::stability::Stability;
use super::sweep::{Sweep, Variant};
use crate::error::ExperimentError;
use crate::paper::lab::Lab;

/// Integration times of the pictures, µs.
const PICTURED_US: [f64; 3] = [2000.0, 8200.0, 20_200.0];

/// The experiments, measured.
pub(super) struct Experiments {
    /// Still scene 1 over integration times.
    pub(super) desk: Stability,
    /// Still scene 2 over integration times.
    pub(super) shelf: Stability,
    /// The lettered board over distances, at two integration times.
    pub(super) board: Stability,
    /// Masks of the fixed threshold on the desk, before and after.
    pub(super) masks: Vec<Picture>,
}

impl Experiments {
    /// Simulates and measures them.
    ///
    /// # Errors
    /// [`ExperimentError`], which no seed should bring about.
    pub(super) fn run(lab: &Lab) -> Result<Self, ExperimentError> {
        let desk_sweep = Sweep::over_time(lab, "office-desk")?;
        let desk = Stability::measure(&desk_sweep)?;
        Ok(Self {
            masks: masks(&desk_sweep, &desk)?,
            desk,
            shelf: Stability::measure(&Sweep::over_time(lab, "office-shelf")?)?,
            board: Stability::measure(&Sweep::over_distance(lab)?)?,
        })
    }
}

/// White where the tuned threshold is exceeded, at three integration times, before and after.
fn masks(sweep: &Sweep, desk: &Stability) -> Result<Vec<Picture>, ExperimentError> {
    let mut pictures = Vec::new();
    for variant in [Variant::Raw, Variant::Standardized] {
        for time_us in PICTURED_US {
            let shot = sweep.shots.iter().find(|shot| shot.conditions.integration_time_us == time_us);
            let missing =
                ExperimentError::Scene { scene: "office-desk", missing: "the integration time of a picture" };
            let image = &shot.ok_or(missing)?.images[variant as usize];
            let tuned = &desk.tuned[variant as usize];
            let mask = tuned.threshold.mask(&tuned.scale.grey(image));
            let values = mask.as_raw().iter().map(|level| if *level > 0 { 1.0 } else { 0.0 }).collect();
            let (name, time_ms) = (variant.name(), time_us / 1000.0);
            pictures.push(Picture {
                id: format!("purpose-mask-{name}-{:.0}us", time_us),
                caption: format!("Desk at {time_ms:.1} ms, {name}: the mask of the one threshold."),
                alt: format!("Mask of the desk at {time_ms:.1} ms, {name}: white where above the threshold."),
                values: isolux::Plane::from_vec(image.shape(), values)?,
                range: (0.0, 1.0),
                label: "above the threshold: 1".to_owned(),
                colours: Colours::Grey,
            });
        }
    }
    Ok(pictures)
}
