//! What four bins of a soft well make of a light: the amplitude that they keep, and its noise.

use crate::terms::response::bins::bins;
use crate::terms::response::well::SoftWell;

/// The well as amplitudes show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Well {
    /// W, DN.
    pub(crate) full_well_dn: f64,
    pub(crate) shape: SoftWell,
    /// Share of W at which a bin clips, at most 1.
    pub(crate) clip: f64,
}

/// The light of one pixel: a linear amplitude, the charge of a bin's mean beside it, and the phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light {
    /// DN.
    pub(crate) amplitude_dn: f64,
    /// Charge of the mean of the bins over the linear amplitude: c, at least 1.
    pub(crate) charge: f64,
    /// Radians.
    pub(crate) phase: f64,
}

impl Light {
    /// Charges of the four bins, DN.
    fn bins(self) -> [f64; 4] {
        bins(self.amplitude_dn * self.charge, self.amplitude_dn, self.phase)
    }
}

impl Well {
    fn kept(self, charge_dn: f64) -> f64 {
        self.full_well_dn * self.shape.kept(charge_dn.max(0.0) / self.full_well_dn).min(self.clip)
    }

    /// The four bins, DN.
    pub(super) fn kept_bins(self, light: Light) -> [f64; 4] {
        light.bins().map(|charge| self.kept(charge))
    }

    fn differences(self, light: Light) -> [f64; 2] {
        let [a1, a2, a3, a4] = self.kept_bins(light);
        [a1 - a3, a2 - a4]
    }

    /// The amplitude (DN) that eq. 1 computes from the saturated bins.
    pub(crate) fn amplitude_dn(self, light: Light) -> f64 {
        let [cosine, sine] = self.differences(light);
        0.5 * cosine.hypot(sine)
    }

    /// Variance of that amplitude, DN²: bins are independent, each with shot noise `shot` (DN² per DN of charge), which
    /// passes through the slope of the well; `read` is the rest (DN²).
    pub(crate) fn variance_dn2(self, light: Light, read: f64, shot: f64) -> f64 {
        let [cosine, sine] = self.differences(light).map(|difference| difference * difference);
        let noise = light.bins().map(|charge| {
            let fill = charge.max(0.0) / self.full_well_dn;
            let slope = if self.shape.kept(fill) < self.clip { self.shape.slope(fill) } else { 0.0 };
            slope.powi(2) * charge.max(0.0)
        });
        let square = (cosine + sine).max(f64::MIN_POSITIVE);
        read + 0.25 * shot * (cosine * (noise[0] + noise[2]) + sine * (noise[1] + noise[3])) / square
    }

    /// The linear amplitude (DN) at which the kept one is largest, for a ratio of charge and a phase.
    pub(crate) fn peak_dn(self, charge: f64, phase: f64) -> f64 {
        let amplitude = |a: f64| self.amplitude_dn(Light { amplitude_dn: a, charge, phase });
        // Without the ripple, the peak lies where x f′(x) is largest, or nearer to where the highest bin saturates.
        let (mut low, mut high) = (0.0, 2.0 * self.full_well_dn / charge);
        // (2/3)^40 = 1e-7 of the interval: the peak itself is flat.
        for _ in 0..40 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if amplitude(left) < amplitude(right) { low = left } else { high = right }
        }
        0.5 * (low + high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn well() -> Well {
        Well { full_well_dn: 5000.0, shape: SoftWell { softness: 5.5 }, clip: 1.0 }
    }

    #[test]
    fn a_faint_light_keeps_its_amplitude_and_has_the_noise_of_its_charge() {
        let light = Light { amplitude_dn: 10.0, charge: 3.0, phase: 0.7 };
        assert!((well().amplitude_dn(light) - 10.0).abs() < 1e-9);
        // σ_a² = σ_n² / 2 of a bin that holds 30 DN, plus at most a ripple of amplitude over mean, squared.
        let variance = well().variance_dn2(light, 2.0, 0.4);
        assert!((variance - (2.0 + 0.2 * 30.0)).abs() < 1e-6, "{variance}");
    }

    /// Amplitude, charge and phase; W and p; read and shot noise; amplitude and variance by a NumPy implementation that
    /// shares no code with this one.
    type Value = ([f64; 3], [f64; 2], [f64; 2], [f64; 2]);

    const VALUES: [Value; 6] = [
        ([100.0, 2.0, 0.3], [2000.0, 5.5], [3.0, 0.1], [99.999_270_117_508_62, 12.999_558_739_123_72]),
        ([600.0, 2.0, 0.3], [2000.0, 5.5], [3.0, 0.1], [534.692_649_401_956_9, 36.879_405_421_155_51]),
        ([900.0, 1.5, 1.1], [2000.0, 4.2], [0.0, 0.02], [683.863_680_463_413_2, 4.675_553_966_712_092]),
        ([300.0, 6.0, 2.9], [2500.0, 7.0], [60.0, 0.25], [265.307_830_120_665_3, 222.818_709_543_090_96]),
        ([20.0, 90.0, 4.0], [2500.0, 7.0], [60.0, 0.25], [17.929_597_670_435_328, 240.790_908_722_956_74]),
        ([450.0, 4.0, 0.785], [1900.0, 6.0], [1.0, 0.3], [239.882_505_761_217_46, 83.249_320_931_979_4]),
    ];

    #[test]
    fn values_equal_those_of_an_independent_implementation() {
        for ([amplitude_dn, charge, phase], [full_well_dn, softness], [read, shot], [amplitude, variance]) in
            VALUES
        {
            let well = Well { full_well_dn, shape: SoftWell { softness }, clip: 1.0 };
            let light = Light { amplitude_dn, charge, phase };
            // Differences of charges cancel to a tenth of them: ten ulp; the powers add p of them.
            assert!((well.amplitude_dn(light) / amplitude - 1.0).abs() < 1e-12, "{light:?}");
            assert!((well.variance_dn2(light, read, shot) / variance - 1.0).abs() < 1e-12, "{light:?}");
        }
    }

    #[test]
    fn the_peak_is_the_largest_amplitude() {
        for charge in [1.5, 4.0, 60.0] {
            for phase in [0.0, 0.4] {
                let peak = well().peak_dn(charge, phase);
                let at = |a: f64| well().amplitude_dn(Light { amplitude_dn: a, charge, phase });
                assert!(at(peak) >= at(0.99 * peak) && at(peak) >= at(1.01 * peak), "{charge} {phase}");
            }
        }
    }
}
