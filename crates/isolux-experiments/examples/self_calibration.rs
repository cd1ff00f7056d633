//! Prints the figures of self-calibration: how near it comes to the truth on cameras that it has never seen, and what
//! recordings refuse to tell. `cargo run --release -p isolux-experiments --example self_calibration [SEED]...`

#![allow(clippy::print_stdout, reason = "the example's purpose")]

use isolux::calibrate::joint::Factor;
use isolux_camera::CameraModel;
use isolux_experiments::unseen::self_calibration::{
    Deviation, Experiment, Poses, RunKind, SelfCalibration, Spoil, measure,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seeds: Vec<u64> = std::env::args().skip(1).map(|seed| seed.parse()).collect::<Result<_, _>>()?;
    let mut cameras = vec![CameraModel::preset("sr3100")?];
    let held_out: &[u64] = if seeds.is_empty() { &[101, 102, 103, 104] } else { &seeds };
    cameras.extend(held_out.iter().map(|&seed| CameraModel::random(seed)));
    println!(
        "camera      noise     poses      s max  s rms  h max  h rms  v max  v rms  k      out    held   frames  time"
    );
    for camera in &cameras {
        for spoil in [Some(Spoil::USUAL), None] {
            for poses in [Poses::Recorded, Poses::Missing] {
                let (camera, scene) = (camera.clone(), RunKind::HandHeld.scene(40)?);
                let found = measure(&Experiment { camera: camera.clone(), scene, poses, spoil, seed: 1 })?;
                let noise = if spoil.is_some() { "2 %+5 %" } else { "its own" };
                println!("{:10}  {noise:8}  {:9}{}", camera.name, format!("{poses:?}"), row(&found));
                if spoil.is_some() {
                    found.warnings.iter().for_each(|warning| println!("    {warning}"));
                }
            }
        }
    }
    for kind in RunKind::ALL {
        let experiment = Experiment {
            camera: cameras[0].clone(),
            scene: kind.scene(24)?,
            poses: Poses::Recorded,
            spoil: Some(Spoil::USUAL),
            seed: 1,
        };
        let found = measure(&experiment)?;
        let told: Vec<&str> = [Factor::Time, Factor::Distance, Factor::Profile, Factor::Angle]
            .into_iter()
            .filter(|&factor| found.determines(factor))
            .map(Factor::name)
            .collect();
        println!(
            "\n{}: {}\n {}",
            kind.name(),
            if told.is_empty() { "nothing".into() } else { told.join(", ") },
            row(&found)
        );
        found.warnings.iter().for_each(|warning| println!("  {warning}"));
    }
    Ok(())
}

fn row(found: &SelfCalibration) -> String {
    let percent =
        |value: Option<f64>| value.map_or_else(|| "     -".to_owned(), |v| format!("{:6.2}", 100.0 * v));
    let pair = |deviation: Option<Deviation>| {
        format!("{} {}", percent(deviation.map(|d| d.largest)), percent(deviation.map(|d| d.typical)))
    };
    format!(
        "{} {} {} {} {} {} {:6} {:6.2} s",
        pair(found.time),
        pair(found.distance),
        pair(found.profile),
        found.angle_exponent.map_or_else(|| "    -".to_owned(), |k| format!("{k:5.3}")),
        percent(Some(found.report.outlier_share)),
        percent(found.report.held_out_residual),
        found.frames,
        found.elapsed.as_secs_f64()
    )
}
