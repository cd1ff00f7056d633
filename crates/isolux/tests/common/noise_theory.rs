//! What the mean amplitude of the simulated camera must be, noise included, and how far it may scatter: from the
//! camera's published equations alone, without rendering a frame.

use isolux_camera::{CameraModel, FullWell, SimulatedFrame, Simulation};

/// Mean amplitude of all living pixels over all frames of one integration time.
#[derive(Clone, Copy, Debug)]
pub struct ExpectedMean {
    pub integration_time_us: f64,
    /// Without noise, DN.
    pub noise_free_dn: f64,
    /// With what noise adds to the mean (Rice) or takes from it (clip), DN.
    pub expected_dn: f64,
    /// Standard error of the measured mean, DN.
    pub standard_error_dn: f64,
}

/// The curve that an exposure sweep of `simulation` must show. `frames` is the whole recording: the truth comes
/// from its planes.
pub fn mean_curve(simulation: &Simulation, frames: &[SimulatedFrame]) -> Vec<ExpectedMean> {
    let (model, kept) = (simulation.model(), KeptCharge::new(simulation.model()));
    let rates = rates_electrons_per_us(simulation, &frames[0]);
    let planned = simulation.frames().iter().zip(frames).collect::<Vec<_>>();
    let one_time = |group: &[(&isolux_camera::PlannedFrame, &SimulatedFrame)]| {
        let mut sum = ExpectedMean {
            integration_time_us: group[0].0.integration_time_us,
            noise_free_dn: 0.0,
            expected_dn: 0.0,
            standard_error_dn: 0.0,
        };
        let mut count = 0.0;
        for (planned, simulated) in group {
            let dn = model.gain_dn_per_electron * model.warm_up_factor(planned.frames_since_change);
            let truth = simulated.truth.noise_free_amplitude.values();
            for (index, rates) in rates.iter().enumerate().filter(|(i, _)| !simulation.dead_pixels()[*i]) {
                let (mean, variance) = kept.amplitude(rates.map(|rate| rate * planned.integration_time_us));
                sum.noise_free_dn += f64::from(truth[index]);
                sum.expected_dn += dn * mean;
                sum.standard_error_dn += dn * dn * variance;
                count += 1.0;
            }
        }
        sum.noise_free_dn /= count;
        sum.expected_dn /= count;
        // Pixels and frames are independent: the variance of the mean is the mean variance over their number.
        sum.standard_error_dn = sum.standard_error_dn.sqrt() / count;
        sum
    };
    planned.chunk_by(|a, b| a.0.integration_time_us == b.0.integration_time_us).map(one_time).collect()
}

/// Electrons per µs in the four bins of every pixel, from the planes of truth.
fn rates_electrons_per_us(simulation: &Simulation, simulated: &SimulatedFrame) -> Vec<[f64; 4]> {
    let (model, truth) = (simulation.model(), &simulated.truth);
    let width = model.width;
    (0..model.shape().pixels())
        .map(|index| {
            let lens = model.lens_factor_at((index / width) as f64, (index % width) as f64);
            let ambient = simulation.scene().ambient * f64::from(truth.reflectivity.values()[index]) * lens;
            let return_factor = f64::from(truth.return_factor.values()[index]);
            let distance_m = f64::from(truth.true_distance_m.values()[index]);
            model.bin_rates_electrons_per_us(model.light(return_factor, ambient, distance_m))
        })
        .collect()
}

/// Mean and variance of the charge that a bin keeps of a mean charge that it receives, tabulated.
struct KeptCharge {
    step_electrons: f64,
    table: Vec<[f64; 2]>,
    /// Read noise and quantization, electrons squared.
    added_variance: f64,
}

impl KeptCharge {
    /// Linear interpolation errs by f″/8 of a squared interval: 220 electrons give 1 electron at the clip, where
    /// shot noise rounds the kink, and 0.2 elsewhere; a mean amplitude there is 10⁴ electrons and more.
    const INTERVALS: usize = 4096;

    fn new(model: &CameraModel) -> Self {
        let well = FullWell::of(model);
        let clip = well.received_at_clip_electrons();
        let step_electrons = 2.0 * clip / Self::INTERVALS as f64;
        let table =
            (0..=Self::INTERVALS).map(|index| moments(&well, step_electrons * index as f64)).collect();
        Self { step_electrons, table, added_variance: model.bin_noise_electrons(0.0).powi(2) }
    }

    fn of(&self, received_electrons: f64) -> [f64; 2] {
        let position = (received_electrons / self.step_electrons).min((Self::INTERVALS - 1) as f64);
        let (index, share) = (position as usize, position - position.floor());
        let (low, high) = (self.table[index], self.table[index + 1]);
        [0, 1].map(|i| low[i] + (high[i] - low[i]) * share)
    }

    /// Mean and variance of eq. 1's amplitude, electrons. Noise across the phasor adds to its length, noise along
    /// it scatters it; both are half the difference of two bins, so half the mean variance of a bin.
    fn amplitude(&self, received_electrons: [f64; 4]) -> (f64, f64) {
        let bins = received_electrons.map(|electrons| self.of(electrons));
        let (x, y) = (0.5 * (bins[0][0] - bins[2][0]), 0.5 * (bins[1][0] - bins[3][0]));
        let variance = |a: usize, b: usize| 0.25 * (bins[a][1] + bins[b][1]) + 0.5 * self.added_variance;
        let (vx, vy) = (variance(0, 2), variance(1, 3));
        let squared = (x * x + y * y).max(f64::MIN_POSITIVE);
        let along = (vx * x * x + vy * y * y) / squared;
        let across = (vx * y * y + vy * x * x) / squared;
        (rice_mean(squared.sqrt(), across), along)
    }
}

/// Mean and variance of the kept charge over shot noise, a normal law of variance μ, by the trapezoidal rule.
fn moments(well: &FullWell, mean: f64) -> [f64; 2] {
    let (mut weight, mut first, mut second) = (0.0, 0.0, 0.0);
    for step in -24..=24 {
        let z = 0.25 * f64::from(step);
        let density = (-0.5 * z * z).exp();
        let kept = well.kept_electrons((mean + z * mean.sqrt()).max(0.0));
        weight += density;
        first += density * kept;
        second += density * kept * kept;
    }
    let mean = first / weight;
    [mean, (second / weight - mean * mean).max(0.0)]
}

/// Mean of Rice's law for a phasor of length `a` and the variance `v` of each of its components:
/// `√(πv/2) e^(−u) ((1 + 2u) I0(u) + 2u I1(u))`, u = a²/4v. From a signal-to-noise ratio of 10 on, its asymptotic
/// series, whose next term is below 10⁻⁶ of a.
pub fn rice_mean(a: f64, v: f64) -> f64 {
    let u = a * a / (4.0 * v);
    if u > 25.0 {
        return a + v / (2.0 * a) + v * v / (8.0 * a.powi(3));
    }
    let quarter = 0.25 * u * u;
    let (mut term, mut i0, mut i1) = (1.0, 0.0, 0.0);
    for k in 0..80 {
        let k = f64::from(k);
        i0 += term;
        i1 += term * 0.5 * u / (k + 1.0);
        term *= quarter / ((k + 1.0) * (k + 1.0));
    }
    (0.5 * std::f64::consts::PI * v).sqrt() * (-u).exp() * ((1.0 + 2.0 * u) * i0 + 2.0 * u * i1)
}
