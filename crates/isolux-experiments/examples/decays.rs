fn main() {
    use isolux_experiments::unseen::{chains, decay, held_out::HeldOut, still};
    for seed in std::env::args().skip(1).map(|s| s.parse::<u64>().unwrap()) {
        let t = std::time::Instant::now();
        let camera = HeldOut::new(seed).unwrap();
        eprintln!("calibrated in {:?}", t.elapsed());
        let a = camera.from_amplitude.terms.response.as_ref().unwrap().ambient.as_ref().unwrap();
        println!(
            "{seed} clip {:.3} W/c0 {:.0} p {:.2} c0 {:.3} B {:.4} K {:.4} noise {:?} fit {:?}",
            a.clip,
            a.full_well_dn / a.own_charge,
            a.softness,
            a.own_charge,
            a.ambient_dn_per_us,
            a.target_dn_per_us,
            a.noise,
            a.fit
        );
        println!(
            "  truth W/c0 {:.0} p {:.2} gain {:.4}",
            camera.model.full_well_electrons
                * camera.model.gain_dn_per_electron
                * camera.model.modulation_contrast,
            camera.model.softness,
            camera.model.gain_dn_per_electron
        );
        println!("  spline fit {:?}", camera.from_amplitude.terms.spline.as_ref().unwrap().fit);
        for ambient in decay::Ambient::ALL {
            let t = std::time::Instant::now();
            let d = decay::measure(&camera, ambient, &chains::ALL).unwrap();
            print!("  {ambient:?}:");
            for (c, d) in chains::ALL.iter().zip(d) {
                print!(" {} {:.4} ({}/{})", &c.name[..c.name.len().min(20)], d.cv, d.positions, d.of);
            }
            println!(" {:?}", t.elapsed());
        }
        let s = still::measure(&camera, &chains::ALL).unwrap();
        for (c, d) in chains::ALL.iter().zip(s.chains) {
            println!("   still {} {:.3} valid {:.3}", c.name, d.median_cv / s.floor.median_cv, d.valid);
        }
    }
}
