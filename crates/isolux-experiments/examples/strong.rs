fn main() {
    use isolux_experiments::unseen::response::{FittedOn, Light, measure};
    for seed in [101, 102, 103] {
        for light in [Light::StrongAmbient, Light::Dark] {
            for on in [FittedOn::Wall] {
                for f in measure(seed, light, on).unwrap() {
                    println!(
                        "{seed} {light:?} {on:?} {:14} median {:.4} p95 {:.4} valid {:.3} lut {:.4} floor {:.4}",
                        f.method, f.median_cv, f.p95_cv, f.valid_fraction, f.lut_median_cv, f.floor_median_cv
                    );
                }
            }
        }
    }
}
